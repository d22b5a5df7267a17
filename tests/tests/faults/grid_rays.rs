//! Rays exactly through vertices, along edges, in faces and diagonals: none is lost, none counted twice.

use glam::DVec3;
use tetlux_mesh::TetMesh;
use tetlux_mesh::procedural::{Split, cuboid};
use tetlux_scene::Camera;
use tetlux_tests::{Convex, mesh_of, orthographic, perspective, scene, white};

use crate::{TOLERANCE, assert_white};

/// A box of unit hexahedra; all coordinates are exact in single precision.
const BOUNDS: [DVec3; 2] = [DVec3::ZERO, DVec3::splat(4.0)];
const MIDDLE: DVec3 = DVec3::splat(2.0);

const AXES: [DVec3; 6] = [DVec3::X, DVec3::NEG_X, DVec3::Y, DVec3::NEG_Y, DVec3::Z, DVec3::NEG_Z];

fn field(p: DVec3) -> f64 {
    p.x + 2.0 * p.y + 4.0 * p.z
}

/// A constant and a ramp that passes vertices at its nodes.
const OPACITIES: [&[[f64; 2]]; 2] = [&[[0.0, 0.3]], &[[0.0, 0.0], [8.0, 0.5], [12.0, 0.125], [28.0, 1.0]]];

/// Asserts every pixel, and that exactly `on_a_jump` have rays in the box's surface.
fn assert_grid(what: &str, mesh: &TetMesh, camera: Camera, size: [u32; 2], on_a_jump: usize) {
    for opacity in OPACITIES {
        let scene = scene(mesh, white(opacity), camera, size);
        let judged = assert_white(what, mesh, &scene, &Convex::cuboid(BOUNDS), field, TOLERANCE);
        assert_eq!(judged.on_a_jump, on_a_jump, "{what}");
        assert!(judged.covered > 200, "{what}: {} pixels", judged.covered);
    }
}

#[test]
fn orthographic_along_every_axis() {
    for split in [Split::Five, Split::Six] {
        let mesh = mesh_of(&cuboid([4, 4, 4], split, BOUNDS), field);
        for axis in AXES {
            // Pixels of 1/4: centres at 2 + k/4, |k| <= 10: on vertices, edges, diagonals, and in faces. Those with
            // |k| = 8 in one and at most 8 in the other run in the surface: 17^2 - 15^2 = 64.
            let camera = orthographic(MIDDLE - axis * 8.0, MIDDLE, 21.0 / 8.0);
            assert_grid(&format!("{split:?} along {axis}"), &mesh, camera, [21, 21], 64);
        }
    }
}

#[test]
fn orthographic_along_face_and_space_diagonals() {
    for split in [Split::Five, Split::Six] {
        let mesh = mesh_of(&cuboid([4, 4, 4], split, BOUNDS), field);
        for direction in [
            DVec3::new(1.0, 1.0, 0.0),
            DVec3::new(1.0, -1.0, 0.0),
            DVec3::new(0.0, 1.0, 1.0),
            DVec3::new(-1.0, 0.0, 1.0),
        ] {
            // The direction itself is not exact in binary, so rays come within roundings of edges and faces, from
            // either side. Rows are 1/4 apart, with the middle one in a plane of the grid; two rows run in the
            // surface. Across, pixels are no multiple of sqrt(2): the sides fall between them.
            let camera = orthographic(MIDDLE - direction * 6.0, MIDDLE, 21.0 / 8.0);
            for opacity in OPACITIES {
                let scene = scene(&mesh, white(opacity), camera, [31, 21]);
                let what = format!("{split:?} along {direction}");
                assert_white(&what, &mesh, &scene, &Convex::cuboid(BOUNDS), field, TOLERANCE);
            }
        }
        for direction in [DVec3::ONE, DVec3::new(-1.0, 1.0, 1.0), DVec3::new(1.0, -1.0, 1.0)] {
            // Along the diagonal round which six tetrahedra lie: the middle pixel's ray runs in an edge of each.
            let camera = orthographic(MIDDLE - direction * 6.0, MIDDLE, 4.0);
            assert_grid(&format!("{split:?} along {direction}"), &mesh, camera, [33, 33], 0);
        }
    }
}

#[test]
fn perspective_through_vertices_and_edges() {
    for split in [Split::Five, Split::Six] {
        let mesh = mesh_of(&cuboid([4, 4, 4], split, BOUNDS), field);
        for axis in AXES {
            // The eye is 4 before the face, pixels are 1/8 at depth 1: rays of slope k/8 meet the near face at 2 + k/2,
            // on vertices and edges, and the planes behind it in edges and vertices time and again; those of the
            // middle row and column run in planes of the grid. Nothing jumps: the sides recede from the eye.
            // 2 tan(half the angle) / 21 is 1/8 to a rounding.
            let camera = perspective(MIDDLE - axis * 6.0, MIDDLE, 2.0 * (21.0f64 / 16.0).atan().to_degrees());
            assert_perspective(&format!("{split:?} along {axis}"), &mesh, camera, [21, 21]);
        }
        // From a vertex's extension along an edge of the surface: rays leave in faces of the box.
        let corner = perspective(DVec3::new(0.0, 0.0, -4.0), DVec3::new(0.0, 0.0, 4.0), 90.0);
        let scene = scene(&mesh, white(OPACITIES[1]), corner, [21, 21]);
        assert_white("from a corner", &mesh, &scene, &Convex::cuboid(BOUNDS), field, TOLERANCE);
    }
}

fn assert_perspective(what: &str, mesh: &TetMesh, camera: Camera, size: [u32; 2]) {
    for opacity in OPACITIES {
        let scene = scene(mesh, white(opacity), camera, size);
        let judged = assert_white(what, mesh, &scene, &Convex::cuboid(BOUNDS), field, TOLERANCE);
        assert_eq!(judged.on_a_jump, 0, "{what}");
        assert!(judged.covered >= 49, "{what}: {} pixels", judged.covered);
    }
}
