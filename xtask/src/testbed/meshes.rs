//! Procedural meshes and scenes, in a line each.

use anyhow::{Context, Result};
use glam::DVec3;
use tetlux_mesh::procedural::{Parts, Split, cuboid, grid};
use tetlux_mesh::{Component, Field, TetMesh};
use tetlux_optics::transfer::{ColorNode, OpacityNode, TransferFunction};
use tetlux_scene::{Camera, Method, Projection, Scene};

use crate::input::Input;

/// The name of the field that meshes get here.
pub(crate) const FIELD: &str = "s";

/// A mesh with a function of the position, how it glows, and from where it is seen.
#[derive(Clone, Copy)]
pub(crate) struct Setting {
    pub(crate) mesh: fn() -> Parts,
    pub(crate) field: fn(DVec3) -> f64,
    /// Scalar, red, green, blue.
    pub(crate) color: &'static [[f64; 4]],
    /// Scalar, opacity.
    pub(crate) opacity: &'static [[f64; 2]],
    pub(crate) unit_distance: f64,
    /// The eye; it looks at `focus`.
    pub(crate) eye: [f64; 3],
    pub(crate) focus: [f64; 3],
    pub(crate) view_angle: f64,
}

impl Setting {
    pub(crate) fn input(&self, name: &str, title: &str, side: u32) -> Result<Input> {
        let parts = (self.mesh)();
        let field = parts.sample(self.field);
        let specimen = Specimen {
            parts,
            field: Field::point(FIELD, 1, field),
            transfer: transfer(self.color, self.opacity)?,
            unit_distance: self.unit_distance,
            camera: Camera {
                position: self.eye.into(),
                focal_point: self.focus.into(),
                view_up: DVec3::Z,
                projection: Projection::Perspective { view_angle: self.view_angle },
                near: 0.0,
            },
            size: [side; 2],
        };
        specimen.input(name, title)
    }
}

/// A transfer function of (scalar, red, green, blue) and (scalar, opacity).
pub(crate) fn transfer(color: &[[f64; 4]], opacity: &[[f64; 2]]) -> Result<TransferFunction> {
    Ok(TransferFunction::new(
        color.iter().map(|&[s, r, g, b]| ColorNode { s, rgb: [r, g, b] }).collect(),
        opacity.iter().map(|&[s, opacity]| OpacityNode { s, opacity }).collect(),
    )?)
}

/// A mesh that a program made, with one field, and how it is seen.
pub(crate) struct Specimen {
    pub(crate) parts: Parts,
    pub(crate) field: Field,
    pub(crate) transfer: TransferFunction,
    pub(crate) unit_distance: f64,
    pub(crate) camera: Camera,
    pub(crate) size: [u32; 2],
}

impl Specimen {
    pub(crate) fn input(self, name: &str, title: &str) -> Result<Input> {
        let Specimen { parts, field, transfer, unit_distance, camera, size } = self;
        let field_name = field.name.clone();
        let mesh = TetMesh::assemble(&parts.points, &parts.cells, vec![field]).context("a procedural mesh")?;
        let scene = Scene {
            scalar: mesh.scalar(&field_name, Component::Magnitude)?,
            second: None,
            no_data: tetlux_optics::NoData::default(),
            classification: tetlux_optics::Classification::OneField(transfer),
            lighting: None,
            emphasis: None,
            surfaces: Vec::new(),
            unit_distance,
            camera,
            size,
            background: [0.0; 3],
            method: Method::default(),
        };
        Ok(Input {
            name: name.into(),
            title: title.into(),
            mesh,
            scene,
            display_space: false,
            extras: None,
            integrator_forced: true,
        })
    }
}

/// The cube from -1 to 1 of so many hexahedra a side.
pub(crate) fn cube<const N: usize>() -> Parts {
    cuboid([N; 3], Split::Six, [DVec3::NEG_ONE, DVec3::ONE])
}

/// The cube from -1 to 1 of long cells: one along x, 20 along y and z.
pub(crate) fn long_cells() -> Parts {
    cuboid([1, 20, 20], Split::Six, [DVec3::NEG_ONE, DVec3::ONE])
}

/// The cube from -1 to 1, its spacings growing from the middle outwards by the same factor each: edges from `grading` to
/// about 1. There are so many hexahedra from its middle to its surface.
pub(crate) fn graded_from(grading: f64, count: usize) -> Parts {
    let half = count as f64;
    let place = |u: f64| {
        let steps = ((2.0 * u - 1.0) * half).round();
        let growth = grading.powf(-1.0 / (half - 1.0).max(1.0));
        steps.signum() * (growth.powf(steps.abs()) - 1.0) / (growth.powf(half) - 1.0)
    };
    grid([2 * count; 3], Split::Six, |u| DVec3::new(place(u.x), place(u.y), place(u.z)))
}

/// Spacing in the middle of the graded cube over that at its surface.
const GRADING: f64 = 1e-5;

/// The graded cube of edges from 1e-5 to 1.
pub(crate) fn graded(count: usize) -> Parts {
    graded_from(GRADING, count)
}

/// One of 48 000 cells.
pub(crate) fn graded_cube() -> Parts {
    graded(10)
}

/// The distance from the middle on a logarithmic scale: 0 there, 1 at distance 1.
pub(crate) fn log_radius(p: DVec3) -> f64 {
    log_radius_from(GRADING, p)
}

/// The same where it begins at another length.
pub(crate) fn log_radius_from(grading: f64, p: DVec3) -> f64 {
    (p.length() / grading).ln_1p() / grading.recip().ln_1p()
}
