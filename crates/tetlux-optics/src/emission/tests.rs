use proptest::prelude::*;

use super::*;
use crate::accuracy::relative_error;
use crate::segment::{psi, segment_with, zeta};
use crate::transfer::{ColorNode, OpacityNode, TransferFunction};

/// Relative error that every f64 quantity keeps.
const TOLERANCE: f64 = 1e-12;

#[test]
fn closed_forms_where_they_do_not_cancel() {
    for (a, b) in [(8.0, 3.0), (0.5, 7.0), (40.0, 20.0), (3.0, 0.0)] {
        let (alpha, psi) = (1.0 - zeta(a, b), psi(a, b));
        let weights = density_weights(a, b);
        // The quotients lose a digit or two.
        assert!(relative_error(weights.back, (alpha - b * psi) / (a - b)) < 1e-13, "{a} {b}");
        assert!(relative_error(weights.front, (a * psi - alpha) / (a - b)) < 1e-13, "{a} {b}");
    }
    // Constant extinction: int_0^1 u exp(-x u) du = (1 - (1 + x) exp(-x)) / x^2.
    let x = 5.0_f64;
    let back = (1.0 - (1.0 + x) * (-x).exp()) / (x * x);
    assert!(relative_error(density_weights(x, x).back, back) < 1e-14);
}

#[test]
fn limits_and_unclean_inputs() {
    for nothing in [0.0, -1.0, f64::NAN, 1e-320] {
        let weights = density_weights(nothing, nothing);
        assert!((weights.back - 0.5).abs() < 1e-15 && (weights.front - 0.5).abs() < 1e-15);
        assert!((q_e(nothing, nothing) - 0.5).abs() < 1e-15);
    }
    for (a, b) in [(f64::INFINITY, 0.0), (0.0, f64::INFINITY), (f64::INFINITY, f64::INFINITY)] {
        let weights = density_weights(a, b);
        assert!(weights.back > 0.0 && weights.back < 1e-70 && weights.front > 0.0 && weights.front < 1e-70);
    }
    // Dense front: m_b -> 1 / b^2, m_f -> 1 / b.
    let weights = density_weights(0.0, 1e9);
    assert!(relative_error(weights.back, 1e-18) < 1e-8 && relative_error(weights.front, 1e-9) < 1e-8);
}

#[test]
fn the_average_model_has_the_stated_error() {
    // b = 0, thin: w_b is 2/3 alpha instead of 1/2.
    let thin = weights_average(1e-6, 0.0);
    assert!(relative_error(crate::segment::weights(1e-6, 0.0).back - thin.back, thin.alpha / 6.0) < 1e-5);
    let thick = weights_average(100.0, 100.0);
    assert_eq!(thick.alpha, crate::segment::weights(100.0, 100.0).alpha);
    assert!(crate::segment::weights(100.0, 100.0).front - thick.front > 0.48);
}

#[test]
fn empty_space_glows_only_as_an_emission_density() {
    let tf = TransferFunction::new(
        vec![ColorNode { s: 0.0, rgb: [1.0, 0.0, 0.0] }, ColorNode { s: 1.0, rgb: [0.0, 1.0, 0.0] }],
        vec![OpacityNode { s: 0.0, opacity: 0.0 }],
    )
    .unwrap();
    let color = |convention| segment_with(&tf, 1.0, 0.0, 1.0, 4.0, convention).color;
    assert_eq!(color(EmissionConvention::EmissionAbsorption), [0.0; 3]);
    let glow = color(EmissionConvention::EmissionDensity);
    // Mean emission of each channel 1/2 over length 4.
    assert!((glow[0] - 2.0).abs() < 1e-14 && (glow[1] - 2.0).abs() < 1e-14 && glow[2] == 0.0, "{glow:?}");
}

proptest! {
    #[test]
    fn the_weights_share_psi(exponents in prop::array::uniform2(-20.0_f64..8.0)) {
        let [a, b] = exponents.map(|exponent| 10.0_f64.powf(exponent));
        let weights = density_weights(a, b);
        prop_assert!(relative_error(weights.back + weights.front, psi(a, b)) <= TOLERANCE);
        // Rounding of the thin limit 1/2.
        prop_assert!(weights.back > 0.0 && weights.back <= weights.front * (1.0 + 1e-14));
    }
}
