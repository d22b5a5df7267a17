//! The image itself: a size and its pixels.

use crate::ImageError;

/// Largest width and largest height of an image, in pixels.
pub const MAX_SIDE: u32 = 32_768;

/// Largest number of pixels of an image: 16 384 x 16 384, or 4 GiB.
///
/// Bounds what a small hostile file can make a reader allocate.
pub const MAX_PIXELS: u64 = 1 << 28;

/// So many zeros, if there is memory for them. It is taken from the system zeroed already where it can be, so that what is
/// never written takes none: a file may promise more than it gives.
pub(crate) fn zeroed<T: bytemuck::Zeroable>(count: usize) -> Option<Vec<T>> {
    bytemuck::allocation::try_zeroed_vec(count).ok()
}

/// A linear RGBA image in `f32`, premultiplied by alpha, top row first.
///
/// Colour and alpha are not confined to 0..1; NaN and infinities are kept, so that [`compare`](crate::compare) sees
/// them.
#[derive(Clone, Debug, PartialEq)]
pub struct Image {
    width: u32,
    height: u32,
    pixels: Vec<[f32; 4]>,
}

impl Image {
    /// A transparent black image of `width` x `height` pixels.
    ///
    /// # Errors
    /// [`ImageError::Size`] if a side is 0 or exceeds [`MAX_SIDE`], or the area exceeds [`MAX_PIXELS`];
    /// [`ImageError::Memory`] if there is no memory for it.
    pub fn new(width: u32, height: u32) -> Result<Self, ImageError> {
        let count = pixel_count(width.into(), height.into())?;
        let pixels = zeroed(count).ok_or(ImageError::Memory { width, height })?;
        Ok(Self { width, height, pixels })
    }

    /// An image of the given pixels, row by row from the top, each row from the left.
    ///
    /// # Errors
    /// [`ImageError::Size`] as for [`Image::new`]; [`ImageError::PixelCount`] unless `pixels` holds exactly
    /// `width * height` of them.
    pub fn from_pixels(width: u32, height: u32, pixels: Vec<[f32; 4]>) -> Result<Self, ImageError> {
        if pixels.len() != pixel_count(width.into(), height.into())? {
            return Err(ImageError::PixelCount { width, height, found: pixels.len() });
        }
        Ok(Self { width, height, pixels })
    }

    /// Width in pixels.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Height in pixels.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// The pixels, `width * height` of them: red, green, blue (premultiplied) and alpha.
    pub fn pixels(&self) -> &[[f32; 4]] {
        &self.pixels
    }

    /// The pixels, to be changed in place.
    pub fn pixels_mut(&mut self) -> &mut [[f32; 4]] {
        &mut self.pixels
    }

    /// This image over an opaque linear background colour: `color + (1 - alpha) * background`, alpha 1.
    #[must_use]
    pub fn over(&self, background: [f32; 3]) -> Image {
        let [red, green, blue] = background;
        let pixels = self
            .pixels
            .iter()
            .map(|&[r, g, b, a]| {
                let through = 1.0 - a;
                [r + through * red, g + through * green, b + through * blue, 1.0]
            })
            .collect();
        Image { width: self.width, height: self.height, pixels }
    }
}

/// The number of pixels of an image of this size, if it is within the limits.
pub(crate) fn pixel_count(width: u64, height: u64) -> Result<usize, ImageError> {
    let sides = 1..=u64::from(MAX_SIDE);
    let count = width.saturating_mul(height);
    match usize::try_from(count) {
        Ok(fits) if sides.contains(&width) && sides.contains(&height) && count <= MAX_PIXELS => Ok(fits),
        _ => Err(ImageError::Size { width, height }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_outside_the_limits_are_refused() {
        for (width, height) in [(0, 5), (5, 0), (MAX_SIDE + 1, 1), (1, MAX_SIDE + 1), (MAX_SIDE, MAX_SIDE)] {
            let error = Image::new(width, height).unwrap_err();
            assert!(matches!(error, ImageError::Size { .. }), "{width} x {height}: {error}");
            assert!(error.to_string().contains(&format!("{width} x {height}")));
        }
        assert_eq!(Image::new(MAX_SIDE, 1).unwrap().pixels().len(), MAX_SIDE as usize);
        assert!(pixel_count(u64::MAX, u64::MAX).is_err());
    }

    #[test]
    fn the_pixel_count_must_match_the_size() {
        assert!(Image::from_pixels(3, 2, vec![[0.0; 4]; 6]).is_ok());
        for found in [0, 5, 7] {
            assert!(matches!(
                Image::from_pixels(3, 2, vec![[0.0; 4]; found]),
                Err(ImageError::PixelCount { found: count, .. }) if count == found
            ));
        }
    }

    #[test]
    fn over_shows_the_background_through_what_alpha_leaves() {
        // Dyadic values, so that the sums are exact.
        let image = Image::from_pixels(3, 1, vec![[0.0; 4], [0.25, 0.5, 0.0, 0.75], [0.5, 0.25, 0.125, 1.0]]).unwrap();
        let composed = image.over([1.0, 0.5, 0.25]);
        assert_eq!(composed.pixels(), [[1.0, 0.5, 0.25, 1.0], [0.5, 0.625, 0.0625, 1.0], [0.5, 0.25, 0.125, 1.0]]);
        assert_eq!(composed.over([9.0; 3]), composed);
    }
}
