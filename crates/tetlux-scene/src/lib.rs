//! What is to be rendered, and what of it need not be.
//!
//! A [`Scene`] is a classification, a camera, a picture size and a method, read from a TOML file
//! ([`SceneFile`]) or made in code; a [`View`] is its camera resolved to pixels and rays; a [`Plan`] says, before
//! anything runs, what is done and skipped for a mesh, and why.
//!
//! ```
//! use tetlux_scene::SceneFile;
//!
//! let file = SceneFile::parse("example.toml", r#"
//!     [field]
//!     name = "temperature"
//!     [transfer]
//!     color = [[0.0, 0.1, 0.2, 1.0], [1.0, 1.0, 0.4, 0.1]]
//!     opacity = [[0.0, 0.0], [1.0, 0.8]]
//! "#)?;
//! assert_eq!(file.size, [800, 800]);
//! # Ok::<(), tetlux_scene::SceneError>(())
//! ```

mod budget;
mod camera;
mod cost;
mod culling;
mod document;
mod emphasis;
mod error;
mod even;
mod file;
mod frequency;
mod histogram;
mod integral;
mod look;
mod method;
mod one_peak;
mod plan;
mod planner;
mod ranges;
mod reason;
mod skip;
mod surface;
mod verdict;
mod view;

pub use budget::{COLOR_SHARE, COLOR_SHARE_LIT, LIGHT_SHARE, Stated, Term};
pub use camera::{Camera, Projection};
pub use cost::{Cost, Costs, Work};
pub use culling::CellBoxes;
pub use emphasis::Emphasized;
pub use error::SceneError;
pub use even::even_opacity;
pub use file::{CameraSpec, FieldSpec, NodeRange, SceneFile, TransferSource, UnitDistance, gradient_magnitude};
pub use frequency::{FrequencyLimits, frequency_limits};
pub use histogram::{Histogram, MAX_BINS};
pub use method::{
    Backend, CellProjection, Classification, Integrator, Interpolation, Method, Order, TablePrecision, Target,
    UnknownName, parse_name,
};
pub use plan::{Device, Plan};

pub use planner::{Planner, Skips};
pub use skip::{Fate, Skip, SkipLine, SkipSet};
pub use surface::{Surface, SurfaceSpec};
pub use view::View;

use glam::DVec3;
use tetlux_mesh::ScalarField;
use tetlux_optics::{Light, NoData, TransferFunction};

/// Everything about a picture but the mesh.
#[derive(Debug, Clone)]
pub struct Scene {
    /// The scalar that is classified; the first of two.
    pub scalar: ScalarField,
    /// The second scalar, where the classification takes two: another field, or the magnitude of the gradient.
    pub second: Option<ScalarField>,
    /// Luminance and opacity over the scalars.
    pub classification: tetlux_optics::Classification,
    /// What cells look like that have a value which is not finite, of the scalar or of the second.
    pub no_data: NoData,
    /// Light by the gradient, and silhouettes.
    pub lighting: Option<Lighting>,
    /// The scalar classified at the vertices, its opacity emphasised there.
    pub emphasis: Option<Emphasized>,
    /// Opaque surfaces: the first that a ray meets ends the volume.
    pub surfaces: Vec<Surface>,
    /// World length over which an opacity of 1 is an optical depth of 1: extinction = opacity / unit distance.
    pub unit_distance: f64,
    /// Where the eye is.
    pub camera: Camera,
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// Linear RGB behind the volume.
    pub background: [f32; 3],
    /// How to render, and to what error.
    pub method: Method,
}

/// A light and the normals it needs.
#[derive(Debug, Clone)]
pub struct Lighting {
    /// The light.
    pub light: Light,
    /// The gradient of the first scalar at every point of the mesh, per world length; linear in each cell. 0: no normal.
    pub gradients: Vec<DVec3>,
}

impl Lighting {
    /// Gradients shorter than this share of the longest have no direction: where a field fades out there is no surface to
    /// light, and single precision, in which back ends shade, could not tell one.
    pub const LEAST_GRADIENT: f64 = 1e-12;

    /// With gradients too short for a direction made 0: they count as none.
    pub fn new(light: Light, mut gradients: Vec<DVec3>) -> Lighting {
        let longest = gradients.iter().map(|g| g.length()).filter(|l| l.is_finite()).fold(0.0, f64::max);
        for gradient in &mut gradients {
            if gradient.length() < Lighting::LEAST_GRADIENT * longest {
                *gradient = DVec3::ZERO;
            }
        }
        Lighting { light, gradients }
    }
}

impl Scene {
    /// The transfer function, where one field is classified.
    pub fn transfer(&self) -> Option<&TransferFunction> {
        match &self.classification {
            tetlux_optics::Classification::OneField(transfer) => Some(transfer),
            _ => None,
        }
    }

    /// The luminance, if it is the same wherever something is seen: then the order of cells does not matter.
    pub fn single_luminance(&self) -> Option<[f64; 3]> {
        let shaded = self.lighting.as_ref().is_some_and(|lighting| lighting.light.shades());
        let single = self.classification.single_luminance().filter(|_| !shaded);
        let other = !self.seen_without_data().is_empty();
        single.filter(|luminance| !other || *luminance == self.no_data.luminance())
    }

    /// The scalars of which values are missing, if cells without data are seen; else none.
    pub fn seen_without_data(&self) -> Vec<&ScalarField> {
        let scalars = [Some(&self.scalar), self.second.as_ref()].into_iter().flatten();
        scalars.filter(|scalar| scalar.missing > 0 && self.no_data.is_visible()).collect()
    }
}
