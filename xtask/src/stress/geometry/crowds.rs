//! Few cells over many pixels, and many over few.

use anyhow::Result;
use glam::DVec3;
use tetlux_mesh::procedural::{Parts, Split, cuboid};
use tetlux_scene::Camera;

use super::{count, perspective, specimen};
use crate::input::Input;

/// A cell that holds the origin.
fn large() -> Parts {
    let points =
        [DVec3::new(-5.0, -4.0, -3.0), DVec3::new(6.0, -3.0, -4.0), DVec3::new(0.5, 7.0, -3.5), DVec3::Z * 6.0];
    Parts { points: points.to_vec(), cells: vec![[0, 1, 2, 3]] }
}

fn height(p: DVec3) -> f64 {
    (4.0 + p.z) / 10.0
}

pub(super) fn round_eye(short: bool) -> Result<Input> {
    let eye = DVec3::new(0.3, 0.2, 0.5);
    let mut specimen = specimen(large(), height, perspective(eye, DVec3::new(1.0, 2.0, 0.0), 100.0), short)?;
    specimen.unit_distance = 4.0;
    specimen.input("stress", "")
}

pub(super) fn fills(short: bool) -> Result<Input> {
    // Before the face of the first three vertices, at their middle.
    let middle = DVec3::new(0.5, 0.0, -3.5);
    let camera = perspective(middle - DVec3::Z * 1e-5, middle + DVec3::new(0.2, 0.1, 1.0), 90.0);
    let mut specimen = specimen(large(), height, camera, short)?;
    specimen.unit_distance = 4.0;
    specimen.input("stress", "")
}

pub(super) fn in_a_pixel(short: bool) -> Result<Input> {
    let n = count(short, 56, 12);
    let parts = cuboid([n; 3], Split::Six, [DVec3::NEG_ONE, DVec3::ONE]);
    // Seven pixels, 30 degrees: the middle one is 5 wide at this distance.
    let eye = DVec3::new(20.0, -55.0, 17.0);
    let mut specimen = specimen(parts, |p| p.length() / 1.75, perspective(eye, DVec3::ZERO, 30.0), short)?;
    specimen.size = [7; 2];
    specimen.input("stress", "")
}

/// Layers that are 1 thick together.
fn layers(short: bool) -> Parts {
    cuboid([1, 1, count(short, 10_000, 1000)], Split::Six, [DVec3::ZERO, DVec3::ONE])
}

fn wave(p: DVec3) -> f64 {
    0.5 + 0.45 * (9.0 * p.z).sin()
}

fn stacked(short: bool, camera: Camera) -> Result<Input> {
    let mut specimen = specimen(layers(short), wave, camera, short)?;
    // Two parts of a hundred are still seen through it.
    specimen.unit_distance = 0.25;
    specimen.size = if short { [8, 8] } else { [16, 16] };
    specimen.input("stress", "")
}

pub(super) fn stack(short: bool) -> Result<Input> {
    stacked(short, perspective(DVec3::new(0.4, 0.55, 4.0), DVec3::new(0.5, 0.5, 0.0), 24.0))
}

pub(super) fn stack_aside(short: bool) -> Result<Input> {
    stacked(short, perspective(DVec3::new(2.4, -2.1, 1.9), DVec3::splat(0.5), 30.0))
}
