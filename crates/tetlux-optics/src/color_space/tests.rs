use super::*;
use proptest::prelude::*;

fn assert_close(actual: [f64; 3], expected: [f64; 3], tolerance: f64) {
    let close = (0..3).all(|i| (actual[i] - expected[i]).abs() <= tolerance);
    assert!(close, "{actual:?} is not {expected:?}");
}

/// Both matrices are rounded to four digits: the way to Lab and back is good to about that.
const MATRIX_ROUNDING: f64 = 1e-3;

#[test]
fn hues_of_the_corners() {
    assert_eq!(rgb_to_hsv([1.0, 0.0, 0.0]), [0.0, 1.0, 1.0]);
    assert_close(rgb_to_hsv([0.0, 1.0, 0.0]), [1.0 / 3.0, 1.0, 1.0], 1e-15);
    assert_close(rgb_to_hsv([0.5, 0.0, 0.5]), [5.0 / 6.0, 1.0, 0.5], 1e-15);
    assert_eq!(rgb_to_hsv([0.25; 3]), [0.0, 0.0, 0.25]);
}

#[test]
fn hue_wraps_only_when_told() {
    // Yellow-red (hue 1/12) to blue-red (hue 11/12): through red, or through cyan.
    let (orange, rose) = ([1.0, 0.5, 0.0], [1.0, 0.0, 0.5]);
    assert_close(ColorSpace::Hsv { wrap: true }.interpolate(orange, rose, 0.5), [1.0, 0.0, 0.0], 1e-14);
    assert_close(ColorSpace::Hsv { wrap: false }.interpolate(orange, rose, 0.5), [0.0, 1.0, 1.0], 1e-14);
}

#[test]
fn lab_of_known_colors() {
    // L* of white is 100, of black 0; red's published coordinates under D65 are (53.24, 80.09, 67.20).
    assert_close(rgb_to_lab([1.0; 3]), [100.0, 0.0, 0.0], 0.02);
    assert_close(rgb_to_lab([0.0; 3]), [0.0; 3], 1e-12);
    assert_close(rgb_to_lab([1.0, 0.0, 0.0]), [53.24, 80.09, 67.20], 0.05);
    // L* is the cube root of the luminance, stretched: 50 is 18.4 % linear, 0.466 encoded.
    assert_close(lab_to_rgb([50.0, 0.0, 0.0]), [0.4663; 3], MATRIX_ROUNDING);
}

#[test]
fn diverging_passes_white_between_saturated_colors() {
    // Moreland's cool to warm: published colour at the middle is (0.865, 0.865, 0.865).
    let (cool, warm) = ([0.2298057, 0.298717966, 0.753683153], [0.705673158, 0.01555616, 0.150232812]);
    let middle = ColorSpace::Diverging.interpolate(cool, warm, 0.5);
    assert_close(middle, [0.865, 0.865, 0.865], 2e-3);
    // Published table of the map, at a quarter: (0.554, 0.690, 0.996).
    assert_close(ColorSpace::Diverging.interpolate(cool, warm, 0.25), [0.554, 0.690, 0.996], 3e-3);
}

#[test]
fn step_takes_the_second_color() {
    assert_eq!(ColorSpace::Step.interpolate([1.0, 0.0, 0.0], [0.0, 0.0, 1.0], 0.01), [0.0, 0.0, 1.0]);
}

proptest! {
    #[test]
    fn conversions_invert(rgb in prop::array::uniform3(0.0_f64..1.0)) {
        assert_close(hsv_to_rgb(rgb_to_hsv(rgb)), rgb, 1e-13);
        assert_close(lab_to_rgb(rgb_to_lab(rgb)), rgb, MATRIX_ROUNDING);
        assert_close(msh_to_lab(lab_to_msh(rgb_to_lab(rgb))), rgb_to_lab(rgb), 1e-3);
    }

    #[test]
    fn ends_are_kept(
        from in prop::array::uniform3(0.0_f64..1.0), to in prop::array::uniform3(0.0_f64..1.0), wrap: bool,
    ) {
        let mut spaces = vec![ColorSpace::Rgb, ColorSpace::Hsv { wrap }, ColorSpace::Lab];
        // An unsaturated end is given the other's hue, as Moreland's method wants it.
        if [from, to].iter().all(|&rgb| lab_to_msh(rgb_to_lab(rgb))[1] > SATURATED) {
            spaces.push(ColorSpace::Diverging);
        }
        for space in spaces {
            assert_close(space.interpolate(from, to, 0.0), from, MATRIX_ROUNDING);
            assert_close(space.interpolate(from, to, 1.0), to, MATRIX_ROUNDING);
        }
    }
}
