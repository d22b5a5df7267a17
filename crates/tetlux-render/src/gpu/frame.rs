//! One picture: upload, project and draw batch by batch, read back.

use wgpu::util::DeviceExt;

use super::Open;
use super::pipelines::{CELL_BYTES, Pipelines, TARGET};
use crate::Job;

/// Invocations a workgroup of the projection, as shaders/stages/project.wgsl has them.
const WORKGROUP: u32 = 64;

/// Laid out as the shader's `Batch` (shaders/lib/mesh.wgsl).
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub(crate) struct Batch {
    pub(crate) last: u32,
    pub(crate) count: u32,
    pub(crate) unused: [u32; 2],
}

/// Cells a batch: what one binding of projected cells, and one dispatch, can hold.
fn batch_size(limits: &wgpu::Limits) -> u32 {
    let bytes = limits.max_storage_buffer_binding_size.min(limits.max_buffer_size);
    let dispatch = limits.max_compute_workgroups_per_dimension.saturating_mul(WORKGROUP);
    // Six vertices a cell are numbered in 32 bits.
    u32::try_from(bytes / CELL_BYTES).unwrap_or(u32::MAX).min(dispatch).clamp(1, u32::MAX / 6)
}

/// Draws the picture; the error is what the driver said.
pub(super) fn draw(open: &Open, pipelines: &Pipelines, job: &Job) -> Result<Vec<[f32; 4]>, String> {
    let Open { device, queue } = open;
    let buffer = |label, contents: &[u8], usage| {
        // Bindings may not be empty.
        let contents = if contents.is_empty() { &[0; 16] } else { contents };
        device.create_buffer_init(&wgpu::util::BufferInitDescriptor { label: Some(label), contents, usage })
    };
    let storage = wgpu::BufferUsages::STORAGE;
    let pieces: Vec<[[f32; 4]; 3]> = job.pieces.iter().map(|p| [p.low, p.high, p.s]).collect();
    let scene = [
        buffer("view", bytemuck::bytes_of(&job.lens.view), wgpu::BufferUsages::UNIFORM),
        buffer("pieces", bytemuck::cast_slice(&pieces), storage),
        buffer("points", bytemuck::cast_slice(&job.mesh.points), storage),
        buffer("cells", bytemuck::cast_slice(&job.mesh.cells), storage),
        buffer("cell scalars", bytemuck::cast_slice(&job.mesh.cell_scalars), storage),
        buffer("order", bytemuck::cast_slice(job.order), storage),
    ];
    let bind = |layout, buffers: &[&wgpu::Buffer]| {
        let entries: Vec<_> = (0u32..)
            .zip(buffers)
            .map(|(binding, b)| wgpu::BindGroupEntry { binding, resource: b.as_entire_binding() })
            .collect();
        device.create_bind_group(&wgpu::BindGroupDescriptor { label: None, layout, entries: &entries })
    };
    let scene_group = bind(&pipelines.scene, &scene.each_ref());

    let cells = job.order.len() as u32;
    let batch = batch_size(&device.limits()).min(cells.max(1));
    let projected = device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("projected cells"),
        size: u64::from(batch) * CELL_BYTES,
        usage: storage,
        mapped_at_creation: false,
    });
    let size = wgpu::Extent3d { width: job.size[0], height: job.size[1], depth_or_array_layers: 1 };
    let target = device.create_texture(&wgpu::TextureDescriptor {
        label: Some("picture"),
        size,
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: TARGET,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC,
        view_formats: &[],
    });
    let target_view = target.create_view(&wgpu::TextureViewDescriptor::default());
    let row_bytes = (job.size[0] * 16).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
    let readback = device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("readback"),
        size: u64::from(row_bytes) * u64::from(job.size[1]),
        usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });

    let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    let mut load = wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT);
    let mut remaining = cells;
    // Once even without cells: the picture must be cleared.
    loop {
        let count = remaining.min(batch);
        let uniform = Batch { last: remaining.saturating_sub(1), count, unused: [0; 2] };
        let uniform = buffer("batch", bytemuck::bytes_of(&uniform), wgpu::BufferUsages::UNIFORM);
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
        pass.set_pipeline(&pipelines.project);
        pass.set_bind_group(0, &scene_group, &[]);
        pass.set_bind_group(1, &bind(&pipelines.project_batch, &[&uniform, &projected]), &[]);
        pass.dispatch_workgroups(count.div_ceil(WORKGROUP), 1, 1);
        drop(pass);
        let attachment = wgpu::RenderPassColorAttachment {
            view: &target_view,
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations { load, store: wgpu::StoreOp::Store },
        };
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            color_attachments: &[Some(attachment)],
            ..Default::default()
        });
        pass.set_pipeline(&pipelines.draw);
        pass.set_bind_group(0, &scene_group, &[]);
        pass.set_bind_group(1, &bind(&pipelines.draw_batch, &[&uniform, &projected]), &[]);
        pass.draw(0..6 * count, 0..1);
        drop(pass);
        load = wgpu::LoadOp::Load;
        remaining -= count;
        if remaining == 0 {
            break;
        }
    }
    encoder.copy_texture_to_buffer(
        target.as_image_copy(),
        wgpu::TexelCopyBufferInfo {
            buffer: &readback,
            layout: wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(row_bytes), rows_per_image: None },
        },
        size,
    );
    queue.submit([encoder.finish()]);

    let (sender, receiver) = std::sync::mpsc::channel();
    readback.map_async(wgpu::MapMode::Read, .., move |result| {
        // The receiver is gone only if polling failed, which is reported.
        let _ = sender.send(result);
    });
    device.poll(wgpu::PollType::wait_indefinitely()).map_err(|e| e.to_string())?;
    receiver.recv().map_err(|e| e.to_string())?.map_err(|e| e.to_string())?;
    let bytes = readback.get_mapped_range(..).map_err(|e| e.to_string())?;
    let rows = bytes.chunks_exact(row_bytes as usize);
    let mut pixels = Vec::with_capacity(job.size[0] as usize * job.size[1] as usize);
    for row in rows {
        pixels.extend_from_slice(bytemuck::cast_slice(&row[..job.size[0] as usize * 16]));
    }
    Ok(pixels)
}
