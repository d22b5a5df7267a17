//! Direct volume rendering of tetrahedral meshes on wgpu and on the CPU.
//!
//! Both back ends project cells and composite, for every pixel, the exact integral along its ray through each cell.
//! Which is used, and in which order cells are composited, the [`Plan`] says.
//!
//! Opaque surfaces of the scene are drawn once for either; rays end where they first meet one.
//!
//! The CPU back end bins cells into tiles of pixels and draws vectors of pixels, with the best instruction set that the
//! processor has: pictures are the same bit for bit every time and on any number of threads, and may differ by roundings
//! between instruction sets. It leaves out what lies behind pixels whose transmittance is below a thousandth of the
//! scene's `max_error` (a tenth if that is above 1e-3): a pixel changes by less than that share of it.
//!
//! ```
//! use tetlux_mesh::{Field, TetMesh, procedural};
//! use tetlux_render::{Model, Renderer};
//! use tetlux_scene::{Plan, SceneFile};
//!
//! let parts = procedural::cuboid([4, 4, 4], procedural::Split::Six, [[-1.0; 3].into(), [1.0; 3].into()]);
//! let field = Field::point("r", 1, parts.sample(|p| p.length()));
//! let mesh = TetMesh::assemble(&parts.points, &parts.cells, vec![field])?;
//! let file = SceneFile::parse("ball.toml", r#"
//!     [transfer]
//!     color = [[0.0, 1.0, 0.5, 0.2]]
//!     opacity = [[0.5, 2.0], [1.0, 0.0]]
//!     [image]
//!     size = [64, 64]
//! "#)?;
//! let scene = file.scene(&mesh, 0)?;
//! let renderer = Renderer::new();
//! let plan = Plan::new(&scene, &mesh, renderer.device())?;
//! let frame = renderer.render(&scene, &Model::new(&mesh), &plan)?;
//! assert!(frame.image.pixels()[32 * 64 + 32][3] > 0.5);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod adaptive;
mod attributes;
mod backdrop;
mod calibration;
#[cfg(test)]
mod cell;
mod device_mesh;
mod device_view;
mod error;
mod eye_space;
mod gpu;
mod instructions;
#[cfg(test)]
mod layout_tests;
mod lens;
mod look;
mod march;
mod model;
mod order;
#[cfg(feature = "planted")]
pub mod planted;
mod published;
mod resources;
mod saved;
mod seen;
mod sequence;
mod stage;
mod tables;
mod tiles;

pub use error::RenderError;
pub use instructions::Instructions;
pub use look::Spent;
pub use model::Model;
pub use order::sampling;
pub use resources::Resources;
pub use saved::bytes_saved;
pub use sequence::frames;
pub use stage::{Stage, Stages};
pub use tables::table_specs;

use std::ops::Range;
use std::sync::{Arc, Mutex};

use tetlux_image::Image;
use tetlux_mesh::ScalarField;
use tetlux_optics::no_data_f32::{add_no_data, no_data};
use tetlux_optics::transfer_f32::{Piece, Weights, pieces};
use tetlux_order::{OrderReport, Orderer};
use tetlux_scene::{
    Backend, CellProjection, Classification, Device, Integrator, Plan, Scene, Skip, SkipSet, TablePrecision,
};
use tetlux_tables::{Table, TableKind, TableSpec};

use crate::attributes::Attributes;
use crate::backdrop::Backdrop;
use crate::device_mesh::DeviceMesh;
use crate::device_view::DeviceView;
use crate::eye_space::EyeSpace;
use crate::gpu::Drawn;
use crate::lens::Lens;
use crate::look::Look;
use crate::march::March;
use crate::published::Published;
use crate::seen::Seen;

/// A picture and the time it took.
#[derive(Debug)]
pub struct Frame {
    /// Linear, premultiplied, without the background.
    pub image: Image,
    /// What was done, in order.
    pub stages: Vec<Stage>,
    /// What it took of the device.
    pub resources: Resources,
    /// How the cells were ordered.
    pub order: OrderReport,
    /// The mesh was prepared, and uploaded if that is how it is drawn, for an earlier picture.
    pub mesh_reused: bool,
    /// The pieces that it took to keep to the error budget, where segments are shaded one by one.
    pub spent: Option<Spent>,
    /// Where the picture may be wrong, found on the way.
    pub warnings: Vec<String>,
}

/// What a picture is made of.
struct Job<'a> {
    mesh: &'a Arc<DeviceMesh>,
    /// The mesh's cells, positively oriented.
    cells: &'a [[u32; 4]],
    scalar: &'a ScalarField,
    view: DeviceView,
    eye: EyeSpace,
    pieces: &'a [Piece],
    weights: Weights,
    /// Luminance and extinction per device unit of the points, for the graphics back end, where they are given.
    attributes: &'a [[f32; 4]],
    /// What the scene asks for beyond one field's transfer function.
    look: Option<Look>,
    /// The mesh's points as they are seen, for a graphics adapter.
    seen: &'a [Seen],
    /// The cells to draw, nearest first.
    order: &'a [u32],
    /// Ranges of positions in `order`, ascending and apart, whose cells have no order among themselves: they are
    /// sorted along each ray.
    groups: &'a [Range<u32>],
    /// The piece that each is clipped to, where cells are drawn piece by piece; else empty.
    entry_pieces: &'a [u32],
    /// The tables of the integral.
    tables: &'a [Arc<Table>],
    table_precision: TablePrecision,
    /// Factor from device lengths to those of the tables.
    table_length: f32,
    /// What a march needs instead of the order.
    march: Option<March>,
    /// Opaque surfaces, if there are any.
    backdrop: Option<Backdrop>,
    /// Alpha beyond which a pixel is as good as opaque.
    opaque: f32,
    /// What is done though it need not be.
    kept: SkipSet,
    /// Width and height in pixels.
    size: [u32; 2],
}

/// An alpha that no pixel has.
const NEVER_OPAQUE: f32 = 2.0;

/// Alpha beyond which a pixel is as good as opaque: what lies behind it, however bright, changes it by no more than
/// `hidden`. If that is 0, no pixel counts as opaque.
fn opaque(hidden: f64, pieces: &[Piece], look: Option<&Look>, backdrop: Option<&Backdrop>) -> f32 {
    let luminances = pieces.iter().flat_map(|p| [p.low, p.high]).flat_map(|c| [c[0], c[1], c[2]]);
    let brightest = f64::from(luminances.fold(1.0, f32::max));
    let brightest = look.map_or(brightest, |look| brightest.max(look.brightest));
    let brightest = backdrop.map_or(brightest, |backdrop| brightest.max(backdrop.brightest().into()));
    if hidden > 0.0 { (1.0 - hidden / brightest) as f32 } else { NEVER_OPAQUE }
}

/// Renders by plan; holds the graphics device once one has been used, and the last order.
#[derive(Debug)]
pub struct Renderer {
    gpu: Option<gpu::Gpu>,
    orderer: Mutex<Orderer>,
    instructions: Instructions,
    room: tiles::Room,
}

impl Default for Renderer {
    fn default() -> Self {
        Renderer::new()
    }
}

impl Renderer {
    /// Looks for a graphics adapter, hardware before software; opens none.
    pub fn new() -> Renderer {
        Renderer { gpu: gpu::Gpu::find(), ..Renderer::without_adapter() }
    }

    /// Draws by these vector instructions where the processor draws: to compare them. The best are the default.
    #[must_use]
    pub fn with_instructions(self, instructions: Instructions) -> Renderer {
        Renderer { instructions, ..self }
    }

    /// One that has no adapter, and looks for none: the processor draws.
    pub fn without_adapter() -> Renderer {
        Renderer {
            gpu: None,
            orderer: Mutex::default(),
            instructions: Instructions::default(),
            room: tiles::Room::default(),
        }
    }

    /// The adapter there is, for the plan.
    pub fn device(&self) -> Option<&Device> {
        self.gpu.as_ref().map(gpu::Gpu::device)
    }

    /// Loses the device, as when a driver is reset: the picture that is being drawn fails with [`RenderError::Lost`], and the
    /// next opens the device anew. For programs that try whether they stand it.
    pub fn lose_device(&self) {
        self.gpu.iter().for_each(gpu::Gpu::lose);
    }

    /// The stable order of some keys, found on the adapter by the radix sort that tiles are binned by: where in `keys` the
    /// least is, and so on.
    ///
    /// # Errors
    ///
    /// No adapter, more keys than it can hold, or a driver that fails.
    pub fn sort(&self, keys: &[u32]) -> Result<Vec<u32>, RenderError> {
        self.gpu.as_ref().ok_or(RenderError::NoAdapter)?.sort(keys)
    }

    /// The adapter's driver and its version, as they name themselves.
    pub fn driver(&self) -> Option<&str> {
        self.device().map(|device| device.driver.as_str())
    }

    /// Renders a scene on a mesh as its plan says: by a method without tables.
    ///
    /// # Errors
    ///
    /// No adapter where the plan wants one; a mesh or a picture over the device's limits; a driver that fails; a table
    /// that the method needs.
    pub fn render(&self, scene: &Scene, model: &Model, plan: &Plan) -> Result<Frame, RenderError> {
        self.render_with(scene, model, plan, &[])
    }

    /// The same by any method; `tables` are those that [`table_specs`] asks for, in any order.
    ///
    /// # Errors
    ///
    /// As [`Renderer::render`].
    pub fn render_with(
        &self,
        scene: &Scene,
        model: &Model,
        plan: &Plan,
        tables: &[Arc<Table>],
    ) -> Result<Frame, RenderError> {
        let find = |spec: &TableSpec| {
            let found = tables.iter().find(|table| table.spec() == spec).cloned();
            found.ok_or_else(|| RenderError::NoTable { id: spec.id.clone() })
        };
        let tables = table_specs(scene, model.mesh(), plan).iter().map(find).collect::<Result<Vec<_>, _>>()?;
        let mut stages = Stages::default();
        let (mesh, view) = (model.mesh(), &plan.view);
        let on_device = plan.backend == Backend::Gpu && self.gpu.as_ref().is_some_and(|gpu| gpu.sorts(plan));
        let mut order = order::order(&self.orderer, model, plan, on_device, &mut stages);
        let (device_mesh, mesh_reused) = stages.run("prepare", || model.prepared(scene, plan.may_skip(Skip::Uploads)));
        if plan.kept.contains(Skip::Gradients) {
            stages.run("gradients", || std::hint::black_box(mesh.vertex_gradients(&scene.scalar)));
        }
        let extinction = 1.0 / (scene.unit_distance * device_mesh.scale);
        let attributes = stages.run("classify", || Attributes::new(scene, plan, extinction));
        if plan.colors.as_ref().is_some_and(|colors| colors.len() != mesh.points().len()) {
            return Err(RenderError::Missing("luminance and opacity at every point"));
        }
        // Of a function of two fields one piece of nothing.
        let mut pieces = plan
            .transfer
            .as_ref()
            .or(scene.transfer())
            .map_or_else(|| vec![Piece::default()], |transfer| pieces(transfer, scene.scalar.range, extinction));
        if !scene.seen_without_data().is_empty() {
            add_no_data(&mut pieces, no_data(&scene.no_data, extinction));
        }
        let weights = match plan.integrator {
            Integrator::Average => Weights::Average,
            // The CPU back end has these two: the plan sees to it.
            _ => Weights::Direct,
        };
        let clipped = plan.backend == Backend::Gpu && plan.classification == Classification::PostClip;
        let (cells, entry_pieces) = if clipped {
            // Pieces of cells take the place of cells: groups are composited as they come.
            order.groups.clear();
            stages.run("clip", || adaptive::entries(mesh, &device_mesh, &pieces, view, &order.cells))
        } else {
            (std::mem::take(&mut order.cells), Vec::new())
        };
        let eye = EyeSpace::new(view, mesh, &device_mesh);
        let longest = || tables::largest_thickness(mesh, &plan.cells) * device_mesh.scale;
        let published = Published::new(plan, &tables, longest);
        let [low, high] = device_mesh.bounds;
        let across = low.distance(high);
        let on_cpu = attributes.as_ref().filter(|_| plan.backend == Backend::Cpu);
        let look =
            Look::new(scene, mesh.points().len(), &eye, (&pieces, weights), on_cpu, extinction, published, across)?;
        let on_gpu = plan.backend == Backend::Gpu;
        let drawn = on_gpu && plan.projection != CellProjection::March;
        let seen = if drawn { stages.run("see", || eye.seen(&device_mesh)) } else { Vec::new() };
        let lens = Lens { view: DeviceView::new(view, mesh, &device_mesh), orthographic: view.orthographic };
        let march = (on_gpu && plan.projection == CellProjection::March)
            .then(|| stages.run("entries", || March::new(mesh, &device_mesh, &lens, &plan.cells, view.size)));
        let backdrop = (!scene.surfaces.is_empty())
            .then(|| stages.run("surfaces", || Backdrop::new(&scene.surfaces, &eye, device_mesh.scale, view.size)));
        let opaque = opaque(plan.hidden, &pieces, look.as_ref(), backdrop.as_ref());
        let job = Job {
            mesh: &device_mesh,
            cells: mesh.cells(),
            scalar: &scene.scalar,
            view: lens.view,
            eye,
            pieces: &pieces,
            weights,
            attributes: attributes.as_ref().map_or(&[], |attributes| &attributes.values),
            look,
            seen: &seen,
            order: &cells,
            groups: &order.groups,
            entry_pieces: &entry_pieces,
            table_precision: plan.table_precision,
            table_length: (1.0 / (device_mesh.scale * table_unit(&tables))) as f32,
            tables: &tables,
            march,
            backdrop,
            opaque,
            kept: plan.kept,
            size: view.size,
        };
        let Drawn { mut pixels, resources, spent } = match plan.backend {
            Backend::Gpu => self.gpu.as_ref().ok_or(RenderError::NoAdapter)?.draw(plan, &job, &mut stages)?,
            Backend::Cpu | Backend::Auto => {
                let (pixels, pieces) = tiles::draw(self.instructions.0, &job, &self.room, &mut stages);
                let resources = Resources { cells: cells.len(), ..Resources::default() };
                Drawn { pixels, resources, spent: job.look.is_some().then_some(pieces) }
            }
        };
        if let Some(backdrop) = &job.backdrop {
            backdrop.put_behind(&mut pixels);
        }
        let warnings = order::doubts(&order, plan);
        let image = Image::from_pixels(view.size[0], view.size[1], pixels)?;
        Ok(Frame { image, stages: stages.into_vec(), resources, order: order.report, mesh_reused, spent, warnings })
    }
}

/// The world length that is 1 in the tables' thickness.
fn table_unit(tables: &[Arc<Table>]) -> f64 {
    let largest = |table: &Arc<Table>| match &table.spec().kind {
        TableKind::PreIntegrated { transfer, .. } => Some(transfer.max_length),
        _ => None,
    };
    tables.iter().find_map(largest).unwrap_or(1.0)
}
