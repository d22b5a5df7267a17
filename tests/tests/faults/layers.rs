//! Thin, flat and far cells.

use glam::DVec3;
use tetlux_mesh::procedural::{Parts, Split, cuboid};
use tetlux_scene::Camera;
use tetlux_tests::{Convex, Way, mesh_of, orthographic, perspective, plan, scene, white};

use crate::{TOLERANCE, assert_white};

/// From above, aslant and nearly along the layers.
fn cameras(center: DVec3, width: f64) -> Vec<(&'static str, Camera)> {
    let mut cameras = Vec::new();
    for direction in [DVec3::new(0.1, 0.07, 1.0), DVec3::new(0.8, 0.3, 0.5), DVec3::new(1.0, 0.3, 0.1)] {
        let position = center + direction.normalize() * (3.0 * width);
        cameras.push(("perspective", perspective(position, center, 30.0)));
        cameras.push(("orthographic", orthographic(position, center, 0.8 * width)));
    }
    cameras
}

#[test]
fn fifty_thin_layers_keep_their_thickness() {
    // 50 layers of 1/3200 each, 0.03 % of the longest edge; extinction 64 over 1/64: depth 1 from above, and where a
    // table of optical depths would round every layer to nothing, 1 - exp(-1) = 161/255.
    let bounds = [DVec3::ZERO, DVec3::new(1.0, 1.0, 1.0 / 64.0)];
    let mesh = mesh_of(&cuboid([1, 1, 50], Split::Six, bounds), |_| 0.5);
    // Single precision knows the direction of a plane to 1e-7. Seen at an angle a, the depth at which a ray meets it is
    // then off by up to 1e-7 / a^2 of the mesh: at 1/8 6e-6, of which extinction 64 makes 64 times as much at worst.
    let dense = 1e-4;
    for (what, camera) in cameras(DVec3::new(0.5, 0.5, 1.0 / 128.0), 1.0) {
        let scene = scene(&mesh, white(&[[0.0, 64.0]]), camera, [48, 40]);
        let judged = assert_white(what, &mesh, &scene, &Convex::cuboid(bounds), |_| 0.5, dense);
        assert!(judged.covered > 50, "the layers are seen: {} pixels", judged.covered);
    }
}

#[test]
fn one_long_cell_far_away_leaves_the_rest_as_it_is() {
    let bounds = [DVec3::ZERO, DVec3::ONE];
    // Positions are single precision about the middle of the mesh: 3000 times as wide, they are good to 1e-4 of the box.
    for (longer, tolerance) in [(45.0, TOLERANCE), (155.0, TOLERANCE), (3000.0, 1e-4)] {
        let mut parts = cuboid([4, 4, 4], Split::Six, bounds);
        // The longest edge of the box's cells is sqrt(3)/4. The far cell lies behind the eye's back.
        let length = longer * 0.75f64.sqrt() / 2.0;
        let base = DVec3::new(20.0, 20.0, 20.0);
        parts.append(&Parts {
            points: vec![base, base + DVec3::X * length, base + DVec3::Y * 0.5, base + DVec3::Z * 0.5],
            cells: vec![[0, 1, 2, 3]],
        });
        // Off the body's own range, so that the field's range is stretched as well.
        let field = |p: DVec3| if p.x < 2.0 { p.x + p.y } else { 40.0 };
        let mesh = mesh_of(&parts, field);
        for camera in [
            perspective(DVec3::new(3.0, 2.0, 2.5), DVec3::splat(0.5), 30.0),
            orthographic(DVec3::new(3.0, 2.0, 2.5), DVec3::splat(0.5), 1.0),
        ] {
            let scene = scene(&mesh, white(&[[0.0, 0.2], [2.0, 3.0]]), camera, [48, 40]);
            let what = format!("{longer} times longer");
            assert_white(&what, &mesh, &scene, &Convex::cuboid(bounds), |p| p.x + p.y, tolerance);
        }
    }
}

#[test]
fn flat_cells_are_reported_and_change_nothing() {
    let bounds = [DVec3::ZERO, DVec3::ONE];
    for split in [Split::Five, Split::Six] {
        let mut parts = cuboid([3, 3, 3], split, bounds);
        let at = |i: u32, j: u32, k: u32| (k * 4 + j) * 4 + i;
        let whole = mesh_of(&parts, |p| p.z);
        let triangles = whole.cells().len();
        // On the surface, inside, and with three vertices on a line.
        let flat = [
            [at(0, 0, 3), at(1, 0, 3), at(0, 1, 3), at(1, 1, 3)],
            [at(1, 1, 1), at(2, 1, 1), at(2, 2, 1), at(1, 2, 1)],
            [at(1, 1, 1), at(2, 1, 1), at(3, 1, 1), at(1, 2, 1)],
            [at(0, 1, 2), at(0, 2, 2), at(0, 2, 1), at(0, 1, 1)],
        ];
        parts.cells.extend(flat);
        let mesh = mesh_of(&parts, |p| p.z);
        assert_eq!((mesh.cells().len(), mesh.assembly().cells_flat), (triangles + flat.len(), flat.len()));
        assert!(mesh.validate().faults().iter().any(|fault| fault.contains("4 cells have zero volume")));
        for (what, camera) in cameras(DVec3::splat(0.5), 1.0) {
            let scene = scene(&mesh, white(&[[0.0, 1.0], [1.0, 2.0]]), camera, [48, 40]);
            for way in Way::ALL {
                assert_eq!(plan(&mesh, &scene, way).skips.flat, flat.len(), "{what}");
            }
            assert_white(what, &mesh, &scene, &Convex::cuboid(bounds), |p| p.z, TOLERANCE);
        }
    }
}

#[test]
fn cells_that_are_almost_flat_keep_neighbours_apart() {
    // Layers between planes a millionth apart, alternating with thick ones: the sum of all thicknesses must be that
    // of the box.
    let mut parts = cuboid([2, 2, 6], Split::Six, [DVec3::ZERO, DVec3::ONE]);
    let heights = [0.0, 0.25, 0.25 + 1e-6, 0.5, 0.5 + 1e-6, 0.75, 1.0];
    for (i, p) in parts.points.iter_mut().enumerate() {
        p.z = heights[i / 9];
    }
    let mesh = mesh_of(&parts, |p| p.z);
    for (what, camera) in cameras(DVec3::splat(0.5), 1.0) {
        let scene = scene(&mesh, white(&[[0.0, 1.0], [1.0, 2.0]]), camera, [48, 40]);
        let body = Convex::cuboid([DVec3::ZERO, DVec3::ONE]);
        assert_white(what, &mesh, &scene, &body, |p| p.z, TOLERANCE);
    }
}
