//! From where meshes are looked at, and along which rays orders are judged.

use glam::DVec3;
use tetlux_mesh::TetMesh;
use tetlux_order::Sampling;
use tetlux_order::verify::Ray;

use crate::random::Random;

/// A perspective view of a square picture; `slope` is half its side at unit depth.
pub(crate) fn perspective(eye: DVec3, target: DVec3, slope: f64, side: u32) -> Sampling {
    let forward = (target - eye).normalize();
    let right = forward.any_orthonormal_vector();
    let pixel = 2.0 * slope / f64::from(side);
    let down = forward.cross(right);
    Sampling { eye, right, down, forward, pixel, size: [side; 2], near: 0.0, orthographic: false }
}

/// A parallel view of a square picture of half side `half`.
pub(crate) fn orthographic(eye: DVec3, target: DVec3, half: f64, side: u32) -> Sampling {
    Sampling { orthographic: true, ..perspective(eye, target, half, side) }
}

/// The ray of every pixel; whole lines if they are parallel.
pub(crate) fn rays(view: &Sampling) -> Vec<Ray> {
    let start = if view.orthographic { f64::MIN } else { 0.0 };
    let pixels = (0..view.size[1]).flat_map(|j| (0..view.size[0]).map(move |i| (i, j)));
    pixels
        .map(|(i, j)| {
            let (origin, direction) = view.ray(i, j);
            Ray { origin, direction, start }
        })
        .collect()
}

/// Views from every kind of place: near and far, inside, on a vertex, on an edge, in the planes of faces; parallel
/// ones at random and along the axes.
pub(crate) fn views(mesh: &TetMesh, side: u32, seed: u64) -> Vec<(&'static str, Sampling)> {
    let mut random = Random::new(seed);
    let [low, high] = mesh.bounds();
    let (middle, radius) = (0.5 * (low + high), 0.5 * low.distance(high));
    let cell = mesh.cells()[random.below(mesh.cells().len())].map(|v| mesh.world(v));
    let toward = |random: &mut Random| random.point(1.0).normalize_or(DVec3::X);
    let mut found = Vec::new();
    for (what, distance) in [("near", 1.3), ("away", 3.0), ("far away", 1e6)] {
        let eye = middle + toward(&mut random) * (distance * radius);
        found.push((what, perspective(eye, middle, 1.0 / distance, side)));
    }
    let wide = |eye: DVec3, target: DVec3| perspective(eye, target, 1.5, side);
    let within = DVec3::from([0, 1, 2].map(|i| random.between(low[i], high[i])));
    found.push(("inside", wide(within, within + toward(&mut random))));
    found.push(("in a cell", wide(cell.iter().sum::<DVec3>() * 0.25, middle + toward(&mut random) * radius)));
    found.push(("on a vertex", wide(cell[0], middle + toward(&mut random) * (0.5 * radius))));
    found.push(("on an edge", wide(0.5 * (cell[0] + cell[1]), middle + toward(&mut random) * (0.5 * radius))));
    let in_plane = cell[0] + 3.0 * (cell[1] - cell[0]) - 4.0 * (cell[2] - cell[0]);
    found.push(("in a face's plane", wide(in_plane, middle + toward(&mut random) * (0.01 * radius))));
    // On the axis of a box: in the planes of a whole grid's faces.
    found.push(("before the middle", wide(middle + DVec3::X * (2.0 * radius), middle)));
    found.push(("parallel", orthographic(middle, middle + toward(&mut random), radius, side)));
    found.push(("parallel to an axis", orthographic(middle - DVec3::Z * (2.0 * radius), middle, radius, side)));
    found
}
