//! What lies close to the eye, against the size of the mesh or the length of its cells.

use glam::DVec3;
use tetlux_mesh::procedural::{Parts, Split, cuboid};
use tetlux_tests::{Convex, mesh_of, perspective, scene, white};

use crate::{TOLERANCE, assert_white};

#[test]
fn wide_views_are_not_cut_by_the_depth_that_is_not_asked_for() {
    // A thousandth of the mesh aside at a millionth of it ahead was behind a near plane that no one had asked for.
    let bounds = [DVec3::ZERO, DVec3::splat(3.0)];
    let field = |p: DVec3| p.x + 0.5 * p.y + 1.5 * p.z;
    let mesh = mesh_of(&cuboid([3; 3], Split::Six, bounds), field);
    let eye = DVec3::new(1.3, 1.55, 1.21);
    // Of 179.99 degrees a ray goes 10 000 times as far aside as ahead: scalars lost four digits of their seven.
    for view_angle in [150.0, 179.0, 179.9, 179.99] {
        for direction in [DVec3::new(0.9, 0.3, -0.2), DVec3::NEG_Y, DVec3::new(1.0, 1.0, 1.0)] {
            let camera = perspective(eye, eye + direction, view_angle);
            let scene = scene(&mesh, white(&[[0.0, 0.1], [2.0, 0.5], [3.0, 0.2], [9.0, 1.0]]), camera, [25, 22]);
            let what = format!("{view_angle} degrees along {direction}");
            assert_white(&what, &mesh, &scene, &Convex::cuboid(bounds), field, TOLERANCE);
        }
    }
}

#[test]
fn an_eye_in_a_body_that_is_a_millionth_of_the_mesh_sees_all_of_it() {
    // Two cells far away on both sides, so that the body stays in the middle, where positions have all their digits.
    let bounds = [DVec3::splat(-0.5), DVec3::splat(0.5)];
    let mut parts = cuboid([2; 3], Split::Six, bounds);
    for side in [-1.0, 1.0] {
        let base = DVec3::new(0.0, 0.0, side * 5e5);
        parts.append(&Parts {
            points: vec![base, base + DVec3::X, base + DVec3::Y, base - DVec3::Z * side],
            cells: vec![[0, 1, 2, 3]],
        });
    }
    // What is far away is transparent.
    let field = |p: DVec3| if p.z.abs() < 1.0 { p.x + p.y } else { -10.0 };
    let mesh = mesh_of(&parts, field);
    let opacity = [[-9.0, 0.0], [-1.0, 0.4], [1.0, 2.0]];
    for eye in [DVec3::new(0.1, 0.07, -0.13), DVec3::ZERO, DVec3::new(-0.5, 0.1, 0.2)] {
        let scene = scene(&mesh, white(&opacity), perspective(eye, eye + DVec3::new(1.0, 0.3, 0.1), 70.0), [24, 20]);
        assert_white("far cells", &mesh, &scene, &Convex::cuboid(bounds), |p| p.x + p.y, TOLERANCE);
    }
}

#[test]
fn cells_a_million_times_as_long_as_the_eye_is_far_are_not_edge_on() {
    // Their faces pass the eye at less than a millionth of their length, which was taken for no distance at all.
    let thick = 1.0 / f64::from(1 << 20);
    let bounds = [DVec3::new(-1.0, -thick, -thick), DVec3::new(1.0, thick, thick)];
    let field = |p: DVec3| p.z / thick;
    let mesh = mesh_of(&cuboid([1, 3, 3], Split::Six, bounds), field);
    for (eye, toward) in [
        (DVec3::new(0.25, -5.0 * thick, 2.0 * thick), DVec3::new(0.25, 0.0, 0.0)),
        (DVec3::new(-0.125, 0.3 * thick, -4.0 * thick), DVec3::new(-0.125, 0.0, 0.0)),
    ] {
        let mut scene =
            scene(&mesh, white(&[[-1.0, 0.2], [0.0, 1.0], [1.0, 0.1]]), perspective(eye, toward, 50.0), [24, 20]);
        scene.unit_distance = thick;
        let judged = assert_white("long cells", &mesh, &scene, &Convex::cuboid(bounds), field, TOLERANCE);
        assert!(judged.covered > 100, "{judged:?}");
    }
}
