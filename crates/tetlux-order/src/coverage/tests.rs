use proptest::prelude::*;

use super::*;
use crate::exact::{Viewpoint, plane_sign};

const SIDE: u32 = 40;

fn rays(eye: DVec3, target: DVec3, width: f64, orthographic: bool) -> Rays {
    let forward = (target - eye).normalize();
    let right = forward.any_orthonormal_vector();
    let down = forward.cross(right);
    let pixel = width / f64::from(SIDE);
    Rays::new(&Sampling { eye, right, down, forward, pixel, size: [SIDE; 2], near: 0.0, orthographic }, DVec3::ZERO)
}

/// How often the ray of every pixel enters and leaves a surface of triangles.
fn crossings(rays: &Rays, triangles: &[[Vec3; 3]]) -> Vec<[u32; 2]> {
    let at = if rays.parallel { -rays.forward } else { rays.eye };
    let eye = Viewpoint::new(at, !rays.parallel);
    let mut counts = vec![[0, 0]; (SIDE * SIDE) as usize];
    for &[a, b, c] in triangles {
        let (side, corners) = match plane_sign(a, b, c, &eye).value {
            1 => (0, [a, c, b]),
            -1 => (1, [a, b, c]),
            _ => continue,
        };
        Triangle::new(rays, corners).cover(rays, rays.bounds(corners), |row, columns| {
            for column in columns {
                counts[(row * SIDE + column) as usize][side] += 1;
            }
        });
    }
    counts
}

/// The surface of a box, every side split into n by n squares along diagonals, moved by `place`.
fn box_surface(n: i32, place: impl Fn(DVec3) -> DVec3) -> Vec<[Vec3; 3]> {
    let mut triangles = Vec::new();
    let step = |i: i32| f64::from(2 * i - n) / f64::from(n);
    for axis in 0..3 {
        for side in [-1.0, 1.0] {
            for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))) {
                let corner = |i, j| {
                    let mut p = [0.0; 3];
                    (p[axis], p[(axis + 1) % 3], p[(axis + 2) % 3]) = (side, step(i), step(j));
                    place(DVec3::from(p)).as_vec3()
                };
                let [p, q, r, s] = [corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)];
                for [a, b, c] in [[p, q, r], [p, r, s]] {
                    triangles.push(if side > 0.0 { [a, b, c] } else { [a, c, b] });
                }
            }
        }
    }
    triangles
}

proptest! {
    #[test]
    fn rays_cross_a_closed_surface_as_often_in_as_out(
        n in 1i32..9, bend in 0.0f64..0.4, phase in 0.0f64..6.0,
        eye in prop::array::uniform3(-6.0f64..6.0), aim in prop::array::uniform3(-0.5f64..0.5),
        width in 0.05f64..6.0, parallel in any::<bool>(),
    ) {
        let eye = DVec3::from(eye);
        // A bent box; from within 1 - bend, one is inside.
        prop_assume!(parallel || eye.abs().max_element() > 1.0 + bend);
        let surface = box_surface(n, |p| p + bend * DVec3::new((3.0 * p.y + phase).sin(), (3.0 * p.z).sin(), (3.0 * p.x).sin()));
        let rays = rays(eye, DVec3::from(aim), width, parallel);
        let counts = crossings(&rays, &surface);
        prop_assert!(counts.iter().all(|[entries, exits]| entries == exits));
        // A planted hole is seen: not all rays that met its triangle still balance.
        for missing in 0..surface.len() {
            let one = crossings(&rays, &surface[missing..=missing]);
            if one.iter().any(|&count| count != [0, 0]) {
                let rest = [&surface[..missing], &surface[missing + 1..]].concat();
                prop_assert!(crossings(&rays, &rest).iter().any(|[entries, exits]| entries != exits));
                break;
            }
        }
    }

    #[test]
    fn from_inside_every_ray_leaves_once(
        n in 1i32..6, eye in prop::array::uniform3(-0.9f64..0.9), aim in prop::array::uniform3(-1.0f64..1.0),
        width in 0.1f64..20.0,
    ) {
        // Vertices all around: also beside and behind the eye.
        let eye = DVec3::from(eye);
        prop_assume!((DVec3::from(aim) - eye).length() > 1e-3);
        let counts = crossings(&rays(eye, DVec3::from(aim), width, false), &box_surface(n, |p| p));
        prop_assert!(counts.iter().all(|&count| count == [0, 1]));
    }
}

#[test]
fn rays_through_vertices_and_along_edges_cross_once() {
    // Pixel centres at odd multiples of 1/40: a grid of 40 squares a side, moved by half a square, has vertices on all.
    for (n, shift) in [(40, 0.025), (40, 0.0), (20, 0.025), (8, 0.0), (1, 0.025)] {
        let surface = box_surface(n, |p| p + DVec3::new(shift, shift, 0.0));
        for orthographic in [true, false] {
            let eye = DVec3::new(0.0, 0.0, 2.0);
            // In perspective, the pixels of the front side at depth 1.
            let rays = Rays::new(
                &Sampling {
                    eye,
                    right: DVec3::X,
                    down: DVec3::NEG_Y,
                    forward: DVec3::NEG_Z,
                    pixel: 0.05,
                    size: [SIDE; 2],
                    near: 0.0,
                    orthographic,
                },
                DVec3::ZERO,
            );
            let counts = crossings(&rays, &surface);
            assert!(counts.iter().all(|&[entries, exits]| entries == exits && entries <= 1), "{n}, {shift}");
            // Moved to the right and up, the box misses at most a column and a row.
            let hit = counts.iter().filter(|&&count| count == [1, 1]).count() as u32;
            assert!(hit >= (SIDE - 1) * (SIDE - 1), "{n}, {shift}: {hit}");
        }
    }
}

#[test]
fn rows_that_run_along_edges_are_tested_pixel_by_pixel() {
    // Edges along rows of pixel centres in a turned view: only roundings of the rays say which side they are on.
    let (sin, cos) = 0.3f64.sin_cos();
    let turn = |p: DVec3| DVec3::new(cos * p.x - sin * p.y, sin * p.x + cos * p.y, p.z);
    let surface = box_surface(40, |p| turn(p + DVec3::new(0.025, 0.025, 0.0)));
    for orthographic in [true, false] {
        let view = Sampling {
            eye: DVec3::new(0.0, 0.0, 2.0),
            right: turn(DVec3::X),
            down: turn(DVec3::NEG_Y),
            forward: DVec3::NEG_Z,
            pixel: 0.05,
            size: [SIDE; 2],
            near: 0.0,
            orthographic,
        };
        let counts = crossings(&Rays::new(&view, DVec3::ZERO), &surface);
        assert!(counts.iter().all(|[entries, exits]| entries == exits && *entries <= 1));
    }
}

proptest! {
    #[test]
    fn depths_are_those_of_the_plane(
        a in prop::array::uniform3(-1.0f32..1.0), b in prop::array::uniform3(-1.0f32..1.0),
        c in prop::array::uniform3(-1.0f32..1.0), orthographic in any::<bool>(),
    ) {
        let corners = [a, b, c].map(Vec3::from);
        let rays = rays(DVec3::new(2.0, 3.0, 4.0), DVec3::ZERO, 0.5, orthographic);
        let depth = Depth::new(&rays, corners);
        let [p, q, r] = corners.map(|v| v.as_dvec3());
        let n = (q - p).cross(r - p);
        for (column, row) in [(3, 5), (20, 19), (39, 0)] {
            let across = rays.across(column, row);
            let (origin, direction) =
                if orthographic { (rays.eye + across, rays.forward) } else { (rays.eye, rays.forward + across) };
            let expected = n.dot(p - origin) / n.dot(direction);
            let z = [p, q, r].map(|v| rays.forward.dot(v - rays.eye));
            let [low, high] = [z.into_iter().fold(f64::INFINITY, f64::min), z.into_iter().fold(0.0, f64::max)];
            // Only where the plane is not almost edge-on: a few roundings over the cosine.
            if n.dot(direction).abs() > 1e-3 {
                prop_assert!((depth.at(&rays, column, row) - expected.clamp(low, high)).abs() < 1e-10);
            }
        }
    }
}
