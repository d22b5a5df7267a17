use proptest::prelude::*;

use super::*;
use crate::accuracy::relative_error;
use crate::transfer::{ColorNode, OpacityNode};

/// Relative error that every f64 quantity keeps.
const TOLERANCE: f64 = 1e-12;

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
