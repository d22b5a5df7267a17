use std::f64::consts::PI;

use proptest::prelude::*;

use super::*;
use crate::accuracy::relative_error;
use crate::emission::EmissionConvention;
use crate::widget::{BivariateFunction, WaveProfile};

const WHITE: [f64; 3] = [1.0; 3];

fn wave(profile: WaveProfile, max_opacity: f64) -> Widget {
    Widget::new(Shape::Wave { profile, frequency: [1.0, 0.0], offset: 0.0 }, None, max_opacity, WHITE).unwrap()
}

/// Of formulas that lose a digit or two of their own.
const LOOSE: f64 = 1e-12;

#[test]
fn the_bounded_forms_give_the_same_mean_transmittance() {
    // Gaussian on the ray s = t sqrt 2 sigma through the centre: P = a D sqrt(pi) / (2 A).
    let gaussian = |a| Widget::new(Shape::Gaussian { center: [0.0; 2], sigma: [1.0; 2] }, None, a, WHITE).unwrap();
    for (t0, t1, a) in
        [(-2.0_f64, 1.5_f64, 3.0), (-0.3, 0.9, 40.0), (0.5, 2.0, 5.0), (-40.0, -1.0, 8.0), (-3.0, 3.0, 500.0)]
    {
        let root = std::f64::consts::SQRT_2;
        let ray = RaySegment { front: [root * t0, 0.0], back: [root * t1, 0.0], length: 1.0 };
        let result = widget_integral(&gaussian(a), 1.0, &ray);
        let p = a * PI.sqrt() / (2.0 * (t1 - t0));
        let tail = -f64::exp(-p * erfc(t0)) * (t0 - t1);
        let psi = (gaussian_bounded(p, t0) - result.transmittance * gaussian_bounded(p, t1) + tail) / (t1 - t0);
        assert!(relative_error(result.psi, psi) < LOOSE, "{t0} {t1} {a}: {} {psi}", result.psi);
    }
    // |sin| from t1 to t2: M = a D / (t2 - t1).
    for (t1, t2, a) in [(0.0, PI, 5.0), (0.3, 1.2, 2.0), (0.7, 3.0, 300.0), (2.0, 2.5, 1.0)] {
        let ray = RaySegment { front: [t1 / PI, 0.0], back: [t2 / PI, 0.0], length: 1.0 };
        let result = widget_integral(&wave(WaveProfile::AbsSine, a), 1.0, &ray);
        let m = a / (t2 - t1);
        let psi = (sine_bounded(m, t1) - result.transmittance * sine_bounded(m, t2)) / (t2 - t1);
        assert!(relative_error(result.psi, psi) < LOOSE, "{t1} {t2} {a}: {} {psi}", result.psi);
    }
}

fn erfc(x: f64) -> f64 {
    errorfunctions::RealErrorFunctions::erfc(x)
}

#[test]
fn the_bounded_forms_have_their_limits() {
    // V(0) = pi exp(-M) I_0(M), by the power series of I_0.
    for m in [0.0, 1e-6, 0.5, 3.0, 12.0] {
        let (mut term, mut bessel) = (1.0_f64, 1.0_f64);
        for k in 1..60 {
            term *= (m / 2.0 / f64::from(k)).powi(2);
            bessel += term;
        }
        let expected = PI * (-m).exp() * bessel;
        assert!(relative_error(sine_bounded(m, 0.0), expected) < 1e-13, "{m}");
    }
    // Without extinction the rest of the lobe is seen.
    assert!((sine_bounded(0.0, 1.0) - (PI - 1.0)).abs() < 1e-15);
    assert_eq!((sine_bounded(3.0, PI), sine_bounded(3.0, 9.0)), (0.0, 0.0));
    assert_eq!(sine_bounded(f64::NAN, f64::NAN), sine_bounded(0.0, 0.0));
    assert!((sine_bounded(1e100, 1.0) * 1e100 * 1.0_f64.sin() - 1.0).abs() < 1e-12, "1 / extinction");

    // Thin: int_t^inf P erfc y dy = P (exp(-t^2)/sqrt(pi) - t erfc t), to first order in P.
    for t in [-2.0_f64, 0.0, 1.5] {
        let expected = 1e-9 * ((-t * t).exp() / PI.sqrt() - t * erfc(t));
        assert!(relative_error(gaussian_bounded(1e-9, t), expected) < 1e-8, "{t}");
    }
    for p in [1e200, f64::INFINITY] {
        assert!(gaussian_bounded(p, 0.0) < 1e-140 && sine_bounded(p, 1.0) < 1e-140);
    }
    assert_eq!([gaussian_bounded(0.0, 1.0), gaussian_bounded(f64::NAN, 1.0), gaussian_bounded(1.0, 30.0)], [0.0; 3]);
    let (far, near) = (gaussian_bounded(2.0, -50.0), gaussian_bounded(2.0, -40.0));
    assert!(relative_error(far - near, 10.0 * (1.0 - (-4.0_f64).exp())) < LOOSE);
}

#[test]
fn many_periods_cost_nothing_and_keep_their_depth() {
    // A million periods have the mean of one: 1/2, 2/pi and 1/2 of the peak; psi tends to that of constant extinction.
    for (profile, mean) in
        [(WaveProfile::Triangle, 0.5), (WaveProfile::AbsSine, 2.0 / PI), (WaveProfile::SineSquared, 0.5)]
    {
        for (front, back) in [(0.25, 1_000_000.25), (1_000_000.25, 0.25)] {
            let ray = RaySegment { front: [front, 0.0], back: [back, 0.0], length: 2.0 };
            let result = widget_integral(&wave(profile, 3.0), 1.5, &ray);
            let depth = 4.0 * mean;
            assert!(relative_error(result.optical_depth, depth) < LOOSE, "{profile:?}: {result:?}");
            let constant = crate::segment::weights(depth, depth);
            // One period is 1e-6 of the segment.
            assert!((result.back - constant.back).abs() < 1e-5 && (result.front - constant.front).abs() < 1e-5);
        }
    }
}

#[test]
fn a_support_cuts_the_segment() {
    let support = Rectangle { s: [0.25, 0.75], g: [f64::NEG_INFINITY, f64::INFINITY] };
    let widget = Widget::new(Shape::Uniform, Some(support), 2.0, WHITE).unwrap();
    for (front, back) in [([0.0, 5.0], [1.0, 5.0]), ([1.0, -2.0], [0.0, 9.0])] {
        let ray = RaySegment { front, back, length: 4.0 };
        let result = widget_integral(&widget, 1.0, &ray);
        // Two length units of extinction 2, one empty unit on either side.
        assert!(relative_error(result.optical_depth, 4.0) < 1e-15);
        let alpha = -(-4.0_f64).exp_m1();
        let inner = alpha / 4.0;
        assert!(relative_error(result.psi, 0.25 + 0.5 * inner + 0.25 * (1.0 - alpha)) < 1e-15);
        assert!(relative_error(result.emission_only, 2.0 * inner) < 1e-15);
        assert!(relative_error(result.back + result.front, alpha) < 1e-15);
    }
    // Beside it, touching it, or nowhere.
    for (front, back, length) in [
        ([0.8, 0.0], [0.9, 0.0], 1.0),
        ([0.8, 0.0], [0.75, 0.0], 1.0),
        ([0.8, 0.0], [0.8, 0.0], 1.0),
        ([f64::NAN, 0.0], [0.5, 0.0], 1.0),
        ([0.5, 0.0], [0.5, f64::INFINITY], 1.0),
        ([0.5, 0.0], [0.5, 0.0], -1.0),
    ] {
        let result = widget_integral(&widget, 1.0, &RaySegment { front, back, length });
        assert_eq!((result.optical_depth, result.psi, result.alpha, result.emission_only), (0.0, 1.0, 0.0, 0.0));
    }
    // On its edge, along it: inside.
    let edge = RaySegment { front: [0.75, 0.0], back: [0.75, 1.0], length: 1.0 };
    assert_eq!(optical_depth(&widget, 1.0, &edge), 2.0);
}

#[test]
fn extreme_numbers_stay_finite() {
    let shapes = [
        Shape::Gaussian { center: [0.0; 2], sigma: [1e-300, 1e300] },
        Shape::Gaussian { center: [1e300, -1e300], sigma: [1e-5; 2] },
        Shape::Gaussian { center: [0.0; 2], sigma: [f64::MIN_POSITIVE; 2] },
        Shape::Wave { profile: WaveProfile::AbsSine, frequency: [1e300, 0.0], offset: 0.25 },
        Shape::Wave { profile: WaveProfile::Triangle, frequency: [f64::MAX, f64::MAX], offset: 0.0 },
        Shape::Wave { profile: WaveProfile::SineSquared, frequency: [1e-300, 1e15], offset: 1e300 },
    ];
    for shape in shapes {
        for opacity in [0.0, 1e-300, 1.0, 1e300] {
            let widget = Widget::new(shape, None, opacity, WHITE).unwrap();
            for (front, back) in [([0.0; 2], [1.0; 2]), ([-1e300; 2], [1e300; 2]), ([1.0; 2], [1.0; 2])] {
                let result = widget_integral(&widget, 1.0, &RaySegment { front, back, length: 1.0 });
                let unit = 0.0..=1.0 + 1e-12;
                for value in [result.transmittance, result.alpha, result.psi, result.back, result.front] {
                    assert!(unit.contains(&value), "{widget:?} {front:?}: {result:?}");
                }
                assert!(result.optical_depth >= 0.0);
            }
        }
    }
}

fn any_widget() -> impl Strategy<Value = Widget> {
    let shape = prop_oneof![
        Just(Shape::Uniform),
        (prop::array::uniform2(-1.0..1.0), prop::array::uniform2(0.05..1.0))
            .prop_map(|(center, sigma)| Shape::Gaussian { center, sigma }),
        (0..3_usize, prop::array::uniform2(-3.0..3.0), -2.0..2.0).prop_map(|(profile, frequency, offset)| {
            let profile = [WaveProfile::Triangle, WaveProfile::AbsSine, WaveProfile::SineSquared][profile];
            Shape::Wave { profile, frequency, offset }
        }),
    ];
    let support = prop_oneof![Just(None), Just(Some(Rectangle { s: [-0.5, 0.5], g: [f64::NEG_INFINITY, 0.25] }))];
    let color = prop::array::uniform3(0.0..1.0);
    (shape, support, -3.0_f64..2.0, color).prop_map(|(shape, support, opacity, color)| {
        Widget::new(shape, support, 10.0_f64.powf(opacity), color).unwrap()
    })
}

fn any_ray() -> impl Strategy<Value = RaySegment> {
    let point = || prop::array::uniform2(-1.0..1.0);
    (point(), point(), 0.1..4.0).prop_map(|(front, back, length)| RaySegment { front, back, length })
}

proptest! {
    #[test]
    fn a_segment_is_the_composition_of_its_parts(widget in any_widget(), ray in any_ray(), cut in 0.1..0.9_f64) {
        let whole = widget_integral(&widget, 1.0, &ray);
        let near = RaySegment { back: ray.at(cut), length: ray.length * cut, ..ray };
        let far = RaySegment { front: ray.at(cut), length: ray.length * (1.0 - cut), ..ray };
        let (near, far) = (widget_integral(&widget, 1.0, &near), widget_integral(&widget, 1.0, &far));
        // The cut is rounded; opacities are at most 100 and slopes 20 of them.
        let tolerance = 1e-11;
        prop_assert!((whole.optical_depth - near.optical_depth - far.optical_depth).abs() < tolerance);
        prop_assert!((optical_depth(&widget, 1.0, &ray) - whole.optical_depth).abs() < tolerance);
        let psi = cut * near.psi + near.transmittance * (1.0 - cut) * far.psi;
        prop_assert!((whole.psi - psi).abs() < tolerance);
        let emission_only = near.emission_only + near.transmittance * far.emission_only;
        prop_assert!((whole.emission_only - emission_only).abs() < tolerance);
        prop_assert!((whole.back + whole.front - whole.alpha).abs() < tolerance);
        prop_assert!((whole.back - (whole.psi - whole.transmittance)).abs() < tolerance);
    }

    #[test]
    fn several_widgets_are_exact_in_opacity_and_close_in_color(
        widgets in prop::collection::vec(any_widget(), 1..4), ray in any_ray(),
    ) {
        let function = BivariateFunction { widgets };
        let depth: f64 = function.widgets.iter().map(|widget| optical_depth(widget, 0.5, &ray)).sum();
        for convention in [EmissionConvention::EmissionAbsorption, EmissionConvention::EmissionDensity] {
            let of = |pieces| bivariate_segment(&function, 0.5, &ray, pieces, convention);
            let (coarse, fine, finest) = (of(64), of(1024), of(4096));
            prop_assert_eq!(coarse.alpha, -(-depth).exp_m1());
            for channel in 0..3 {
                // Second order: 64 pieces of waves with up to 12 kinks, depths up to 800.
                let scale = 1.0 + finest.color[channel];
                prop_assert!((coarse.color[channel] - finest.color[channel]).abs() < 5e-2 * scale);
                prop_assert!((fine.color[channel] - finest.color[channel]).abs() < 1e-3 * scale);
            }
        }
    }
}

#[test]
fn one_widget_among_several_is_itself() {
    let support = Rectangle { s: [0.1, 0.6], g: [-1.0, 1.0] };
    let shape = Shape::Gaussian { center: [0.5, 0.5], sigma: [0.2, 0.3] };
    let color = [0.9, 0.5, 0.1];
    let widget = Widget::new(shape, Some(support), 7.0, color).unwrap();
    let invisible = Widget::new(Shape::Uniform, None, 0.0, WHITE).unwrap();
    let function = BivariateFunction { widgets: vec![widget, invisible] };
    let ray = RaySegment { front: [0.0, 0.1], back: [1.0, 0.7], length: 2.0 };
    let alone = widget_integral(&widget, 1.0, &ray);
    let result = bivariate_segment(&function, 1.0, &ray, 3, EmissionConvention::EmissionAbsorption);
    for channel in 0..3 {
        assert!(relative_error(result.color[channel], color[channel] * alone.alpha) < 1e-14, "{result:?}");
    }
    let function = BivariateFunction { widgets: vec![widget] };
    let result = bivariate_segment(&function, 1.0, &ray, 4000, EmissionConvention::EmissionDensity);
    for channel in 0..3 {
        // Second order in 1/2000.
        assert!(relative_error(result.color[channel], color[channel] * alone.emission_only) < 1e-6, "{result:?}");
    }
}

#[test]
fn two_rectangles_side_by_side_are_two_segments() {
    let half = |s, color| {
        let support = Rectangle { s, g: [f64::NEG_INFINITY, f64::INFINITY] };
        Widget::new(Shape::Uniform, Some(support), 1.5, color).unwrap()
    };
    let function =
        BivariateFunction { widgets: vec![half([0.0, 0.3], [1.0, 0.0, 0.0]), half([0.3, 1.0], [0.0, 1.0, 0.0])] };
    let ray = RaySegment { front: [0.0, 0.0], back: [1.0, 2.0], length: 2.0 };
    let [near, far] = [0.9_f64, 2.1].map(|depth| -(-depth).exp_m1());
    for pieces in [0, 1, 7] {
        let result = bivariate_segment(&function, 1.0, &ray, pieces, EmissionConvention::EmissionAbsorption);
        assert!(relative_error(result.color[0], near) < 1e-14, "{result:?}");
        assert!(relative_error(result.color[1], (1.0 - near) * far) < 1e-14);
        assert_eq!(result.color[2], 0.0);
    }
}
