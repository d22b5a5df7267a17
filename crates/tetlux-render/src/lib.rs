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

mod cell;
mod cpu;
mod device_mesh;
mod device_view;
mod error;
mod gpu;
#[cfg(test)]
mod layout_tests;
mod march;
mod resources;
mod stage;

pub use error::RenderError;
pub use resources::Resources;
pub use stage::{Stage, Stages};

use tetlux_image::Image;
use tetlux_mesh::TetMesh;
use tetlux_optics::transfer_f32::{Piece, Weights, pieces};
use tetlux_order::Eye;
use tetlux_scene::{Backend, CellProjection, Device, Integrator, Order, Plan, Scene};

use crate::cell::Lens;
use crate::device_mesh::DeviceMesh;
use crate::device_view::DeviceView;
use crate::march::March;

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
    /// What a march needs instead of the order.
    march: Option<March>,
    /// Alpha beyond which a pixel is as good as opaque.
    opaque: f32,
    /// Width and height in pixels.
    size: [u32; 2],
}

/// The share of the error allowed that goes to what is never seen behind a nearly opaque pixel.
const OPAQUE_SHARE: f64 = 1.0 / 64.0;

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
            Integrator::Average => Weights::Average,
            // The CPU back end has these two: the plan sees to it.
            _ => Weights::Direct,
        };
        let march = (plan.backend == Backend::Gpu && plan.projection == CellProjection::March)
            .then(|| stages.run("entries", || March::new(mesh, &device_mesh, &lens, &plan.cells, view.size)));
        let opaque = (1.0 - OPAQUE_SHARE * scene.method.max_error.clamp(0.0, 1.0)) as f32;
        let size = view.size;
        let job = Job { mesh: &device_mesh, lens, pieces: &pieces, weights, order: &order, march, opaque, size };
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
