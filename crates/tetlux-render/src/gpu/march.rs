//! One picture by marching: one dispatch, a pixel an invocation; no order, no draw, no blending.

use wgpu::{BindingType, BufferBindingType, ShaderStages};

use super::frame::Maker;
use super::picture::Picture;
use super::spent::Count;
use super::surfaces;
use super::tables;
use super::variant::{Binding, Variant};
use super::{Drawn, Open};
use crate::march::March;
use crate::{Job, RenderError, Resources};

/// Pixels a workgroup has in x and in y, as shaders/stages/march.wgsl has them.
const WORKGROUP: u32 = 8;

/// Laid out as the shader's `March` (shaders/stages/march.wgsl).
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub(crate) struct Limits {
    pub(crate) opaque: f32,
    pub(crate) steps: u32,
    pub(crate) unused: [u32; 2],
}

#[derive(Debug)]
pub(super) struct Marcher {
    pipeline: wgpu::ComputePipeline,
    scene: wgpu::BindGroupLayout,
    /// Where rays come in, and the picture.
    entries: wgpu::BindGroupLayout,
    /// Tables of integrals, if there are any.
    tables: Option<wgpu::BindGroupLayout>,
    /// Where surfaces end rays, if there are any.
    surfaces: Option<wgpu::BindGroupLayout>,
}

impl Marcher {
    pub(super) fn new(device: &wgpu::Device, variant: Variant) -> Result<Marcher, RenderError> {
        let name = "stages::march";
        let source = wgpu::ShaderSource::Wgsl(tetlux_shaders::compose(name, &variant.choices())?.into());
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor { label: Some(name), source });
        let buffer = |ty| BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None };
        let uniform = buffer(BufferBindingType::Uniform);
        let storage = buffer(BufferBindingType::Storage { read_only: true });
        let picture = BindingType::StorageTexture {
            access: wgpu::StorageTextureAccess::WriteOnly,
            format: variant.format(),
            view_dimension: wgpu::TextureViewDimension::D2,
        };
        let layout = |label, entries: &[(u32, BindingType)]| {
            let entry = |&(binding, ty)| wgpu::BindGroupLayoutEntry {
                binding,
                visibility: ShaderStages::COMPUTE,
                ty,
                count: None,
            };
            let entries: Vec<_> = entries.iter().map(entry).collect();
            device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: Some(label), entries: &entries })
        };
        let of = |binding: Binding| (binding as u32, buffer(binding.kind()));
        let scene: Vec<_> = variant.bindings().into_iter().map(of).collect();
        let scene = layout("scene", &scene);
        let entries = layout("march", &[(0, uniform), (1, storage), (2, storage), (3, storage), (4, picture)]);
        let tables = tables::layout(device, &variant, ShaderStages::COMPUTE);
        let surfaces = variant.surfaces.then(|| surfaces::layout(device, ShaderStages::COMPUTE));
        let layouts = [Some(&scene), Some(&entries), tables.as_ref(), surfaces.as_ref()];
        let count = layouts.iter().rposition(Option::is_some).map_or(0, |last| last + 1);
        let pipeline_layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: None,
            bind_group_layouts: &layouts[..count],
            immediate_size: 0,
        });
        let constants = [("ORTHOGRAPHIC", f64::from(u8::from(variant.orthographic)))];
        let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some(name),
            layout: Some(&pipeline_layout),
            module: &module,
            entry_point: None,
            compilation_options: wgpu::PipelineCompilationOptions { constants: &constants, ..Default::default() },
            cache: None,
        });
        Ok(Marcher { pipeline, scene, entries, tables, surfaces })
    }

    /// Makes the picture; the error is what the driver said.
    pub(super) fn draw(&self, open: &Open, variant: &Variant, job: &Job, march: &March) -> Result<Drawn, String> {
        let Open { device, queue, resident, .. } = open;
        let make = Maker::new(device, Resources { pipelines: 1, cells: job.order.len(), ..Resources::default() });
        let scene: Vec<_> = variant.bindings().into_iter().map(|b| (b, make.scene(b, job, resident))).collect();
        let count = Count::new(&make, &scene);
        let scene: Vec<_> = scene.iter().map(|(binding, buffer)| (*binding as u32, buffer)).collect();
        let scene = make.bind(&self.scene, &scene);
        let tables = self.tables.as_ref().map(|layout| tables::bind(&make, queue, layout, job));
        let steps = u32::try_from(job.order.len()).unwrap_or(u32::MAX);
        let limits = Limits { opaque: job.opaque, steps, unused: [0; 2] };
        let storage = wgpu::BufferUsages::STORAGE;
        let buffers = [
            make.filled("limits", bytemuck::bytes_of(&limits), wgpu::BufferUsages::UNIFORM),
            make.filled("neighbors", bytemuck::cast_slice(&march.neighbors), storage),
            make.filled("starts", bytemuck::cast_slice(&march.starts), storage),
            make.filled("entries", bytemuck::cast_slice(&march.entries), storage),
        ];
        let picture = Picture::new(device, job.size, variant.format(), wgpu::TextureUsages::STORAGE_BINDING);
        let [texture, readback] = picture.bytes();
        make.count(0, 1, texture);
        make.count(1, 0, readback);
        let view = picture.view();
        let entry = |(binding, resource)| wgpu::BindGroupEntry { binding, resource };
        let resources = buffers.iter().map(wgpu::Buffer::as_entire_binding);
        let resources = resources.chain([wgpu::BindingResource::TextureView(&view)]);
        let entries: Vec<_> = (0..).zip(resources).map(entry).collect();
        let entries = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("march"),
            layout: &self.entries,
            entries: &entries,
        });
        let surfaces = self.surfaces.as_ref().map(|layout| surfaces::bound(open, &make, layout, job));
        let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &scene, &[]);
        pass.set_bind_group(1, &entries, &[]);
        if let Some(tables) = &tables {
            pass.set_bind_group(2, tables, &[]);
        }
        if let Some(surfaces) = &surfaces {
            pass.set_bind_group(surfaces::GROUP, surfaces, &[]);
        }
        let [columns, rows] = job.size.map(|n| n.div_ceil(WORKGROUP));
        pass.dispatch_workgroups(columns, rows, 1);
        drop(pass);
        picture.copy(&mut encoder);
        count.iter().for_each(|count| count.copy(&mut encoder));
        queue.submit([encoder.finish()]);
        let spent = count.map(|count| count.read(device)).transpose()?;
        Ok(Drawn { pixels: picture.read(device)?, resources: make.made(), spent })
    }
}
