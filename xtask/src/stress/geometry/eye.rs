//! Places of the eye in and about the mesh.

use anyhow::Result;
use glam::DVec3;
use tetlux_mesh::procedural::{Parts, Split, cuboid};
use tetlux_scene::Camera;

use super::{COLOR, count, input, orthographic, perspective, specimen};
use crate::input::Input;
use crate::testbed::meshes::{graded_from, log_radius_from, transfer};

/// A box of three cubes a side, vertices on whole numbers.
fn cube() -> Parts {
    cuboid([3; 3], Split::Six, [DVec3::ZERO, DVec3::splat(3.0)])
}

fn field(p: DVec3) -> f64 {
    (p.x + 0.5 * p.y + 1.5 * p.z) / 9.0
}

fn seen(short: bool, camera: Camera) -> Result<Input> {
    input(cube(), field, camera, short)
}

/// Along no axis, plane or diagonal.
const SOMEWHERE: DVec3 = DVec3::new(0.9, 0.3, -0.2);

pub(super) fn at(short: bool, place: DVec3) -> Result<Input> {
    seen(short, perspective(place, place + SOMEWHERE, 80.0))
}

pub(super) fn on_corner(short: bool) -> Result<Input> {
    seen(short, perspective(DVec3::ZERO, DVec3::X, 70.0))
}

pub(super) fn in_plane(short: bool) -> Result<Input> {
    seen(short, perspective(DVec3::new(-4.0, 1.0, 2.0), DVec3::new(1.5, 1.0, 2.0), 40.0))
}

pub(super) fn parallel(short: bool) -> Result<Input> {
    let place = DVec3::new(1.3, 1.55, 1.21);
    seen(short, orthographic(place, place + SOMEWHERE, 1.7))
}

pub(super) fn near(short: bool, near: f64) -> Result<Input> {
    let camera = perspective(DVec3::new(-1.0, 1.4, 1.6), DVec3::new(3.0, 1.4, 1.6), 60.0);
    seen(short, Camera { near: 1.0 + near, ..camera })
}

pub(super) fn wide(short: bool, view_angle: f64) -> Result<Input> {
    let place = DVec3::new(1.3, 1.55, 1.21);
    seen(short, perspective(place, place + SOMEWHERE, view_angle))
}

/// A medium whose extinction falls as the distance from the middle grows: as opaque from each decade to the next.
pub(super) fn in_smallest(short: bool) -> Result<Input> {
    const SMALLEST: f64 = 1e-4;
    const NODES: u32 = 12;
    // sqrt(3) at the corners makes 1.06.
    const LARGEST: f64 = 1.1;
    let parts = graded_from(SMALLEST, count(short, 8, 4));
    let eye = DVec3::new(3.0, 2.0, 1.0) * (0.1 * SMALLEST);
    let field = |p: DVec3| log_radius_from(SMALLEST, p) / LARGEST;
    let opacity = |i: u32| {
        let s = f64::from(i) / f64::from(NODES);
        let radius = SMALLEST * (s * LARGEST * SMALLEST.recip().ln_1p()).exp_m1();
        [s, 0.1 / (radius + SMALLEST)]
    };
    let mut specimen = specimen(parts, field, perspective(eye, eye + SOMEWHERE, 80.0), short)?;
    specimen.transfer = transfer(&COLOR, &(0..=NODES).map(opacity).collect::<Vec<_>>())?;
    specimen.input("stress", "")
}
