//! The picture on the device, and back.

/// The picture as a texture.
pub(super) struct Picture {
    size: wgpu::Extent3d,
    format: wgpu::TextureFormat,
    texture: wgpu::Texture,
    readback: wgpu::Buffer,
    row_bytes: u32,
}

impl Picture {
    /// `usage` is how it is written.
    pub(super) fn new(
        device: &wgpu::Device,
        [width, height]: [u32; 2],
        format: wgpu::TextureFormat,
        usage: wgpu::TextureUsages,
    ) -> Picture {
        let size = wgpu::Extent3d { width, height, depth_or_array_layers: 1 };
        let texture = device.create_texture(&wgpu::TextureDescriptor {
            label: Some("picture"),
            size,
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage: usage | wgpu::TextureUsages::COPY_SRC,
            view_formats: &[],
        });
        let row_bytes = (width * pixel_bytes(format)).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
        let readback = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("readback"),
            size: u64::from(row_bytes) * u64::from(height),
            usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        Picture { size, format, texture, readback, row_bytes }
    }

    pub(super) fn view(&self) -> wgpu::TextureView {
        self.texture.create_view(&wgpu::TextureViewDescriptor::default())
    }

    /// Bytes of the texture and of the buffer that it is read back through.
    pub(super) fn bytes(&self) -> [u64; 2] {
        let pixels = u64::from(self.size.width) * u64::from(self.size.height);
        [pixels * u64::from(pixel_bytes(self.format)), self.readback.size()]
    }

    /// Records the copy that [`Picture::read`] waits for.
    pub(super) fn copy(&self, encoder: &mut wgpu::CommandEncoder) {
        let layout =
            wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(self.row_bytes), rows_per_image: None };
        let buffer = wgpu::TexelCopyBufferInfo { buffer: &self.readback, layout };
        encoder.copy_texture_to_buffer(self.texture.as_image_copy(), buffer, self.size);
    }

    /// The pixels, top row first, once the device is done; the error is what the driver said.
    pub(super) fn read(&self, device: &wgpu::Device) -> Result<Vec<[f32; 4]>, String> {
        let bytes = mapped(device, &self.readback)?;
        let used = (self.size.width * pixel_bytes(self.format)) as usize;
        let mut pixels = Vec::with_capacity(self.size.width as usize * self.size.height as usize);
        for row in bytes.chunks_exact(self.row_bytes as usize) {
            decode(&row[..used], self.format, &mut pixels);
        }
        Ok(pixels)
    }
}

/// What a buffer that can be mapped holds, once the device is done; the error is what the driver said.
pub(super) fn mapped(device: &wgpu::Device, buffer: &wgpu::Buffer) -> Result<wgpu::BufferView, String> {
    let (sender, receiver) = std::sync::mpsc::channel();
    buffer.map_async(wgpu::MapMode::Read, .., move |result| {
        // The receiver is gone only if polling failed, which is reported.
        let _ = sender.send(result);
    });
    // wgpu panics if the device is lost while it is waited for.
    let wait = || device.poll(wgpu::PollType::wait_indefinitely());
    let waited = std::panic::catch_unwind(std::panic::AssertUnwindSafe(wait));
    waited.map_err(|_| "the device did not finish".to_string())?.map_err(|e| e.to_string())?;
    receiver.recv().map_err(|e| e.to_string())?.map_err(|e| e.to_string())?;
    buffer.get_mapped_range(..).map_err(|e| e.to_string())
}

/// Bytes of a pixel.
pub(super) fn pixel_bytes(format: wgpu::TextureFormat) -> u32 {
    match format {
        wgpu::TextureFormat::Rgba8Unorm => 4,
        wgpu::TextureFormat::Rgba16Float => 8,
        _ => 16,
    }
}

fn decode(row: &[u8], format: wgpu::TextureFormat, pixels: &mut Vec<[f32; 4]>) {
    match format {
        wgpu::TextureFormat::Rgba8Unorm => {
            pixels.extend(row.chunks_exact(4).map(|p| std::array::from_fn(|i| f32::from(p[i]) / 255.0)));
        }
        wgpu::TextureFormat::Rgba16Float => pixels.extend(
            row.chunks_exact(8)
                .map(|p| std::array::from_fn(|i| half::f16::from_le_bytes([p[2 * i], p[2 * i + 1]]).to_f32())),
        ),
        _ => pixels.extend_from_slice(bytemuck::cast_slice(row)),
    }
}
