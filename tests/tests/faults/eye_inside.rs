//! The eye in the mesh and cells that cross the near plane: what lies in front of it is seen, and nothing else.

use glam::DVec3;
use tetlux_mesh::TetMesh;
use tetlux_mesh::procedural::{Split, cuboid};
use tetlux_scene::Camera;
use tetlux_tests::{Convex, Random, mesh_of, orthographic, perspective, scene, white};

use crate::{TOLERANCE, assert_white};

const BOUNDS: [DVec3; 2] = [DVec3::ZERO, DVec3::splat(3.0)];

const OPACITY: [[f64; 2]; 4] = [[0.0, 0.1], [2.0, 0.5], [3.0, 0.2], [9.0, 1.0]];

fn field(p: DVec3) -> f64 {
    p.x + 0.5 * p.y + 1.5 * p.z
}

/// Jittered inside, so that no plane of the grid is left but the sides; still a box with a linear scalar.
fn jittered() -> TetMesh {
    let mut random = Random::new(3);
    let mut parts = cuboid([3, 3, 3], Split::Six, BOUNDS);
    for p in &mut parts.points {
        let inside = p.cmpgt(DVec3::splat(0.5)) & p.cmplt(DVec3::splat(2.5));
        let by = DVec3::new(random.between(-0.2, 0.2), random.between(-0.2, 0.2), random.between(-0.2, 0.2));
        *p += DVec3::select(inside, by, DVec3::ZERO);
        // To places that single precision has, or the scalar would not be linear in the rounded ones.
        *p = (*p * 1024.0).round() / 1024.0;
    }
    mesh_of(&parts, field)
}

fn meshes() -> [TetMesh; 3] {
    let grid = |split| mesh_of(&cuboid([3, 3, 3], split, BOUNDS), field);
    [grid(Split::Five), grid(Split::Six), jittered()]
}

/// Where the eye stands: in a cell, on a vertex, on an edge, on a diagonal, in a face, near a vertex, on the surface.
const PLACES: [DVec3; 8] = [
    DVec3::new(1.3, 1.55, 1.21),
    DVec3::new(1.0, 2.0, 1.0),
    DVec3::new(1.5, 1.0, 2.0),
    DVec3::new(1.5, 1.5, 1.0),
    DVec3::new(1.25, 1.625, 2.0),
    DVec3::new(1.000001, 1.999999, 1.0000005),
    DVec3::new(0.0, 1.5, 1.5),
    DVec3::ZERO,
];

const DIRECTIONS: [DVec3; 4] =
    [DVec3::new(0.3, 0.9, -0.2), DVec3::X, DVec3::new(-0.5, -0.4, 0.7), DVec3::new(1.0, 1.0, 1.0)];

fn cameras(place: DVec3, near: f64) -> Vec<Camera> {
    let toward = |direction: DVec3| place + direction;
    let all = DIRECTIONS.iter().flat_map(|&d| {
        [perspective(place, toward(d), 60.0), perspective(place, toward(d), 140.0), orthographic(place, toward(d), 1.7)]
    });
    all.map(|camera| Camera { near, ..camera }).collect()
}

#[test]
fn what_lies_in_front_of_the_eye_is_seen() {
    for mesh in meshes() {
        for place in PLACES {
            for camera in cameras(place, 0.0) {
                let scene = scene(&mesh, white(&OPACITY), camera, [24, 20]);
                let what = format!("from {place}, {:?}", camera.projection);
                assert_white(&what, &mesh, &scene, &Convex::cuboid(BOUNDS), field, TOLERANCE);
            }
        }
    }
}

#[test]
fn nothing_before_the_near_plane_is_seen() {
    let [_, grid, jittered] = meshes();
    for mesh in [grid, jittered] {
        for place in [PLACES[0], PLACES[1], DVec3::new(-1.0, 1.4, 1.6)] {
            // The near plane crosses cells, passes through vertices, or lies behind everything.
            for near in [1e-4, 0.3, 1.0, 2.0, 20.0] {
                for camera in cameras(place, near) {
                    let scene = scene(&mesh, white(&OPACITY), camera, [24, 20]);
                    let what = format!("from {place}, near {near}, {:?}", camera.projection);
                    assert_white(&what, &mesh, &scene, &Convex::cuboid(BOUNDS), field, TOLERANCE);
                }
            }
        }
    }
}

/// One cell reaches from a millionth of its size before the eye to all of it: its planes meet rays at inverse depths of
/// up to a million, and the depth that is left of their differences is good to 5e-5.
const HUGE_CELL: f64 = 5e-5;

#[test]
fn a_single_huge_cell_round_the_eye() {
    let points =
        [DVec3::new(-5.0, -4.0, -3.0), DVec3::new(6.0, -3.0, -4.0), DVec3::new(0.5, 7.0, -3.5), DVec3::Z * 6.0];
    let parts = tetlux_mesh::procedural::Parts { points: points.to_vec(), cells: vec![[0, 1, 2, 3]] };
    let field = |p: DVec3| 5.0 + p.z;
    let mesh = mesh_of(&parts, field);
    for place in [DVec3::ZERO, DVec3::new(0.3, 0.2, 5.0), points[1] * 0.999, (points[0] + points[1] + points[2]) / 3.0]
    {
        for camera in cameras(place, 0.0) {
            let scene = scene(&mesh, white(&[[0.0, 0.05], [4.0, 0.3], [12.0, 0.1]]), camera, [24, 20]);
            let body = Convex::tetrahedron(points);
            assert_white(&format!("one cell, from {place}"), &mesh, &scene, &body, field, HUGE_CELL);
        }
    }
}
