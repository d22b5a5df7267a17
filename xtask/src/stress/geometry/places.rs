//! Sizes and places of meshes, and from how far they are seen.

use anyhow::Result;
use glam::DVec3;
use tetlux_mesh::procedural::{Split, cuboid};

use super::{count, orthographic, perspective, specimen};
use crate::input::Input;

/// A cube of a width from a place on, seen whole, of the same optical depth however wide.
pub(super) fn cube(short: bool, low: f64, width: f64) -> Result<Input> {
    let bounds = [DVec3::splat(low), DVec3::splat(low + width)];
    let parts = cuboid([count(short, 10, 4); 3], Split::Six, bounds);
    let middle = (bounds[0] + bounds[1]) * 0.5;
    let camera = perspective(middle + DVec3::new(2.0, -1.25, 1.5) * width, middle, 35.0);
    let mut specimen = specimen(parts, |p| (p - middle).length() / width, camera, short)?;
    specimen.unit_distance = 0.5 * width;
    specimen.input("stress", "")
}

pub(super) fn from_afar(short: bool) -> Result<Input> {
    let parts = cuboid([count(short, 10, 4); 3], Split::Six, [DVec3::ZERO, DVec3::ONE]);
    let middle = DVec3::splat(0.5);
    let direction = DVec3::new(0.5, 0.25, 1.0).normalize();
    let camera = perspective(middle - direction * 1e6, middle, 1e-4);
    let mut specimen = specimen(parts, |p| p.distance(middle), camera, short)?;
    specimen.unit_distance = 0.5;
    specimen.input("stress", "")
}

/// Pixels of 1/8 whose centres lie on multiples of 1/8, vertices on those of 1/2 along every axis.
pub(super) fn on_edges(short: bool) -> Result<Input> {
    let parts = cuboid([4; 3], Split::Six, [DVec3::NEG_ONE, DVec3::ONE]);
    let camera = orthographic(DVec3::new(0.0, -3.0, 0.0), DVec3::ZERO, 21.0 / 16.0);
    let mut specimen = specimen(parts, |p| 0.5 + 0.3 * p.x + 0.1 * p.y, camera, short)?;
    specimen.size = [21; 2];
    specimen.input("stress", "")
}
