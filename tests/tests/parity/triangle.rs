//! Interpolation over triangles, judged by what must hold of it: the shares are those of which the place is the mean.

use glam::DVec2;
use tetlux_shaders::{DEFAULTS, compose};
use tetlux_tests::Random;

use crate::device::run;

const TEST: &str = "
fn place_at(i: u32) -> vec2<f32> {
    return bitcast<vec2<f32>>(vec2<u32>(inputs[i], inputs[i + 1u]));
}

fn row(i: u32) {
    let shares = shares_of(place_at(8u * i), place_at(8u * i + 2u), place_at(8u * i + 4u), place_at(8u * i + 6u));
    for (var k = 0u; k < 3u; k++) {
        outputs[3u * i + k] = bitcast<u32>(shares[k]);
    }
}
";

/// Shares of places within a triangle and a triangle's width beside it, to single precision.
const TOLERANCE: f64 = 1e-5;

/// Whether shares are those of a place in a triangle.
fn balance(place: DVec2, corners: [DVec2; 3], shares: &[f32]) -> bool {
    let shares = [0, 1, 2].map(|k| f64::from(shares[k]));
    let mean: DVec2 = corners.iter().zip(shares).map(|(&corner, share)| corner * share).sum();
    let size = corners.iter().map(|c| c.length()).fold(0.0, f64::max);
    (shares.iter().sum::<f64>() - 1.0).abs() < TOLERANCE && mean.distance(place) < TOLERANCE * size
}

#[test]
fn shares_balance_at_the_place() {
    let mut random = Random::new(17);
    let rows = 20_000;
    let triangles: Vec<[DVec2; 4]> = (0..rows)
        .map(|i| {
            let size = 10f64.powf(random.between(-1.0, 3.0));
            let mut corners = [[0.0, 0.0], [1.0, 0.2], [-0.1, 0.9]].map(|[x, y]| {
                let jitter = DVec2::new(random.between(-0.2, 0.2), random.between(-0.2, 0.2));
                ((DVec2::new(x, y) + jitter) * size).as_vec2().as_dvec2()
            });
            // Either way round.
            corners.rotate_left(i % 3);
            if i % 2 == 0 {
                corners.swap(0, 1);
            }
            let place = DVec2::new(random.between(-0.5, 1.0), random.between(-0.5, 1.0)) * size;
            [place.as_vec2().as_dvec2(), corners[0], corners[1], corners[2]]
        })
        .collect();
    let flat = [DVec2::ZERO, DVec2::ONE, DVec2::splat(2.0), DVec2::splat(3.0)];
    let inputs: Vec<f32> = triangles.iter().chain([&flat]).flatten().flat_map(|p| p.as_vec2().to_array()).collect();
    let source = compose("lib::triangle", DEFAULTS).unwrap() + TEST;
    // The view is not looked at, but bound where it is declared.
    let found = run(&source, &[], &inputs, rows + 1, 3);
    for ([place, a, b, c], shares) in triangles.iter().zip(found.chunks_exact(3)) {
        assert!(balance(*place, [*a, *b, *c], shares), "{place} in {a} {b} {c}: {shares:?}");
    }
    assert!(found[3 * rows..].iter().all(|&share| share == -1.0), "no area, no shares: {:?}", &found[3 * rows..]);
    // Planted: shares of another vertex.
    let [place, a, b, c] = triangles[5];
    assert!(!balance(place, [b, a, c], &found[15..18]));
}
