use proptest::prelude::*;

use super::*;

/// 3 x 2 texels over [0, 2] x [10, 11]: opacity 1 + column + 4 row, red twice that.
fn ramp() -> ImageFunction {
    let texel = |k: usize| {
        let opacity = (1 + k % 3 + 4 * (k / 3)) as f32;
        [2.0 * opacity, 0.0, 0.0, opacity]
    };
    ImageFunction::new(3, (0..6).map(texel).collect(), [[0.0, 2.0], [10.0, 11.0]]).unwrap()
}

#[test]
fn a_bilinear_function_is_reproduced_and_goes_on_constant() {
    let image = ramp();
    for (s, g) in [(0.0, 10.0), (2.0, 11.0), (0.25, 10.5), (1.75, 10.125), (1.0, 11.0)] {
        let opacity = 1.0 + s + 4.0 * (g - 10.0);
        assert_eq!(image.at([s, g]), [2.0 * opacity, 0.0, 0.0, opacity]);
    }
    assert_eq!(image.at([-7.0, 10.0])[3], 1.0);
    assert_eq!(image.at([9.0, 99.0])[3], 7.0);
    assert_eq!(image.at([f64::NAN, 10.0])[3], 1.0);
    let one = ImageFunction::new(1, vec![[0.5; 4]], [[0.0, 1.0]; 2]).unwrap();
    assert_eq!((one.at([0.3, 0.9]), one.size()), ([0.5; 4], [1, 1]));
}

#[test]
fn impossible_images_are_refused() {
    let range = [[0.0, 1.0]; 2];
    for (width, texels) in [(0, vec![[0.0; 4]]), (2, vec![[0.0; 4]; 3]), (2, vec![])] {
        assert!(matches!(ImageFunction::new(width, texels, range), Err(ImageFunctionError::Size { .. })));
    }
    for bad in [[1.0, 1.0], [0.0, f64::INFINITY], [f64::NAN, 1.0], [-1e308, 1.7e308]] {
        let error = ImageFunction::new(1, vec![[0.0; 4]], [[0.0, 1.0], bad]).unwrap_err();
        assert!(matches!(error, ImageFunctionError::Range { axis: 1, .. }), "{error}");
    }
    for bad in [-1.0, f32::NAN, f32::INFINITY] {
        let error = ImageFunction::new(1, vec![[0.0; 4], [0.0, bad, 0.0, 0.0]], range).unwrap_err();
        assert!(matches!(error, ImageFunctionError::Value { column: 0, row: 1, .. }), "{error}");
    }
}

proptest! {
    #[test]
    fn the_culling_bound_is_never_exceeded(
        corner in prop::array::uniform2(-1.0..12.0_f64), size in prop::array::uniform2(0.0..2.0_f64),
        at in prop::array::uniform2(0.0..=1.0_f64),
    ) {
        let image = ramp();
        let range = Rectangle { s: [corner[0], corner[0] + size[0]], g: [corner[1], corner[1] + size[1]] };
        let point = [corner[0] + at[0] * size[0], corner[1] + at[1] * size[1]];
        prop_assert!(image.at(point)[3] <= image.max_opacity_over(&range) * (1.0 + 1e-12));
    }
}
