//! Direct volume rendering of tetrahedral meshes on wgpu and on the CPU.
//!
//! Both back ends project cells and composite, for every pixel, the exact integral along its ray through each cell:
//! the CPU back end is the twin of the shaders. Which is used, and in which order cells are composited, the
//! [`Plan`] says.
//!
//! ```
//! use tetlux_mesh::{Field, TetMesh, procedural};
//! use tetlux_render::Renderer;
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
//! let frame = renderer.render(&scene, &mesh, &plan)?;
//! assert!(frame.image.pixels()[32 * 64 + 32][3] > 0.5);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod adaptive;
mod cell;
mod cpu;
mod device_mesh;
mod device_view;
mod error;
mod gpu;
#[cfg(test)]
mod layout_tests;
mod resources;
mod stage;
mod tables;

pub use error::RenderError;
pub use resources::Resources;
pub use stage::{Stage, Stages};
pub use tables::table_specs;

use std::sync::Arc;

use tetlux_image::Image;
use tetlux_mesh::TetMesh;
use tetlux_optics::transfer_f32::{Piece, Weights, pieces};
use tetlux_order::Eye;
use tetlux_scene::{Backend, Classification, Device, Integrator, Order, Plan, Scene, TablePrecision};
use tetlux_tables::{Table, TableKind, TableSpec};

use crate::cell::Lens;
use crate::device_mesh::DeviceMesh;
use crate::device_view::DeviceView;

/// A picture and the time it took.
#[derive(Debug)]
pub struct Frame {
    /// Linear, premultiplied, without the background.
    pub image: Image,
    /// What was done, in order.
    pub stages: Vec<Stage>,
    /// What it took of the device.
    pub resources: Resources,
}

/// What a picture is made of.
struct Job<'a> {
    mesh: &'a DeviceMesh,
    lens: Lens,
    pieces: &'a [Piece],
    weights: Weights,
    /// The cells to draw, nearest first.
    order: &'a [u32],
    /// The piece that each is clipped to, where cells are drawn piece by piece; else empty.
    entry_pieces: &'a [u32],
    /// The tables of the integral.
    tables: &'a [Arc<Table>],
    table_precision: TablePrecision,
    /// Factor from device lengths to those of the tables.
    table_length: f32,
    /// Width and height in pixels.
    size: [u32; 2],
}

/// Renders by plan; holds the graphics device once one has been used.
#[derive(Debug)]
pub struct Renderer {
    gpu: Option<gpu::Gpu>,
}

impl Default for Renderer {
    fn default() -> Self {
        Renderer::new()
    }
}

impl Renderer {
    /// Looks for a graphics adapter, hardware before software; opens none.
    pub fn new() -> Renderer {
        Renderer { gpu: gpu::Gpu::find() }
    }

    /// The adapter there is, for the plan.
    pub fn device(&self) -> Option<&Device> {
        self.gpu.as_ref().map(gpu::Gpu::device)
    }

    /// Renders a scene on a mesh as its plan says: by a method without tables.
    ///
    /// # Errors
    ///
    /// No adapter where the plan wants one; a mesh or a picture over the device's limits; a driver that fails; a table
    /// that the method needs.
    pub fn render(&self, scene: &Scene, mesh: &TetMesh, plan: &Plan) -> Result<Frame, RenderError> {
        self.render_with(scene, mesh, plan, &[])
    }

    /// The same by any method; `tables` are those that [`table_specs`] asks for, in any order.
    ///
    /// # Errors
    ///
    /// As [`Renderer::render`].
    pub fn render_with(
        &self,
        scene: &Scene,
        mesh: &TetMesh,
        plan: &Plan,
        tables: &[Arc<Table>],
    ) -> Result<Frame, RenderError> {
        let find = |spec: &TableSpec| {
            let found = tables.iter().find(|table| table.spec() == spec).cloned();
            found.ok_or_else(|| RenderError::NoTable { id: spec.id.clone() })
        };
        let tables = table_specs(scene, mesh, plan).iter().map(find).collect::<Result<Vec<_>, _>>()?;
        let mut stages = Stages::default();
        let view = &plan.view;
        let eye = if view.orthographic { Eye::Direction(view.forward) } else { Eye::Point(view.eye) };
        let order = match plan.order {
            Order::None => plan.cells.clone(),
            // Pixels are sorted the faster the better they are sorted already.
            Order::Centroid | Order::Pixel | Order::Auto => {
                stages.run("order", || tetlux_order::centroid(mesh, eye, &plan.cells))
            }
        };
        let device_mesh = stages.run("prepare", || DeviceMesh::new(mesh, &scene.scalar));
        let lens = Lens { view: DeviceView::new(view, mesh, &device_mesh), orthographic: view.orthographic };
        let pieces = pieces(&scene.transfer, scene.scalar.range, 1.0 / (scene.unit_distance * device_mesh.scale));
        let weights = match plan.integrator {
            Integrator::Average => Weights::Average,
            // The CPU back end has these two: the plan sees to it.
            _ => Weights::Direct,
        };
        let clipped = plan.backend == Backend::Gpu && plan.classification == Classification::PostClip;
        let (order, entry_pieces) = if clipped {
            stages.run("clip", || adaptive::entries(mesh, &device_mesh, &pieces, view, &order))
        } else {
            (order, Vec::new())
        };
        let job = Job {
            mesh: &device_mesh,
            lens,
            pieces: &pieces,
            weights,
            order: &order,
            entry_pieces: &entry_pieces,
            table_precision: plan.table_precision,
            table_length: (1.0 / (device_mesh.scale * table_unit(&tables))) as f32,
            tables: &tables,
            size: view.size,
        };
        let (pixels, resources) = match plan.backend {
            Backend::Gpu => self.gpu.as_ref().ok_or(RenderError::NoAdapter)?.draw(plan, &job, &mut stages)?,
            Backend::Cpu | Backend::Auto => {
                let pixels = stages.run("draw", || cpu::draw(&job, plan.order == Order::Pixel));
                (pixels, Resources { cells: order.len(), ..Resources::default() })
            }
        };
        let image = Image::from_pixels(view.size[0], view.size[1], pixels)?;
        Ok(Frame { image, stages: stages.into_vec(), resources })
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
