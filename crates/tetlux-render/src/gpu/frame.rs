//! One picture: upload, project and draw batch by batch, read back.

use std::cell::Cell;

use wgpu::util::DeviceExt;

use super::Open;
use super::picture::Picture;
use super::pipelines::Pipelines;
use super::variant::{Binding, Geometry, Variant};
use crate::{Job, Resources};

/// Invocations a workgroup of the compute stages, as shaders/stages have them.
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
fn batch_size(limits: &wgpu::Limits, geometry: &Geometry) -> u32 {
    let bytes = limits.max_storage_buffer_binding_size.min(limits.max_buffer_size);
    let index_bytes = geometry.indices.map_or(0, size_of_val) as u64;
    let dispatch = limits.max_compute_workgroups_per_dimension.saturating_mul(WORKGROUP);
    // The vertices of a draw call are numbered in 32 bits.
    let cells = u32::try_from(bytes / geometry.bytes.max(index_bytes)).unwrap_or(u32::MAX);
    cells.min(dispatch).clamp(1, u32::MAX / geometry.indices.map_or(geometry.vertices, |i| i.len() as u32))
}

/// Makes buffers and counts them.
pub(super) struct Maker<'a> {
    device: &'a wgpu::Device,
    made: Cell<Resources>,
}

impl<'a> Maker<'a> {
    pub(super) fn new(device: &'a wgpu::Device, made: Resources) -> Maker<'a> {
        Maker { device, made: Cell::new(made) }
    }

    /// Everything made so far.
    pub(super) fn made(&self) -> Resources {
        self.made.get()
    }

    pub(super) fn count(&self, buffers: usize, textures: usize, bytes: u64) {
        let mut made = self.made.get();
        made.buffers += buffers;
        made.textures += textures;
        made.bytes += bytes;
        self.made.set(made);
    }

    pub(super) fn filled(&self, label: &str, contents: &[u8], usage: wgpu::BufferUsages) -> wgpu::Buffer {
        // Bindings may not be empty.
        let contents = if contents.is_empty() { &[0; 16] } else { contents };
        self.count(1, 0, contents.len() as u64);
        self.device.create_buffer_init(&wgpu::util::BufferInitDescriptor { label: Some(label), contents, usage })
    }

    fn empty(&self, label: &str, size: u64, usage: wgpu::BufferUsages) -> wgpu::Buffer {
        self.count(1, 0, size);
        self.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some(label),
            size,
            usage,
            mapped_at_creation: false,
        })
    }

    pub(super) fn bind(&self, layout: &wgpu::BindGroupLayout, buffers: &[(u32, &wgpu::Buffer)]) -> wgpu::BindGroup {
        let entries: Vec<_> = buffers
            .iter()
            .map(|&(binding, b)| wgpu::BindGroupEntry { binding, resource: b.as_entire_binding() })
            .collect();
        self.device.create_bind_group(&wgpu::BindGroupDescriptor { label: None, layout, entries: &entries })
    }

    pub(super) fn scene(&self, binding: Binding, job: &Job) -> wgpu::Buffer {
        let storage = wgpu::BufferUsages::STORAGE;
        match binding {
            Binding::View => self.filled("view", bytemuck::bytes_of(&job.lens.view), wgpu::BufferUsages::UNIFORM),
            Binding::Pieces => {
                let pieces: Vec<[[f32; 4]; 3]> = job.pieces.iter().map(|p| [p.low, p.high, p.s]).collect();
                self.filled("pieces", bytemuck::cast_slice(&pieces), storage)
            }
            Binding::Points => self.filled("points", bytemuck::cast_slice(&job.mesh.points), storage),
            Binding::Cells => self.filled("cells", bytemuck::cast_slice(&job.mesh.cells), storage),
            Binding::CellScalars => self.filled("cell scalars", bytemuck::cast_slice(&job.mesh.cell_scalars), storage),
            Binding::Order => self.filled("order", bytemuck::cast_slice(job.order), storage),
        }
    }
}

/// Draws the picture; the error is what the driver said.
pub(super) fn draw(
    open: &Open,
    variant: &Variant,
    pipelines: &Pipelines,
    job: &Job,
) -> Result<(Vec<[f32; 4]>, Resources), String> {
    let Open { device, queue } = open;
    let cells = job.order.len() as u32;
    let made = Resources { pipelines: pipelines.count(), cells: job.order.len(), ..Resources::default() };
    let make = Maker::new(device, made);
    let scene: Vec<_> = variant.bindings().into_iter().map(|b| (b as u32, make.scene(b, job))).collect();
    let scene: Vec<_> = scene.iter().map(|(binding, buffer)| (*binding, buffer)).collect();
    let scene = make.bind(&pipelines.scene, &scene);

    let geometry = variant.geometry();
    let batch = batch_size(&device.limits(), &geometry).min(cells.max(1));
    let indices = geometry.indices.map(|pattern| {
        let all: Vec<u32> = (0..batch).flat_map(|i| pattern.iter().map(move |k| geometry.vertices * i + k)).collect();
        make.filled("indices", bytemuck::cast_slice(&all), wgpu::BufferUsages::INDEX)
    });
    let projected = pipelines
        .compute
        .is_some()
        .then(|| make.empty("projected cells", u64::from(batch) * geometry.bytes, wgpu::BufferUsages::STORAGE));
    let picture = Picture::new(device, job.size, variant.format(), wgpu::TextureUsages::RENDER_ATTACHMENT);
    let [texture, readback] = picture.bytes();
    make.count(0, 1, texture);
    make.count(1, 0, readback);
    let target = picture.view();

    let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    let mut load = wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT);
    let mut remaining = cells;
    // Once even without cells: the picture must be cleared.
    loop {
        let count = remaining.min(batch);
        let uniform = Batch { last: remaining.saturating_sub(1), count, unused: [0; 2] };
        let uniform = make.filled("batch", bytemuck::bytes_of(&uniform), wgpu::BufferUsages::UNIFORM);
        let buffers: Vec<_> = [&uniform].into_iter().chain(&projected).collect();
        let buffers: Vec<_> = (0u32..).zip(buffers).collect();
        if let Some(stage) = &pipelines.compute {
            let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
            pass.set_pipeline(&stage.pipeline);
            pass.set_bind_group(0, &scene, &[]);
            pass.set_bind_group(1, &make.bind(&stage.batch, &buffers), &[]);
            pass.dispatch_workgroups(count.div_ceil(WORKGROUP), 1, 1);
        }
        let attachment = wgpu::RenderPassColorAttachment {
            view: &target,
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations { load, store: wgpu::StoreOp::Store },
        };
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            color_attachments: &[Some(attachment)],
            ..Default::default()
        });
        pass.set_pipeline(&pipelines.draw.pipeline);
        pass.set_bind_group(0, &scene, &[]);
        pass.set_bind_group(1, &make.bind(&pipelines.draw.batch, &buffers), &[]);
        match (&indices, geometry.indices) {
            (Some(indices), Some(pattern)) => {
                pass.set_index_buffer(indices.slice(..), wgpu::IndexFormat::Uint32);
                pass.draw_indexed(0..pattern.len() as u32 * count, 0, 0..1);
            }
            _ => pass.draw(0..geometry.vertices * count, 0..1),
        }
        drop(pass);
        load = wgpu::LoadOp::Load;
        remaining -= count;
        if remaining == 0 {
            break;
        }
    }
    picture.copy(&mut encoder);
    queue.submit([encoder.finish()]);
    Ok((picture.read(device)?, make.made()))
}
