use super::*;
use crate::accuracy::Random;
use crate::emission::EmissionConvention;
use crate::widget::{BivariateFunction, Shape, WaveProfile};
use crate::widget_f32::tests::{exact_segment, random_segment, random_widget};
use crate::widget_f32::widgets as pack;
use crate::widget_integral::bivariate_segment;

const UNIT: [[f64; 2]; 2] = [[0.0, 1.0]; 2];

/// What f32 cannot hold: rims of rectangles and phases are moved by some 1e-7 of the range, or 1e-4 of the segments
/// that are a thousandth of it, of an optical depth of up to 20.
const ROUNDING: f64 = 3e-5;

fn random_function(random: &mut Random) -> BivariateFunction {
    let count = 2 + (3.0 * random.unit()) as usize;
    BivariateFunction { widgets: (0..count).map(|_| random_widget(random)).collect() }
}

#[test]
fn the_bound_holds_and_a_looser_one_takes_fewer_pieces() {
    let mut random = Random::new(5);
    let bounds = [1e-2, 1e-3, 1e-4];
    let (mut worst, mut spent, mut mean_error) = ([0.0_f64; 3], [0_u64; 3], [0.0_f64; 3]);
    let mut cases = 0;
    while cases < 400 {
        let function = random_function(&mut random);
        let device = pack(&function, UNIT, 1.0);
        // Half of them right across the plane, half as short as a mesh's cells make them.
        let (front, mut back) = random_segment(&mut random);
        if cases % 2 == 0 {
            back = [random.unit() as f32, random.unit() as f32];
        }
        let length = random.decades(-1.5, 0.3);
        let ray = exact_segment(front, back, length);
        // Second order in a two-thousandth of the segment.
        let exact = bivariate_segment(&function, 1.0, &ray, 2000, EmissionConvention::EmissionAbsorption);
        if exact.alpha < 1e-3 {
            continue;
        }
        cases += 1;
        for (k, bound) in bounds.into_iter().enumerate() {
            let got = integrate(&device, front, back, length, bound as f32);
            let error = (0..3).map(|c| (f64::from(got.color[c]) - exact.color[c]).abs()).fold(0.0, f64::max);
            let alpha = (f64::from(got.color[3]) - exact.alpha).abs();
            assert!(error <= bound + ROUNDING, "{error:e} for {bound:e}: {function:?} {ray:?} {got:?} {exact:?}");
            assert!(alpha <= ROUNDING, "alpha off by {alpha:e}: {function:?} {ray:?}");
            worst[k] = worst[k].max(error / bound);
            mean_error[k] += error / bound / 400.0;
            spent[k] += u64::from(got.pieces);
        }
    }
    let pieces = spent.map(|n| n as f64 / 400.0);
    println!("largest error / bound {worst:?}, mean {mean_error:?}; mean pieces {pieces:?}");
    assert!(spent[0] < spent[1] && spent[1] < spent[2], "{spent:?}");
    // Third order in theory: ten times the accuracy for 2.2 times the pieces, and never for much more than 3.
    assert!(spent[2] < 4 * spent[1], "{spent:?}");
}

#[test]
fn a_coarser_cut_than_the_bound_asks_for_would_be_seen() {
    // The planted difference: two bells one behind the other, in one piece, are off by far more than 1e-3.
    let bell = |x: f64, color| {
        let shape = Shape::Gaussian { center: [x, 0.5], sigma: [0.15, 1.0] };
        crate::widget::Widget::new(shape, None, 8.0, color).unwrap()
    };
    let function = BivariateFunction { widgets: vec![bell(0.3, [1.0, 0.0, 0.0]), bell(0.7, [0.0, 0.0, 1.0])] };
    let device = pack(&function, UNIT, 1.0);
    let (front, back) = ([0.0, 0.5], [1.0, 0.5]);
    let exact = bivariate_segment(
        &function,
        1.0,
        &exact_segment(front, back, 1.0),
        4000,
        EmissionConvention::EmissionAbsorption,
    );
    let error = |color: [f32; 4]| (0..3).map(|c| (f64::from(color[c]) - exact.color[c]).abs()).fold(0.0, f64::max);
    assert!(error(integrate(&device, front, back, 1.0, 10.0).color) > 0.1);
    assert!(error(integrate(&device, front, back, 1.0, 1e-3).color) < 1e-3);
}

#[test]
fn one_color_is_exact_in_one_piece_for_any_number_of_peaks() {
    let shape = Shape::Wave { profile: WaveProfile::AbsSine, frequency: [7.3, 2.0], offset: 0.1 };
    let color = [0.9, 0.5, 0.2];
    let wave = crate::widget::Widget::new(shape, None, 3.0, color).unwrap();
    let bell = Shape::Gaussian { center: [0.5, 0.5], sigma: [0.1, 0.1] };
    let bell = crate::widget::Widget::new(bell, None, 2.0, color).unwrap();
    let function = BivariateFunction { widgets: vec![wave, bell] };
    let got = integrate(&pack(&function, UNIT, 1.0), [0.0, 0.1], [1.0, 0.9], 1.5, 1e-4);
    let ray = exact_segment([0.0, 0.1], [1.0, 0.9], 1.5);
    let exact = bivariate_segment(&function, 1.0, &ray, 1, EmissionConvention::EmissionAbsorption);
    assert_eq!(got.pieces, 1);
    assert!((0..3).all(|c| (f64::from(got.color[c]) - color[c] * exact.alpha).abs() < 1e-5), "{got:?}");
}

#[test]
fn a_point_has_the_colour_and_extinction_of_the_function() {
    let mut random = Random::new(31);
    for _ in 0..2000 {
        let function = random_function(&mut random);
        let point = [random.unit() as f32, random.unit() as f32];
        let got = classify(&pack(&function, UNIT, 1.0), point).map(f64::from);
        let at = point.map(f64::from);
        let (opacity, luminance) = (function.opacity(at), function.luminance(at));
        // Places are good to 1e-7 of the range; the steepest Gaussian has a slope of 10 * 0.86 / 0.02 a range.
        assert!((got[3] - opacity).abs() < 2e-4, "{got:?} {opacity} {function:?} {point:?}");
        if opacity > 0.1 {
            assert!((0..3).all(|c| (got[c] - luminance[c]).abs() < 1e-2), "{got:?} {luminance:?}");
        }
    }
    assert_eq!(classify(&[], [0.5; 2]), [0.0; 4]);
}

#[test]
fn more_periods_than_pieces_still_mix_their_colors() {
    // Red throughout and a green wave of 5000.5 periods: half as much of it in the mean.
    let shape = Shape::Wave { profile: WaveProfile::Triangle, frequency: [5000.5, 0.0], offset: 0.25 };
    let wave = crate::widget::Widget::new(shape, None, 1.0, [0.0, 1.0, 0.0]).unwrap();
    let fog = crate::widget::Widget::new(Shape::Uniform, None, 1.0, [1.0, 0.0, 0.0]).unwrap();
    let device = pack(&BivariateFunction { widgets: vec![wave, fog] }, UNIT, 1.0);
    let got = integrate(&device, [0.0; 2], [1.0; 2], 2.0, 1e-4);
    let alpha = 1.0 - (-3.0_f64).exp();
    // A period is a ten-thousandth of the depth.
    assert!((f64::from(got.color[0]) - alpha * 2.0 / 3.0).abs() < 1e-3, "{got:?}");
    assert!((f64::from(got.color[1]) - alpha / 3.0).abs() < 1e-3 && got.pieces <= MAX_PIECES + 1, "{got:?}");
}

#[test]
fn empty_segments_and_no_widgets() {
    assert_eq!(integrate(&[], [0.0; 2], [1.0; 2], 1.0, 1e-3), Integrated::default());
    let device = pack(&random_function(&mut Random::new(1)), UNIT, 1.0);
    let nothing = integrate(&device, [0.2; 2], [0.8; 2], 0.0, 1e-3);
    assert_eq!(nothing, Integrated::default());
    // A value that is the same along the segment, and values that are not.
    for (front, back) in [([0.4; 2], [0.4; 2]), ([-1e30; 2], [1e30; 2]), ([0.0; 2], [1e-30; 2])] {
        let got = integrate(&device, front, back, 1e3, 1e-4);
        assert!(got.color.iter().all(|v| (0.0..=1.0).contains(v)), "{got:?}");
    }
}
