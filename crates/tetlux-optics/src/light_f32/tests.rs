use proptest::prelude::*;

use super::*;

/// A few roundings of values up to 3; the exponent multiplies the rounding of a cosine: 50 times 6e-8.
const TOLERANCE: f64 = 2e-5;

fn direction() -> impl Strategy<Value = [f64; 3]> {
    prop::array::uniform3(-1.0..1.0_f64).prop_filter("a direction", |v| v.iter().map(|x| x * x).sum::<f64>() > 1e-3)
}

fn unit(v: [f64; 3]) -> [f64; 3] {
    let length = v.iter().map(|x| x * x).sum::<f64>().sqrt();
    v.map(|x| x / length)
}

proptest! {
    #[test]
    fn agrees_with_f64(
        gradient in direction(), view in direction(), toward in prop::option::of(direction()),
        luminance in prop::array::uniform3(0.0..1.0_f64), shininess in 0.0..50.0_f64, silhouette in 0.0..4.0_f64,
    ) {
        let view = unit(view);
        let light = Light::new(toward, [0.2, 0.7, 0.4], shininess, silhouette).unwrap();
        let device = LightUniform::new(&light, |d| d);
        let single = |v: [f64; 3]| v.map(|x| x as f32);
        let n = normal(single(gradient));
        let eye = single(view);
        let to_light = if toward.is_some() { device.direction } else { eye };
        let got = lit(&device, single(luminance), n, to_light, half_way(to_light, eye));
        let exact = light.luminance(luminance, gradient, view);
        for channel in 0..3 {
            prop_assert!((f64::from(got[channel]) - exact[channel]).abs() < TOLERANCE, "{got:?} {exact:?}");
        }
        let factor = light.opacity_factor(gradient, view);
        // Near exponent 0 the power has no bound on its slope where its base vanishes.
        if factor > 0.1 {
            prop_assert!((f64::from(silhouette_factor(&device, n, eye)) - factor).abs() < TOLERANCE);
        }
    }

    #[test]
    fn never_makes_what_is_not_finite(
        gradient in prop::array::uniform3(proptest::num::f32::ANY), luminance in prop::array::uniform3(0.0..1e6_f32),
    ) {
        let light = Light::new(None, [0.2, 0.7, 0.4], 1e6, 1e6).unwrap();
        let device = LightUniform::new(&light, |d| d);
        let n = normal(gradient);
        let eye = [0.0, 0.0, 1.0];
        let values = lit(&device, luminance, n, eye, half_way(eye, [0.0, 0.0, -1.0]));
        prop_assert!(values.iter().chain(&n).all(|v| v.is_finite()));
        prop_assert!((0.0..=1.0).contains(&silhouette_factor(&device, n, eye)));
    }
}
