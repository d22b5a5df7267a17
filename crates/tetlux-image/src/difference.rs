//! How far two images differ, as a picture.

use crate::metrics::{pixel_error, require_equal_sizes};
use crate::{Image, ImageError};

/// Error up to which a difference picture is black: about the spacing of `f32` values below 1.
pub const DIFFERENCE_FLOOR: f64 = 1e-7;

/// The colour scale, from [`DIFFERENCE_FLOOR`] to the top in equal steps of the logarithm, linear RGB. Luminance
/// rises all along, so that it reads in grey too, and magenta is far from all of it.
const SCALE: [[f32; 3]; 6] =
    [[0.0, 0.0, 0.0], [0.0, 0.03, 0.25], [0.0, 0.2, 0.3], [0.1, 0.5, 0.05], [0.9, 0.7, 0.0], [1.0, 1.0, 1.0]];

const NON_FINITE: [f32; 4] = [1.0, 0.0, 1.0, 1.0];

/// A heat map of the error of each pixel, as [`Metrics`](crate::Metrics) defines it, on a logarithmic scale.
///
/// Black is an error of at most [`DIFFERENCE_FLOOR`]; then dark blue, teal, green and yellow follow in equal steps of
/// the logarithm up to white, which is `scale` and above. Pixels with NaN or an infinity are magenta. The picture is
/// opaque and linear: write it with [`Encoding::Srgb`](crate::Encoding::Srgb).
///
/// # Errors
/// [`ImageError::SizeMismatch`] if the sizes differ; [`ImageError::Parameter`] if `scale` is not finite or not above
/// [`DIFFERENCE_FLOOR`].
pub fn difference_picture(a: &Image, b: &Image, scale: f64) -> Result<Image, ImageError> {
    require_equal_sizes(a, b)?;
    if !(scale.is_finite() && scale > DIFFERENCE_FLOOR) {
        return Err(ImageError::Parameter {
            name: "the scale of a difference picture",
            found: scale,
            expected: "finite and above 1e-7",
        });
    }
    let decades = (scale / DIFFERENCE_FLOOR).log10();
    let pixels = a
        .pixels()
        .iter()
        .zip(b.pixels())
        .map(|(p, q)| match pixel_error(p, q) {
            error if error.is_infinite() => NON_FINITE,
            error if error <= DIFFERENCE_FLOOR => color_at(0.0),
            error => color_at((error / DIFFERENCE_FLOOR).log10() / decades),
        })
        .collect();
    Image::from_pixels(a.width(), a.height(), pixels)
}

/// The opaque colour at `position`: 0 is the bottom of the scale, 1 and above its top.
fn color_at(position: f64) -> [f32; 4] {
    let steps = SCALE.len() - 1;
    let scaled = position.min(1.0) * steps as f64;
    let below = (scaled as usize).min(steps - 1);
    let fraction = (scaled - below as f64) as f32;
    let [low, high] = [SCALE[below], SCALE[below + 1]];
    let mix = |channel: usize| low[channel] + fraction * (high[channel] - low[channel]);
    [mix(0), mix(1), mix(2), 1.0]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Pictures of one row: an empty image against one whose red channel holds these errors.
    fn picture(errors: &[f32], scale: f64) -> Image {
        let width = u32::try_from(errors.len()).unwrap();
        let pixels = errors.iter().map(|&error| [error, 0.0, 0.0, 0.0]).collect();
        let b = Image::from_pixels(width, 1, pixels).unwrap();
        difference_picture(&Image::new(width, 1).unwrap(), &b, scale).unwrap()
    }

    #[test]
    fn the_ends_of_the_scale_are_black_and_white_and_non_finite_is_magenta() {
        let picture = picture(&[0.0, 0.9e-7, 0.0625, 1e6, f32::NAN, f32::INFINITY], 0.0625);
        let (black, white) = ([0.0, 0.0, 0.0, 1.0], [1.0; 4]);
        assert_eq!(picture.pixels(), [black, black, white, white, NON_FINITE, NON_FINITE]);
    }

    #[test]
    fn an_error_above_the_floor_is_not_black() {
        assert!(picture(&[2e-7], 1.0).pixels()[0][2] > 0.0);
    }

    #[test]
    fn equal_ratios_are_equal_steps() {
        // Five steps of ten from 1e-7 to 1e-2. The errors are f32 and so off by up to 6e-8 of themselves, which is
        // 1.3e-7 of a step; the colours are f32 too.
        let tolerance = 1e-6;
        let picture = picture(&[1e-6, 1e-5, 1e-4, 1e-3], 1e-2);
        for (pixel, stop) in picture.pixels().iter().zip(&SCALE[1..5]) {
            assert!(pixel.iter().zip(stop).all(|(x, y)| (x - y).abs() < tolerance), "{pixel:?} for {stop:?}");
        }
    }

    #[test]
    fn luminance_rises_with_the_error() {
        let luminance = |[r, g, b, _]: [f32; 4]| 0.2126 * r + 0.7152 * g + 0.0722 * b;
        let values: Vec<f32> = (0..=200).map(|step| luminance(color_at(f64::from(step) / 200.0))).collect();
        assert!(values.windows(2).all(|pair| pair[0] < pair[1]));
    }

    #[test]
    fn different_sizes_and_useless_scales_are_refused() {
        let image = Image::new(2, 1).unwrap();
        assert!(matches!(
            difference_picture(&image, &Image::new(1, 2).unwrap(), 1.0),
            Err(ImageError::SizeMismatch { .. })
        ));
        for scale in [f64::NAN, f64::INFINITY, 0.0, DIFFERENCE_FLOOR] {
            assert!(matches!(difference_picture(&image, &image, scale), Err(ImageError::Parameter { .. })));
        }
    }
}
