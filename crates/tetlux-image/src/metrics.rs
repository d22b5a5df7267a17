//! How far two images differ, in numbers.

use serde::{Serialize, Serializer};

use crate::{Image, ImageError};

/// The difference of two images of one size, in linear `f32` values, evaluated in `f64`.
///
/// The error of a pixel is the largest absolute difference of its four channels. A pixel with NaN or an infinity in
/// either image has an infinite error, so it can never go unseen. A pixel is covered if any channel of either image
/// is not zero: elsewhere both images are empty and the error is 0, and averaging over that would flatter.
///
/// Serialised, a figure that is not finite becomes null.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Metrics {
    /// Largest error of any pixel.
    #[serde(serialize_with = "finite_or_null")]
    pub max: f64,
    /// Mean error over the covered pixels.
    #[serde(serialize_with = "finite_or_null")]
    pub mean: f64,
    /// 99.9th percentile of the error over the covered pixels (nearest rank): 0.1 % of them exceed it at most.
    #[serde(serialize_with = "finite_or_null")]
    pub p999: f64,
    /// Root of the mean squared error over the covered pixels.
    #[serde(serialize_with = "finite_or_null")]
    pub rmse: f64,
    /// Peak signal-to-noise ratio in dB for a peak of 1, from `rmse`; infinite for equal images.
    #[serde(serialize_with = "finite_or_null")]
    pub psnr: f64,
    /// Number of pixels whose error exceeds the threshold.
    pub over: u64,
    /// Number of covered pixels.
    pub covered: u64,
    /// Column and row, from the top left, of the first pixel with the largest error.
    pub worst: [u32; 2],
    /// Number of pixels with NaN or an infinity in either image.
    pub non_finite: u64,
}

/// Compares two images of one size; pixels whose error exceeds `threshold` are counted in [`Metrics::over`].
///
/// # Errors
/// [`ImageError::SizeMismatch`] if the sizes differ; [`ImageError::Parameter`] if `threshold` is negative or not
/// finite, as nothing would then be counted rightly.
pub fn compare(a: &Image, b: &Image, threshold: f64) -> Result<Metrics, ImageError> {
    require_equal_sizes(a, b)?;
    if !(threshold.is_finite() && threshold >= 0.0) {
        return Err(ImageError::Parameter {
            name: "the threshold of a comparison",
            found: threshold,
            expected: "finite and not negative",
        });
    }

    let mut errors = Vec::new();
    let (mut max, mut worst, mut over, mut non_finite) = (0.0, 0, 0, 0);
    for (index, (p, q)) in a.pixels().iter().zip(b.pixels()).enumerate() {
        if is_empty(p) && is_empty(q) {
            continue;
        }
        let error = pixel_error(p, q);
        non_finite += u64::from(error.is_infinite());
        over += u64::from(error > threshold);
        if error > max {
            (max, worst) = (error, index);
        }
        errors.push(error);
    }

    let covered = errors.len();
    let mean_of = |sum: f64| if covered == 0 { 0.0 } else { sum / covered as f64 };
    let rmse = mean_of(errors.iter().map(|error| error * error).sum()).sqrt();
    Ok(Metrics {
        max,
        mean: mean_of(errors.iter().sum()),
        p999: percentile_999(&mut errors),
        rmse,
        psnr: -20.0 * rmse.log10(),
        over,
        covered: covered as u64,
        worst: [worst as u32 % a.width(), worst as u32 / a.width()],
        non_finite,
    })
}

pub(crate) fn require_equal_sizes(a: &Image, b: &Image) -> Result<(), ImageError> {
    let (first, second) = ([a.width(), a.height()], [b.width(), b.height()]);
    if first == second { Ok(()) } else { Err(ImageError::SizeMismatch { first, second }) }
}

/// Largest absolute difference of the channels; infinite if any of the eight values is not finite.
pub(crate) fn pixel_error(p: &[f32; 4], q: &[f32; 4]) -> f64 {
    if !p.iter().chain(q).all(|value| value.is_finite()) {
        return f64::INFINITY;
    }
    p.iter().zip(q).map(|(&x, &y)| (f64::from(x) - f64::from(y)).abs()).fold(0.0, f64::max)
}

fn is_empty(pixel: &[f32; 4]) -> bool {
    pixel.iter().all(|&value| value == 0.0)
}

/// The smallest error that at least 99.9 % of all errors do not exceed; 0 for none. Reorders them.
fn percentile_999(errors: &mut [f64]) -> f64 {
    // In integers, since 0.999 is no f64: ceil(999 n / 1000).
    let rank = (errors.len() as u64 * 999).div_ceil(1000) as usize;
    match rank.checked_sub(1) {
        Some(index) => *errors.select_nth_unstable_by(index, f64::total_cmp).1,
        None => 0.0,
    }
}

fn finite_or_null<S: Serializer>(value: &f64, serializer: S) -> Result<S::Ok, S::Error> {
    value.is_finite().then_some(*value).serialize(serializer)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// Opaque grey, with values that f32 holds exactly.
    fn grey(width: u32, height: u32) -> Image {
        Image::from_pixels(width, height, vec![[0.5, 0.5, 0.5, 1.0]; (width * height) as usize]).unwrap()
    }

    #[test]
    fn equal_images_have_no_error() {
        let metrics = compare(&grey(4, 3), &grey(4, 3), 0.0).unwrap();
        assert_eq!((metrics.max, metrics.mean, metrics.p999, metrics.rmse), (0.0, 0.0, 0.0, 0.0));
        assert_eq!((metrics.psnr, metrics.over, metrics.covered), (f64::INFINITY, 0, 12));
        assert_eq!((metrics.worst, metrics.non_finite), ([0, 0], 0));
    }

    #[test]
    fn a_planted_difference_in_any_channel_is_found_where_it_is() {
        for channel in 0..4 {
            let mut b = grey(4, 3);
            b.pixels_mut()[4 * 2 + 1][channel] -= 0.25;
            let metrics = compare(&grey(4, 3), &b, 0.125).unwrap();
            assert_eq!((metrics.max, metrics.worst, metrics.over), (0.25, [1, 2], 1), "channel {channel}");
            assert_eq!(metrics.mean, 0.25 / 12.0);
            assert_eq!(metrics.rmse, (0.0625f64 / 12.0).sqrt());
            // 12 pixels: the nearest rank of 99.9 % is the last.
            assert_eq!(metrics.p999, 0.25);
            assert_eq!(compare(&grey(4, 3), &b, 0.25).unwrap().over, 0, "the threshold itself is not exceeded");
        }
    }

    #[test]
    fn the_largest_channel_makes_the_error_and_the_first_largest_pixel_is_worst() {
        let mut b = grey(3, 1);
        b.pixels_mut()[1] = [0.625, 0.25, 0.5, 1.0];
        b.pixels_mut()[2] = [0.75, 0.5, 0.5, 1.0];
        let metrics = compare(&grey(3, 1), &b, 0.0).unwrap();
        assert_eq!((metrics.max, metrics.worst, metrics.over), (0.25, [1, 0], 2));
    }

    #[test]
    fn the_percentile_leaves_out_one_pixel_in_a_thousand() {
        let (a, mut b) = (grey(1000, 1), grey(1000, 1));
        b.pixels_mut()[7][0] = 1.0;
        assert_eq!(compare(&a, &b, 0.0).unwrap().p999, 0.0);
        b.pixels_mut()[8][0] = 0.75;
        assert_eq!(compare(&a, &b, 0.0).unwrap().p999, 0.25);
    }

    #[test]
    fn a_tenth_of_error_everywhere_is_twenty_decibels() {
        let a = Image::from_pixels(2, 1, vec![[0.0, 0.0, 0.0, 1.0]; 2]).unwrap();
        let b = Image::from_pixels(2, 1, vec![[0.1, 0.0, 0.0, 1.0]; 2]).unwrap();
        // 0.1 as f32 is off by 1.5e-8 of itself, which is 1.3e-7 dB.
        let tolerance = 1e-6;
        assert!((compare(&a, &b, 0.0).unwrap().psnr - 20.0).abs() < tolerance);
    }

    #[test]
    fn non_finite_values_are_infinite_errors_even_when_both_images_have_them() {
        for value in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
            let mut planted = grey(2, 2);
            planted.pixels_mut()[3][2] = value;
            for (a, b) in [(grey(2, 2), planted.clone()), (planted.clone(), grey(2, 2)), (planted.clone(), planted)] {
                let metrics = compare(&a, &b, 1e30).unwrap();
                assert_eq!((metrics.non_finite, metrics.over, metrics.worst), (1, 1, [1, 1]), "{value}");
                assert_eq!((metrics.max, metrics.mean, metrics.rmse), (f64::INFINITY, f64::INFINITY, f64::INFINITY));
                assert_eq!(metrics.psnr, f64::NEG_INFINITY);
            }
        }
    }

    #[test]
    fn empty_pixels_do_not_dilute_the_mean() {
        let (mut a, b) = (Image::new(10, 10).unwrap(), Image::new(10, 10).unwrap());
        assert_eq!(compare(&a, &b, 0.0).unwrap().covered, 0);
        assert_eq!(compare(&a, &b, 0.0).unwrap().mean, 0.0);
        a.pixels_mut()[0] = [0.0, 0.0, 0.0, 0.5];
        a.pixels_mut()[1] = [0.25, 0.0, 0.0, 0.0]; // emission without extinction
        let metrics = compare(&a, &b, 0.0).unwrap();
        assert_eq!((metrics.covered, metrics.mean, metrics.over), (2, 0.375, 2));
    }

    #[test]
    fn different_sizes_and_useless_thresholds_are_refused() {
        let error = compare(&grey(4, 3), &grey(3, 4), 0.0).unwrap_err();
        assert!(error.to_string().contains("4 x 3 and 3 x 4"), "{error}");
        for threshold in [f64::NAN, f64::INFINITY, -1e-9] {
            assert!(matches!(compare(&grey(2, 2), &grey(2, 2), threshold), Err(ImageError::Parameter { .. })));
        }
    }

    #[test]
    fn figures_that_are_not_finite_are_serialised_as_null() {
        let json = serde_json::to_value(compare(&grey(2, 1), &grey(2, 1), 0.0).unwrap()).unwrap();
        assert!(json["psnr"].is_null());
        assert_eq!(json["max"], 0.0);
        assert_eq!(json["covered"], 2);
        assert_eq!(json["worst"], serde_json::json!([0, 0]));
    }

    proptest! {
        #[test]
        fn metrics_are_symmetric_and_ordered(values in prop::collection::vec(prop::array::uniform4(0.0f32..2.0), 24)) {
            let a = Image::from_pixels(4, 3, values[..12].to_vec()).unwrap();
            let b = Image::from_pixels(4, 3, values[12..].to_vec()).unwrap();
            let metrics = compare(&a, &b, 0.5).unwrap();
            prop_assert_eq!(metrics, compare(&b, &a, 0.5).unwrap());
            // Mean and root mean square each carry a rounding error of some units in the last place.
            let slack = 1.0 + 1e-12;
            prop_assert!(metrics.mean <= metrics.rmse * slack && metrics.rmse <= metrics.max * slack);
            prop_assert!(metrics.p999 <= metrics.max);
            let worst = (metrics.worst[1] * 4 + metrics.worst[0]) as usize;
            prop_assert_eq!(pixel_error(&a.pixels()[worst], &b.pixels()[worst]), metrics.max);
        }
    }
}
