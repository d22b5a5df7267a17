//! Compute stages: pipelines, and what they bind.

use tetlux_shaders::{Choice, compose};
use wgpu::{BindingType, BufferBindingType};

use crate::RenderError;

pub(super) const UNIFORM: BindingType = buffer(BufferBindingType::Uniform);
pub(super) const READ: BindingType = buffer(BufferBindingType::Storage { read_only: true });
pub(super) const WRITE: BindingType = buffer(BufferBindingType::Storage { read_only: false });

const fn buffer(ty: BufferBindingType) -> BindingType {
    BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None }
}

/// A pipeline and the layout of the one bind group that is its own.
#[derive(Debug)]
pub(super) struct Stage {
    pub(super) pipeline: wgpu::ComputePipeline,
    pub(super) layout: wgpu::BindGroupLayout,
}

/// The layout of bindings that compute stages see.
pub(super) fn layout(device: &wgpu::Device, label: &str, entries: &[(u32, BindingType)]) -> wgpu::BindGroupLayout {
    let entry = |&(binding, ty)| wgpu::BindGroupLayoutEntry {
        binding,
        visibility: wgpu::ShaderStages::COMPUTE,
        ty,
        count: None,
    };
    let entries: Vec<_> = entries.iter().map(entry).collect();
    device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: Some(label), entries: &entries })
}

/// The pipeline of a module of one entry point, which binds these groups.
pub(super) fn pipeline(
    device: &wgpu::Device,
    name: &str,
    choices: &[Choice],
    constants: &[(&str, f64)],
    groups: &[Option<&wgpu::BindGroupLayout>],
) -> Result<wgpu::ComputePipeline, RenderError> {
    let source = wgpu::ShaderSource::Wgsl(compose(name, choices)?.into());
    let module = device.create_shader_module(wgpu::ShaderModuleDescriptor { label: Some(name), source });
    // None at the end.
    let count = groups.iter().rposition(Option::is_some).map_or(0, |last| last + 1);
    let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: Some(name),
        bind_group_layouts: &groups[..count],
        immediate_size: 0,
    });
    Ok(device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
        label: Some(name),
        layout: Some(&layout),
        module: &module,
        entry_point: None,
        compilation_options: wgpu::PipelineCompilationOptions { constants, ..Default::default() },
        cache: None,
    }))
}

/// Records one dispatch.
pub(super) fn dispatch(
    encoder: &mut wgpu::CommandEncoder,
    pipeline: &wgpu::ComputePipeline,
    groups: &[Option<&wgpu::BindGroup>],
    [x, y]: [u32; 2],
) {
    let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
    pass.set_pipeline(pipeline);
    for (index, group) in (0u32..).zip(groups) {
        if let Some(group) = *group {
            pass.set_bind_group(index, group, &[]);
        }
    }
    pass.dispatch_workgroups(x, y, 1);
}
