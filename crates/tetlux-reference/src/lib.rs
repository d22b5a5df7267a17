//! The truth that every renderer is judged by: an f64 ray caster with its own quadrature.
//!
//! A [`Caster`] follows each ray from cell to cell by exact predicates, so that none is lost at an edge or a vertex,
//! and integrates the emission-absorption model
//!
//! ```text
//! C = int L(s) tau(s) exp(-int tau) dx,    tau = opacity(s) / unit distance
//! ```
//!
//! adaptively to a stated tolerance. Of a classification by one or two scalars, and of a light, it takes the definitions
//! alone, never a closed form of an integral: it shares no formula with what it judges.
//!
//! ```
//! use glam::DVec3;
//! use tetlux_mesh::{Component, Field, TetMesh, procedural::{Split, cuboid}};
//! use tetlux_optics::{Classification, ColorNode, OpacityNode, TransferFunction};
//! use tetlux_reference::{Caster, DEFAULT_TOLERANCE, Ray, Scene};
//!
//! let parts = cuboid([2, 2, 2], Split::Six, [DVec3::ZERO, DVec3::splat(3.0)]);
//! let field = Field::point("density", 1, parts.sample(|_| 0.5));
//! let mesh = TetMesh::assemble(&parts.points, &parts.cells, vec![field])?;
//! let scalar = mesh.scalar("density", Component::Magnitude)?;
//! let transfer = TransferFunction::new(
//!     vec![ColorNode { s: 0.0, rgb: [1.0; 3] }],
//!     vec![OpacityNode { s: 0.0, opacity: 0.25 }],
//! )?;
//! let scene = Scene {
//!     mesh: &mesh,
//!     scalar: &scalar,
//!     second: None,
//!     classification: &Classification::OneField(transfer),
//!     lighting: None,
//!     colors: None,
//!     unit_distance: 1.0,
//!     tolerance: DEFAULT_TOLERANCE,
//! };
//! let ray = Ray { origin: DVec3::new(1.0, 1.0, -5.0), direction: DVec3::Z, start: 0.0, end: f64::INFINITY };
//! let seen = Caster::new(scene)?.cast(&ray);
//! // Three units of extinction 0.25, all white.
//! assert!((seen.alpha - (1.0 - (-0.75_f64).exp())).abs() < 1e-10);
//! assert!((seen.color[0] - seen.alpha).abs() < 1e-10);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod caster;
mod definition;
mod double;
mod error;
mod hierarchy;
mod line;
mod quadrature;
mod rule;
mod surface;
#[cfg(test)]
mod testing;
mod walk;

pub use caster::{Caster, DEFAULT_TOLERANCE, Radiance, Ray, Scene};
pub use error::ReferenceError;
pub use surface::Surface;
