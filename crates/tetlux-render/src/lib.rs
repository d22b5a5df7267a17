//! Direct volume rendering of tetrahedral meshes on wgpu and on the CPU.
//!
//! Both back ends project cells and composite, for every pixel, the exact integral along its ray through each cell.
//! Which is used, and in which order cells are composited, the [`Plan`] says.
//!
//! The CPU back end bins cells into tiles of pixels and draws vectors of pixels, with the best instruction set that the
//! processor has: pictures are the same bit for bit every time and on any number of threads, and may differ by roundings
//! between instruction sets. It leaves out what lies behind pixels whose transmittance is below a thousandth of the
//! scene's `max_error`: a pixel changes by less than that share of it.
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

#[cfg(test)]
mod cell;
mod device_mesh;
mod device_view;
mod error;
mod eye_space;
mod gpu;
#[cfg(test)]
mod layout_tests;
mod stage;
mod tiles;

pub use error::RenderError;
pub use stage::{Stage, Stages};

use std::ops::Range;

use tetlux_image::Image;
use tetlux_mesh::{ScalarField, TetMesh};
use tetlux_optics::transfer_f32::{Piece, Weights, pieces};
use tetlux_order::Eye;
use tetlux_scene::{Backend, Device, Integrator, Order, Plan, Scene};

use crate::device_mesh::DeviceMesh;
use crate::device_view::{DeviceView, Lens};
use crate::eye_space::EyeSpace;

/// A picture and the time it took.
#[derive(Debug)]
pub struct Frame {
    /// Linear, premultiplied, without the background.
    pub image: Image,
    /// What was done, in order.
    pub stages: Vec<Stage>,
}

/// What a picture is made of.
struct Job<'a> {
    mesh: &'a DeviceMesh,
    scalar: &'a ScalarField,
    lens: Lens,
    eye: EyeSpace,
    pieces: &'a [Piece],
    weights: Weights,
    /// The cells to draw, nearest first.
    order: &'a [u32],
    /// Ranges of positions in `order`, ascending and apart, whose cells have no order among themselves: only the CPU
    /// back end sorts them along each ray.
    groups: &'a [Range<u32>],
    /// Largest error of a pixel that is allowed.
    max_error: f64,
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

    /// Renders a scene on a mesh as its plan says.
    ///
    /// # Errors
    ///
    /// No adapter where the plan wants one; a mesh or a picture over the device's limits; a driver that fails.
    pub fn render(&self, scene: &Scene, mesh: &TetMesh, plan: &Plan) -> Result<Frame, RenderError> {
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
            Integrator::Direct => Weights::Direct,
            Integrator::Average => Weights::Average,
        };
        let everything = 0..order.len() as u32;
        let job = Job {
            mesh: &device_mesh,
            scalar: &scene.scalar,
            lens,
            eye: EyeSpace::new(view, mesh, &device_mesh),
            pieces: &pieces,
            weights,
            order: &order,
            groups: if plan.order == Order::Pixel { std::slice::from_ref(&everything) } else { &[] },
            max_error: scene.method.max_error,
            size: view.size,
        };
        let pixels = match plan.backend {
            Backend::Gpu => self.gpu.as_ref().ok_or(RenderError::NoAdapter)?.draw(&job, &mut stages)?,
            Backend::Cpu | Backend::Auto => tiles::draw(&job, &mut stages),
        };
        let image = Image::from_pixels(view.size[0], view.size[1], pixels)?;
        Ok(Frame { image, stages: stages.into_vec() })
    }
}
