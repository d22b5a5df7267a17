//! Where opaque surfaces end rays, as a texture of depths (shaders/surface/opaque.wgsl).

use glam::DVec3;
use wgpu::util::{DeviceExt, TextureDataOrder};

use super::Open;
use super::frame::Maker;
use crate::Job;
use crate::backdrop::BEYOND;

/// The bind group.
pub(super) const GROUP: u32 = 3;

pub(super) fn layout(device: &wgpu::Device, visibility: wgpu::ShaderStages) -> wgpu::BindGroupLayout {
    let ty = wgpu::BindingType::Texture {
        sample_type: wgpu::TextureSampleType::Float { filterable: false },
        view_dimension: wgpu::TextureViewDimension::D2,
        multisampled: false,
    };
    let entries = [wgpu::BindGroupLayoutEntry { binding: 0, visibility, ty, count: None }];
    device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: Some("surfaces"), entries: &entries })
}

/// The bind group, made.
pub(super) fn bound(open: &Open, make: &Maker, layout: &wgpu::BindGroupLayout, job: &Job) -> wgpu::BindGroup {
    let depths = depths(job);
    let bytes: &[u8] = bytemuck::cast_slice(&depths);
    make.count(0, 1, bytes.len() as u64);
    let descriptor = wgpu::TextureDescriptor {
        label: Some("surfaces"),
        size: wgpu::Extent3d { width: job.size[0], height: job.size[1], depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::R32Float,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    };
    let texture = open.device.create_texture_with_data(&open.queue, &descriptor, TextureDataOrder::LayerMajor, bytes);
    let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
    let entries = [wgpu::BindGroupEntry { binding: 0, resource: wgpu::BindingResource::TextureView(&view) }];
    open.device.create_bind_group(&wgpu::BindGroupDescriptor { label: Some("surfaces"), layout, entries: &entries })
}

/// For every pixel the depth from the pivot at which its ray ends.
fn depths(job: &Job) -> Vec<f32> {
    let [high, low] =
        [job.view.pivot_high, job.view.pivot_low].map(|[x, y, z, _]| DVec3::new(x.into(), y.into(), z.into()));
    let pivot = job.eye.frame(high + low).z as f32;
    let from_origin = job.backdrop.iter().flat_map(|backdrop| &backdrop.depths);
    from_origin.map(|&depth| if depth < BEYOND { depth - pivot } else { BEYOND }).collect()
}
