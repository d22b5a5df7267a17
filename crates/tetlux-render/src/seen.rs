//! A point of the mesh as it is seen.

/// Laid out as the shader's `Seen` (shaders/lib/view.wgsl). Single precision leaves a pixel's place 3e-5 of a pixel uncertain
/// in a picture a thousand pixels wide: enough to be seen where a cell is so thin that the ray passes it in less.
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub(crate) struct Seen {
    /// In pixels from the picture's middle, rounded; of use only in front of the near plane.
    pub(crate) pixel: [f32; 2],
    /// What that leaves of it, x in the lower half: signed shares of [`UNIT`] of the rounded value, in 2^15 - 1 steps.
    pub(crate) rest: [i16; 2],
    /// Depth from the eye, in device units.
    pub(crate) depth: f32,
}

/// Rounding to single precision changes a value by no more than this share of it.
pub(crate) const UNIT: f64 = 1.0 / (1 << 24) as f64;

impl Seen {
    pub(crate) fn new(pixel: [f64; 2], depth: f64) -> Seen {
        // Beyond this a vertex is before the near plane: its place is of no use, and must be finite.
        let pixel = pixel.map(|p| p.clamp(-1e20, 1e20));
        let high = pixel.map(|p| p as f32);
        let rest = std::array::from_fn(|i| {
            let high = f64::from(high[i]);
            let share = if high == 0.0 { 0.0 } else { (pixel[i] - high) / (high.abs() * UNIT) };
            // A conversion of a float saturates.
            (share * f64::from(i16::MAX)).round() as i16
        });
        Seen { pixel: high, rest, depth: depth as f32 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_summands_give_the_place_to_ten_digits() {
        for place in [0.0, 1.0 / 3.0, -400.123_456_789, 1e-9, 16_777_217.0, -0.999_999_99] {
            let seen = Seen::new([place, -place], 2.5);
            for (axis, place) in [place, -place].into_iter().enumerate() {
                let high = f64::from(seen.pixel[axis]);
                let found = high + f64::from(seen.rest[axis]) / f64::from(i16::MAX) * high.abs() * UNIT;
                // Half a step.
                assert!((found - place).abs() <= place.abs() * UNIT / 65_000.0, "{place}: {found}");
            }
            assert_eq!(seen.depth, 2.5);
        }
        assert!(Seen::new([f64::INFINITY, f64::MIN], 1.0).pixel.iter().all(|p| p.is_finite()));
    }
}
