use super::*;
use crate::accuracy::{POINTS, Random, SETS, measure};
use crate::testing::{assert_same_functions, assert_valid_shader, numbers_of, shader_constant};

const SHADER: &str = include_str!("../../../../shaders/lib/segment.wgsl");

/// Relative error of the weights against f64; the fits alone have 4.2e-6.
const RELATIVE: f64 = 1e-5;

/// Absolute error of the weights against f64.
const ABSOLUTE: f64 = 2e-6;

#[test]
fn direct_weights_keep_their_error_in_every_regime() {
    for set in &SETS {
        let measured = measure(set, POINTS, weights_direct);
        println!("{}: {measured:?}", set.name);
        assert!(measured.relative <= RELATIVE && measured.absolute <= ABSOLUTE, "{}: {measured:?}", set.name);
        for (a, b) in set.points(POINTS) {
            let [alpha, back, front] = weights_direct(a, b);
            // One rounding of each product and of their sum.
            assert!((back + front - alpha).abs() <= 2.0 * f32::EPSILON * alpha, "{a} {b}");
        }
    }
}

#[test]
fn any_input_gives_finite_weights() {
    let inputs = [
        0.0,
        -0.0,
        1e-45,
        1e-40,
        f32::MIN_POSITIVE,
        1e-30,
        1e-7,
        1.0,
        3.0,
        1e6,
        1e14,
        1e15,
        1e16,
        f32::MAX,
        f32::INFINITY,
        f32::NEG_INFINITY,
        f32::NAN,
        -f32::NAN,
        -1.0,
        -1e-40,
    ];
    for a in inputs {
        for b in inputs {
            for [alpha, back, front] in [weights_direct(a, b), weights_average(a, b)] {
                let all = [alpha, back, front];
                assert!(all.iter().all(|w| (0.0..=1.0).contains(w)), "({a}, {b}): {all:?}");
                // Roundings of each product and of their sum; of denormals, units of the last place.
                let rounding = 2.0 * f32::EPSILON * alpha + 3.0 * f32::from_bits(1);
                assert!((back + front - alpha).abs() <= rounding, "({a}, {b}): {all:?}");
            }
            assert_eq!(weights_direct(a, b), weights_direct(clean(a), clean(b)));
        }
    }
}

#[test]
fn empty_and_opaque_limits() {
    for nothing in [0.0, -0.0, -1.0, f32::NAN, f32::NEG_INFINITY] {
        assert_eq!(weights_direct(nothing, nothing), [0.0; 3]);
        assert_eq!(weights_average(nothing, nothing), [0.0; 3]);
    }
    // An infinite back end: q tends to sqrt(pi / (2 a)), at a = 1e15 4.0e-8; an infinite front end: 1 / b.
    let [alpha, back, front] = weights_direct(f32::INFINITY, 0.0);
    assert!(alpha == 1.0 && front >= 1.0 - f32::EPSILON && (back / 3.963_327e-8 - 1.0).abs() < 1e-5, "{back}");
    let [alpha, back, front] = weights_direct(0.0, f32::INFINITY);
    assert!(alpha == 1.0 && front == 1.0 && (back / 1e-15 - 1.0).abs() < 1e-5, "{back}");
    // Thin: w_b = a / 3 + b / 6.
    assert_eq!(weights_average(0.2, 0.4)[1], 0.5 * opacity(0.3));
    let [_, back, front] = weights_direct(6e-20, 0.0);
    assert!((back / 2e-20 - 1.0).abs() < 1e-5 && (front / 1e-20 - 1.0).abs() < 1e-5);
}

#[test]
fn opacity_keeps_relative_accuracy() {
    let mut random = Random::new(1);
    for _ in 0..20_000 {
        let x = random.decades(-37.0, 3.0);
        let exact = -(-f64::from(x)).exp_m1();
        // A few roundings of the series; of 1 - exp(-x) from 0.25 on.
        assert!((f64::from(opacity(x)) / exact - 1.0).abs() < 5e-7, "{x}");
    }
}

#[test]
fn shader_and_twin_have_the_same_constants() {
    assert_eq!(shader_constant(SHADER, "Q_SMALL"), Q_SMALL.concat());
    assert_eq!(shader_constant(SHADER, "ERFCX_P"), ERFCX_P);
    assert_eq!(shader_constant(SHADER, "ERFCX_Q"), ERFCX_Q);
    assert_eq!(shader_constant(SHADER, "DAWSON_P"), DAWSON_P);
    assert_eq!(shader_constant(SHADER, "DAWSON_Q"), DAWSON_Q);
    assert_eq!(shader_constant(SHADER, "SQRT_PI"), [SQRT_PI]);
    assert_eq!(shader_constant(SHADER, "MAX_DEPTH"), [MAX_DEPTH]);
    // The last digit of the last coefficient changed.
    let changed = SHADER.replace("1.4655121e-6", "1.4655123e-6");
    assert_ne!(shader_constant(&changed, "Q_SMALL"), Q_SMALL.concat());
}

#[test]
fn shader_and_twin_have_the_same_functions() {
    assert_same_functions(SHADER, include_str!("../segment_f32.rs"));
    let changed = SHADER.replace("3.0 * (1.0 - x / 4.0", "3.0 * (1.0 - x / 5.0");
    assert_ne!(numbers_of(&changed, "opacity"), numbers_of(SHADER, "opacity"));
}

#[test]
fn the_shader_is_valid() {
    assert_valid_shader(&[SHADER]);
}
