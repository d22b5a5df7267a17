//! Extreme sizes, places, fields and pictures.

use glam::DVec3;
use tetlux_mesh::procedural::{Split, cuboid};
use tetlux_mesh::{Field, TetMesh};
use tetlux_scene::Camera;
use tetlux_tests::{
    Convex, FIELD, Way, composite, mesh_of, mesh_with, orthographic, perspective, plan, render, scene, transfer, white,
};

use crate::{TOLERANCE, assert_judged, assert_white, white_ray};

/// Cameras that see a cube of this middle and width.
fn cameras(middle: DVec3, width: f64) -> [Camera; 2] {
    let position = middle + DVec3::new(2.0, -1.25, 1.5) * width;
    [perspective(position, middle, 35.0), orthographic(position, middle, width)]
}

#[test]
fn tiny_huge_and_far_meshes_look_like_any_other() {
    // Extinctions per width; places that are exact at 1e9, where doubles are 1.2e-7 apart.
    for (width, low) in [(1e-9, 0.0), (1e9, 0.0), (1.0, 1e9), (1e-30, 0.0), (1e30, 0.0), (0.5, -1e9)] {
        let bounds = [DVec3::splat(low), DVec3::splat(low + width)];
        let field = move |p: DVec3| (p.x - low + 0.5 * (p.z - low)) / width;
        let mesh = mesh_of(&cuboid([4, 4, 4], Split::Six, bounds), field);
        for camera in cameras((bounds[0] + bounds[1]) * 0.5, width) {
            let mut scene = scene(&mesh, white(&[[0.0, 0.0], [0.5, 3.0], [0.75, 0.0], [1.5, 1.0]]), camera, [48, 40]);
            scene.unit_distance = width;
            let what = format!("{width:e} wide at {low:e}");
            let judged = assert_white(&what, &mesh, &scene, &Convex::cuboid(bounds), field, TOLERANCE);
            assert!(judged.covered > 200, "{what}");
        }
    }
}

#[test]
fn a_million_widths_away_through_a_tiny_angle() {
    let bounds = [DVec3::ZERO, DVec3::ONE];
    let field = |p: DVec3| p.x + p.y;
    let mesh = mesh_of(&cuboid([3, 3, 3], Split::Six, bounds), field);
    let direction = DVec3::new(0.5, 0.25, 1.0).normalize();
    let position = DVec3::splat(0.5) - direction * 1e6;
    let camera = perspective(position, DVec3::splat(0.5), (2e-6f64).to_degrees());
    let scene = scene(&mesh, white(&[[0.0, 0.2], [0.8, 2.0], [2.0, 0.1]]), camera, [48, 40]);
    let judged = assert_white("far", &mesh, &scene, &Convex::cuboid(bounds), field, TOLERANCE);
    assert!(judged.covered > 500, "{judged:?}");
}

#[test]
fn cell_data_are_constant_in_every_cell() {
    // Four layers across z with luminance and extinction of their own; along z centroids order them rightly.
    let parts = cuboid([3, 3, 4], Split::Six, [DVec3::ZERO, DVec3::new(3.0, 3.0, 4.0)]);
    let layer = |cell: &[u32; 4]| cell.iter().map(|&v| parts.points[v as usize].z).sum::<f64>().div_euclid(4.0);
    let mesh = mesh_with(&parts, Field::cell(FIELD, 1, parts.cells.iter().map(layer).collect()));
    let colors = [[0.0, 1.0, 0.0, 0.25], [1.0, 0.0, 1.0, 0.5], [2.0, 0.5, 0.5, 1.0], [3.0, 1.0, 1.0, 0.0]];
    let tf = transfer(&colors, &[[0.0, 0.4], [1.0, 0.7], [2.0, 0.1], [3.0, 5.0]]);
    let depths = [0.4, 0.7, 0.1, 5.0];
    let stretches: Vec<([f64; 3], f64)> = colors.iter().zip(depths).map(|(&[_, r, g, b], d)| ([r, g, b], d)).collect();
    let middle = DVec3::new(1.5, 1.5, 0.0);
    // Nearest first from below, the other way from above.
    for (sign, stretches) in [(-1.0, stretches.clone()), (1.0, stretches.iter().rev().copied().collect())] {
        let camera = orthographic(middle + DVec3::Z * (2.0 + sign * 5.0), middle + DVec3::Z * 2.0, 1.4);
        let scene = scene(&mesh, tf.clone(), camera, [23, 23]);
        let ways = [Way::GpuCentroid, Way::CpuCentroid, Way::CpuPixel];
        assert_judged("cell data", &mesh, &scene, &ways, TOLERANCE, |_, _, _| Some(composite(&stretches)));
    }
}

#[test]
fn cells_without_data_are_left_out() {
    // Missing at the top: the upper layer of four is not there.
    let bounds = [DVec3::ZERO, DVec3::ONE];
    let parts = cuboid([3, 3, 4], Split::Six, bounds);
    for missing in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let values = parts.sample(|p| if p.z == 1.0 { missing } else { p.z });
        let mesh = mesh_with(&parts, Field::point(FIELD, 1, values));
        let body = Convex::cuboid([DVec3::ZERO, DVec3::new(1.0, 1.0, 0.75)]);
        for camera in cameras(DVec3::splat(0.5), 1.0) {
            let scene = scene(&mesh, white(&[[0.0, 1.0], [0.75, 3.0]]), camera, [48, 40]);
            let plan = plan(&mesh, &scene, Way::CpuPixel);
            assert_eq!(plan.skips.no_data, 9 * 6);
            assert!(plan.warnings.iter().any(|warning| warning.contains("54 cells")));
            assert_white("missing data", &mesh, &scene, &body, |p| p.z, TOLERANCE);
        }
    }
}

#[test]
fn a_constant_field_has_no_range_to_divide_by() {
    let bounds = [DVec3::ZERO, DVec3::ONE];
    for value in [0.0, 7.25, -1e12, 1e-300] {
        let mesh = mesh_of(&cuboid([2, 2, 2], Split::Five, bounds), |_| value);
        let tf = white(&[[value - 1.0, 0.0], [value + 1.0, 4.0]]);
        for camera in cameras(DVec3::splat(0.5), 1.0) {
            let scene = scene(&mesh, tf.clone(), camera, [24, 20]);
            assert_white(&format!("constant {value}"), &mesh, &scene, &Convex::cuboid(bounds), |_| value, TOLERANCE);
        }
    }
}

#[test]
fn an_orthographic_eye_in_the_middle_sees_half() {
    let bounds = [DVec3::ZERO, DVec3::splat(2.0)];
    let mesh = mesh_of(&cuboid([3, 3, 3], Split::Six, bounds), |_| 0.0);
    let camera = orthographic(DVec3::ONE, DVec3::new(1.0, 1.0, 5.0), 0.9);
    let scene = scene(&mesh, white(&[[0.0, 1.0]]), camera, [9, 9]);
    // One of the two units of length lies in front.
    let truth = |_, _, _| Some([-(-1.0f64).exp_m1(); 4]);
    assert_judged("half", &mesh, &scene, &Way::ALL, TOLERANCE, truth);
}

#[test]
fn fields_of_any_range() {
    // Up to where differences overflow, and down to where their reciprocals do.
    let bounds = [DVec3::ZERO, DVec3::ONE];
    let opacity = [[0.3, 0.0], [0.45, 3.0], [0.5, 0.5], [0.7, 2.0]];
    for [low, high] in [[0.0, 1e-30], [-1e30, 1e30], [1.0, 1.0 + 1e-12], [0.0, 1e-310], [-1.7e308, 1.7e308]] {
        let place = |u: f64| low * (1.0 - u) + high * u;
        let field = |p: DVec3| 0.5 * p.x + 0.5 * p.z;
        let mesh = mesh_of(&cuboid([4, 3, 4], Split::Six, bounds), |p| place(field(p)));
        let nodes = opacity.map(|[u, opacity]| [place(u), opacity]);
        for camera in cameras(DVec3::splat(0.5), 1.0) {
            let scene = scene(&mesh, white(&nodes), camera, [32, 28]);
            let truth = |o, d, start| white_ray(&Convex::cuboid(bounds), field, &opacity, 1.0, (o, d, start));
            // Of 1 + 1e-12 double precision itself leaves four digits.
            let tolerance = if low == 1.0 { 1e-3 } else { TOLERANCE };
            assert_judged(&format!("{low:e} to {high:e}"), &mesh, &scene, &Way::ALL, tolerance, truth);
        }
    }
}

/// A mesh of which nothing should be seen, whatever the way.
fn assert_empty(what: &str, mesh: &TetMesh, opacity: &[[f64; 2]], camera: Camera) {
    let scene = scene(mesh, white(opacity), camera, [17, 13]);
    for way in Way::ALL {
        let image = render(mesh, &scene, way);
        assert_eq!((image.width(), image.height()), (17, 13));
        assert!(image.pixels().iter().all(|&p| p == [0.0; 4]), "{what}, {way:?}");
    }
}

#[test]
fn empty_pictures_are_empty() {
    let bounds = [DVec3::ZERO, DVec3::ONE];
    let mesh = mesh_of(&cuboid([2, 2, 2], Split::Six, bounds), |p| p.x);
    let outside = [[1.5, 0.0], [2.0, 1.0]];
    for camera in cameras(DVec3::splat(0.5), 1.0) {
        assert_empty("nothing opaque", &mesh, &[[0.0, 0.0]], camera);
        assert_empty("nothing opaque in the field's range", &mesh, &outside, camera);
        let away = Camera { focal_point: camera.position * 2.0 - camera.focal_point, ..camera };
        assert_empty("behind the eye", &mesh, &[[0.0, 1.0]], away);
        let near = Camera { near: 100.0, ..camera };
        assert_empty("before the near plane", &mesh, &[[0.0, 1.0]], near);
        let aside = Camera {
            focal_point: camera.focal_point + DVec3::X * 50.0,
            position: camera.position + DVec3::X * 50.0,
            ..camera
        };
        assert_empty("outside the frustum", &mesh, &[[0.0, 1.0]], aside);
    }
}

#[test]
fn pictures_of_any_shape() {
    let bounds = [DVec3::ZERO, DVec3::ONE];
    let field = |p: DVec3| p.y;
    let mesh = mesh_of(&cuboid([3, 2, 4], Split::Five, bounds), field);
    for size in [[1, 1], [333, 7], [7, 333], [1, 65], [257, 1], [64, 64]] {
        for camera in cameras(DVec3::splat(0.5), 1.0) {
            let scene = scene(&mesh, white(&[[0.0, 0.5], [1.0, 2.0]]), camera, size);
            let what = format!("{} x {}", size[0], size[1]);
            assert_white(&what, &mesh, &scene, &Convex::cuboid(bounds), field, TOLERANCE);
        }
    }
}
