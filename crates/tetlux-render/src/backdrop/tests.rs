#![allow(clippy::unwrap_used, reason = "a test stops at its first surprise")]

use tetlux_mesh::procedural::{Split, cuboid};
use tetlux_mesh::{Component, Field, TetMesh};
use tetlux_optics::Light;
use tetlux_scene::{Camera, Projection, SurfaceSpec, View};

use super::*;
use crate::device_mesh::DeviceMesh;

const SIZE: [u32; 2] = [40, 30];

/// Depths are rounded to single precision once; of the order of 1.
const ROUNDING: f64 = 2e-7;

fn mesh() -> TetMesh {
    let parts = cuboid([1; 3], Split::Six, [DVec3::new(-1.0, -2.0, 0.0), DVec3::new(2.0, 1.0, 3.0)]);
    TetMesh::assemble(&parts.points, &parts.cells, vec![Field::point("s", 1, parts.sample(|p| p.x))]).unwrap()
}

fn spec() -> SurfaceSpec {
    let light = Light::new(Some([1.0, -2.0, 3.0]), [0.2, 0.7, 0.4], 9.0, 0.0).unwrap();
    SurfaceSpec { color: [0.9, 0.5, 0.1], ..SurfaceSpec::new("surface".into(), Some(light)) }
}

fn views() -> [View; 4] {
    let (outside, inside) = (DVec3::new(5.0, -6.0, 4.0), DVec3::new(0.4, -0.3, 1.2));
    let focal_point = DVec3::new(0.5, -0.5, 1.5);
    let view = |position, projection, near| {
        let camera = Camera { position, focal_point, view_up: DVec3::Z, projection, near };
        camera.view(SIZE).unwrap()
    };
    [
        view(outside, Projection::Perspective { view_angle: 40.0 }, 0.0),
        view(outside, Projection::Orthographic { parallel_scale: 2.5 }, 6.0),
        view(inside, Projection::Perspective { view_angle: 100.0 }, 0.2),
        view(inside, Projection::Orthographic { parallel_scale: 1.5 }, 0.0),
    ]
}

fn drawn(surface: &Surface, view: &View) -> (Backdrop, EyeSpace, f64) {
    let mesh = mesh();
    let device = DeviceMesh::new(&mesh, &mesh.scalar("s", Component::Magnitude).unwrap(), &[]);
    let eye = EyeSpace::new(view, &mesh, &device);
    let backdrop = Backdrop::new(std::slice::from_ref(surface), &eye, device.scale, view.size);
    (backdrop, eye, device.scale)
}

/// Numbers in [-1, 1) (a linear congruential generator; Knuth's multiplier).
fn numbers() -> impl FnMut() -> f64 {
    let mut state = 12345u64;
    move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }
}

/// Triangles of all sizes, around and inside the mesh.
fn soup() -> Surface {
    let mut next = numbers();
    let mut point = |scale: f64| DVec3::new(next(), next(), next()) * scale;
    let mut points = Vec::new();
    for k in 0..60 {
        let (middle, size) = (point(3.0) + DVec3::new(0.5, -0.5, 1.5), [2.0, 0.4, 0.05][k % 3]);
        points.extend([(); 3].map(|()| middle + point(size)));
    }
    let triangles = (0..60).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect();
    spec().on(&mesh(), &points, triangles).unwrap()
}

/// What ends the ray of a pixel by the planes of all triangles: depth, and normal.
fn first(surface: &Surface, view: &View, [x, y]: [f64; 2]) -> Option<(f64, DVec3)> {
    let (origin, direction) = view.ray(x, y);
    let origin = origin - mesh().origin();
    let meets = |names: &[u32; 3]| {
        let [a, b, c] = names.map(|v| surface.points()[v as usize].as_dvec3());
        let n = (b - a).cross(c - a);
        let depth = n.dot(a - origin) / n.dot(direction);
        let p = origin + depth * direction;
        let inside = [[a, b], [b, c], [c, a]].iter().all(|[u, v]| (v - u).cross(p - u).dot(n) > 0.0);
        (inside && depth >= view.near && depth > 0.0).then_some((depth, n))
    };
    surface.triangles().iter().filter_map(meets).min_by(|a, b| a.0.total_cmp(&b.0))
}

#[test]
fn every_pixel_has_the_first_triangle_on_its_ray() {
    let surface = soup();
    for view in views() {
        let (backdrop, eye, scale) = drawn(&surface, &view);
        let mut covered = 0;
        for (i, (&depth, color)) in backdrop.depths.iter().zip(&backdrop.colors).enumerate() {
            let at = [i % SIZE[0] as usize, i / SIZE[0] as usize].map(|k| k as f64 + 0.5);
            let Some((exact, normal)) = first(&surface, &view, at) else {
                assert_eq!(depth, BEYOND, "{view:?} {at:?}");
                continue;
            };
            let level = exact * scale - eye.offset.z;
            assert!((f64::from(depth) - level).abs() <= ROUNDING * level.abs().max(1.0), "{at:?}: {depth} for {level}");
            let view_vector = -view.ray(at[0], at[1]).1.normalize();
            let lit = spec().light.luminance(spec().color, normal.to_array(), view_vector.to_array());
            for (found, exact) in color.iter().zip(lit) {
                assert!((f64::from(*found) - exact).abs() < 1e-6, "{at:?}: {color:?} for {lit:?}");
            }
            covered += 1;
        }
        assert!(covered > 200 && covered < 1150, "{covered} of 1200 pixels");
    }
}

#[test]
fn pixels_on_edges_and_corners_are_covered() {
    // Looking down at squares of halves whose corners lie on pixel centres, with a scale that is exact.
    let projection = Projection::Orthographic { parallel_scale: 15.0 / 16.0 };
    let (position, focal_point) = (DVec3::new(0.5, -0.5, 9.0), DVec3::new(0.5, -0.5, 0.0));
    let camera = Camera { position, focal_point, view_up: DVec3::Y, projection, near: 0.0 };
    let view = camera.view(SIZE).unwrap();
    let corner = |i: u32, j: u32| {
        DVec3::new(0.5 + (f64::from(i) * 3.0 - 16.5) / 16.0, -0.5 + (f64::from(j) * 3.0 - 13.5) / 16.0, 1.5)
    };
    const N: u32 = 9;
    let points: Vec<DVec3> = (0..=N).flat_map(|j| (0..=N).map(move |i| corner(i, j))).collect();
    let name = |i: u32, j: u32| j * (N + 1) + i;
    let squares = (0..N).flat_map(|j| (0..N).map(move |i| (i, j)));
    let triangles = squares.flat_map(|(i, j)| {
        let [a, b, c, d] = [name(i, j), name(i + 1, j), name(i + 1, j + 1), name(i, j + 1)];
        // One in three the other way round.
        if i % 3 == 0 { [[a, b, c], [a, d, c]] } else { [[b, a, d], [d, c, b]] }
    });
    let surface = spec().on(&mesh(), &points, triangles.collect()).unwrap();
    let (backdrop, ..) = drawn(&surface, &view);
    // Every centre from corner to corner: 27 intervals each way.
    assert_eq!(backdrop.depths.iter().filter(|&&depth| depth < BEYOND).count(), 28 * 28);
}

#[test]
fn triangles_of_no_area_or_behind_the_eye_end_no_ray() {
    let [perspective, ..] = views();
    let line: Vec<DVec3> = [-1.0, 0.0, 2.0].map(|t| DVec3::new(0.5, -0.5, 1.5) + t * DVec3::ONE).to_vec();
    let behind: Vec<DVec3> =
        [DVec3::ZERO, DVec3::X * 9.0, DVec3::Y * 9.0].map(|p| p + DVec3::new(9.0, -12.0, 8.0)).to_vec();
    for points in [line, behind] {
        let surface = spec().on(&mesh(), &points, vec![[0, 1, 2], [0, 0, 1]]).unwrap();
        let (backdrop, ..) = drawn(&surface, &perspective);
        assert!(backdrop.depths.iter().all(|&depth| depth == BEYOND));
    }
}

#[test]
fn a_backdrop_is_the_same_on_any_number_of_threads() {
    let (surface, view) = (soup(), views()[2]);
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let (backdrop, ..) = pool.install(|| drawn(&surface, &view));
        (backdrop.depths, backdrop.colors)
    };
    assert_eq!(on(1), on(3));
}

#[test]
fn what_is_before_it_is_composited_over_it() {
    let backdrop = Backdrop { depths: vec![1.0, BEYOND], colors: vec![[0.5, 1.0, 2.0], [9.0; 3]] };
    let mut pixels = [[0.25, 0.0, 0.5, 0.75]; 2];
    backdrop.put_behind(&mut pixels);
    assert_eq!(pixels, [[0.375, 0.25, 1.0, 1.0], [0.25, 0.0, 0.5, 0.75]]);
    assert_eq!(backdrop.brightest(), 9.0);
}
