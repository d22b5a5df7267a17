//! Reversing a ray through what only absorbs changes nothing: in pictures, and in the integral of a segment.

use tetlux_optics::segment::weights;
use tetlux_optics::segment_f32::weights_direct;
use tetlux_optics::symmetric_f32::weights_symmetric;
use tetlux_optics::transfer_f32::{Weights, integrate, pieces};
use tetlux_tests::twins::reversing;
use tetlux_tests::{Random, Recipe, range_of};

use crate::{SEEDS, assert_same};

#[test]
fn parallel_views() {
    assert_same("from behind", reversing::parallel, 0..SEEDS);
}

#[test]
fn rays_of_perspective() {
    assert_same("rays", reversing::ray, 0..5 * SEEDS);
}

#[test]
fn the_ends_of_a_segment() {
    let mut random = Random::new(8);
    let mut depth = || 10f64.powf(random.between(-12.0, 12.0));
    for _ in 0..20_000 {
        let (a, b) = (depth(), depth());
        // The optical depth is a sum, and opacity depends on nothing else.
        assert_eq!(weights(a, b).alpha, weights(b, a).alpha, "{a} {b}");
        let (a, b) = (a as f32, b as f32);
        assert_eq!(weights_direct(a, b)[0], weights_direct(b, a)[0], "direct: {a} {b}");
        let [there, back] = [(a, b), (b, a)].map(|(a, b)| weights_symmetric(a, b)[0]);
        // Beyond an optical depth of 3 it is composited from parts, which lie elsewhere the other way.
        let same = if a + b > 6.0 { (there - back).abs() <= ROUNDING * there } else { there == back };
        assert!(same, "symmetric: {a} {b}: {there}, back {back}");
    }
}

/// Relative: each of up to a dozen parts of a segment has cuts, depths and opacity in single precision.
const ROUNDING: f32 = 1e-5;

#[test]
fn the_ends_of_a_segment_through_a_transfer_function() {
    let mut random = Random::new(9);
    for seed in 0..40 {
        let recipe = Recipe::random(seed, 1);
        let pieces = pieces(recipe.transfer(), range_of(&recipe.field), 1.0);
        let all = [0, pieces.len() - 1];
        for _ in 0..100 {
            let [s, t] = [0; 2].map(|_| random.between(0.0, 1.0) as f32);
            let length = 10f64.powf(random.between(-6.0, 2.0)) as f32;
            let alpha = |s, t| integrate(&pieces, all, Weights::Direct, s, t, length)[3];
            let [there, back] = [alpha(s, t), alpha(t, s)];
            let same = |back: f32| (there - back).abs() <= ROUNDING * there;
            assert!(same(back), "seed {seed}, from {s} to {t}: {there}, back {back}");
            assert!(there == 0.0 || !same(back * 1.001), "a difference would be found");
        }
    }
}
