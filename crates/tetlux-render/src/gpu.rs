//! The wgpu back end: cells projected in a compute stage, drawn back to front, blended by the fixed-function hardware.

pub(crate) mod frame;
mod picture;
pub(crate) mod pipelines;
mod stretch;
pub(crate) mod tables;
pub(crate) mod variant;

use std::collections::HashMap;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use tetlux_scene::{Device, Plan};

use crate::stage::Stages;
use crate::{Job, RenderError, Resources};
use pipelines::Pipelines;
pub(crate) use stretch::LARGEST_GROUP;
use variant::Variant;

/// A graphics adapter, and its device and pipelines once they have been used.
#[derive(Debug)]
pub(crate) struct Gpu {
    adapter: wgpu::Adapter,
    device: Device,
    open: OnceLock<Open>,
    pipelines: Mutex<HashMap<Variant, Arc<Pipelines>>>,
}

#[derive(Debug)]
struct Open {
    device: wgpu::Device,
    queue: wgpu::Queue,
}

/// What is used where the adapter has it, beyond what every device can do.
const FEATURES: wgpu::Features = wgpu::Features::FLOAT32_BLENDABLE.union(wgpu::Features::TEXTURE_FORMAT_16BIT_NORM);

impl Gpu {
    /// The best adapter: one that blends f32, hardware, discrete.
    pub(crate) fn find() -> Option<Gpu> {
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle_from_env());
        let adapters = pollster::block_on(instance.enumerate_adapters(wgpu::Backends::PRIMARY));
        let rank = |adapter: &wgpu::Adapter| {
            let kind = match adapter.get_info().device_type {
                wgpu::DeviceType::DiscreteGpu => 0,
                wgpu::DeviceType::IntegratedGpu => 1,
                wgpu::DeviceType::VirtualGpu | wgpu::DeviceType::Other => 2,
                wgpu::DeviceType::Cpu => 3,
            };
            (!adapter.features().contains(wgpu::Features::FLOAT32_BLENDABLE), kind)
        };
        let adapter = adapters.into_iter().min_by_key(rank)?;
        let info = adapter.get_info();
        let device = Device {
            name: format!("{} ({})", info.name, info.backend),
            software: info.device_type == wgpu::DeviceType::Cpu,
            blends_f32: adapter.features().contains(wgpu::Features::FLOAT32_BLENDABLE),
            norm16: adapter.features().contains(wgpu::Features::TEXTURE_FORMAT_16BIT_NORM),
        };
        Some(Gpu { adapter, device, open: OnceLock::new(), pipelines: Mutex::default() })
    }

    pub(crate) fn device(&self) -> &Device {
        &self.device
    }

    /// Draws a picture: premultiplied pixels, top row first.
    pub(crate) fn draw(
        &self,
        plan: &Plan,
        job: &Job,
        stages: &mut Stages,
    ) -> Result<(Vec<[f32; 4]>, Resources), RenderError> {
        let open = match self.open.get() {
            Some(open) => open,
            None => {
                let open = stages.run("open device", || self.open())?;
                self.open.get_or_init(|| open)
            }
        };
        let variant = Variant::new(plan, !job.mesh.cell_scalars.is_empty());
        let pipelines = self.pipelines(open, variant, stages)?;
        let sorted = job.groups.iter().any(|group| group.end - group.start <= LARGEST_GROUP);
        let groups = if sorted { Some(self.pipelines(open, variant.of_groups(), stages)?) } else { None };
        self.check_limits(open, job)?;
        let draw = || self.checked(open, || frame::draw(open, &variant, &pipelines, groups.as_deref(), job));
        stages.run("draw", draw)?.map_err(|e| self.failed(e))
    }

    /// The pipelines of a variant, made when first asked for.
    fn pipelines(&self, open: &Open, variant: Variant, stages: &mut Stages) -> Result<Arc<Pipelines>, RenderError> {
        // A panic elsewhere cannot have left the map half changed.
        let known = self.pipelines.lock().unwrap_or_else(PoisonError::into_inner).get(&variant).cloned();
        if let Some(pipelines) = known {
            return Ok(pipelines);
        }
        let made = stages.run("pipelines", || self.checked(open, || Pipelines::new(&open.device, variant)))??;
        let made = Arc::new(made);
        self.pipelines.lock().unwrap_or_else(PoisonError::into_inner).insert(variant, made.clone());
        Ok(made)
    }

    fn open(&self) -> Result<Open, RenderError> {
        let descriptor = wgpu::DeviceDescriptor {
            label: Some("tetlux"),
            required_features: self.adapter.features() & FEATURES,
            required_limits: self.adapter.limits(),
            ..Default::default()
        };
        let (device, queue) = pollster::block_on(self.adapter.request_device(&descriptor))
            .map_err(|e| RenderError::Open { adapter: self.device.name.clone(), reason: e.to_string() })?;
        Ok(Open { device, queue })
    }

    /// Runs work on the device and turns what the driver reports into an error.
    fn checked<T>(&self, open: &Open, work: impl FnOnce() -> T) -> Result<T, RenderError> {
        let scopes = [wgpu::ErrorFilter::OutOfMemory, wgpu::ErrorFilter::Validation, wgpu::ErrorFilter::Internal]
            .map(|filter| open.device.push_error_scope(filter));
        let result = work();
        // Scopes end in the reverse order of their beginning.
        let errors = scopes.into_iter().rev().filter_map(|scope| pollster::block_on(scope.pop()));
        match errors.collect::<Vec<_>>().first() {
            Some(error) => Err(self.failed(error.to_string())),
            None => Ok(result),
        }
    }

    fn failed(&self, reason: String) -> RenderError {
        RenderError::Device { adapter: self.device.name.clone(), reason }
    }

    fn check_limits(&self, open: &Open, job: &Job) -> Result<(), RenderError> {
        let limits = open.device.limits();
        let binding = limits.max_storage_buffer_binding_size.min(limits.max_buffer_size);
        let side = u64::from(limits.max_texture_dimension_2d);
        let pixels = u64::from(job.size[0]) * u64::from(job.size[1]);
        for (what, needed, unit, limit) in [
            ("the mesh's points", size_of_val(&job.mesh.points[..]) as u64, "bytes", binding),
            ("the mesh's cells", size_of_val(&job.mesh.cells[..]) as u64, "bytes", binding),
            ("the transfer function", size_of_val(job.pieces) as u64, "bytes", binding),
            ("the order of the cells", size_of_val(job.order) as u64, "bytes", binding),
            ("the picture", u64::from(job.size[0].max(job.size[1])), "pixels a side", side),
            ("the picture", pixels * 16 + 256 * u64::from(job.size[1]), "bytes", limits.max_buffer_size),
        ] {
            if needed > limit {
                return Err(RenderError::Limit { what, needed, unit, limit, adapter: self.device.name.clone() });
            }
        }
        Ok(())
    }
}
