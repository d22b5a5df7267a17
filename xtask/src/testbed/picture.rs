//! Two pictures side by side, a part of each magnified below.

use tetlux_image::{Image, ImageError};

/// Pixels between the parts.
const GAP: u32 = 6;
const FRAME: [f32; 4] = [1.0; 4];
const PAPER: [f32; 4] = [0.12, 0.12, 0.12, 1.0];

/// Left, top and side of the inset, in pixels of a picture of that side.
pub(super) fn inset_pixels(inset: [f32; 3], side: u32) -> [u32; 3] {
    let pixels = inset.map(|part| (part * side as f32) as u32);
    let length = pixels[2].clamp(1, side);
    [pixels[0].min(side - length), pixels[1].min(side - length), length]
}

/// Pictures of one side on black, their insets below; the contrast of the insets is about the mean of the truth's.
pub(super) fn side_by_side(
    halves: [&Image; 2],
    truth: &Image,
    inset: [u32; 3],
    gain: f32,
) -> Result<Image, ImageError> {
    let side = truth.width();
    let [left, top, length] = inset;
    let at = |image: &Image, x: u32, y: u32| image.pixels()[(y * image.width() + x) as usize];
    let mut mean = [0.0f32; 3];
    for y in top..top + length {
        for x in left..left + length {
            let pixel = at(truth, x, y);
            (0..3).for_each(|i| mean[i] += pixel[i] / (length * length) as f32);
        }
    }
    let on_frame = |x: u32, y: u32| {
        // One pixel outside the inset.
        let (x, y, low_x, low_y) = (x + 1, y + 1, left, top);
        let inside = |v: u32, low: u32| (low..=low + length + 1).contains(&v);
        let edge = |v: u32, low: u32| v == low || v == low + length + 1;
        inside(x, low_x) && inside(y, low_y) && (edge(x, low_x) || edge(y, low_y))
    };
    let magnified = |image: &Image, x: u32, y: u32| {
        let pixel = at(image, left + x * length / side, top + y * length / side);
        let stretched = |i: usize| (mean[i] + gain * (pixel[i] - mean[i])).clamp(0.0, 1.0);
        [stretched(0), stretched(1), stretched(2), 1.0]
    };
    let whole = 2 * side + GAP;
    let pixels = (0..whole * whole).map(|i| {
        let (x, y) = (i % whole, i / whole);
        let beyond = |v: u32| v.checked_sub(side + GAP);
        let image = halves[usize::from(x >= side)];
        let Some(column) = (if x < side { Some(x) } else { beyond(x) }) else { return PAPER };
        match (y < side, beyond(y)) {
            (true, _) if on_frame(column, y) => FRAME,
            (true, _) => {
                let [r, g, b, _] = at(image, column, y);
                [r, g, b, 1.0]
            }
            (_, Some(row)) => magnified(image, column, row),
            _ => PAPER,
        }
    });
    Image::from_pixels(whole, whole, pixels.collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_half_and_its_inset_are_in_their_places() {
        let image = |v: f32| Image::from_pixels(8, 8, vec![[v, v, v, 1.0]; 64]).unwrap();
        let (dark, light, truth) = (image(0.25), image(0.75), image(0.5));
        let inset = inset_pixels([0.9, 0.5, 0.25], 8);
        assert_eq!(inset, [6, 4, 2], "moved into the picture");
        let whole = side_by_side([&dark, &light], &truth, inset, 2.0).unwrap();
        let at = |x: u32, y: u32| whole.pixels()[(y * whole.width() + x) as usize][0];
        let far = 8 + GAP;
        assert_eq!([at(0, 0), at(far, 0)], [0.25, 0.75]);
        // Stretched by 2 about 0.5.
        assert_eq!([at(0, far), at(far, far)], [0.0, 1.0]);
        assert_eq!([at(5, 3), at(5, 4), at(9, 0)], [FRAME[0], FRAME[0], PAPER[0]]);
    }
}
