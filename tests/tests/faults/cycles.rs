//! Cells that occlude one another in a cycle: no order of cells is right, and every pixel is.

use glam::{DMat3, DVec3};
use tetlux_mesh::procedural::Parts;
use tetlux_render::Model;
use tetlux_scene::{Backend, Camera, Method, Order};
use tetlux_tests::{
    Way, largest_error, mesh_of, orthographic, perspective, plan_by, reference, render, renderer, scene, transfer,
};

/// Extinctions of up to 6 over lengths of up to 2, sixty times what the other pictures' tolerance is for; single precision
/// leaves 1e-7 of each depth on the device.
const TOLERANCE: f64 = 5e-5;

/// Three cells, each in front of the next.
fn three() -> Parts {
    let first = [[0.0, 1.0, 1.0], [-1.0, 0.0, 0.0], [1.0, 2.0, 1.0], [0.0, -1.0, 1.0]].map(DVec3::from);
    // (x, y, z) to (z, x, y).
    let turn = DMat3::from_cols(DVec3::Y, DVec3::Z, DVec3::X);
    let second = first.map(|p| turn * p);
    let third = second.map(|p| turn * p);
    Parts { points: [first, second, third].concat(), cells: vec![[0, 1, 2, 3], [4, 5, 6, 7], [8, 9, 10, 11]] }
}

/// A ring of `k` cells about the z axis, each leaning on the next, turned by `degrees` from bottom to top; `closed` by a
/// point in the middle and cones from it over the ring's faces, so that the cells share them.
fn ring(k: u32, degrees: f64) -> Parts {
    let turn = degrees.to_radians();
    let angle = |i: u32| std::f64::consts::TAU * f64::from(i) / f64::from(k);
    let low = (0..k).map(|i| DVec3::new(angle(i).cos(), angle(i).sin(), 0.0));
    let high = (0..k).map(|i| DVec3::new((angle(i) + turn).cos(), (angle(i) + turn).sin(), 1.0));
    let cells = (0..k).map(|i| [i, (i + 1) % k, k + i, k + (i + 1) % k]).collect();
    Parts { points: low.chain(high).collect(), cells }
}

/// The ring of three, its inside filled by eight cones from a point in the middle: a convex body, conforming, and
/// cyclic through faces alone.
fn filled_ring() -> Parts {
    let mut parts = ring(3, 30.0);
    parts.points.push(DVec3::new(0.0, 0.0, 0.5));
    // The faces of the outer cells that look inwards, and the two ends.
    let mut cones = vec![[0, 1, 2, 6], [3, 4, 5, 6]];
    for i in 0..3u32 {
        let j = (i + 1) % 3;
        cones.push([i, j, 3 + i, 6]);
        cones.push([j, 3 + i, 3 + j, 6]);
    }
    // Of each outer cell the two faces with one vertical diagonal lie outside: those of the other diagonal are shared.
    parts.cells.extend(cones);
    parts
}

/// Renders by exact order on both back ends and judges every pixel; tells how many cells were in groups.
fn assert_exact(what: &str, parts: &Parts, camera: Camera) -> usize {
    // The scalar tells cells apart: a wrong order changes the colour.
    let mesh = mesh_of(parts, |p| p.x + 0.6 * p.y - 0.3 * p.z);
    let colors = [[-2.0, 1.0, 0.0, 0.1], [-0.4, 0.1, 1.0, 0.0], [0.4, 0.0, 0.2, 1.0], [2.0, 1.0, 1.0, 0.0]];
    let scene = scene(&mesh, transfer(&colors, &[[-2.0, 4.0], [0.0, 1.0], [2.0, 6.0]]), camera, [64, 56]);
    let truth = reference(&mesh, &scene);
    assert!(truth.iter().filter(|p| p[3] > 0.1).count() > 100, "{what}: the mesh is seen");
    for way in [Way::GpuExact, Way::CpuExact] {
        let error = largest_error(render(&mesh, &scene, way).pixels(), &truth);
        println!("{what}, {way:?}: max {error:.1e}");
        assert!(error < TOLERANCE, "{what}, {way:?}: {error:.2e}");
    }
    let method = Method { backend: Backend::Cpu, order: Order::Exact, ..Method::default() };
    let frame = renderer().render(&scene, &Model::new(&mesh), &plan_by(&mesh, &scene, method));
    let found = frame.unwrap_or_else(|e| panic!("{e}")).order.cells_in_groups;
    // The fault that is mended: by centroid, no order can be right.
    if found > 0 {
        let error = largest_error(render(&mesh, &scene, Way::CpuCentroid).pixels(), &truth);
        println!("{what}, by centroid: {error:.1e} with {found} cells in groups");
    }
    found
}

#[test]
fn three_disjoint_cells() {
    let eye = DVec3::splat(12.0);
    assert_eq!(assert_exact("three cells", &three(), perspective(eye, DVec3::splat(0.4), 16.0)), 3);
    assert_eq!(assert_exact("three cells", &three(), orthographic(eye, DVec3::splat(0.4), 2.0)), 3);
}

#[test]
fn three_disjoint_cells_by_centroid_are_wrong() {
    let mesh = mesh_of(&three(), |p| p.x - p.y);
    let colors = [[-2.0, 1.0, 0.0, 0.0], [2.0, 0.0, 0.0, 1.0]];
    let camera = perspective(DVec3::splat(12.0), DVec3::splat(0.4), 16.0);
    let scene = scene(&mesh, transfer(&colors, &[[0.0, 5.0]]), camera, [64, 56]);
    let error = largest_error(render(&mesh, &scene, Way::CpuCentroid).pixels(), &reference(&mesh, &scene));
    // The budget of a scene that says nothing.
    assert!(error > 1e-3, "no order of the cells is right: {error:.1e}");
}

#[test]
fn rings_of_any_size() {
    for k in [3, 4, 5, 8, 13, 32] {
        for z in [8.0, -8.0] {
            let along = perspective(DVec3::new(0.013, 0.007, z), DVec3::new(0.0, 0.0, 0.5), 22.0);
            assert_eq!(assert_exact(&format!("ring of {k} from {z}"), &ring(k, 60.0), along), k as usize);
        }
        let aside = perspective(DVec3::new(8.0, 1.0, 3.0), DVec3::new(0.0, 0.0, 0.5), 22.0);
        assert_eq!(assert_exact(&format!("ring of {k} from aside"), &ring(k, 60.0), aside), 0);
    }
}

#[test]
fn a_convex_conforming_mesh() {
    let along = perspective(DVec3::new(0.013, 0.007, 8.0), DVec3::new(0.0, 0.0, 0.5), 22.0);
    let found = assert_exact("filled ring", &filled_ring(), along);
    assert!(found >= 3, "{found} cells are in groups");
}
