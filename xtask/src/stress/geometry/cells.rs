//! Shapes of cells.

use anyhow::Result;
use glam::{DQuat, DVec3};
use tetlux_mesh::procedural::{Parts, Split, cuboid, for_each_hexahedron, grid, ring, sphere_shell};

use super::{count, input, perspective, specimen};
use crate::input::Input;
use crate::testbed::meshes::{graded_from, log_radius_from};

/// From where a cube from -1 to 1 is seen whole.
const ASIDE: DVec3 = DVec3::new(2.2, -5.4, 1.7);

const BOX: [DVec3; 2] = [DVec3::NEG_ONE, DVec3::ONE];

/// The distance from a cube's middle; 1 at its corners.
fn radius(p: DVec3) -> f64 {
    p.length() / 3f64.sqrt()
}

pub(super) fn cube(short: bool) -> Result<Input> {
    input(cuboid([count(short, 12, 4); 3], Split::Six, BOX), radius, perspective(ASIDE, DVec3::ZERO, 30.0), short)
}

/// A box of layers across z at given heights, ascending.
fn layers(across: usize, heights: &[f64]) -> Parts {
    let last = heights.len() - 1;
    grid([across, across, last], Split::Six, |u| {
        // A grid's parameter is an index over a count: rounded it is that index again.
        let z = heights[(u.z * last as f64).round() as usize];
        DVec3::new(2.0 * u.x - 1.0, 2.0 * u.y - 1.0, z)
    })
}

/// Heights 0, and by factors from the smallest to 1, above and below.
fn heights(smallest: f64, factor: f64) -> Vec<f64> {
    let above: Vec<f64> =
        std::iter::successors(Some(smallest), |h| Some(h * factor)).take_while(|h| *h < 0.9).collect();
    let below = above.iter().rev().map(|h| -h);
    [-1.0].into_iter().chain(below).chain([0.0]).chain(above.iter().copied()).chain([1.0]).collect()
}

pub(super) fn flat(short: bool) -> Result<Input> {
    let parts = layers(count(short, 6, 3), &heights(1e-12, 100.0));
    input(parts, |p| 0.5 + 0.3 * p.z + 0.15 * p.x, perspective(ASIDE, DVec3::ZERO, 30.0), short)
}

pub(super) fn flat_aslant(short: bool) -> Result<Input> {
    let turn = DQuat::from_axis_angle(DVec3::new(0.3, 0.8, 0.5).normalize(), 0.7);
    let mut parts = layers(count(short, 5, 3), &heights(1e-5, 10.0));
    parts.points.iter_mut().for_each(|p| *p = turn * *p);
    input(parts, |p| 0.5 + 0.2 * p.z + 0.1 * p.x, perspective(ASIDE, DVec3::ZERO, 36.0), short)
}

pub(super) fn zero_volume(short: bool) -> Result<Input> {
    let n = count(short, 8, 3);
    let mut parts = cuboid([n; 3], Split::Six, BOX);
    let at = |i: usize, j: usize, k: usize| ((k * (n + 1) + j) * (n + 1) + i) as u32;
    parts.cells.extend([
        [at(0, 0, n), at(1, 0, n), at(0, 1, n), at(1, 1, n)],
        [at(1, 1, 1), at(2, 1, 1), at(2, 2, 1), at(1, 2, 1)],
        [at(1, 1, 1), at(2, 1, 1), at(3, 1, 1), at(1, 2, 1)],
        [at(0, 1, 2), at(0, 2, 2), at(0, 2, 1), at(0, 1, 1)],
        [at(0, 0, 0), at(1, 1, 1), at(2, 2, 2), at(3, 3, 3)],
    ]);
    input(parts, radius, perspective(ASIDE, DVec3::ZERO, 30.0), short)
}

/// Layers in a sheet of some thickness, which is as opaque as others are thick: a field that goes from end to end of its
/// range through it.
fn sheet(short: bool, layers: usize, thickness: f64) -> Result<Input> {
    let n = count(short, 6, 3);
    let corner = DVec3::new(1.0, 1.0, 0.5 * thickness);
    let parts = cuboid([n, n, layers], Split::Six, [-corner, corner]);
    let camera = perspective(DVec3::new(1.0, -2.5, 5.0), DVec3::ZERO, 30.0);
    let mut specimen = specimen(parts, |p| 0.5 + 0.9 * p.z / thickness, camera, short)?;
    specimen.unit_distance = thickness;
    specimen.input("stress", "")
}

pub(super) fn thin_sheet(short: bool) -> Result<Input> {
    sheet(short, 20, 1.0 / 128.0)
}

pub(super) fn film(short: bool) -> Result<Input> {
    sheet(short, 4, 1e-4)
}

pub(super) fn long(short: bool) -> Result<Input> {
    let n = count(short, 6, 3);
    let parts = cuboid([1, n, n], Split::Six, [DVec3::new(-1.0, -1e-6, -1e-6), DVec3::new(1.0, 1e-6, 1e-6)]);
    // From near enough to see how thick it is.
    let camera = perspective(DVec3::new(0.25, -5e-6, 2e-6), DVec3::new(0.25, 0.0, 0.0), 50.0);
    let mut specimen = specimen(parts, |p| 0.5 + 4e5 * p.z, camera, short)?;
    specimen.unit_distance = 1e-6;
    specimen.input("stress", "")
}

/// The shortest edge of the graded mesh, its longest about 1.
const GRADING: f64 = 1e-6;

pub(super) fn graded(short: bool) -> Result<Input> {
    let parts = graded_from(GRADING, count(short, 8, 4));
    // sqrt(3) at the corners makes 1.04.
    let field = |p| log_radius_from(GRADING, p) / 1.05;
    input(parts, field, perspective(DVec3::new(1.6, -2.9, 1.3), DVec3::ZERO, 36.0), short)
}

pub(super) fn one_far(short: bool) -> Result<Input> {
    let mut parts = cuboid([count(short, 8, 3); 3], Split::Six, BOX);
    let base = DVec3::splat(40.0);
    parts.append(&Parts {
        points: vec![base, base + DVec3::X * 6000.0, base + DVec3::Y, base + DVec3::Z],
        cells: vec![[0, 1, 2, 3]],
    });
    let field = |p: DVec3| if p.x < 2.0 { 0.25 + 0.1 * (p.x + p.y) } else { 1.0 };
    input(parts, field, perspective(ASIDE, DVec3::ZERO, 30.0), short)
}

pub(super) fn co_spherical(short: bool) -> Result<Input> {
    let counts = if short { [8, 4, 4] } else { [24, 12, 4] };
    let parts = sphere_shell(counts, Split::Six, DVec3::ZERO, [0.25, 1.25]);
    input(parts, |p| 0.5 + 0.35 * p.z, perspective(ASIDE, DVec3::ZERO, 26.0), short)
}

pub(super) fn co_planar(short: bool) -> Result<Input> {
    let parts = cuboid([4; 3], Split::Five, BOX);
    // From a point of the grid's own planes: rays run in faces and along diagonals.
    let camera = perspective(DVec3::new(0.0, -4.0, 0.0), DVec3::ZERO, 2.0 * 0.5f64.atan().to_degrees());
    let mut specimen = specimen(parts, radius, camera, short)?;
    specimen.size = [if short { 21 } else { 63 }; 2];
    specimen.input("stress", "")
}

pub(super) fn every_other(short: bool) -> Result<Input> {
    let n = count(short, 7, 3);
    let mut parts = cuboid([n; 3], Split::Six, BOX);
    parts.cells.clear();
    for_each_hexahedron([n + 1; 3], |[i, j, k], corners| {
        if (i + j + k).is_multiple_of(2) {
            parts.cells.extend(Split::Six.hexahedron(corners, [i, j, k]));
        }
    });
    input(parts, radius, perspective(ASIDE, DVec3::ZERO, 30.0), short)
}

pub(super) fn cycle(short: bool) -> Result<Input> {
    let along = perspective(DVec3::new(0.013, 0.007, 8.0), DVec3::new(0.0, 0.0, 0.5), 22.0);
    input(ring(13, 60.0), |p| 0.5 + 0.2 * p.x + 0.1 * p.y, along, short)
}
