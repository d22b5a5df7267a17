//! Pipelines, one set for each variant of the shaders.

use wgpu::{BindingType, BufferBindingType, ShaderStages};

use crate::RenderError;

/// The format of the picture on the device.
pub(super) const TARGET: wgpu::TextureFormat = wgpu::TextureFormat::Rgba32Float;

/// Bytes of a projected cell: `Cell` of shaders/lib/cell.wgsl.
pub(crate) const CELL_BYTES: u64 = 80;

/// The values of the shaders' overrides.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(super) struct Variant {
    pub(super) orthographic: bool,
    pub(super) cell_data: bool,
    pub(super) average: bool,
}

#[derive(Debug)]
pub(super) struct Pipelines {
    /// View, transfer function, mesh and order.
    pub(super) scene: wgpu::BindGroupLayout,
    /// A batch and its projected cells, as they are written.
    pub(super) project_batch: wgpu::BindGroupLayout,
    /// The same, as they are read.
    pub(super) draw_batch: wgpu::BindGroupLayout,
    pub(super) project: wgpu::ComputePipeline,
    pub(super) draw: wgpu::RenderPipeline,
}

impl Pipelines {
    pub(super) fn new(device: &wgpu::Device, variant: Variant) -> Result<Pipelines, RenderError> {
        let shader = |name: &str| -> Result<wgpu::ShaderModule, RenderError> {
            let source = wgpu::ShaderSource::Wgsl(tetlux_shaders::compose(name)?.into());
            Ok(device.create_shader_module(wgpu::ShaderModuleDescriptor { label: Some(name), source }))
        };
        let storage = BindingType::Buffer {
            ty: BufferBindingType::Storage { read_only: true },
            has_dynamic_offset: false,
            min_binding_size: None,
        };
        let writable = BindingType::Buffer {
            ty: BufferBindingType::Storage { read_only: false },
            has_dynamic_offset: false,
            min_binding_size: None,
        };
        let uniform =
            BindingType::Buffer { ty: BufferBindingType::Uniform, has_dynamic_offset: false, min_binding_size: None };
        let layout = |label, entries: &[(ShaderStages, BindingType)]| {
            let entries: Vec<_> = (0u32..)
                .zip(entries)
                .map(|(binding, &(visibility, ty))| wgpu::BindGroupLayoutEntry { binding, visibility, ty, count: None })
                .collect();
            device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: Some(label), entries: &entries })
        };
        let geometry = ShaderStages::COMPUTE | ShaderStages::VERTEX;
        let scene = layout(
            "scene",
            &[
                (geometry | ShaderStages::FRAGMENT, uniform),
                (ShaderStages::VERTEX_FRAGMENT, storage),
                (geometry, storage),
                (geometry, storage),
                (geometry, storage),
                (geometry, storage),
            ],
        );
        let project_batch = layout("project", &[(ShaderStages::COMPUTE, uniform), (ShaderStages::COMPUTE, writable)]);
        let draw_batch = layout("draw", &[(ShaderStages::VERTEX, uniform), (ShaderStages::VERTEX, storage)]);
        let pipeline_layout = |batch| {
            device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                label: None,
                bind_group_layouts: &[Some(&scene), Some(batch)],
                immediate_size: 0,
            })
        };

        let geometry = [
            ("ORTHOGRAPHIC", f64::from(u8::from(variant.orthographic))),
            ("CELL_DATA", f64::from(u8::from(variant.cell_data))),
        ];
        let fragment = [geometry[0], ("INTEGRATOR", f64::from(u8::from(variant.average)))];
        let options = |constants| wgpu::PipelineCompilationOptions { constants, ..Default::default() };
        let project = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some("project"),
            layout: Some(&pipeline_layout(&project_batch)),
            module: &shader("stages::project")?,
            entry_point: Some("project"),
            compilation_options: options(&geometry),
            cache: None,
        });
        let module = shader("stages::draw")?;
        let draw = device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some("draw"),
            layout: Some(&pipeline_layout(&draw_batch)),
            vertex: wgpu::VertexState {
                module: &module,
                entry_point: Some("cover"),
                compilation_options: options(&geometry),
                buffers: &[],
            },
            fragment: Some(wgpu::FragmentState {
                module: &module,
                entry_point: Some("shade"),
                compilation_options: options(&fragment),
                targets: &[Some(wgpu::ColorTargetState {
                    format: TARGET,
                    blend: Some(wgpu::BlendState::PREMULTIPLIED_ALPHA_BLENDING),
                    write_mask: wgpu::ColorWrites::ALL,
                })],
            }),
            primitive: wgpu::PrimitiveState::default(),
            depth_stencil: None,
            multisample: wgpu::MultisampleState::default(),
            multiview_mask: None,
            cache: None,
        });
        Ok(Pipelines { scene, project_batch, draw_batch, project, draw })
    }
}
