//! Lengths of rays in meshes whose shape is known, however the rays meet edges, vertices and faces.

use super::super::*;
use crate::testing::{Body, depth, fog, length_in_box, line, numbers, ray};
use proptest::prelude::*;
use tetlux_mesh::procedural::{Parts, Split, cuboid, grid, sphere_shell};

/// Rounding of a path length relative to the mesh's size: a few hundred units in the last place for positions, and
/// the way through the optical depth and back.
const ROUNDING: f64 = 1e-12;

/// Path length in a body, all of it of one extinction.
fn length(body: &Body, ray: &Ray) -> f64 {
    // About one optical depth across the mesh: best conditioned for the way back from alpha.
    let [low, high] = body.mesh.bounds();
    let size = low.distance(high);
    let fog = fog(1.0);
    let caster = Caster::new(Scene { unit_distance: size, ..body.scene(&fog) }).unwrap();
    depth(caster.cast(ray)) * size
}

fn plain(parts: &Parts) -> Body {
    Body::by_point(parts, |_| 0.0)
}

fn block(counts: [usize; 3], split: Split, low: f64, high: f64) -> Parts {
    cuboid(counts, split, [DVec3::splat(low), DVec3::splat(high)])
}

/// A box of unequal sides whose inner points are moved by up to `by` of a cell.
fn jittered(counts: [usize; 3], split: Split, by: f64, seed: u64) -> (Parts, [DVec3; 2]) {
    let corners = [DVec3::new(-2.0, -1.0, -3.0), DVec3::new(2.0, 1.0, 3.0)];
    let mut number = numbers(seed);
    let mut parts = grid(counts, split, |u| u);
    for point in &mut parts.points {
        let u = *point;
        let inside = |k: usize| u[k] > 0.0 && u[k] < 1.0;
        let shift = DVec3::new(number() - 0.5, number() - 0.5, number() - 0.5) * 2.0 * by;
        let cells = DVec3::new(counts[0] as f64, counts[1] as f64, counts[2] as f64);
        // Points of the surface stay in it: the shape is the box still.
        let moved = u + DVec3::from_array([0, 1, 2].map(|k| if inside(k) { shift[k] / cells[k] } else { 0.0 }));
        *point = corners[0] * (1.0 - moved) + corners[1] * moved;
    }
    (parts, corners)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]
    #[test]
    fn random_rays_through_jittered_grids_have_the_boxs_length(
        counts in [1..6usize, 1..6usize, 1..6usize],
        five: bool,
        seed: u64,
    ) {
        let split = if five { Split::Five } else { Split::Six };
        let (parts, corners) = jittered(counts, split, 0.15, seed);
        let body = plain(&parts);
        let size = corners[0].distance(corners[1]);
        let fog = fog(1.0);
        let caster = Caster::new(Scene { unit_distance: size, ..body.scene(&fog) }).unwrap();
        let mut number = numbers(!seed);
        let mut random = |scale: f64| DVec3::new(number() - 0.5, number() - 0.5, number() - 0.5) * scale;
        for k in 0..40 {
            // From outside and inside, whole lines and parts of them.
            let origin = random(if k % 2 == 0 { 20.0 } else { 4.0 });
            let toward = random(4.0) - origin;
            let start = if k % 3 == 0 { f64::NEG_INFINITY } else { 0.0 };
            let end = if k % 5 == 0 { 0.9 } else { f64::INFINITY };
            let ray = Ray { origin, direction: toward, start, end };
            let (found, exact) = (depth(caster.cast(&ray)) * size, length_in_box(&ray, corners));
            prop_assert!((found - exact).abs() < ROUNDING * size, "{ray:?}: {found} for {exact}");
        }
    }
}

#[test]
fn rays_along_a_grid_see_the_whole_box() {
    // Every ray runs through edges, vertices or in faces of the grid, in all lattice directions.
    let low = -2;
    for (split, direction) in [Split::Five, Split::Six].into_iter().flat_map(|split| {
        let directions =
            [[1, 0, 0], [0, -1, 0], [0, 0, 1], [1, 1, 0], [1, 0, -1], [0, 1, 1], [1, 1, 1], [-1, 1, 1], [1, -2, 3]];
        directions.map(|d| (split, DVec3::from_array(d.map(f64::from))))
    }) {
        let body = plain(&block([4, 4, 4], split, -2.0, 2.0));
        let corners = [DVec3::splat(-2.0), DVec3::splat(2.0)];
        let fog = fog(1.0);
        let caster = body.caster(&fog);
        let (mut inside, mut grazing) = (0, 0);
        for [x, y, z] in (0..9 * 9 * 9).map(|i| [i % 9, i / 9 % 9, i / 81].map(|k| f64::from(low) + 0.5 * f64::from(k)))
        {
            let ray = line(DVec3::new(x, y, z), direction);
            let found = depth(caster.cast(&ray));
            let exact = length_in_box(&ray, corners);
            // A line of lattice direction either meets the interior or keeps to the surface.
            if exact > 0.0 {
                inside += 1;
                // exp of up to 4 sqrt(14) / 3 makes rounding that much larger on the way back from alpha.
                let bound = 1e-14 * exact.exp().max(10.0);
                assert!((found - exact).abs() < bound, "{split:?} {ray:?}: {found} for {exact}");
            } else {
                grazing += 1;
                let closed = [corners[0] - 1e-9, corners[1] + 1e-9];
                let full = length_in_box(&ray, closed);
                assert!(
                    found == 0.0 || (found - full).abs() < 1e-6,
                    "{split:?} {ray:?}: {found}, neither 0 nor {full}"
                );
            }
        }
        assert!(inside > 100 && grazing > 0);
    }
}

#[test]
fn an_axis_aligned_grazing_ray_is_in_one_of_two_boxes_that_share_a_face() {
    // x in [0, 2] and [2, 4]: once conforming, once with grids that do not match, so that both sides are boundary.
    for counts in [[2, 2, 2], [2, 3, 5]] {
        let mut parts = cuboid([2, 2, 2], Split::Six, [DVec3::ZERO, DVec3::splat(2.0)]);
        parts.append(&cuboid(counts, Split::Six, [DVec3::new(2.0, 0.0, 0.0), DVec3::new(4.0, 2.0, 2.0)]));
        let body = plain(&parts);
        for k in 1..8 {
            let at = 0.25 * f64::from(k);
            for (origin, direction) in [
                ([2.0, at, -1.0], [0.0, 0.0, 1.0]),
                ([2.0, 5.0, at], [0.0, -1.0, 0.0]),
                ([2.0, at, -1.0], [0.0, 0.0, 2.0]),
            ] {
                let found = length(&body, &ray(origin, direction));
                assert!((found - 2.0).abs() < ROUNDING, "in the shared face, {origin:?}: {found}");
            }
            let across = length(&body, &ray([-1.0, at, at], [1.0, 0.0, 0.0]));
            assert!((across - 4.0).abs() < 4.0 * ROUNDING, "through the shared face: {across}");
        }
    }
}

#[test]
fn scaling_space_changes_nothing() {
    let (parts, _) = jittered([3, 4, 5], Split::Six, 0.15, 7);
    let body = Body::by_point(&parts, |p| p.x + p.y * p.z);
    let functions = crate::testing::transfer(&[[-3.0, 0.0], [0.5, 1.0], [3.0, 0.2]], &[[-1.0, 0.1], [2.0, 1.0]]);
    let origin = DVec3::new(-5.0, 0.7, -9.0);
    let direction = DVec3::new(0.5, -0.07, 1.0);
    let seen = body.caster(&functions).cast(&line(origin, direction));
    assert!(seen.alpha > 0.1);
    for power in [-40, -3, 1, 40] {
        let factor = 2f64.powi(power);
        let scaled = Parts { points: parts.points.iter().map(|&p| p * factor).collect(), ..parts.clone() };
        let Body { mesh, .. } = Body::by_point(&scaled, |_| 0.0);
        let scene = Scene { mesh: &mesh, unit_distance: factor, ..body.scene(&functions) };
        let caster = Caster::new(scene).unwrap();
        // Powers of two move no digit: all is bit for bit the same.
        assert_eq!(caster.cast(&line(origin * factor, direction * factor)), seen);
        assert_eq!(caster.cast(&line(origin * factor, direction)), seen);
    }
}

#[test]
fn meshes_of_any_width_at_any_place() {
    for width in [1e-30, 1e-12, 1e12, 1e30] {
        for place in [0.0, 1e3] {
            let corners = [place * width, (place + 1.0) * width].map(DVec3::splat);
            let body = plain(&cuboid([3, 3, 3], Split::Six, corners));
            for toward in [DVec3::Z, DVec3::new(0.2, 0.1, 1.0)] {
                let middle = 0.5 * (corners[0] + corners[1]);
                let ray = Ray { start: 0.0, ..line(middle - toward * 20.0 * width, toward) };
                // Corners are stored in single precision about the centre, here half a width from it; world positions
                // are rounded at `place` widths from the origin.
                let rounding = f64::from(f32::EPSILON).max(1e-13 * place);
                let error = length(&body, &ray) / length_in_box(&ray, corners) - 1.0;
                assert!(error.abs() < rounding, "{width:e} wide at {place:e} widths: relative error {error:e}");
            }
        }
    }
}

#[test]
fn a_ray_is_cut_at_its_ends() {
    let body = plain(&block([4, 4, 4], Split::Five, 0.0, 4.0));
    let along = |start: f64, end: f64| Ray { start, end, ..ray([0.3, 1.7, -1.0], [0.0, 0.0, 0.5]) };
    // z = -1 + t/2; the box is z in [0, 4], t in [2, 10].
    for (start, end, exact) in [
        (0.0, f64::INFINITY, 4.0),
        (5.5, f64::INFINITY, 2.25),
        (f64::NEG_INFINITY, 5.5, 1.75),
        (5.1, 5.3, 0.1),
        (10.5, 20.0, 0.0),
        (-5.0, 1.5, 0.0),
    ] {
        let found = length(&body, &along(start, end));
        assert!((found - exact).abs() < 4.0 * ROUNDING, "[{start}, {end}]: {found} for {exact}");
    }
}

/// 27 blocks of side 1 without the middle one, about (1.5, 1.5, 1.5), and a box of half the hole's side in the hole.
fn box_in_a_hole() -> Parts {
    let mut parts = Parts::default();
    for [i, j, k] in (0..27).map(|c| [c % 3, c / 3 % 3, c / 9]) {
        if [i, j, k] != [1, 1, 1] {
            let low = DVec3::new(f64::from(i), f64::from(j), f64::from(k));
            parts.append(&cuboid([2, 2, 2], Split::Six, [low, low + 1.0]));
        }
    }
    parts.append(&block([2, 2, 2], Split::Five, 1.25, 1.75));
    parts
}

#[test]
fn nested_components_and_holes() {
    let body = plain(&box_in_a_hole());
    assert_eq!(body.mesh.validate().components, 2);
    let cube = |low: f64, high: f64| [DVec3::splat(low), DVec3::splat(high)];
    let [shell, hole, core] = [cube(0.0, 3.0), cube(1.0, 2.0), cube(1.25, 1.75)];
    let exact = |ray: &Ray| length_in_box(ray, shell) - length_in_box(ray, hole) + length_in_box(ray, core);
    let mut number = numbers(11);
    let mut random = || DVec3::new(number(), number(), number());
    for _ in 0..500 {
        let origin = random() * 9.0 - 3.0;
        let ray = Ray { start: 0.0, ..line(origin, random() * 3.0 - origin) };
        let found = length(&body, &ray);
        assert!((found - exact(&ray)).abs() < 5.0 * ROUNDING, "{ray:?}: {found} for {}", exact(&ray));
    }
    // Along the axis through the centre, through vertices of all three: 1 + 0.5 + 1.
    assert!((length(&body, &ray([1.5, 1.5, -1.0], [0.0, 0.0, 1.0])) - 2.5).abs() < 5.0 * ROUNDING);
    // From the centre, inside the core: 0.25 + 1. From the gap: 0.5 + 1.
    assert!((length(&body, &ray([1.5, 1.5, 1.5], [0.0, 0.0, 1.0])) - 1.25).abs() < 5.0 * ROUNDING);
    assert!((length(&body, &ray([1.5, 1.5, 1.125], [0.0, 0.0, 1.0])) - 1.5).abs() < 5.0 * ROUNDING);
}

#[test]
fn interleaved_components_are_met_in_order() {
    // A comb with teeth z in [0, 1] and [2, 3], joined by a bar beyond x = 1, and a loose box z in [1.25, 1.75] between
    // them: the ray leaves the comb, meets the box, and meets the comb again.
    let boxes = [
        ([0.0, 0.0, 0.0], [1.0, 1.0, 1.0], 0.0),
        ([1.0, 0.0, 0.0], [2.0, 1.0, 1.0], 0.0),
        ([1.0, 0.0, 1.0], [2.0, 1.0, 2.0], 0.0),
        ([1.0, 0.0, 2.0], [2.0, 1.0, 3.0], 2.0),
        ([0.0, 0.0, 2.0], [1.0, 1.0, 3.0], 2.0),
        ([0.0, 0.0, 1.25], [0.75, 1.0, 1.75], 1.0),
    ];
    let (mut parts, mut values) = (Parts::default(), Vec::new());
    for (low, high, value) in boxes {
        parts.append(&cuboid([2, 2, 2], Split::Six, [low.into(), high.into()]));
        values.resize(parts.cells.len(), value);
    }
    let body = Body::by_cell(&parts, values);
    assert_eq!(body.mesh.validate().components, 2);
    let (tau, light) = ([1.0, 3.0, 0.5], [0.3, 1.0, 0.6]);
    let nodes = |v: [f64; 3]| [[0.0, v[0]], [1.0, v[1]], [2.0, v[2]]];
    let functions = crate::testing::transfer(&nodes(tau), &nodes(light));
    let seen = body.caster(&functions).cast(&ray([0.4, 0.3, -1.0], [0.0, 0.0, 1.0]));
    let alpha = |depth: f64| -(-depth).exp_m1();
    let expected =
        light[0] * alpha(1.0) + (-1.0_f64).exp() * (light[1] * alpha(1.5) + (-1.5_f64).exp() * light[2] * alpha(0.5));
    assert!((seen.color[0] - expected).abs() < 1e-10);
    assert!((depth(seen) - 3.0).abs() < ROUNDING * 3.0_f64.exp());
}

#[test]
fn a_flat_cell_is_passed_without_depth() {
    // A square pyramid on either side of a flat cell, its base split along one diagonal above and the other below.
    let points: [[f64; 3]; 6] =
        [[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0], [0.5, 0.5, 1.0], [0.5, 0.5, -1.0]];
    let parts = Parts {
        points: points.map(DVec3::from).to_vec(),
        cells: vec![[0, 1, 2, 4], [0, 2, 3, 4], [0, 1, 3, 5], [1, 2, 3, 5], [0, 1, 2, 3]],
    };
    // The flat cell would be opaque if it had any depth.
    let body = Body::by_cell(&parts, vec![0.0, 0.0, 0.0, 0.0, 1.0]);
    assert_eq!((body.mesh.assembly().cells_flat, body.mesh.validate().boundary_faces), (1, 8));
    let functions = crate::testing::transfer(&[[0.0, 1.0], [1.0, 1e30]], &[[0.0, 1.0]]);
    let caster = body.caster(&functions);
    for [i, j] in (0..81).map(|c| [c % 9, c / 9]) {
        let (x, y) = (f64::from(i) / 8.0, f64::from(j) / 8.0);
        let found = depth(caster.cast(&ray([x, y, 5.0], [0.0, 0.0, -1.0])));
        // A pyramid's height falls linearly from the centre to the nearest side.
        let exact = 2.0 * (1.0 - 2.0 * (x - 0.5).abs().max((y - 0.5).abs()));
        assert!((found - exact).abs() < 10.0 * ROUNDING, "at {x}, {y}: {found} for {exact}");
    }
    // In the flat cell's own plane the ray is in one pyramid or the other, all the way.
    let found = depth(caster.cast(&ray([-1.0, 0.3, 0.0], [1.0, 0.0, 0.0])));
    assert!((found - 1.0).abs() < ROUNDING, "{found}");
}

#[test]
fn a_spherical_shell_converges_and_its_axis_is_exact() {
    let radii = [1.0, 2.0];
    let exact = |ray: &Ray| {
        let d = ray.direction.normalize();
        let distance = ray.origin - d * ray.origin.dot(d);
        let chord = |r: f64| 2.0 * (r * r - distance.length_squared()).max(0.0).sqrt();
        chord(radii[1]) - chord(radii[0])
    };
    let mut number = numbers(3);
    let rays: Vec<Ray> = (0..200)
        .map(|_| {
            let mut random = || DVec3::new(number() - 0.5, number() - 0.5, number() - 0.5);
            let (through, direction) = (random(), random());
            line(through, direction)
        })
        .collect();
    let mean_error = |n: usize| {
        let body = plain(&sphere_shell([4 * n, 2 * n, n], Split::Six, DVec3::ZERO, radii));
        let report = body.mesh.validate();
        assert_eq!((report.components, report.assembly.faces_non_manifold), (1, 0));
        // The axis runs through both poles, where dozens of edges meet.
        let axis = length(&body, &ray([0.0, 0.0, 9.0], [0.0, 0.0, -1.0]));
        assert!((axis - 2.0).abs() < 1e-6, "along the axis: {axis}");
        rays.iter().map(|ray| (length(&body, ray) - exact(ray)).abs()).sum::<f64>() / rays.len() as f64
    };
    // Chords of a polyhedron differ from the sphere's in second order: a quarter of the error at twice the counts.
    let ratio = mean_error(8) / mean_error(16);
    assert!((3.0..5.0).contains(&ratio), "ratio {ratio}");
}
