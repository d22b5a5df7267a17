//! The wgpu back end: cells projected in a compute stage, drawn back to front, blended by the fixed-function hardware;
//! or binned into tiles and composited in registers; or none of it, every pixel walking from cell to cell.

mod compute;
pub(crate) mod frame;
pub(crate) mod look;
pub(crate) mod march;
mod picture;
pub(crate) mod pipelines;
pub(crate) mod radix;
mod resident;
pub(crate) mod scan;
#[cfg(test)]
mod size_tests;
mod spent;
mod stretch;
mod surfaces;
pub(crate) mod tables;
pub(crate) mod tiles;
pub(crate) mod variant;

use std::collections::HashMap;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use tetlux_scene::{CellProjection, Classification, Device, Order, Plan, Skip};

use crate::look::Spent;
use crate::march::March;
use crate::stage::Stages;
use crate::{Job, RenderError, Resources};
use look::LookVariant;
use march::Marcher;
use pipelines::Pipelines;
use radix::Radix;
use resident::Resident;
pub(crate) use stretch::LARGEST_GROUP;
use tiles::{Room, Tiler};
use variant::Variant;

/// A graphics adapter, and its device and pipelines once they have been used.
#[derive(Debug)]
pub(crate) struct Gpu {
    adapter: wgpu::Adapter,
    device: Device,
    /// What is asked of the adapter, of what it has.
    features: wgpu::Features,
    limits: wgpu::Limits,
    open: Mutex<Option<Arc<Open>>>,
    pipelines: Made<Pipelines>,
    marchers: Made<Marcher>,
    tilers: Made<Tiler>,
    /// How much tiles do at a time at most.
    room: Room,
}

/// What has been made for each variant of the shaders.
type Made<T> = Mutex<HashMap<Variant, Arc<T>>>;

#[derive(Debug)]
struct Open {
    device: wgpu::Device,
    queue: wgpu::Queue,
    /// Why the device is gone, once it is.
    lost: Arc<OnceLock<String>>,
    resident: Resident,
    /// The pipelines of sorts, once there was one.
    radix: OnceLock<Radix>,
}

/// What a picture came to.
pub(crate) struct Drawn {
    /// Premultiplied, top row first.
    pub(crate) pixels: Vec<[f32; 4]>,
    pub(crate) resources: Resources,
    /// Pieces of segments, where there are two fields or light.
    pub(crate) spent: Option<Spent>,
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
        let limits = adapter.limits();
        Some(Gpu::new(adapter, FEATURES, limits))
    }

    /// An adapter of which no more is asked than these features, if it has them, and limits.
    fn new(adapter: wgpu::Adapter, features: wgpu::Features, limits: wgpu::Limits) -> Gpu {
        let features = features & FEATURES & adapter.features();
        let info = adapter.get_info();
        let device = Device {
            name: format!("{} ({})", info.name, info.backend),
            software: info.device_type == wgpu::DeviceType::Cpu,
            blends_f32: features.contains(wgpu::Features::FLOAT32_BLENDABLE),
            norm16: features.contains(wgpu::Features::TEXTURE_FORMAT_16BIT_NORM),
            driver: format!("{} {}", info.driver, info.driver_info),
            costs: None,
        };
        Gpu {
            adapter,
            device,
            features,
            limits,
            open: Mutex::default(),
            pipelines: Mutex::default(),
            marchers: Mutex::default(),
            tilers: Mutex::default(),
            room: if info.device_type == wgpu::DeviceType::Cpu { Room::OF_SOFTWARE } else { Room::MOST },
        }
    }

    pub(crate) fn device(&self) -> &Device {
        &self.device
    }

    /// Whether it sorts a plan's cells itself, so that their order stays on the device: by centroid, for tiles. What runs on
    /// the processor too is slower at it than the processor itself.
    pub(crate) fn sorts(&self, plan: &Plan) -> bool {
        plan.projection == CellProjection::Tiles
            && plan.order == Order::Centroid
            && plan.classification != Classification::PostClip
            && !self.device.software
    }

    /// The stable order of some keys.
    pub(crate) fn sort(&self, keys: &[u32]) -> Result<Vec<u32>, RenderError> {
        let stages = &mut Stages::default();
        let open = &*self.opened(stages)?;
        let limits = open.device.limits();
        let bytes = limits.max_storage_buffer_binding_size.min(limits.max_buffer_size);
        let most = u64::from(Radix::most(&limits)).min(bytes / 4);
        if keys.len() as u64 > most {
            let (what, needed, unit, adapter) = ("the sort", keys.len() as u64, "keys", self.device.name.clone());
            return Err(RenderError::Limit { what, needed, unit, limit: most, adapter });
        }
        let radix = self.radix(open, stages)?;
        self.checked(open, || radix.order(open, keys, u32::BITS))?.map_err(|e| self.failed(open, e))
    }

    /// Draws a picture.
    pub(crate) fn draw(&self, plan: &Plan, job: &Job, stages: &mut Stages) -> Result<Drawn, RenderError> {
        let open = &*self.opened(stages)?;
        let look = job.look.as_ref().map(LookVariant::new);
        let variant = Variant::new(plan, job.mesh.data, look, job.backdrop.is_some());
        let all = job.kept.contains(Skip::Pipelines) && job.entry_pieces.is_empty();
        let sorted = all || stretch::sorted(job.groups).next().is_some();
        self.check_limits(open, &variant, job)?;
        let pipelines = |variant, stages: &mut Stages| {
            made(&self.pipelines, variant, stages, || self.checked(open, || Pipelines::new(&open.device, variant)))
        };
        let drawn = if let Some(march) = &job.march {
            let make = || self.checked(open, || Marcher::new(&open.device, variant));
            let marcher = made(&self.marchers, variant, stages, make)?;
            stages.run("draw", || self.checked(open, || marcher.draw(open, &variant, job, march)))?
        } else if variant.projection == CellProjection::Tiles {
            let variant = if sorted { variant.of_groups() } else { variant };
            let make = || self.checked(open, || Tiler::new(&open.device, variant));
            let tiler = made(&self.tilers, variant, stages, make)?;
            let radix = self.radix(open, stages)?;
            let room = Room::of(&open.device.limits(), &variant, job.size).within(self.room);
            let by_centroid = self.sorts(plan);
            let draw = || tiler.draw(open, radix, &variant, job, by_centroid, room, &self.device.name);
            let drawn = stages.run("draw", || self.checked(open, draw))?.map_err(|error| match error {
                RenderError::Device { reason, .. } => self.failed(open, reason),
                error => error,
            });
            return self.whole(drawn?);
        } else {
            let cells = pipelines(variant, stages)?;
            let groups = if sorted { Some(pipelines(variant.of_groups(), stages)?) } else { None };
            let draw = || frame::draw(open, &variant, &cells, groups.as_deref(), job);
            stages.run("draw", || self.checked(open, draw))?
        };
        self.whole(drawn.map_err(|e| self.failed(open, e))?)
    }

    /// A picture without rays that the driver has left before their end: shaders give these a negative alpha.
    fn whole(&self, drawn: Drawn) -> Result<Drawn, RenderError> {
        match drawn.pixels.iter().filter(|pixel| pixel[3] < 0.0).count() {
            0 => Ok(drawn),
            rays => Err(RenderError::CutShort { adapter: self.device.name.clone(), rays }),
        }
    }

    /// Loses the device, if it is open.
    pub(crate) fn lose(&self) {
        if let Some(open) = self.open.lock().unwrap_or_else(PoisonError::into_inner).as_ref() {
            open.device.destroy();
        }
    }

    /// The device, opened if it was not, or anew if it is lost.
    fn opened(&self, stages: &mut Stages) -> Result<Arc<Open>, RenderError> {
        let mut known = self.open.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(open) = known.as_ref().filter(|open| open.lost.get().is_none()) {
            return Ok(open.clone());
        }
        // What was made on a device that is lost is lost with it.
        self.pipelines.lock().unwrap_or_else(PoisonError::into_inner).clear();
        self.marchers.lock().unwrap_or_else(PoisonError::into_inner).clear();
        self.tilers.lock().unwrap_or_else(PoisonError::into_inner).clear();
        let open = Arc::new(stages.run("open device", || self.open())?);
        *known = Some(open.clone());
        Ok(open)
    }

    /// The pipelines of sorts, made once.
    fn radix<'a>(&self, open: &'a Open, stages: &mut Stages) -> Result<&'a Radix, RenderError> {
        if let Some(radix) = open.radix.get() {
            return Ok(radix);
        }
        let radix = stages.run("pipelines", || self.checked(open, || Radix::new(&open.device)))??;
        Ok(open.radix.get_or_init(|| radix))
    }

    fn open(&self) -> Result<Open, RenderError> {
        let descriptor = wgpu::DeviceDescriptor {
            label: Some("tetlux"),
            required_features: self.features,
            required_limits: self.limits.clone(),
            ..Default::default()
        };
        let (device, queue) = pollster::block_on(self.adapter.request_device(&descriptor))
            .map_err(|e| RenderError::Open { adapter: self.device.name.clone(), reason: e.to_string() })?;
        let lost = Arc::new(OnceLock::new());
        let told = lost.clone();
        device.set_device_lost_callback(move |reason, message| {
            // The first reason counts.
            let _ = told.set(format!("{reason:?}: {message}").trim_end_matches([':', ' ']).to_string());
        });
        Ok(Open { device, queue, lost, resident: Resident::default(), radix: OnceLock::new() })
    }

    /// Runs work on the device and turns what the driver reports into an error.
    fn checked<T>(&self, open: &Open, work: impl FnOnce() -> T) -> Result<T, RenderError> {
        let scopes = [wgpu::ErrorFilter::OutOfMemory, wgpu::ErrorFilter::Validation, wgpu::ErrorFilter::Internal]
            .map(|filter| open.device.push_error_scope(filter));
        let result = work();
        // Scopes end in the reverse order of their beginning.
        let errors = scopes.into_iter().rev().filter_map(|scope| pollster::block_on(scope.pop()));
        match cause(&errors.collect::<Vec<_>>()) {
            Some(error) => Err(self.reported(open, error)),
            None => Ok(result),
        }
    }

    fn reported(&self, open: &Open, error: &wgpu::Error) -> RenderError {
        match error {
            wgpu::Error::OutOfMemory { source } if open.lost.get().is_none() => {
                RenderError::OutOfMemory { adapter: self.device.name.clone(), reason: source.to_string() }
            }
            error => self.failed(open, error.to_string()),
        }
    }

    /// What the driver said, or that the device is gone: then all else that went wrong follows from it.
    fn failed(&self, open: &Open, reason: String) -> RenderError {
        let adapter = self.device.name.clone();
        match open.lost.get() {
            Some(reason) => RenderError::Lost { adapter, reason: reason.clone() },
            None => RenderError::Device { adapter, reason },
        }
    }

    fn check_limits(&self, open: &Open, variant: &Variant, job: &Job) -> Result<(), RenderError> {
        let limits = open.device.limits();
        let binding = limits.max_storage_buffer_binding_size.min(limits.max_buffer_size);
        let side = u64::from(limits.max_texture_dimension_2d);
        let pixels = u64::from(job.size[0]) * u64::from(job.size[1]);
        // Projected cells too or, of a march or of tiles, their lists.
        let own = match variant.projection {
            CellProjection::March => 3,
            CellProjection::Tiles => 4,
            _ => 1,
        };
        let buffers = own + variant.bindings().into_iter().filter(|binding| binding.is_storage()).count();
        let stage = u64::from(limits.max_storage_buffers_per_shader_stage);
        for (what, needed, unit, limit) in [
            ("the mesh's points", size_of_val(&job.mesh.points[..]) as u64, "bytes", binding),
            ("the mesh's cells", size_of_val(job.cells) as u64, "bytes", binding),
            ("the vertices' luminance and extinction", size_of_val(job.attributes) as u64, "bytes", binding),
            ("the points as they are seen", size_of_val(job.seen) as u64, "bytes", binding),
            ("the transfer function", size_of_val(job.pieces) as u64, "bytes", binding),
            ("the gradients or the image", job.look.as_ref().map_or(0, look::largest), "bytes", binding),
            ("the order of the cells", size_of_val(job.order) as u64, "bytes", binding),
            ("the faces through which rays come in", job.march.as_ref().map_or(0, March::largest), "bytes", binding),
            ("the scene", buffers as u64, "buffers a stage", stage),
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

/// Which of the errors of some work the others follow from: without memory, what was to be made is invalid wherever it is used.
fn cause(errors: &[wgpu::Error]) -> Option<&wgpu::Error> {
    errors.iter().find(|error| matches!(error, wgpu::Error::OutOfMemory { .. })).or(errors.first())
}

/// What `make` makes for a variant, once.
fn made<T>(
    all: &Made<T>,
    variant: Variant,
    stages: &mut Stages,
    make: impl FnOnce() -> Result<Result<T, RenderError>, RenderError>,
) -> Result<Arc<T>, RenderError> {
    // A panic elsewhere cannot have left the map half changed.
    if let Some(known) = all.lock().unwrap_or_else(PoisonError::into_inner).get(&variant) {
        return Ok(known.clone());
    }
    let made = Arc::new(stages.run("pipelines", make)??);
    all.lock().unwrap_or_else(PoisonError::into_inner).insert(variant, made.clone());
    Ok(made)
}

#[cfg(test)]
mod tests;
