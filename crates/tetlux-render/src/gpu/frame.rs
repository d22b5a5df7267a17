//! One picture: upload, project and draw batch by batch, read back.

use std::cell::Cell;

use super::look;
use super::picture::Picture;
use super::pipelines::Pipelines;
use super::resident::Resident;
use super::spent::{Count, counters};
use super::stretch::{group_ends, scissor, stretches};
use super::surfaces;
use super::tables;
use super::variant::{Binding, CELL_BYTES, Geometry, Variant};
use super::{Drawn, Open};
use crate::device_mesh::ascending;
use crate::{Job, Resources};

/// Invocations a workgroup of the compute stages, as shaders/stages have them.
pub(super) const WORKGROUP: u32 = 64;

/// Laid out as the shader's `Batch` (shaders/lib/mesh.wgsl).
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub(crate) struct Batch {
    pub(crate) last: u32,
    pub(crate) count: u32,
    pub(crate) unused: [u32; 2],
}

/// Cells a batch at most: enough to occupy any device, and few enough that projected cells are a small part of what a
/// large mesh takes.
const LARGEST_BATCH: u32 = 1 << 18;

/// Cells a batch: what one binding of projected cells, and one dispatch, can hold.
pub(super) fn batch_size(limits: &wgpu::Limits, geometry: &Geometry) -> u32 {
    let bytes = limits.max_storage_buffer_binding_size.min(limits.max_buffer_size);
    let index_bytes = geometry.indices.map_or(0, size_of_val) as u64;
    let dispatch = limits.max_compute_workgroups_per_dimension.saturating_mul(WORKGROUP);
    // The vertices of a draw call are numbered in 32 bits.
    let cells = u32::try_from(bytes / geometry.bytes.max(index_bytes)).unwrap_or(u32::MAX);
    cells
        .min(dispatch)
        .min(LARGEST_BATCH)
        .clamp(1, u32::MAX / geometry.indices.map_or(geometry.vertices, |i| i.len() as u32))
}

/// Makes buffers and counts them.
pub(super) struct Maker<'a> {
    pub(super) device: &'a wgpu::Device,
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

    pub(super) fn count_pipelines(&self, pipelines: usize) {
        let mut made = self.made.get();
        made.pipelines += pipelines;
        self.made.set(made);
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
        let buffer = self.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some(label),
            size: (contents.len() as u64).next_multiple_of(wgpu::COPY_BUFFER_ALIGNMENT),
            usage,
            mapped_at_creation: true,
        });
        // Without memory, or on a device that is lost, there is nothing to fill, and an error is on its way.
        if let Ok(mut mapped) = buffer.get_mapped_range_mut(..) {
            mapped.slice(..contents.len()).copy_from_slice(contents);
        }
        buffer.unmap();
        buffer
    }

    pub(super) fn empty(&self, label: &str, size: u64, usage: wgpu::BufferUsages) -> wgpu::Buffer {
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

    pub(super) fn scene(&self, binding: Binding, job: &Job, resident: &Resident) -> wgpu::Buffer {
        let storage = wgpu::BufferUsages::STORAGE;
        let kept = |part, fill: &dyn Fn() -> wgpu::Buffer| resident.buffer(self, job.mesh, part, fill);
        match binding {
            Binding::View => self.filled("view", bytemuck::bytes_of(&job.view), wgpu::BufferUsages::UNIFORM),
            Binding::Pieces => {
                // Those of two fields are the look's.
                let pieces = job.look.as_ref().and_then(look::pieces);
                let pieces = pieces.as_deref().unwrap_or(job.pieces);
                let pieces: Vec<[[f32; 4]; 3]> = pieces.iter().map(|p| [p.low, p.high, p.s]).collect();
                self.filled("pieces", bytemuck::cast_slice(&pieces), storage)
            }
            Binding::Points => kept(0, &|| self.filled("points", bytemuck::cast_slice(&job.mesh.points), storage)),
            Binding::Cells => kept(1, &|| {
                let cells: Vec<[u32; 4]> = job.cells.iter().map(|&cell| ascending(cell)).collect();
                self.filled("cells", bytemuck::cast_slice(&cells), storage)
            }),
            Binding::CellScalars => {
                kept(2, &|| self.filled("cell scalars", bytemuck::cast_slice(&job.mesh.cell_scalars), storage))
            }
            Binding::Order => self.filled("order", bytemuck::cast_slice(job.order), storage),
            Binding::Seen => self.filled("points as seen", bytemuck::cast_slice(job.seen), storage),
            Binding::EntryPieces => self.filled("pieces of cells", bytemuck::cast_slice(job.entry_pieces), storage),
            Binding::GroupEnds => {
                let ends = group_ends(job.order.len() as u32, job.groups);
                self.filled("ends of groups", bytemuck::cast_slice(&ends), storage)
            }
            Binding::Spent => counters(self),
            Binding::Seconds | Binding::Gradients | Binding::Look | Binding::Widgets | Binding::Texels => {
                let contents = job.look.as_ref().map_or(Vec::new(), |look| look::contents(look, binding));
                self.filled("look", &contents, storage)
            }
            Binding::Attributes => self.filled("attributes of vertices", bytemuck::cast_slice(job.attributes), storage),
        }
    }
}

/// Draws the picture; `groups` are the pipelines of cells without an order, if there are any. The error is what the driver
/// said.
pub(super) fn draw(
    open: &Open,
    variant: &Variant,
    pipelines: &Pipelines,
    groups: Option<&Pipelines>,
    job: &Job,
) -> Result<Drawn, String> {
    let Open { device, queue, resident, .. } = open;
    let cells = job.order.len() as u32;
    let pipeline_count = pipelines.count() + groups.map_or(0, Pipelines::count);
    let made = Resources { pipelines: pipeline_count, cells: job.order.len(), ..Resources::default() };
    let make = Maker::new(device, made);
    let scene: Vec<_> = variant.bindings().into_iter().map(|b| (b, make.scene(b, job, resident))).collect();
    let count = Count::new(&make, &scene);
    let scene: Vec<_> = scene.iter().map(|(binding, buffer)| (*binding as u32, buffer)).collect();
    let scene = make.bind(&pipelines.scene, &scene);

    let tables = pipelines.tables.as_ref().map(|layout| tables::bind(&make, queue, layout, job));
    let surfaces = pipelines.surfaces.as_ref().map(|layout| surfaces::bound(open, &make, layout, job));

    let geometry = variant.geometry();
    let batch = batch_size(&device.limits(), &geometry).min(cells.max(1));
    let stretches = stretches(cells, if groups.is_some() { job.groups } else { &[] }, batch);
    let indices = geometry.indices.map(|pattern| {
        let all: Vec<u32> = (0..batch).flat_map(|i| pattern.iter().map(move |k| geometry.vertices * i + k)).collect();
        make.filled("indices", bytemuck::cast_slice(&all), wgpu::BufferUsages::INDEX)
    });
    // Groups are projected whatever the other cells are.
    let projected_bytes =
        u64::from(batch) * if groups.is_some() { CELL_BYTES.max(geometry.bytes) } else { geometry.bytes };
    let projects = pipelines.compute.is_some() || groups.is_some();
    let projected = projects.then(|| make.empty("projected cells", projected_bytes, wgpu::BufferUsages::STORAGE));
    let picture = Picture::new(device, job.size, variant.format(), wgpu::TextureUsages::RENDER_ATTACHMENT);
    let [texture, readback] = picture.bytes();
    make.count(0, 1, texture);
    make.count(1, 0, readback);
    let target = picture.view();

    let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    let mut load = wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT);
    for stretch in stretches {
        let cells = stretch.cells.end - stretch.cells.start;
        let pipelines = if stretch.group { groups.unwrap_or(pipelines) } else { pipelines };
        let uniform = Batch { last: stretch.cells.end.saturating_sub(1), count: cells, unused: [0; 2] };
        let uniform = make.filled("batch", bytemuck::bytes_of(&uniform), wgpu::BufferUsages::UNIFORM);
        let projected = projected.as_ref().filter(|_| pipelines.compute.is_some());
        let buffers: Vec<_> = [&uniform].into_iter().chain(projected).collect();
        let buffers: Vec<_> = (0u32..).zip(buffers).collect();
        if let Some(stage) = &pipelines.compute {
            let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
            pass.set_pipeline(&stage.pipeline);
            pass.set_bind_group(0, &scene, &[]);
            pass.set_bind_group(1, &make.bind(&stage.batch, &buffers), &[]);
            pass.dispatch_workgroups(cells.div_ceil(WORKGROUP), 1, 1);
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
        if let Some(tables) = &tables {
            pass.set_bind_group(2, tables, &[]);
        }
        if let Some(surfaces) = &surfaces {
            pass.set_bind_group(surfaces::GROUP, surfaces, &[]);
        }
        if stretch.group {
            let [x, y, width, height] = scissor(job, &stretch.cells);
            pass.set_scissor_rect(x, y, width, height);
            pass.draw(0..3, 0..1);
        } else if let (Some(indices), Some(pattern)) = (&indices, geometry.indices) {
            pass.set_index_buffer(indices.slice(..), wgpu::IndexFormat::Uint32);
            pass.draw_indexed(0..pattern.len() as u32 * cells, 0, 0..1);
        } else if geometry.instanced {
            pass.draw(0..geometry.vertices, 0..cells);
        } else {
            pass.draw(0..geometry.vertices * cells, 0..1);
        }
        drop(pass);
        load = wgpu::LoadOp::Load;
    }
    picture.copy(&mut encoder);
    count.iter().for_each(|count| count.copy(&mut encoder));
    queue.submit([encoder.finish()]);
    let spent = count.map(|count| count.read(device)).transpose()?;
    Ok(Drawn { pixels: picture.read(device)?, resources: make.made(), spent })
}
