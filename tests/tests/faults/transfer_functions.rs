//! Opacities and control points that tables and eight bits lose.

use glam::DVec3;
use tetlux_mesh::procedural::{Parts, Split, cuboid};
use tetlux_scene::Camera;
use tetlux_tests::{Convex, Way, depth_of, mesh_of, orthographic, perspective, render, scene, transfer, white};

use crate::{TOLERANCE, assert_judged, assert_white};

const UNIT_BOX: [DVec3; 2] = [DVec3::ZERO, DVec3::ONE];

/// Straight on and aslant, both projections.
fn cameras() -> [Camera; 4] {
    let center = DVec3::splat(0.5);
    let (straight, aslant) = (DVec3::new(0.5, 0.5, -2.5), DVec3::new(2.6, -1.1, 1.9));
    [
        perspective(straight, center, 30.0),
        orthographic(straight, center, 0.7),
        perspective(aslant, center, 35.0),
        orthographic(aslant, center, 1.0),
    ]
}

/// Renders a constant white unit box of an opacity and a unit distance every way and asserts every pixel.
fn constant_box(opacity: f64, unit_distance: f64) {
    let mesh = mesh_of(&cuboid([2, 2, 2], Split::Six, UNIT_BOX), |_| 1.0);
    for camera in cameras() {
        let mut scene = scene(&mesh, white(&[[0.0, opacity]]), camera, [31, 31]);
        scene.unit_distance = unit_distance;
        let what = format!("opacity {opacity} per {unit_distance}");
        // Lengths are good to 1e-7 of the box.
        let tolerance = TOLERANCE.max(1e-7 * (opacity / unit_distance).min(1e3));
        assert_white(&what, &mesh, &scene, &Convex::cuboid(UNIT_BOX), |_| 1.0, tolerance);
    }
}

#[test]
fn opacity_is_not_clamped_to_one() {
    // Extinction 3 over length 1: 1 - exp(-3) = 242/255; clamped to 1 it would be 161/255.
    constant_box(3.0, 1.0);
    constant_box(1000.0, 1.0);
    // Of the largest opacity nothing overflows: opaque.
    constant_box(1e300, 1.0);
}

#[test]
fn opacity_is_not_cut_to_eight_bits() {
    // 0.003 is less than 1/255; per 0.01 it is an extinction of 0.3: 1 - exp(-0.3) = 66/255.
    constant_box(0.003, 0.01);
    // And where only a series keeps the digits, seen as relative error.
    constant_box(3e-9, 1e-8);
}

#[test]
fn faint_alpha_is_relatively_right() {
    let mesh = mesh_of(&cuboid([2, 2, 2], Split::Six, UNIT_BOX), |_| 1.0);
    let camera = orthographic(DVec3::new(0.5, 0.5, -2.5), DVec3::splat(0.5), 0.4);
    for opacity in [1e-6, 1e-12, 1e-20] {
        let scene = scene(&mesh, white(&[[0.0, opacity]]), camera, [9, 9]);
        for way in Way::ALL {
            for pixel in render(&mesh, &scene, way).pixels() {
                // Depth is opacity times 1, alpha as much.
                assert!((f64::from(pixel[3]) / opacity - 1.0).abs() < TOLERANCE, "{way:?}: {pixel:?} of {opacity}");
            }
        }
    }
}

/// A tetrahedron with scalar 0 at three vertices and 1 at the fourth: the scalar is the barycentric coordinate z.
fn single_cell() -> ([DVec3; 4], Parts) {
    let points = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
    (points, Parts { points: points.to_vec(), cells: vec![[0, 1, 2, 3]] })
}

#[test]
fn a_peak_inside_one_cell_is_seen() {
    // Zero at every vertex of the only cell; between 0.45 and 0.55 a triangle of height 20, hence of area 1.
    let (points, parts) = single_cell();
    let mesh = mesh_of(&parts, |p| p.z);
    let opacity = [[0.0, 0.0], [0.45, 0.0], [0.5, 20.0], [0.55, 0.0], [1.0, 0.0]];
    for camera in cameras() {
        let scene = scene(&mesh, white(&opacity), camera, [48, 40]);
        let judged = assert_white("peak", &mesh, &scene, &Convex::tetrahedron(points), |p| p.z, TOLERANCE);
        assert!(judged.covered > 20, "{} pixels", judged.covered);
    }
    // By hand: the ray down the z axis at (1/8, 1/8) crosses the whole peak; it runs over scalars 0 to 3/4 in 3/4 of
    // length, so the depth is the peak's area of 1.
    let camera = orthographic(DVec3::new(0.125, 0.125, -2.0), DVec3::new(0.125, 0.125, 0.0), 0.01);
    let scene = scene(&mesh, white(&opacity), camera, [1, 1]);
    for way in Way::ALL {
        let alpha = render(&mesh, &scene, way).pixels()[0][3];
        assert!((f64::from(alpha) + (-1.0f64).exp_m1()).abs() < TOLERANCE, "{way:?}: {alpha}");
    }
}

#[test]
fn a_peak_narrower_than_any_table_is_seen() {
    // A ten-thousandth of the range wide, of area 1; and narrower than single precision tells one scalar from the next.
    let mesh = mesh_of(&cuboid([3, 3, 3], Split::Five, UNIT_BOX), |p| p.z);
    // Where a ray cuts the corner of a cell its scalars differ by a thousandth, which is known to 6e-8 and divided by.
    let narrow = 2e-4;
    for (at, half) in [(0.4321, 0.5e-4), (0.4321, 1e-6), (0.7654, 1e-8), (0.123, 1e-10)] {
        let opacity = [[at - half, 0.0], [at, 1.0 / half], [at + half, 0.0]];
        for camera in cameras() {
            let scene = scene(&mesh, white(&opacity), camera, [31, 31]);
            let what = format!("peak of half width {half:e}");
            assert_white(&what, &mesh, &scene, &Convex::cuboid(UNIT_BOX), |p| p.z, narrow);
        }
    }
}

#[test]
fn a_function_wider_than_the_data_is_not_moved() {
    // Pieces that begin and end far outside the data: from 8 of its ranges below them to 11 above, and a million.
    for wide in [1.0, 1e6] {
        let mesh = mesh_of(&cuboid([3, 3, 3], Split::Six, UNIT_BOX), |p| 40.0 + 5.0 * p.z);
        let opacity = [[42.0 - 42.0 * wide, 0.0], [42.0, 2.0], [42.0 + 60.0 * wide, 7.0]];
        let falling = [[42.0 - 42.0 * wide, 1.0], [42.0 + 60.0 * wide, 0.25]];
        for opacity in [&opacity[..], &falling[..]] {
            for camera in cameras() {
                let scene = scene(&mesh, white(opacity), camera, [31, 31]);
                let field = |p: DVec3| 40.0 + 5.0 * p.z;
                assert_white("wide function", &mesh, &scene, &Convex::cuboid(UNIT_BOX), field, TOLERANCE);
            }
        }
    }
}

#[test]
fn color_and_opacity_nodes_are_separate() {
    // Opacity nodes that are no colour nodes.
    let mesh = mesh_of(&cuboid([2, 3, 2], Split::Six, UNIT_BOX), |p| p.z);
    let opacity = [[0.4, 0.0], [0.5, 12.0], [0.6, 0.0]];
    for camera in cameras() {
        let tf = transfer(&[[0.0, 1.0, 1.0, 1.0], [1.0, 1.0, 1.0, 1.0]], &opacity);
        let scene = scene(&mesh, tf, camera, [31, 31]);
        assert_white("opacity nodes alone", &mesh, &scene, &Convex::cuboid(UNIT_BOX), |p| p.z, TOLERANCE);
    }
    // A colour step that is no opacity node: red below z = 1/3, green above; constant extinction 2.
    let tf = transfer(&[[1.0 / 3.0, 1.0, 0.0, 0.0], [1.0 / 3.0, 0.0, 1.0, 0.0]], &[[0.0, 2.0]]);
    // Along z, where centroids order the cells rightly too, from below: 2/3 of red before 4/3 of green.
    let camera = orthographic(DVec3::new(0.5, 0.5, -2.0), DVec3::splat(0.5), 0.4);
    let scene = scene(&mesh, tf, camera, [9, 9]);
    let truth = |_, _, _| {
        let (red, all) = (-(-2.0f64 / 3.0).exp_m1(), -(-2.0f64).exp_m1());
        Some([red, all - red, 0.0, all])
    };
    assert_judged("colour step", &mesh, &scene, &[Way::CpuPixel], TOLERANCE, truth);
}

#[test]
fn linear_luminance_in_constant_extinction() {
    // One cell, luminance (z, 1 - z, 1), extinction tau. A stretch of depth x from luminance a to b gives
    //   int_0^1 (a + (b - a) t) x exp(-x t) dt = a (1 - psi) + b (psi - exp(-x)),  psi = (1 - exp(-x)) / x.
    let (points, parts) = single_cell();
    let mesh = mesh_of(&parts, |p| p.z);
    let body = Convex::tetrahedron(points);
    for tau in [0.01, 1.0, 30.0, 1e5] {
        let tf = transfer(&[[0.0, 0.0, 1.0, 1.0], [1.0, 1.0, 0.0, 1.0]], &[[0.0, tau]]);
        let truth = |origin: DVec3, direction: DVec3, start: f64| {
            let [enter, leave] = body.chord(origin, direction, start)?;
            let x = tau * (leave - enter) * direction.length();
            let [front, back] = [enter, leave].map(|t| (origin + direction * t).z);
            let (alpha, zeta) = (-(-x).exp_m1(), (-x).exp());
            let psi = alpha / x;
            let color = |a: f64, b: f64| a * (1.0 - psi) + b * (psi - zeta);
            Some([color(front, back), color(1.0 - front, 1.0 - back), alpha, alpha])
        };
        for camera in cameras() {
            let scene = scene(&mesh, tf.clone(), camera, [48, 40]);
            assert_judged(&format!("extinction {tau}"), &mesh, &scene, &Way::ALL, TOLERANCE, truth);
        }
    }
}

#[test]
fn steps_are_cut_where_they_are() {
    // Nothing, 5, 1, nothing: three steps, one of them at a vertex layer's own scalar.
    let mesh = mesh_of(&cuboid([4, 4, 4], Split::Six, UNIT_BOX), |p| p.x + p.y + p.z);
    let opacity = [[0.7, 0.0], [0.7, 5.0], [1.5, 5.0], [1.5, 1.0], [2.2, 1.0], [2.2, 0.0]];
    // Seen along the layers a step's place decides on whole cells: only these two see them across.
    for camera in [cameras()[2], cameras()[3]] {
        let scene = scene(&mesh, white(&opacity), camera, [48, 40]);
        let field = |p: DVec3| p.x + p.y + p.z;
        assert_white("steps", &mesh, &scene, &Convex::cuboid(UNIT_BOX), field, TOLERANCE);
    }
    // The step function as its definition has it: 5 over [0.7, 1.5), 1 over [1.5, 2.2).
    assert!((depth_of(&opacity, [0.0, 3.0], 3.0, 1.0) - (4.0 + 0.7)).abs() < 1e-12);
}
