use super::*;

const EYE: [f64; 3] = [0.0, 0.0, 1.0];

#[test]
fn a_light_at_the_eye_sees_lambert_and_the_highlight() {
    let light = Light::new(None, [0.25, 0.5, 0.125], 2.0, 0.0).unwrap();
    // 60 degrees: cosine 1/2. Both sides are lit, and the gradient's length does not matter.
    for scale in [1.0, -3.0, 1e-200, 1e200] {
        let slanted = [3.0_f64.sqrt() * scale, 0.0, scale];
        let lit = light.luminance([1.0, 2.0, 0.0], slanted, EYE);
        for (value, expected) in lit.into_iter().zip([0.5, 1.0, 0.0].map(|matte| matte + 0.125 / 4.0)) {
            assert!((value - expected).abs() < 1e-15, "{lit:?}");
        }
    }
    assert_eq!(light.luminance([1.0; 3], [0.0; 3], EYE), [0.75; 3], "no surface");
    assert_eq!(light.opacity_factor([1.0, 2.0, 3.0], EYE), 1.0, "no silhouette asked for");
}

#[test]
fn a_light_from_aside_has_its_highlight_half_way() {
    let light = Light::new(Some([5.0, 0.0, 0.0]), [0.0, 1.0, 1.0], 50.0, 0.0).unwrap();
    assert_eq!(light.direction(), Some([1.0, 0.0, 0.0]));
    let half_way = light.luminance([0.0; 3], [1.0, 0.0, 1.0], EYE)[0];
    assert!((half_way - 1.0).abs() < 1e-13);
    // cos 45 degrees ^ 50 = 2^-25.
    assert!((light.luminance([0.0; 3], EYE, EYE)[0] - 2.0_f64.powi(-25)).abs() < 1e-17);
    assert_eq!(light.luminance([1.0; 3], [0.0, 1.0, 0.0], EYE), [0.0; 3]);
    // Light and eye opposite: no highlight, and no NaN.
    let behind = Light::new(Some([0.0, 0.0, -1.0]), [0.0, 1.0, 1.0], 50.0, 0.0).unwrap();
    assert_eq!(behind.luminance([1.0; 3], EYE, EYE), [1.0; 3]);
}

#[test]
fn silhouettes_fade_what_faces_the_eye() {
    let light = Light::new(None, [1.0, 0.0, 0.0], 1.0, 2.0).unwrap();
    assert!(!light.shades());
    assert_eq!(light.opacity_factor(EYE, EYE), 0.0);
    assert_eq!(light.opacity_factor([2.0, 0.0, 0.0], EYE), 1.0);
    assert!((light.opacity_factor([3.0_f64.sqrt(), 0.0, -1.0], EYE) - 0.25).abs() < 1e-15);
    assert_eq!(light.opacity_factor([0.0; 3], EYE), 1.0);
}

#[test]
fn impossible_lights_are_refused() {
    for bad in [-1.0, f64::NAN, f64::INFINITY] {
        for k in 0..3 {
            let mut shares = [0.5; 3];
            shares[k] = bad;
            assert!(Light::new(None, shares, 1.0, 0.0).is_err());
        }
        assert!(Light::new(None, [0.5; 3], bad, 0.0).is_err());
        assert!(Light::new(None, [0.5; 3], 1.0, bad).is_err());
    }
    for bad in [[0.0; 3], [f64::NAN, 0.0, 1.0], [f64::INFINITY, 0.0, 0.0]] {
        assert!(matches!(Light::new(Some(bad), [0.5; 3], 1.0, 0.0), Err(LightError::Direction(_))));
    }
}
