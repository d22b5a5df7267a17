//! Opaque surfaces in a mesh whose light is known in closed form.

use super::super::*;
use crate::testing::{Body, fog, numbers, ray};
use tetlux_mesh::procedural::{Split, cuboid};

/// Rounding of lengths and exponentials of the order of 1.
const ROUNDING: f64 = 1e-12;

const COLOR: [f64; 3] = [0.25, 0.5, 2.0];

/// The cube from -1 to 1.
fn cube() -> Body {
    Body::by_point(&cuboid([3; 3], Split::Six, [-DVec3::ONE, DVec3::ONE]), |_| 0.0)
}

/// Two triangles that make a square across z, of half a side.
fn square(half: f32, z: f32) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let corner = |x: f32, y: f32| Vec3::new(half * x, half * y, z);
    (vec![corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)], vec![[0, 1, 2], [0, 2, 3]])
}

/// All that comes is ambient.
fn unlit() -> Light {
    Light::new(None, [1.0, 0.0, 0.0], 1.0, 0.0).unwrap()
}

fn with<'a>(caster: Caster<'a>, (points, triangles): &'a (Vec<Vec3>, Vec<[u32; 3]>), light: &'a Light) -> Caster<'a> {
    caster.with_surfaces(vec![Surface { points, triangles, color: COLOR, light }]).unwrap()
}

#[test]
fn what_is_before_a_surface_is_seen_over_it() {
    let (body, fog, light) = (cube(), fog(0.75), unlit());
    // The length of fog before it: none, a part, all.
    for (z, length) in [(-1.5, 0.0), (-1.0, 0.0), (-0.375, 0.625), (0.0, 1.0), (1.0, 2.0), (3.0, 2.0), (1000.0, 2.0)] {
        for half in [2.0, 4000.0] {
            let surface = square(half, z);
            let caster = with(body.caster(&fog), &surface, &light);
            for [x, y] in [[0.0, 0.0], [0.3, -0.7], [0.5, 0.5]] {
                let seen = caster.cast(&ray([x, y, -5.0], [0.0, 0.0, 2.0]));
                let through = f64::exp(-0.75 * length);
                assert_eq!(seen.alpha, 1.0);
                for (found, color) in seen.color.into_iter().zip(COLOR) {
                    let exact = 1.0 - through + through * color;
                    assert!((found - exact).abs() < ROUNDING, "z {z}, half {half}: {found} for {exact}");
                }
            }
        }
    }
}

#[test]
fn a_surface_is_seen_where_it_is_and_nowhere_else() {
    let (body, fog, light) = (cube(), fog(0.75), unlit());
    let (surface, plain) = (square(0.5, 0.25), body.caster(&fog));
    let caster = with(body.caster(&fog), &surface, &light);
    for (origin, direction) in [
        // Beside it; away from it; from behind its end; beside the mesh.
        ([0.6, 0.0, -5.0], [0.0, 0.0, 1.0]),
        ([0.0, 0.0, 0.26], [0.0, 0.0, 1.0]),
        ([0.0, -5.0, 0.25001], [0.0, 1.0, 0.0]),
        ([3.0, 0.0, -5.0], [0.0, 0.0, 1.0]),
        ([90.0, 0.0, -5.0], [0.0, 1.0, 0.0]),
    ] {
        let ray = ray(origin, direction);
        assert_eq!(caster.cast(&ray), plain.cast(&ray), "{ray:?}");
    }
    // A near plane behind it, and an end before it.
    let before = Ray { start: 5.3, ..ray([0.0, 0.0, -5.0], [0.0, 0.0, 1.0]) };
    assert_eq!(caster.cast(&before), plain.cast(&before));
    let short = Ray { end: 5.2, ..ray([0.0, 0.0, -5.0], [0.0, 0.0, 1.0]) };
    assert_eq!(caster.cast(&short), plain.cast(&short));
}

#[test]
fn both_sides_are_lit_by_the_triangles_own_normals() {
    let (body, fog) = (cube(), fog(0.0));
    let light = Light::new(Some([0.0, 3.0, 4.0]), [0.125, 0.5, 0.25], 2.0, 1.0).unwrap();
    let mut surface = square(1.0, 0.0);
    // The light and the eye make 36.87 degrees: cosine 4/5; half-way cos^2 is (1 + 4/5) / 2.
    let expected = COLOR.map(|c| c * (0.125 + 0.5 * 0.8) + 0.25 * 0.9);
    for _ in 0..2 {
        let caster = with(body.caster(&fog), &surface, &light);
        for z in [5.0, -5.0] {
            // Two-sided: from below the light comes from above, hence its highlight lies elsewhere.
            let seen = caster.cast(&ray([0.1, 0.3, z], [0.0, 0.0, -z]));
            let half = if z > 0.0 { 0.9 } else { 0.1 };
            for (k, found) in seen.color.into_iter().enumerate() {
                let exact = expected[k] + 0.25 * (half - 0.9);
                assert!((found - exact).abs() < ROUNDING, "z {z}: {found} for {exact}");
            }
        }
        surface.1.iter_mut().for_each(|triangle| triangle.swap(0, 1));
    }
}

#[test]
fn no_ray_passes_between_triangles() {
    let (body, fog, light) = (cube(), fog(0.0), unlit());
    // A lattice of squares in halves, waving where the points are, and rays through all of its points and edges.
    const N: u32 = 8;
    let at = |i: u32, j: u32| Vec3::new(i as f32 - 4.0, j as f32 - 4.0, ((i * 5 + j * 3) % 4) as f32) * 0.25;
    let points: Vec<Vec3> = (0..=N).flat_map(|j| (0..=N).map(move |i| at(i, j))).collect();
    let corner = |i: u32, j: u32| j * (N + 1) + i;
    let triangles = (0..N).flat_map(|j| (0..N).map(move |i| (i, j))).flat_map(|(i, j)| {
        let [a, b, c, d] = [corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)];
        [[a, b, c], [d, c, a]]
    });
    let surface = (points, triangles.collect());
    let caster = with(body.caster(&fog), &surface, &light);
    for i in 1..4 * N {
        for j in 1..4 * N {
            let [x, y] = [i, j].map(|k| f64::from(k) / 16.0 - 1.0);
            for direction in [[0.0, 0.0, -1.0], [0.125, 0.0, -1.0], [0.25, -0.125, -1.0]] {
                // Through the lattice's lines at height 0, from about 4 above.
                let origin = DVec3::new(x, y, 0.0) - 4.0 * DVec3::from(direction);
                let ray = Ray { origin, direction: direction.into(), start: 0.0, end: f64::INFINITY };
                let inside =
                    direction == [0.0, 0.0, -1.0] || (4..4 * N - 4).contains(&i) && (4..4 * N - 4).contains(&j);
                let seen = caster.cast(&ray);
                assert!(!inside || seen.alpha == 1.0, "{ray:?}");
            }
        }
    }
}

#[test]
fn the_first_of_many_triangles_is_hit() {
    let (body, fog, light) = (cube(), fog(0.0), unlit());
    let mut random = numbers(5);
    let mut point = |scale: f64| DVec3::new(random() - 0.5, random() - 0.5, random() - 0.5) * scale;
    let points: Vec<Vec3> = (0..150).map(|_| point(3.0).as_vec3()).collect();
    let triangles: Vec<[u32; 3]> = (0..50).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect();
    let surface = Surface { points: &points, triangles: &triangles, color: COLOR, light: &light };
    let surfaces = Surfaces::new(vec![surface]).unwrap().unwrap();
    let mut hits = 0;
    for _ in 0..2000 {
        let (origin, direction) = (point(8.0), point(1.0));
        // By the plane, and whether the place is on the inner side of every edge.
        let meets = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|v| points[v as usize].as_dvec3());
            let n = (b - a).cross(c - a);
            let t = n.dot(a - origin) / n.dot(direction);
            let p = origin + t * direction;
            let inside = [[a, b], [b, c], [c, a]].iter().all(|[u, v]| (v - u).cross(p - u).dot(n) > 0.0);
            (t > 0.0 && inside).then_some(t)
        };
        let expected = triangles.iter().filter_map(meets).min_by(f64::total_cmp);
        let ray = Ray { origin, direction, start: 0.0, end: f64::INFINITY };
        let found = surfaces.first(&ray, DVec3::ZERO).map(|hit| hit.t);
        match (found, expected) {
            (Some(a), Some(b)) => assert!((a - b).abs() < 1e-9 * b.abs().max(1.0), "{ray:?}: {a} for {b}"),
            (a, b) => assert_eq!(a, b, "{ray:?}"),
        }
        hits += usize::from(found.is_some());
    }
    assert!(hits > 100 && hits < 1900, "{hits} hits");
    assert!(body.caster(&fog).with_surfaces(vec![surface]).is_ok());
}

#[test]
fn triangles_of_no_area_are_not_seen() {
    let (body, fog, light) = (cube(), fog(0.75), unlit());
    let points: Vec<Vec3> = [-1.0, 0.0, 0.5, 1.0].map(|x| Vec3::new(x, x, 0.25)).to_vec();
    let surface = (points, vec![[0, 1, 2], [0, 3, 1], [2, 2, 3], [1, 1, 1]]);
    let caster = with(body.caster(&fog), &surface, &light);
    let plain = body.caster(&fog);
    for x in [-0.5, 0.0, 0.25] {
        let ray = ray([x, x, -5.0], [0.0, 0.0, 1.0]);
        assert_eq!(caster.cast(&ray), plain.cast(&ray));
    }
}

#[test]
fn impossible_surfaces_are_refused() {
    let (body, fog, light) = (cube(), fog(0.75), unlit());
    let refusal = |points: &[Vec3], triangles: &[[u32; 3]]| {
        let surface = Surface { points, triangles, color: COLOR, light: &light };
        body.caster(&fog).with_surfaces(vec![surface]).map(|_| ()).unwrap_err().to_string()
    };
    let error = refusal(&[Vec3::ZERO, Vec3::X], &[[0, 1, 0], [0, 1, 2]]);
    assert!(error.contains("surface 0") && error.contains("triangle 1") && error.contains("of 2"), "{error}");
    let error = refusal(&[Vec3::ZERO, Vec3::NAN], &[]);
    assert!(error.contains("point 1") && error.contains("finite"), "{error}");
}
