//! Cells that occlude one another in a cycle: no order of cells is right, and every pixel is.

use glam::DVec3;
use tetlux_mesh::procedural::{Parts, filled_ring, ring, three_cycle};
use tetlux_render::Model;
use tetlux_scene::Camera;
use tetlux_tests::{
    Random, Way, largest_error, mesh_of, orthographic, perspective, plan, reference, render, renderer, scene, transfer,
};

/// Extinctions of up to 6 over lengths of up to 2, sixty times what the other pictures' tolerance is for; single precision
/// leaves 1e-7 of each depth on the device.
const TOLERANCE: f64 = 5e-5;

/// Renders by exact order on both back ends and judges every pixel; tells how many cells were in groups.
fn assert_exact(what: &str, parts: &Parts, camera: Camera) -> usize {
    // The scalar tells cells apart: a wrong order changes the colour.
    let mesh = mesh_of(parts, |p| p.x + 0.6 * p.y - 0.3 * p.z);
    let colors = [[-2.0, 1.0, 0.0, 0.1], [-0.4, 0.1, 1.0, 0.0], [0.4, 0.0, 0.2, 1.0], [2.0, 1.0, 1.0, 0.0]];
    let scene = scene(&mesh, transfer(&colors, &[[-2.0, 4.0], [0.0, 1.0], [2.0, 6.0]]), camera, [64, 56]);
    let truth = reference(&mesh, &scene);
    assert!(truth.iter().filter(|p| p[3] > 0.1).count() > 100, "{what}: the mesh is seen");
    for way in [Way::GpuExact, Way::GpuTiles, Way::CpuExact] {
        let error = largest_error(render(&mesh, &scene, way).pixels(), &truth);
        println!("{what}, {way:?}: max {error:.1e}");
        assert!(error < TOLERANCE, "{what}, {way:?}: {error:.2e}");
    }
    let frame = renderer().render(&scene, &Model::new(&mesh), &plan(&mesh, &scene, Way::CpuExact));
    frame.unwrap_or_else(|e| panic!("{e}")).order.cells_in_groups
}

#[test]
fn three_disjoint_cells() {
    let eye = DVec3::splat(12.0);
    assert_eq!(assert_exact("three cells", &three_cycle(), perspective(eye, DVec3::splat(0.4), 16.0)), 3);
    assert_eq!(assert_exact("three cells", &three_cycle(), orthographic(eye, DVec3::splat(0.4), 2.0)), 3);
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
    assert_eq!(assert_exact("filled ring", &filled_ring(), along), 9);
}

#[test]
fn a_tangle_is_drawn_with_a_warning() {
    // Cells through one another have no order: each back end ends, says so, and makes no value that is none.
    let mut random = Random::new(5);
    let mut parts = Parts::default();
    for cell in 0..60 {
        let center: [f64; 3] = std::array::from_fn(|_| random.between(-1.0, 1.0));
        for _ in 0..4 {
            let offset: [f64; 3] = std::array::from_fn(|_| random.between(-0.6, 0.6));
            parts.points.push(DVec3::from(center) + DVec3::from(offset));
        }
        parts.cells.push([0, 1, 2, 3].map(|i| 4 * cell + i));
    }
    let mesh = mesh_of(&parts, |p| p.x);
    let camera = perspective(DVec3::new(5.0, 3.0, 4.0), DVec3::ZERO, 40.0);
    let scene = scene(&mesh, transfer(&[[-2.0, 1.0, 0.0, 0.0], [2.0, 0.0, 0.0, 1.0]], &[[0.0, 1.0]]), camera, [48, 40]);
    let truth = reference(&mesh, &scene);
    for way in [Way::GpuExact, Way::GpuTiles, Way::CpuExact] {
        let frame = renderer().render(&scene, &Model::new(&mesh), &plan(&mesh, &scene, way));
        let frame = frame.unwrap_or_else(|e| panic!("{way:?}: {e}"));
        assert!(frame.order.overlap_pixels > 0 && frame.order.cells_in_groups > 1, "{:?}", frame.order);
        assert!(frame.warnings.iter().any(|w| w.contains("overlap")), "{:?}", frame.warnings);
        // Where cells overlap the reference adds extinctions; alpha does not depend on who comes first.
        let pixels = frame.image.pixels().iter().zip(&truth);
        let alpha = pixels.map(|(p, t)| (f64::from(p[3]) - t[3]).abs()).fold(0.0, f64::max);
        println!("tangle, {way:?}: alpha {alpha:.1e}");
        assert!(alpha < TOLERANCE, "{way:?}: {alpha:.2e}");
    }
}
