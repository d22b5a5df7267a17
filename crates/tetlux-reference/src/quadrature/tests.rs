//! The quadrature against closed forms and values of high precision.

use super::*;
use crate::testing::transfer;
use crate::walk::Values;
use tetlux_optics::{Classification, ColorNode, OpacityNode, TransferFunction};

fn along(classification: &Classification, tolerance: f64, segments: &[Segment], extinction: f64) -> Gathered {
    let definition = Definition::new(classification, None, false);
    Integrator::new(definition, tolerance).integrate(segments, extinction, Sight::default(), &mut Workspace::default())
}

fn one(scalar: f64) -> Values {
    [scalar, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]
}

fn unit(s_0: f64, s_1: f64) -> Segment {
    Segment { t: [0.0, 1.0], values: [one(s_0), one(s_1)] }
}

/// A case of the reference file: functions, segment, expected optical depth and colour.
struct Case {
    transfer: Classification,
    segment: Segment,
    length: f64,
    optical_depth: f64,
    color: [f64; 3],
}

/// The full reference file where the shared data are, else the dozen cases kept here.
fn cases() -> Vec<Case> {
    let own = include_str!("../../tests/fixtures/piecewise_linear_tf.json");
    let shared = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/reference/piecewise_linear_tf.json");
    let text = std::fs::read_to_string(shared).unwrap_or_else(|_| {
        println!("the shared reference values are absent: using the committed ones");
        own.into()
    });
    let file: serde_json::Value = serde_json::from_str(&text).unwrap();
    let number = |v: &serde_json::Value| v.as_f64().unwrap();
    let triple = |v: &serde_json::Value| [number(&v[0]), number(&v[1]), number(&v[2])];
    let cases = file["cases"].as_array().unwrap().iter().map(|case| {
        let s: Vec<f64> = case["s"].as_array().unwrap().iter().map(number).collect();
        let color = |(i, &s): (usize, &f64)| ColorNode { s, rgb: triple(&case["L"][i]) };
        let opacity = |(i, &s): (usize, &f64)| OpacityNode { s, opacity: number(&case["tau"][i]) };
        Case {
            transfer: Classification::OneField(
                TransferFunction::new(
                    s.iter().enumerate().map(color).collect(),
                    s.iter().enumerate().map(opacity).collect(),
                )
                .unwrap(),
            ),
            segment: unit(number(&case["s_f"]), number(&case["s_b"])),
            length: number(&case["length"]),
            optical_depth: number(&case["optical_depth"]),
            color: triple(&case["C"]),
        }
    });
    cases.collect()
}

/// Largest error of colour or transmittance over the cases, and the points it took.
fn judge(tolerance: f64) -> (f64, usize) {
    let cases = cases();
    assert!(cases.len() >= 12);
    cases.iter().fold((0.0, 0), |(worst, work), case| {
        let got = along(&case.transfer, tolerance, &[case.segment], case.length);
        let color = (0..3).map(|c| (got.color[c] - case.color[c]).abs()).fold(0.0, f64::max);
        let transmittance = ((-got.optical_depth).exp() - (-case.optical_depth).exp()).abs();
        (f64::max(worst, color.max(transmittance)), work + got.evaluations)
    })
}

#[test]
fn reference_values_hold_to_the_tolerance_and_work_grows_with_it() {
    let results = [1e-4, 1e-7, 1e-10].map(|tolerance| (tolerance, judge(tolerance)));
    for (tolerance, (worst, work)) in results {
        println!("tolerance {tolerance:e}: worst error {worst:e} with {work} evaluations");
        assert!(worst <= tolerance, "error {worst:e} for a tolerance of {tolerance:e}");
    }
    let work = results.map(|(_, (_, work))| work);
    assert!(work[0] < work[1] && work[1] < work[2], "{work:?}");
}

/// Rounding in sums of some hundred terms of unit size.
const ROUNDING: f64 = 1e-13;

#[test]
fn constant_extinction_with_linear_light_from_thin_to_opaque() {
    // L = 1 + z on [0, 1], tau = K: C = (1 - e) + ((1 - e)/K - e) with e = exp(-K). Series below K = 1e-3, where that
    // cancels: (1 - e)/K - e = K/2 - K^2/3 + K^3/8 - ...
    let light = [[0.0, 1.0], [1.0, 2.0]];
    for k in (-9..=9).map(|power| 10f64.powi(power)) {
        let got = along(&transfer(&[[0.0, k]], &light), 1e-10, &[unit(0.0, 1.0)], 1.0);
        let alpha = -(-k).exp_m1();
        let slope = if k < 1e-3 { k / 2.0 - k * k / 3.0 + k.powi(3) / 8.0 } else { alpha / k - (-k).exp() };
        let error = (got.color[0] - (alpha + slope)).abs();
        assert!(error <= 1e-10, "K = {k:e}: error {error:e}");
        // Thin segments keep their relative accuracy: a polynomial of low degree is integrated exactly.
        if k < 1e-3 {
            assert!(error <= ROUNDING * k, "K = {k:e}: error {error:e}");
        }
    }
}

/// Light of two stretches of constant extinction and luminance, one behind the other.
fn behind(front: [f64; 2], back: [f64; 2]) -> f64 {
    let alpha = |depth: f64| -(-depth).exp_m1();
    front[1] * alpha(front[0]) + (-front[0]).exp() * back[1] * alpha(back[0])
}

#[test]
fn steps_are_seen_from_both_sides() {
    // Opacity 1, luminance 1 below 0.5; 3 and 2 above.
    let stairs = transfer(&[[0.5, 1.0], [0.5, 3.0]], &[[0.5, 1.0], [0.5, 2.0]]);
    let up = along(&stairs, 1e-10, &[unit(0.0, 1.0)], 1.0);
    assert!((up.color[0] - behind([0.5, 1.0], [1.5, 2.0])).abs() < ROUNDING);
    let down = along(&stairs, 1e-10, &[unit(1.0, 0.0)], 1.0);
    assert!((down.color[0] - behind([1.5, 2.0], [0.5, 1.0])).abs() < ROUNDING);
    // A segment that ends on the step sees its own side's limit, opaque or not.
    for (segment, extinction, opacity, light) in
        [(unit(0.0, 0.5), 1.0, 1.0, 1.0), (unit(0.5, 0.0), 1e7, 1.0, 1.0), (unit(0.5, 1.0), 1e7, 3.0, 2.0)]
    {
        let got = along(&stairs, 1e-10, &[segment], extinction);
        let alpha = -(-opacity * extinction).exp_m1();
        assert!((got.color[0] - light * alpha).abs() < 1e-10, "{segment:?}");
    }
    // One that stays on it takes the value from above.
    let on = along(&stairs, 1e-10, &[unit(0.5, 0.5)], 1.0);
    assert!((on.optical_depth - 3.0).abs() < ROUNDING);
}

#[test]
fn overlapping_segments_add() {
    // Opacity s, luminance s, both constant along each segment: 1 on [0, 2] and 3 on [1, 4]. On [1, 2] the extinction
    // is 4 and the luminance (1*1 + 3*3)/4 = 2.5.
    let identity = transfer(&[[0.0, 0.0], [4.0, 4.0]], &[[0.0, 0.0], [4.0, 4.0]]);
    let segments = [Segment { t: [0.0, 2.0], values: [one(1.0); 2] }, Segment { t: [1.0, 4.0], values: [one(3.0); 2] }];
    let got = along(&identity, 1e-10, &segments, 0.25);
    let alpha = |depth: f64| -(-depth).exp_m1();
    let expected = alpha(0.25) + (-0.25_f64).exp() * (2.5 * alpha(1.0) + (-1.0_f64).exp() * 3.0 * alpha(1.5));
    assert!((got.color[0] - expected).abs() < 1e-10);
    assert!((got.optical_depth - 2.75).abs() < ROUNDING);
}

#[test]
fn a_gap_is_clear_and_an_end_on_a_control_point_is_no_trouble() {
    let tent = transfer(&[[0.0, 0.0], [1.0, 2.0], [2.0, 0.0]], &[[0.0, 1.0]]);
    let segments = [
        Segment { t: [0.0, 1.0], values: [one(0.0), one(1.0)] },
        Segment { t: [3.0, 4.0], values: [one(1.0), one(2.0)] },
    ];
    assert!((along(&tent, 1e-10, &segments, 1.0).optical_depth - 2.0).abs() < ROUNDING);
    // Outside the nodes the function is constant, here 0: nothing to do but to look once.
    let outside = along(&tent, 1e-10, &[unit(2.0, 5.0)], 1.0);
    assert_eq!((outside.optical_depth, outside.evaluations), (0.0, 5));
}
