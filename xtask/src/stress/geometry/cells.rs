//! Shapes and sizes of cells.

use anyhow::Result;
use glam::DVec3;
use tetlux_mesh::Field;
use tetlux_mesh::procedural::{Parts, Split, cuboid};
use tetlux_scene::{Camera, Projection};

use crate::input::Input;
use crate::testbed::meshes::{FIELD, Specimen, transfer};

/// Colours and opacities over 0 to 1 that tell orders, ends and places apart.
const COLOR: [[f64; 4]; 4] = [[0.0, 1.0, 0.6, 0.1], [0.35, 0.9, 0.2, 0.3], [0.7, 0.1, 0.5, 1.0], [1.0, 0.2, 1.0, 0.4]];
const OPACITY: [[f64; 2]; 5] = [[0.0, 0.4], [0.3, 1.6], [0.45, 0.1], [0.7, 2.0], [1.0, 0.6]];

pub(super) fn specimen(
    parts: Parts,
    field: impl Fn(DVec3) -> f64,
    unit_distance: f64,
    camera: Camera,
    short: bool,
) -> Result<Specimen> {
    Ok(Specimen {
        field: Field::point(FIELD, 1, parts.sample(field)),
        parts,
        transfer: transfer(&COLOR, &OPACITY)?,
        unit_distance,
        camera,
        size: if short { [24, 20] } else { [64, 56] },
    })
}

pub(super) fn camera(position: DVec3, focal_point: DVec3, view_angle: f64) -> Camera {
    let projection = Projection::Perspective { view_angle };
    Camera { position, focal_point, view_up: DVec3::Z, projection, near: 0.0 }
}

pub(super) fn cube(short: bool) -> Result<Input> {
    let n = if short { 4 } else { 12 };
    let parts = cuboid([n; 3], Split::Six, [DVec3::NEG_ONE, DVec3::ONE]);
    let camera = camera(DVec3::new(2.2, -5.4, 1.7), DVec3::ZERO, 30.0);
    specimen(parts, |p| p.length() / 1.75, 1.0, camera, short)?.input("cube", "")
}
