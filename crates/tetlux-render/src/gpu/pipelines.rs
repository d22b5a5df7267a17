//! Pipelines, one set for each variant of the shaders.

use wgpu::{BindingType, BufferBindingType, ShaderStages};

use super::surfaces;
use super::tables;
use super::variant::{Binding, Variant};
use crate::RenderError;

#[derive(Debug)]
pub(super) struct Pipelines {
    /// What [`Variant::bindings`] names.
    pub(super) scene: wgpu::BindGroupLayout,
    /// Tables and their decoding, if there are any.
    pub(super) tables: Option<wgpu::BindGroupLayout>,
    /// Where surfaces end rays, if there are any.
    pub(super) surfaces: Option<wgpu::BindGroupLayout>,
    pub(super) draw: Stage<wgpu::RenderPipeline>,
    /// The stage before it, if there is one.
    pub(super) compute: Option<Stage<wgpu::ComputePipeline>>,
}

/// A pipeline and the layout of its batch: the batch itself and its projected cells, written or read.
#[derive(Debug)]
pub(super) struct Stage<P> {
    pub(super) pipeline: P,
    pub(super) batch: wgpu::BindGroupLayout,
}

impl Pipelines {
    /// How many there are.
    pub(super) fn count(&self) -> usize {
        1 + usize::from(self.compute.is_some())
    }

    pub(super) fn new(device: &wgpu::Device, variant: Variant) -> Result<Pipelines, RenderError> {
        let choices = variant.choices();
        let shader = |name: &str| -> Result<wgpu::ShaderModule, RenderError> {
            let source = wgpu::ShaderSource::Wgsl(tetlux_shaders::compose(name, &choices)?.into());
            Ok(device.create_shader_module(wgpu::ShaderModuleDescriptor { label: Some(name), source }))
        };
        let buffer = |ty| BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None };
        let uniform = buffer(BufferBindingType::Uniform);
        let storage = buffer(BufferBindingType::Storage { read_only: true });
        let writable = buffer(BufferBindingType::Storage { read_only: false });
        let layout = |label, entries: &[(u32, ShaderStages, BindingType)]| {
            let entries: Vec<_> = entries
                .iter()
                .map(|&(binding, visibility, ty)| wgpu::BindGroupLayoutEntry { binding, visibility, ty, count: None })
                .collect();
            device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: Some(label), entries: &entries })
        };
        let any = ShaderStages::COMPUTE | ShaderStages::VERTEX_FRAGMENT;
        let scene: Vec<_> = variant
            .bindings()
            .into_iter()
            .map(|binding| {
                // Vertex stages may not write.
                let stages = if binding == Binding::Spent { any - ShaderStages::VERTEX } else { any };
                (binding as u32, stages, buffer(binding.kind()))
            })
            .collect();
        let scene = layout("scene", &scene);
        let tables = tables::layout(device, &variant, ShaderStages::FRAGMENT);
        let surfaces = variant.surfaces.then(|| surfaces::layout(device, ShaderStages::FRAGMENT));
        let pipeline_layout = |batch: &wgpu::BindGroupLayout, drawn: [Option<&wgpu::BindGroupLayout>; 2]| {
            let [tables, surfaces] = drawn;
            let layouts = [Some(&scene), Some(batch), tables, surfaces];
            let count = layouts.iter().rposition(Option::is_some).map_or(0, |last| last + 1);
            device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                label: None,
                bind_group_layouts: &layouts[..count],
                immediate_size: 0,
            })
        };
        let constants = [("ORTHOGRAPHIC", f64::from(u8::from(variant.orthographic)))];
        let options = || wgpu::PipelineCompilationOptions { constants: &constants, ..Default::default() };

        let geometry = variant.geometry();
        let compute = match geometry.compute {
            None => None,
            Some(name) => {
                let stage = ShaderStages::COMPUTE;
                let batch = layout("batch, written", &[(0, stage, uniform), (1, stage, writable)]);
                let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                    label: Some(name),
                    layout: Some(&pipeline_layout(&batch, [None; 2])),
                    module: &shader(name)?,
                    entry_point: None,
                    compilation_options: options(),
                    cache: None,
                });
                Some(Stage { pipeline, batch })
            }
        };
        let stages = ShaderStages::VERTEX_FRAGMENT;
        let projected = compute.is_some().then_some((1, stages, storage));
        let batch: Vec<_> = [(0, stages, uniform)].into_iter().chain(projected).collect();
        let batch = layout("batch, read", &batch);
        let module = shader(variant.stage())?;
        let pipeline = device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some("draw"),
            layout: Some(&pipeline_layout(&batch, [tables.as_ref(), surfaces.as_ref()])),
            vertex: wgpu::VertexState {
                module: &module,
                entry_point: Some("cover"),
                compilation_options: options(),
                buffers: &[],
            },
            fragment: Some(wgpu::FragmentState {
                module: &module,
                entry_point: Some("color"),
                compilation_options: options(),
                targets: &[Some(wgpu::ColorTargetState {
                    format: variant.format(),
                    blend: Some(variant.blend()),
                    write_mask: wgpu::ColorWrites::ALL,
                })],
            }),
            primitive: wgpu::PrimitiveState {
                cull_mode: geometry.indices.map(|_| wgpu::Face::Back),
                ..Default::default()
            },
            depth_stencil: None,
            multisample: wgpu::MultisampleState::default(),
            multiview_mask: None,
            cache: None,
        });
        Ok(Pipelines { scene, tables, surfaces, draw: Stage { pipeline, batch }, compute })
    }
}
