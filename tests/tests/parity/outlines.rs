//! Which rectangles of pixels a cell's outline reaches into: never one too few, and none that an edge parts from it.

use tetlux_shaders::{DEFAULTS, compose};
use tetlux_tests::Random;

use crate::device::run;

const TEST: &str = "
fn number(i: u32, k: u32) -> f32 {
    return bitcast<f32>(inputs[12u * i + k]);
}

fn row(i: u32) {
    var corners: array<vec2<f32>, 4>;
    for (var k = 0u; k < 4u; k++) {
        corners[k] = vec2<f32>(number(i, 2u * k), number(i, 2u * k + 1u));
    }
    let first = vec2<u32>(vec2<f32>(number(i, 8u), number(i, 9u)));
    let size = vec2<u32>(vec2<f32>(number(i, 10u), number(i, 11u)));
    outputs[i] = bitcast<u32>(select(0.0, 1.0, reaches(corners, first, size)));
}
";

/// Pixels within which single precision may take a place for the other side of an edge: positions up to a thousand.
const UNSURE: f64 = 1e-3;

/// A triangle, its last corner twice, or a rectangle at an angle; either way round.
fn outline(random: &mut Random) -> [[f32; 2]; 4] {
    let middle = [random.between(0.0, 900.0), random.between(0.0, 900.0)];
    let (turn, sense) = (random.between(0.0, std::f64::consts::TAU), if random.below(2) == 0 { 1.0 } else { -1.0 });
    let [long, wide] = [random.between(0.05, 60.0), random.between(0.05, 60.0)];
    let corner = |u: f64, v: f64| {
        let (u, v) = (u * long, sense * v * wide);
        [middle[0] + u * turn.cos() - v * turn.sin(), middle[1] + u * turn.sin() + v * turn.cos()].map(|p| p as f32)
    };
    match random.below(2) {
        0 => [corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)],
        _ => [corner(-1.0, -1.0), corner(1.0, -0.7), corner(0.3, 1.0), corner(0.3, 1.0)],
    }
}

/// For each edge how far a place lies on its inner side, in pixels.
fn depths(corners: &[[f32; 2]; 4], at: [f64; 2]) -> Vec<f64> {
    let c = corners.map(|corner| corner.map(f64::from));
    let cross = |a: [f64; 2], b: [f64; 2]| a[0] * b[1] - a[1] * b[0];
    let from = |a: [f64; 2], b: [f64; 2]| [b[0] - a[0], b[1] - a[1]];
    let area = cross(from(c[0], c[1]), from(c[0], c[2])) + cross(from(c[0], c[2]), from(c[0], c[3]));
    let edges = (0..4).map(|k| (c[k], from(c[k], c[(k + 1) % 4]))).filter(|(_, e)| e[0].hypot(e[1]) > 0.0);
    edges.map(|(a, e)| area.signum() * cross(e, from(a, at)) / e[0].hypot(e[1])).collect()
}

#[test]
fn no_pixel_inside_is_missed() {
    let mut random = Random::new(17);
    let rows: Vec<([[f32; 2]; 4], [u32; 4])> = (0..60_000)
        .map(|_| {
            let corners = outline(&mut random);
            let side = [[4, 2], [16, 16], [1, 1]][random.below(3)];
            // Near the outline, for the most part.
            let first = corners[0].map(|p| (f64::from(p) + random.between(-60.0, 60.0)).max(0.0) as u32);
            (corners, [first[0], first[1], side[0], side[1]])
        })
        .collect();
    let numbers = |(corners, place): &([[f32; 2]; 4], [u32; 4])| {
        corners.iter().flatten().copied().chain(place.map(|n| n as f32)).collect::<Vec<f32>>()
    };
    let inputs: Vec<f32> = rows.iter().flat_map(numbers).collect();
    let found = run(&(compose("lib::tiles", DEFAULTS).unwrap() + TEST), &[], &inputs, rows.len(), 1);
    let (mut inside, mut apart) = (0, 0);
    for ((corners, [x, y, width, height]), found) in rows.iter().zip(found) {
        let centers: Vec<[f64; 2]> = (*y..y + height)
            .flat_map(|v| (*x..x + width).map(move |u| [f64::from(u) + 0.5, f64::from(v) + 0.5]))
            .collect();
        let all: Vec<Vec<f64>> = centers.iter().map(|&at| depths(corners, at)).collect();
        if all.iter().any(|depths| depths.iter().all(|&depth| depth > UNSURE)) {
            inside += 1;
            assert_eq!(found, 1.0, "{corners:?} holds a pixel of {x}, {y}, {width} x {height}");
        } else if (0..all[0].len()).any(|edge| all.iter().all(|depths| depths[edge] < -UNSURE)) {
            apart += 1;
            assert_eq!(found, 0.0, "an edge of {corners:?} parts it from {x}, {y}, {width} x {height}");
        }
    }
    // Both happen often: an answer that is always the same fails.
    assert!(inside > 5_000 && apart > 5_000, "{inside}, {apart}");
}
