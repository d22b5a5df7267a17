//! The decomposition of projected tetrahedra, judged by what must hold of it in f64: both ends of the thick vertex lie on
//! the cell's surface on one ray and have its scalars, and the triangles cover the silhouette once.

use glam::{DMat3, DVec2, DVec3};
use tetlux_shaders::{DEFAULTS, choose, compose};
use tetlux_tests::Random;

use crate::device::{Bound, run};

const THICK: f32 = 3.0;
const PIXEL: f32 = 1.0 / 1024.0;
const NEAR: f32 = 0.5;

const TEST: &str = "
fn row(i: u32) {
    var c: Corners;
    c.parity = 1.0;
    for (var k = 0u; k < 4u; k++) {
        let at = 16u * i + 4u * k;
        let eye = bitcast<vec3<f32>>(vec3<u32>(inputs[at], inputs[at + 1u], inputs[at + 2u]));
        c.vertices[k] = Vertex(eye, eye, eye, pixel_of(eye), vec2<f32>(0.0));
        c.scalars[k] = bitcast<f32>(inputs[at + 3u]);
    }
    let cell = decompose(c, 0u);
    for (var k = 0u; k < 4u; k++) {
        for (var n = 0u; n < 4u; n++) {
            outputs[20u * i + 4u * k + n] = bitcast<u32>(cell.planes[k][n]);
        }
        outputs[20u * i + 16u + k] = bitcast<u32>(cell.rise[k]);
    }
}
";

fn source(orthographic: bool) -> String {
    let choices = choose(DEFAULTS, &[("geometry", "geometry::thick"), ("shading", "shading::preint")]);
    let text = compose("lib::thick", &choices).unwrap() + TEST;
    let (from, to) = ("override ORTHOGRAPHIC: bool = false", format!("const ORTHOGRAPHIC: bool = {orthographic}"));
    assert!(text.contains(from));
    text.replace(from, &to)
}

fn view() -> Vec<u8> {
    let mut values = vec![0.0f32; 20];
    // Along the axes, from the origin.
    for i in [0, 5, 10] {
        values[i] = 1.0;
    }
    values.extend([1024.0, 1024.0, PIXEL, NEAR]);
    values.into_iter().flat_map(f32::to_ne_bytes).collect()
}

type Corner = (DVec3, f64);

/// Four corners in eye space, beyond the near plane, and their scalars: in general position and in every degenerate one.
fn random_cell(random: &mut Random) -> [Corner; 4] {
    let mut p: [DVec3; 4] = std::array::from_fn(|_| {
        DVec3::new(random.between(-1.0, 1.0), random.between(-1.0, 1.0), random.between(2.0, 5.0))
    });
    match random.below(6) {
        // A vertex over a vertex.
        0 => p[..2].iter_mut().for_each(|p| (p.x, p.y) = (0.0, 0.0)),
        // A vertex over an edge.
        1 => {
            (p[0].x, p[0].y) = (0.0, 0.0);
            (p[1].x, p[1].y, p[2].x, p[2].y) = (p[1].x.abs(), 0.0, -p[2].x.abs(), 0.0);
        }
        // A face seen edge-on.
        2 => p[1..].iter_mut().for_each(|p| p.y = 0.0),
        _ => (),
    }
    // Every vertex has its turn in every role.
    p.rotate_left(random.below(4));
    p.map(|p| (p.as_vec3().as_dvec3(), f64::from(random.between(0.0, 1.0) as f32)))
}

fn barycentric(cell: &[Corner; 4], point: DVec3) -> [f64; 4] {
    let [o, a, b, c] = cell.map(|(p, _)| p);
    let x = DMat3::from_cols(a - o, b - o, c - o).inverse() * (point - o);
    [1.0 - x.x - x.y - x.z, x.x, x.y, x.z]
}

fn pixel_of(p: DVec3, orthographic: bool) -> DVec2 {
    p.truncate() / (if orthographic { 1.0 } else { p.z } * f64::from(PIXEL))
}

/// Twice the area of the convex hull of four points: that of the triangles that any two of opposite edges span.
fn hull(p: [DVec2; 4]) -> f64 {
    let area = |a: DVec2, b: DVec2, c: DVec2| (b - a).perp_dot(c - a).abs();
    // The largest triangle, or the largest quadrilateral as half the cross product of its diagonals.
    let triangles = [area(p[0], p[1], p[2]), area(p[0], p[1], p[3]), area(p[0], p[2], p[3]), area(p[1], p[2], p[3])];
    0.5 * triangles.iter().sum::<f64>().max(2.0 * triangles.iter().copied().fold(0.0, f64::max))
}

/// What is wrong with a decomposed cell.
fn faults(cell: &[Corner; 4], found: &[f32], orthographic: bool) -> Vec<String> {
    let value = |k: usize| f64::from(found[k]);
    let at = pixel_of(cell[0].0, orthographic) + DVec2::new(value(0), value(1));
    let side = at * f64::from(PIXEL);
    let points = if orthographic {
        [value(2), value(2) + value(3)].map(|depth| side.extend(depth))
    } else {
        [value(2), value(2) - value(3)].map(|inverse| side.extend(1.0) / inverse)
    };
    // Single precision of pixels up to a thousand, for cells about a unit wide.
    let tolerance = 1e-4;
    let mut faults = Vec::new();
    for (point, scalar, name) in [(points[0], value(4), "front"), (points[1], value(8), "back")] {
        let b = barycentric(cell, point);
        if b.iter().any(|&b| b < -tolerance) {
            faults.push(format!("the {name} end is outside: {b:?}"));
        }
        if b.iter().all(|&b| b > tolerance) {
            faults.push(format!("the {name} end is inside: {b:?}"));
        }
        let exact: f64 = b.iter().zip(cell).map(|(b, (_, s))| b * s).sum();
        if (exact - scalar).abs() > tolerance {
            faults.push(format!("the {name} end has scalar {scalar}, not {exact}"));
        }
    }
    if points[1].z < points[0].z - 1e-6 {
        faults.push("front and back are exchanged".into());
    }
    let pixels = cell.map(|(p, _)| pixel_of(p, orthographic));
    let (code, count) = (found[12] as usize, found[13] as usize);
    let outer: Vec<DVec2> = (0..count).map(|k| pixels[code >> (2 * k) & 3]).collect();
    let areas: Vec<f64> = (0..count).map(|k| (outer[k] - at).perp_dot(outer[(k + 1) % count] - at)).collect();
    let (covered, hull) = (areas.iter().map(|a| a.abs()).sum::<f64>(), hull(pixels));
    if (covered - hull).abs() > 1e-4 * hull + 1.0 {
        faults.push(format!("{count} triangles cover {covered} of {hull}"));
    }
    faults
}

#[test]
fn the_thick_vertex_is_on_the_cell_and_its_triangles_cover_the_silhouette() {
    let rows = 40_000;
    for orthographic in [false, true] {
        let mut random = Random::new(31);
        let cells: Vec<_> = (0..rows).map(|_| random_cell(&mut random)).collect();
        let inputs: Vec<f32> =
            cells.iter().flatten().flat_map(|(p, s)| p.extend(*s).to_array()).map(|v| v as f32).collect();
        let outputs = run(&source(orthographic), &[Bound::Uniform(0, 0, &view())], &inputs, rows, 20);
        let (mut judged, mut four) = (0, 0);
        for (cell, found) in cells.iter().zip(outputs.chunks_exact(20)) {
            assert!(found.iter().all(|v| v.is_finite()));
            let [o, a, b, c] = cell.map(|(p, _)| p);
            let volume = (a - o).cross(b - o).dot(c - o).abs();
            // Slivers, and cells whose projection is one, lose digits: areas are differences of products. Those of no
            // volume may be hidden.
            let pixels = cell.map(|(p, _)| pixel_of(p, orthographic));
            let extent = pixels.iter().flat_map(|a| pixels.map(|b| a.distance(b))).fold(0.0, f64::max);
            if volume < 0.05 || hull(pixels) < 0.05 * extent * extent {
                continue;
            }
            assert_eq!(found[19], THICK, "{cell:?}");
            let faults = faults(cell, found, orthographic);
            assert!(faults.is_empty(), "orthographic {orthographic}, {cell:?}, {found:?}: {faults:?}");
            judged += 1;
            four += usize::from(found[13] == 4.0);
        }
        assert!(judged > rows / 2 && four > judged / 10 && four < judged, "{judged} judged, {four} of class 2");
        // Planted: each value in turn a little off is seen.
        let index = cells.iter().position(|cell| {
            let [o, a, b, c] = cell.map(|(p, _)| p);
            (a - o).cross(b - o).dot(c - o).abs() > 1.0
        });
        let index = index.unwrap();
        let good = &outputs[20 * index..][..20];
        assert!(faults(&cells[index], good, orthographic).is_empty());
        for k in [0, 1, 2, 3, 4, 8, 13] {
            let mut bad = good.to_vec();
            bad[k] += if k < 2 { 30.0 } else { -0.9 };
            assert!(!faults(&cells[index], &bad, orthographic).is_empty(), "value {k} of {good:?}");
        }
    }
}

#[test]
fn flat_cells_are_hidden_and_near_ones_keep_their_planes() {
    let flat = [[0.0, 0.0, 2.0], [0.5, 0.0, 3.0], [1.0, 0.0, 4.0], [-0.5, 0.0, 3.0]];
    let near = [[0.0, 0.0, 0.25], [1.0, 0.0, 2.0], [0.0, 1.0, 2.0], [-1.0, 0.5, 3.0]];
    let inputs: Vec<f32> = [flat, near].iter().flatten().flat_map(|p| [p[0], p[1], p[2], 0.5]).collect();
    let outputs = run(&source(false), &[Bound::Uniform(0, 0, &view())], &inputs, 2, 20);
    assert_eq!(outputs[19], 0.0, "seen edge-on as a whole: hidden");
    assert_ne!(outputs[39], THICK);
    assert_ne!(outputs[39], 0.0);
}
