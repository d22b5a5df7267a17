//! Texel formats and what each costs.

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

/// How a texel is stored. Integer formats are scaled to the range of values of their channel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Precision {
    /// 256 equal steps between the channel's least and largest value.
    U8,
    /// 65 536 equal steps between the channel's least and largest value.
    U16,
    /// IEEE half: 11 significant bits.
    F16,
    /// IEEE single: 24 significant bits.
    F32,
}

impl Precision {
    /// Every format, coarsest first.
    pub const ALL: [Self; 4] = [Self::U8, Self::U16, Self::F16, Self::F32];

    /// Bytes of one channel of one texel.
    pub fn bytes(self) -> usize {
        match self {
            Self::U8 => 1,
            Self::U16 | Self::F16 => 2,
            Self::F32 => 4,
        }
    }

    /// Largest difference, as a share of the largest value, between a table built here and on another platform, whose
    /// elementary functions may round otherwise: a few ulp, or one step where that tips a rounding over.
    pub fn rebuild_tolerance(self) -> f64 {
        match self {
            Self::U8 => 1.01 / 255.0,
            Self::U16 => 1.01 / 65_535.0,
            Self::F16 => 1.0 / 1024.0,
            Self::F32 => 1e-6,
        }
    }

    /// The name used in specifications: `u8`, `u16`, `f16` or `f32`.
    pub fn name(self) -> &'static str {
        match self {
            Self::U8 => "u8",
            Self::U16 => "u16",
            Self::F16 => "f16",
            Self::F32 => "f32",
        }
    }
}

/// Rounds interleaved texels to what `precision` can hold, decoded again to f32.
pub(crate) fn quantise(texels: &mut [f32], channels: usize, precision: Precision) {
    let steps = match precision {
        Precision::F32 => return,
        Precision::F16 => {
            texels.par_iter_mut().for_each(|value| *value = exr::prelude::f16::from_f32(*value).to_f32());
            return;
        }
        Precision::U8 => 255.0,
        Precision::U16 => 65_535.0,
    };
    for channel in 0..channels {
        let values = || texels.iter().skip(channel).step_by(channels).copied();
        let (low, high) = (values().fold(f32::INFINITY, f32::min), values().fold(f32::NEG_INFINITY, f32::max));
        let (low, range) = (f64::from(low), f64::from(high) - f64::from(low));
        if range > 0.0 {
            for value in texels.iter_mut().skip(channel).step_by(channels) {
                let step = ((f64::from(*value) - low) / range * steps).round();
                *value = (low + step / steps * range) as f32;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn rounding_is_at_most_half_a_step(values in prop::collection::vec(-8.0f32..8.0, 2..60)) {
            for precision in Precision::ALL {
                let mut rounded = values.clone();
                rounded.truncate(values.len() / 2 * 2);
                quantise(&mut rounded, 2, precision);
                for (before, after) in values.iter().zip(&rounded) {
                    let half_step = match precision {
                        Precision::U8 => 8.0 / 255.0,
                        Precision::U16 => 8.0 / 65_535.0,
                        // Half of 2^-10 of a value below 8.
                        Precision::F16 => 4.0 / 1024.0,
                        Precision::F32 => 0.0,
                    };
                    // One ulp of 8 for the decoding itself.
                    prop_assert!((before - after).abs() <= half_step + 1e-6, "{precision:?}: {before} {after}");
                }
            }
        }
    }

    #[test]
    fn coarse_formats_do_round() {
        for precision in [Precision::U8, Precision::U16, Precision::F16] {
            let mut texels = [0.0, 0.123_456_7, 1.0];
            quantise(&mut texels, 1, precision);
            assert_ne!(texels[1], 0.123_456_7, "{precision:?}");
            assert_eq!((texels[0], texels[2]), (0.0, 1.0), "the ends of the range are kept");
        }
    }

    #[test]
    fn a_constant_channel_is_kept() {
        let mut texels = [0.3, 1.0, 0.3, 2.0];
        quantise(&mut texels, 2, Precision::U8);
        assert_eq!(texels, [0.3, 1.0, 0.3, 2.0]);
    }
}
