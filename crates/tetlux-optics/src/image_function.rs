//! A bivariate transfer function painted as an image: luminance and opacity over a grid of two scalars.

#[cfg(test)]
mod tests;

use crate::widget::Rectangle;

/// Why numbers make no image function.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ImageFunctionError {
    /// The number of texels is no multiple of the width, or there are none.
    #[error("an image of width {width} has {texels} texels: it needs whole rows, and at least one")]
    Size {
        /// Texels a row.
        width: usize,
        /// Texels given.
        texels: usize,
    },
    /// A range that does not ascend, or is not finite.
    #[error("axis {axis}: the range {low} to {high} must ascend and be finite")]
    Range {
        /// 0 or 1.
        axis: usize,
        /// Its lower end.
        low: f64,
        /// Its upper end.
        high: f64,
    },
    /// A luminance or opacity that is negative or not finite.
    #[error("texel ({column}, {row}): value {value} must be finite and at least 0")]
    Value {
        /// Column, from 0 at the lower end of the first scalar.
        column: usize,
        /// Row, from 0 at the lower end of the second scalar.
        row: usize,
        /// The offending value.
        value: f32,
    },
}

/// Luminance and opacity bilinear between the nodes of a grid over (s, g), constant outside.
///
/// The first and the last texel of a row lie at the ends of the first scalar's range, the first and the last row at those
/// of the second's; an axis of one texel is constant.
#[derive(Clone, Debug, PartialEq)]
pub struct ImageFunction {
    width: usize,
    texels: Vec<[f32; 4]>,
    range: [[f64; 2]; 2],
}

impl ImageFunction {
    /// Takes rows of `width` texels (linear RGB luminance and, last, opacity), the row of the lowest second scalar
    /// first, and the range that they span along each axis.
    ///
    /// # Errors
    ///
    /// Rows that are not whole, a range that does not ascend, a value that is negative or not finite.
    pub fn new(width: usize, texels: Vec<[f32; 4]>, range: [[f64; 2]; 2]) -> Result<Self, ImageFunctionError> {
        if width == 0 || texels.is_empty() || !texels.len().is_multiple_of(width) {
            return Err(ImageFunctionError::Size { width, texels: texels.len() });
        }
        for (axis, [low, high]) in range.into_iter().enumerate() {
            if !(low < high && (high - low).is_finite()) {
                return Err(ImageFunctionError::Range { axis, low, high });
            }
        }
        for (index, texel) in texels.iter().enumerate() {
            if let Some(&value) = texel.iter().find(|value| !(**value >= 0.0 && value.is_finite())) {
                return Err(ImageFunctionError::Value { column: index % width, row: index / width, value });
            }
        }
        Ok(Self { width, texels, range })
    }

    /// Texels along the first and the second axis.
    pub fn size(&self) -> [usize; 2] {
        [self.width, self.texels.len() / self.width]
    }

    /// The texels, row by row, the row of the lowest second scalar first.
    pub fn texels(&self) -> &[[f32; 4]] {
        &self.texels
    }

    /// What the texels span along each axis.
    pub fn range(&self) -> [[f64; 2]; 2] {
        self.range
    }

    /// Linear RGB luminance and opacity at (s, g); a NaN counts as the lower end.
    pub fn at(&self, point: [f64; 2]) -> [f64; 4] {
        let [(i, x), (j, y)] = [0, 1].map(|axis| {
            let place = self.place(axis, point[axis]);
            let cell = (place.floor() as usize).min(self.size()[axis].saturating_sub(2));
            (cell, place - cell as f64)
        });
        let [right, up] = [usize::from(self.width > 1), if self.size()[1] > 1 { self.width } else { 0 }];
        let corner = i + j * self.width;
        std::array::from_fn(|channel| {
            let [a, b, c, d] =
                [corner, corner + right, corner + up, corner + right + up].map(|k| f64::from(self.texels[k][channel]));
            (a * (1.0 - x) + b * x) * (1.0 - y) + (c * (1.0 - x) + d * x) * y
        })
    }

    /// A bound of the opacity over a rectangle: the largest of all texels that count in it.
    pub fn max_opacity_over(&self, range: &Rectangle) -> f64 {
        let [[left, right], [bottom, top]] = [(0, range.s), (1, range.g)].map(|(axis, [low, high])| {
            let last = self.size()[axis] - 1;
            if low <= high {
                return [self.place(axis, low).floor() as usize, (self.place(axis, high).ceil() as usize).min(last)];
            }
            // A NaN end means the whole axis, so that culling by this bound stays safe.
            [0, last]
        });
        let rows = (bottom..=top).map(|row| &self.texels[row * self.width..][left..=right]);
        rows.flatten().map(|texel| f64::from(texel[3])).fold(0.0, f64::max)
    }

    /// Distance of a scalar from the first node in units of the nodes' spacing, within the grid.
    fn place(&self, axis: usize, value: f64) -> f64 {
        let [low, high] = self.range[axis];
        let last = (self.size()[axis] - 1) as f64;
        let place = (value - low) / (high - low) * last;
        if place > 0.0 { place.min(last) } else { 0.0 }
    }
}
