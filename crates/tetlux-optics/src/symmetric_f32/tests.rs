use super::*;
use crate::accuracy::{POINTS, SETS, measure, relative_error};
use crate::segment::weights;
use crate::testing::{assert_same_functions, assert_valid_shader, numbers_of, shader_constant};

const SHADER: &str = include_str!("../../../../shaders/lib/symmetric.wgsl");
const SEGMENT: &str = include_str!("../../../../shaders/lib/segment.wgsl");

/// Absolute error of alpha and of the weights: half the fit's 5.2e-6, and roundings.
const ABSOLUTE: f64 = 3e-6;

/// Relative error: half the fit's 5.2e-6, where w_b is a small share of alpha.
const RELATIVE: f64 = 2e-5;

#[test]
fn symmetric_weights_keep_their_error_in_every_regime() {
    for set in &SETS {
        let measured = measure(set, POINTS, weights_symmetric);
        println!("{}: {measured:?}", set.name);
        assert!(measured.relative <= RELATIVE && measured.absolute <= ABSOLUTE, "{}: {measured:?}", set.name);
    }
}

type Fit = fn(f32, f32) -> f32;

#[test]
fn each_fit_has_its_stated_error() {
    let fits: [(Fit, f32, f64); 3] = [(shift_8, 0.5, 8.9e-7), (shift_15, 1.0, 1.9e-8), (shift_19, 3.0, 5.3e-6)];
    for (fit, x_max, stated) in fits {
        let mut worst = 0.0_f64;
        for i in 1..=300_i16 {
            for j in -50..=50_i16 {
                let x = x_max * f32::from(i) / 300.0;
                let e = x * f32::from(j) / 50.0;
                let (a, b) = (x + e, x - e);
                let exact = weights(f64::from(a), f64::from(b));
                let (x, e) = (0.5 * (a + b), 0.5 * (a - b));
                let difference = f64::from(fit(x * x, e)) * (-0.5 * f64::from(x)).exp();
                worst = worst.max((difference - (exact.back - exact.front)).abs() / exact.alpha);
            }
        }
        println!("{x_max}: {worst:.2e}");
        // And a few roundings of a sum of terms up to its own size, and of a and b.
        assert!(worst < stated + 8.0 * f64::from(f32::EPSILON), "{x_max}: {worst:.2e}");
        assert!(worst > 0.1 * stated, "a planted zero would be seen: {x_max}: {worst:.2e}");
    }
}

#[test]
fn pieces_and_the_direct_form_meet() {
    // On both sides of the thin form's end and of the last cut.
    for (a, b) in [(6.0, 0.0), (0.0, 6.0), (3.0, 3.0), (24.0, 24.0), (24.0, 0.0), (0.0, 24.0), (24.0, 12.0)] {
        for scale in [0.9999, 1.0, 1.0001] {
            let (a, b) = (a * scale, b * scale);
            let exact = weights(f64::from(a), f64::from(b));
            let [alpha, back, front] = weights_symmetric(a, b);
            for (value, expected) in [(alpha, exact.alpha), (back, exact.back), (front, exact.front)] {
                assert!((f64::from(value) - expected).abs() <= ABSOLUTE, "{a} {b}: {value} {expected}");
            }
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
        1e-30,
        1e-7,
        1.0,
        5.999,
        6.0,
        23.99,
        24.01,
        1e6,
        1e15,
        f32::MAX,
        f32::INFINITY,
        f32::NEG_INFINITY,
        f32::NAN,
        -1.0,
    ];
    for a in inputs {
        for b in inputs {
            let [alpha, back, front] = weights_symmetric(a, b);
            // A rounding above 1 at most.
            let unit = 0.0..=1.0 + f32::EPSILON;
            assert!([alpha, back, front].iter().all(|w| unit.contains(w)), "({a}, {b}): {alpha} {back} {front}");
            let rounding = 8.0 * f32::EPSILON * alpha + 3.0 * f32::from_bits(1);
            assert!((back + front - alpha).abs() <= rounding, "({a}, {b}): {alpha} {back} {front}");
        }
    }
    assert_eq!(weights_symmetric(f32::NAN, -1.0), [0.0; 3]);
    assert!(relative_error(f64::from(weights_symmetric(6e-20, 0.0)[1]), 2e-20) < 1e-5);
}

#[test]
fn shader_and_twin_are_the_same() {
    let constants: [(&str, &[f32]); 13] = [
        ("SHIFT_8_0", &SHIFT_8_0),
        ("SHIFT_8_1", &SHIFT_8_1),
        ("SHIFT_8_2", &[SHIFT_8_2]),
        ("SHIFT_15_0", &SHIFT_15_0),
        ("SHIFT_15_1", &SHIFT_15_1),
        ("SHIFT_15_2", &SHIFT_15_2),
        ("SHIFT_15_3", &[SHIFT_15_3]),
        ("SHIFT_19_0", &SHIFT_19_0),
        ("SHIFT_19_1", &SHIFT_19_1),
        ("SHIFT_19_2", &SHIFT_19_2),
        ("SHIFT_19_3", &SHIFT_19_3),
        ("TWO_SINH_HALF", &TWO_SINH_HALF),
        ("MAX_CUT", &[MAX_CUT]),
    ];
    assert_eq!(SHADER.matches("\nconst ").count(), constants.len());
    for (name, ours) in constants {
        assert_eq!(shader_constant(SHADER, name), ours, "{name}");
    }
    assert_same_functions(SHADER, include_str!("../symmetric_f32.rs"));
    assert_valid_shader(&[SEGMENT, SHADER]);
    let changed = SHADER.replace("back + front <= 6.0", "back + front <= 7.0");
    assert_ne!(numbers_of(&changed, "weights_symmetric"), numbers_of(SHADER, "weights_symmetric"));
}

#[test]
fn coefficients_are_the_reference_fits() {
    let path = format!("{}/../../../shared/reference/symmetric_coefficients.json", env!("CARGO_MANIFEST_DIR"));
    let Ok(text) = std::fs::read_to_string(path) else {
        println!("symmetric_coefficients: the reference set is absent");
        return;
    };
    let file: serde_json::Value = serde_json::from_str(&text).unwrap();
    let ours = [
        (0.5, 8, [&SHIFT_8_0[..], &SHIFT_8_1, &[SHIFT_8_2]].concat()),
        (1.0, 15, [&SHIFT_15_0[..], &SHIFT_15_1, &SHIFT_15_2, &[SHIFT_15_3]].concat()),
        (3.0, 19, [&SHIFT_19_0[..], &SHIFT_19_1, &SHIFT_19_2, &SHIFT_19_3].concat()),
    ];
    for (x_max, count, ours) in ours {
        let fits = file["fits"].as_array().unwrap();
        let matching = |fit: &&serde_json::Value| {
            fit["x_max"].as_f64() == Some(x_max) && fit["terms"].as_array().unwrap().len() == count
        };
        let terms = fits.iter().find(matching).unwrap()["terms"].as_array().unwrap();
        let theirs: Vec<f32> = terms.iter().map(|term| term[2].as_f64().unwrap() as f32).collect();
        assert_eq!(ours, theirs);
    }
}
