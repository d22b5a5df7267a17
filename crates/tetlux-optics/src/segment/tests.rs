use proptest::prelude::*;
use serde_json::Value;

use super::*;
use crate::transfer::{ColorNode, OpacityNode};

/// Relative error that every f64 quantity keeps.
const TOLERANCE: f64 = 1e-12;

/// All cases of a file of 50-digit reference values, or the extract of it that lies beside the tests.
fn cases(name: &str, extract: &str) -> Vec<Value> {
    let path = format!("{}/../../../shared/reference/{name}.json", env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(&path).unwrap_or_else(|_| {
        println!("{name}: the full reference set is absent, using the extract");
        extract.to_owned()
    });
    let file: Value = serde_json::from_str(&text).unwrap();
    let cases = file["cases"].as_array().unwrap().clone();
    assert!(!cases.is_empty());
    cases
}

/// Infinite where NaN, so that it wins over every finite error.
fn relative_error(value: f64, expected: f64) -> f64 {
    let error = if value == expected { 0.0 } else { ((value - expected) / expected).abs() };
    if error.is_nan() { f64::INFINITY } else { error }
}

#[derive(Default)]
struct Worst(Vec<(&'static str, f64, String)>);

impl Worst {
    fn see(&mut self, name: &'static str, value: f64, expected: f64, case: &Value) {
        let error = relative_error(value, expected);
        match self.0.iter_mut().find(|entry| entry.0 == name) {
            Some(entry) if error <= entry.1 => {}
            Some(entry) => *entry = (name, error, case.to_string()),
            None => self.0.push((name, error, case.to_string())),
        }
    }

    fn holds(&self, tolerance: f64) -> bool {
        self.0.iter().all(|entry| entry.1 <= tolerance)
    }

    fn check(&self) {
        for (name, error, case) in &self.0 {
            println!("{name}: {error:.2e} at {case}");
        }
        assert!(!self.0.is_empty() && self.holds(TOLERANCE), "{:#?}", self.0);
    }
}

#[test]
fn the_comparison_sees_a_planted_difference() {
    let case = Value::Null;
    for wrong in [1.0 + 2.0 * TOLERANCE, -1.0, f64::NAN, f64::INFINITY] {
        let mut worst = Worst::default();
        worst.see("w", 1.0, 1.0, &case);
        assert!(worst.holds(TOLERANCE));
        worst.see("w", wrong, 1.0, &case);
        worst.see("w", 1.0, 1.0, &case);
        assert!(!worst.holds(TOLERANCE), "{wrong}");
    }
}

#[test]
fn weights_agree_with_the_reference() {
    let mut worst = Worst::default();
    for case in cases("psi", include_str!("../../tests/fixtures/psi.json")) {
        let get = |name: &str| case[name].as_f64();
        let (a, b) = (get("a").unwrap(), get("b").unwrap());
        let weights = weights(a, b);
        worst.see("alpha", weights.alpha, get("alpha").unwrap(), &case);
        worst.see("w_b", weights.back, get("w_b").unwrap(), &case);
        worst.see("w_f", weights.front, get("w_f").unwrap(), &case);
        worst.see("zeta", zeta(a, b), get("zeta").unwrap(), &case);
        worst.see("psi", psi(a, b), get("psi").unwrap(), &case);
        if let Some(expected) = get("q") {
            worst.see("q", q(a, b), expected, &case);
        }
    }
    worst.check();
}

#[test]
fn single_segments_agree_with_the_reference() {
    let mut worst = Worst::default();
    for case in cases("segment", include_str!("../../tests/fixtures/segment.json")) {
        let get = |name: &str| case[name].as_f64().unwrap();
        let length = get("length");
        let (a, b) = (get("tau_b") * length, get("tau_f") * length);
        let weights = weights(a, b);
        let light = get("I_0") * zeta(a, b) + get("L_b") * weights.back + get("L_f") * weights.front;
        worst.see("transmittance", zeta(a, b), get("transmittance"), &case);
        worst.see("psi", psi(a, b), get("psi"), &case);
        worst.see("I_D", light, get("I_D"), &case);
    }
    worst.check();
}

#[test]
fn segments_through_transfer_functions_agree_with_the_reference() {
    let mut worst = Worst::default();
    for case in cases("piecewise_linear_tf", include_str!("../../tests/fixtures/piecewise_linear_tf.json")) {
        let list = |value: &Value| -> Vec<f64> {
            value.as_array().unwrap().iter().map(|number| number.as_f64().unwrap()).collect()
        };
        let (s, tau) = (list(&case["s"]), list(&case["tau"]));
        let light: Vec<_> = case["L"].as_array().unwrap().iter().map(list).collect();
        // A power of two as unit distance: opacity and back again without rounding.
        let unit_distance = 4.0;
        let nodes = 0..s.len();
        let color = nodes.clone().map(|i| ColorNode { s: s[i], rgb: [light[i][0], light[i][1], light[i][2]] });
        let opacity = nodes.map(|i| OpacityNode { s: s[i], opacity: tau[i] * unit_distance });
        let tf = TransferFunction::new(color.collect(), opacity.collect()).unwrap();
        let get = |name: &str| case[name].as_f64().unwrap();
        let result = segment(&tf, unit_distance, get("s_f"), get("s_b"), get("length"));
        worst.see("transmittance", result.transmittance, get("transmittance"), &case);
        for (channel, expected) in list(&case["C"]).into_iter().enumerate() {
            worst.see("C", result.color[channel], expected, &case);
        }
    }
    worst.check();
}

#[test]
fn the_quadrature_is_exact_for_its_degree() {
    // Twenty nodes integrate u^k over [0, 1] exactly up to k = 39.
    for power in 0..40 {
        let mut sum = 0.0;
        for [node, weight] in QUADRATURE {
            sum += 0.5 * weight * ((0.5 - 0.5 * node).powi(power) + (0.5 + 0.5 * node).powi(power));
        }
        let exact = 1.0 / f64::from(power + 1);
        // Rounding of nodes, grown by the power.
        assert!(relative_error(sum, exact) < 1e-14, "u^{power}: {sum}");
    }
}

#[test]
fn limits_and_unclean_inputs() {
    assert_eq!(weights(0.0, 0.0), Weights { alpha: 0.0, back: 0.0, front: 0.0 });
    assert_eq!(weights(f64::NAN, -1.0), weights(0.0, 0.0));
    assert_eq!((zeta(0.0, 0.0), psi(0.0, 0.0), q(0.0, 0.0)), (1.0, 1.0, 0.5));
    assert_eq!(q(1e-320, 0.0), 2.0 / 3.0);
    for (a, b) in [(f64::INFINITY, 0.0), (0.0, f64::INFINITY), (f64::INFINITY, f64::INFINITY), (f64::MAX, 1.0)] {
        let weights = weights(a, b);
        assert!(weights.alpha == 1.0 && weights.front == 1.0, "{weights:?}");
        assert!(weights.back >= 0.0 && weights.back < 1e-70, "{weights:?}");
    }
}

#[test]
fn a_step_in_opacity_splits_the_segment() {
    // Opacity 1 with red below s = 0.5, opacity 3 with green above: closed forms of two homogeneous halves.
    let tf = TransferFunction::new(
        vec![ColorNode { s: 0.5, rgb: [1.0, 0.0, 0.0] }, ColorNode { s: 0.5, rgb: [0.0, 1.0, 0.0] }],
        vec![OpacityNode { s: 0.5, opacity: 1.0 }, OpacityNode { s: 0.5, opacity: 3.0 }],
    )
    .unwrap();
    let (thin, thick) = (-(-1.0_f64).exp_m1(), -(-3.0_f64).exp_m1());
    let rising = segment(&tf, 1.0, 0.0, 1.0, 2.0);
    let falling = segment(&tf, 1.0, 1.0, 0.0, 2.0);
    for (result, expected) in
        [(rising, [thin, (-1.0_f64).exp() * thick, 0.0]), (falling, [(-3.0_f64).exp() * thin, thick, 0.0])]
    {
        assert!(relative_error(result.transmittance, (-4.0_f64).exp()) < TOLERANCE);
        for channel in 0..3 {
            assert!(relative_error(result.color[channel], expected[channel]) < TOLERANCE, "{result:?}");
        }
    }
    // A segment that only touches the step lies on one side of it.
    assert!(relative_error(segment(&tf, 1.0, 0.0, 0.5, 1.0).alpha, thin) < TOLERANCE);
    assert!(relative_error(segment(&tf, 1.0, 0.5, 1.0, 1.0).alpha, thick) < TOLERANCE);
}

fn depth() -> impl Strategy<Value = f64> {
    prop_oneof![Just(0.0), (-40.0_f64..8.0).prop_map(|exponent| 10.0_f64.powf(exponent))]
}

proptest! {
    #[test]
    fn weights_are_consistent(a in depth(), b in depth()) {
        let weights = weights(a, b);
        prop_assert!(relative_error(weights.back + weights.front, weights.alpha) <= TOLERANCE);
        let q = q(a, b);
        // 0 < q <= 2/3; the bound is reached at b = 0 in the thin limit, to rounding.
        prop_assert!(q > 0.0 && q <= 2.0 / 3.0 + 1e-14);
        prop_assert!((psi(a, b) - weights.back - zeta(a, b)).abs() <= 1e-15);
    }

    #[test]
    fn a_segment_is_the_composition_of_its_parts(
        ends in prop::array::uniform2(0.0_f64..1.0), cut in 0.01_f64..0.99, length in 0.0_f64..50.0,
    ) {
        let tf = TransferFunction::new(
            vec![ColorNode { s: 0.1, rgb: [1.0, 0.5, 0.1] }, ColorNode { s: 0.8, rgb: [0.2, 0.9, 0.3] }],
            vec![
                OpacityNode { s: 0.2, opacity: 0.1 },
                OpacityNode { s: 0.5, opacity: 2.0 },
                OpacityNode { s: 0.5, opacity: 0.5 },
                OpacityNode { s: 0.9, opacity: 0.7 },
            ],
        )
        .unwrap();
        let [front, back] = ends;
        let middle = front + cut * (back - front);
        let whole = segment(&tf, 1.0, front, back, length);
        let near = segment(&tf, 1.0, front, middle, cut * length);
        let far = segment(&tf, 1.0, middle, back, (1.0 - cut) * length);
        // `middle` is rounded: absolute tolerance of a few roundings times the largest depth.
        let tolerance = 1e-12;
        prop_assert!((whole.transmittance - near.transmittance * far.transmittance).abs() < tolerance);
        for channel in 0..3 {
            let composed = near.color[channel] + near.transmittance * far.color[channel];
            prop_assert!((whole.color[channel] - composed).abs() < tolerance);
        }
    }
}
