//! The silhouettes that a tetrahedron can have, all degenerate ones included (Shirley and Tuchman 1990; Wylie et al.
//! 2002 list fourteen): whatever the class, a pixel is the chord of its ray.

use glam::DVec3;
use tetlux_mesh::procedural::Parts;
use tetlux_tests::{Convex, mesh_of, orthographic, perspective, scene, white};

use crate::{TOLERANCE, assert_white};

/// Name and vertices as seen along +z from below, x to the right.
const CLASSES: [(&str, [[f64; 3]; 4]); 9] = [
    (
        "1a: three faces seen, the near vertex within the others",
        [[0.0, 0.0, 0.0], [-1.0, -0.75, 1.0], [1.0, -0.75, 1.0], [0.125, 1.0, 1.5]],
    ),
    (
        "1b: one face seen, the far vertex within it",
        [[0.0, 0.0, 2.0], [-1.0, -0.75, 1.0], [1.0, -0.75, 1.0], [0.125, 1.0, 0.5]],
    ),
    ("2: two faces seen, a quadrilateral", [[-1.0, 0.0, 0.0], [1.0, 0.25, 0.25], [0.0, -1.0, 1.0], [0.25, 1.0, 1.25]]),
    ("a vertex over an edge, before it", [[0.0, -0.5, 0.0], [-1.0, -0.5, 1.0], [1.0, -0.5, 1.5], [0.25, 1.0, 1.0]]),
    ("a vertex over an edge, behind it", [[0.0, -0.5, 2.0], [-1.0, -0.5, 1.0], [1.0, -0.5, 0.5], [0.25, 1.0, 1.0]]),
    ("a vertex over a vertex", [[0.0, 0.5, 0.0], [0.0, 0.5, 1.5], [-1.0, -0.75, 1.0], [1.0, -0.5, 0.5]]),
    ("a face edge-on", [[-1.0, 0.0, 0.0], [1.0, 0.0, 0.25], [0.25, 0.0, 1.5], [0.0, 1.0, 0.5]]),
    ("two faces edge-on", [[0.0, 0.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.25], [0.0, 1.0, 0.5]]),
    (
        "two faces edge-on, a right angle at the far end",
        [[0.5, 0.5, 1.0], [0.5, 0.5, 0.25], [-1.0, 0.5, 1.0], [0.5, -1.0, 1.0]],
    ),
];

/// Linear, with a different value at each vertex.
fn field(p: DVec3) -> f64 {
    2.0 + p.x + 0.5 * p.y + p.z
}

const OPACITY: [[f64; 2]; 4] = [[0.0, 0.5], [1.5, 0.25], [2.5, 4.0], [6.0, 0.5]];

#[test]
fn every_silhouette_in_every_order_of_vertices() {
    for (name, vertices) in CLASSES {
        let vertices = vertices.map(DVec3::from);
        let body = Convex::tetrahedron(vertices);
        // Every vertex is the first once, in both orientations: the index order decides which planes share an origin.
        for order in [[0, 1, 2, 3], [1, 0, 2, 3], [2, 3, 0, 1], [3, 2, 0, 1], [1, 3, 2, 0], [0, 3, 1, 2]] {
            let parts = Parts { points: order.map(|i: usize| vertices[i]).to_vec(), cells: vec![[0, 1, 2, 3]] };
            let mesh = mesh_of(&parts, field);
            // Pixel centres on multiples of 1/8: on the vertices, and on edges that run along rows and columns.
            let on_grid = orthographic(DVec3::new(0.0, 0.0, -3.0), DVec3::ZERO, 21.0 / 16.0);
            // The same between them.
            let shift = DVec3::new(0.0213, 0.0371, 0.0);
            let between = orthographic(on_grid.position + shift, shift, 21.0 / 16.0);
            // From a point over the vertex that is over another: the class holds in perspective too.
            let eye = DVec3::new(vertices[0].x, vertices[0].y, -3.0);
            let through = perspective(eye, eye + DVec3::Z, 45.0);
            let aslant = perspective(DVec3::new(0.3, 0.2, -2.5), DVec3::new(0.05, 0.1, 0.75), 50.0);
            for camera in [on_grid, between, through, aslant] {
                let scene = scene(&mesh, white(&OPACITY), camera, [21, 21]);
                let judged = assert_white(name, &mesh, &scene, &body, field, TOLERANCE);
                assert!(judged.covered > 20, "{name}: {} pixels", judged.covered);
            }
        }
    }
}

#[test]
fn the_cases_are_the_classes_they_claim_to_be() {
    for (name, vertices) in CLASSES {
        let xy = |i: usize| DVec3::from(vertices[i]).truncate();
        // Signed areas of the faces as seen: zero where edge-on.
        let area = |f: [usize; 3]| (xy(f[1]) - xy(f[0])).perp_dot(xy(f[2]) - xy(f[0]));
        let edge_on = [[1, 2, 3], [0, 2, 3], [0, 1, 3], [0, 1, 2]].iter().filter(|&&f| area(f) == 0.0).count();
        let expected = match name {
            n if n.starts_with("two faces") || n.contains("over a vertex") => 2,
            n if n.starts_with("a face") || n.contains("over an edge") => 1,
            _ => 0,
        };
        assert_eq!(edge_on, expected, "{name}");
    }
}
