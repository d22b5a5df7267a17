use super::*;
use crate::accuracy::{SETS, measure};
use crate::testing::{assert_same_functions, assert_valid_shader, shader_constant};

const SHADER: &str = include_str!("../../../../shaders/lib/published.wgsl");
const SEGMENT: &str = include_str!("../../../../shaders/lib/segment.wgsl");

#[test]
fn it_is_right_where_nothing_cancels() {
    for (a, b) in [(5.0, 1.0), (1.0, 5.0), (20.0, 0.5), (3.0, 3.0), (0.0, 8.0), (8.0, 0.0)] {
        let exact = crate::segment::weights(f64::from(a), f64::from(b));
        let [alpha, back, front] = linear_published(a, b);
        for (value, expected) in [(alpha, exact.alpha), (back, exact.back), (front, exact.front)] {
            // The fits of erfcx and Dawson's integral, and a digit of cancellation.
            assert!((f64::from(value) - expected).abs() < 2e-5, "{a} {b}: {value} {expected}");
        }
    }
}

#[test]
fn it_fails_in_the_regimes_it_is_known_for() {
    let measured = SETS.map(|set| measure(&set, 2000, linear_published));
    for (set, measured) in SETS.iter().zip(&measured) {
        println!("{}: {measured:?}", set.name);
    }
    // Nearly equal inputs: wrong by all the light; usual ones by much of it.
    assert!(measured[1].absolute > 0.9 && measured[4].absolute > 0.3, "{measured:?}");
    // Log-uniform, thin, one end empty: no relative accuracy.
    assert!([0, 3, 8].iter().all(|&index| measured[index].relative > 1e4), "{measured:?}");
    // Dense, or with a dense front: powers overflow, and nothing is left of w_b.
    assert!([6, 7].iter().all(|&index| measured[index].relative >= 1.0), "{measured:?}");
    // A dense back end is the regime it is good in.
    assert!(measured[5].relative < 1e-4, "{:?}", measured[5]);
}

#[test]
fn any_input_gives_finite_weights() {
    let inputs = [0.0, 1e-45, 1e-30, 1e-7, 1.0, 3.0, 1e6, 1e15, f32::MAX, f32::INFINITY, f32::NAN, -1.0];
    for a in inputs {
        for b in inputs.into_iter().chain([a * (1.0 + 1e-6)]) {
            let weights = linear_published(a, b);
            assert!(weights.iter().all(|w| (0.0..=1.0).contains(w)), "({a}, {b}): {weights:?}");
        }
    }
    assert_eq!(linear_published(0.0, f32::NAN)[0], 0.0);
}

#[test]
fn shader_and_twin_are_the_same() {
    assert_eq!(shader_constant(SHADER, "MAX_EXPONENT"), [MAX_EXPONENT]);
    assert_eq!(shader_constant(SHADER, "ROOT_PI"), [ROOT_PI]);
    assert_eq!(shader_constant(SHADER, "TWO_OVER_ROOT_PI"), [TWO_OVER_ROOT_PI]);
    assert_same_functions(SHADER, include_str!("../published_f32.rs"));
    assert_valid_shader(&[SEGMENT, SHADER]);
}
