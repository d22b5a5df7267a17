//! The inputs on which stated f32 errors are measured, and the measure.
//!
//! Each set is a regime in which some formula for the weights loses its digits. A method is a function of
//! (a, b) = (tau_b D, tau_f D) that gives (alpha, w_b, w_f); the judge is [`crate::segment::weights`] on the same f32
//! inputs.
//!
//! ```
//! use tetlux_optics::accuracy::{SETS, measure};
//! use tetlux_optics::segment_f32::weights_direct;
//!
//! for set in &SETS {
//!     assert!(measure(set, 1000, weights_direct).relative < 1e-5, "{}", set.name);
//! }
//! ```

#[cfg(test)]
mod tests;

use crate::segment::weights;

/// Points of a set for stated figures.
pub const POINTS: usize = 20_000;

/// Below this f32 has no relative accuracy to keep: values are denormal or nearly so.
const SMALLEST: f64 = 1e-37;

/// Deterministic numbers (Marsaglia's xorshift64): figures are the same on every run.
#[derive(Clone, Debug)]
pub struct Random(u64);

impl Random {
    /// The sequence of a seed; 0, which has none, counts as 1.
    pub fn new(seed: u64) -> Self {
        Self(seed.max(1))
    }

    /// Uniform in [0, 1).
    pub fn unit(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Log-uniform between two powers of ten.
    pub fn decades(&mut self, low: f64, high: f64) -> f32 {
        10.0_f64.powf(low + (high - low) * self.unit()) as f32
    }
}

/// A regime of inputs.
#[derive(Clone, Copy, Debug)]
pub struct InputSet {
    /// What the inputs have in common.
    pub name: &'static str,
    generate: fn(&mut Random) -> (f32, f32),
}

impl InputSet {
    /// The first `count` pairs (a, b) of the set, always the same.
    pub fn points(&self, count: usize) -> impl Iterator<Item = (f32, f32)> + use<> {
        let (mut random, generate) = (Random::new(0x9E37_79B9_7F4A_7C15), self.generate);
        (0..count).map(move |_| generate(&mut random))
    }
}

/// All sets; together they hold every regime.
pub const SETS: [InputSet; 9] = [
    InputSet {
        name: "log-uniform 1e-8..1e6",
        generate: |random| (random.decades(-8.0, 6.0), random.decades(-8.0, 6.0)),
    },
    InputSet {
        name: "nearly equal, 1e-7..1e-2",
        generate: |random| {
            let b = random.decades(-8.0, 6.0);
            let sign = if random.unit() < 0.5 { -1.0 } else { 1.0 };
            (b * (1.0 + sign * random.decades(-7.0, -2.0)), b)
        },
    },
    InputSet {
        name: "equal",
        generate: |random| {
            let b = random.decades(-8.0, 6.0);
            (b, b)
        },
    },
    InputSet { name: "thin, 1e-8..1e-3", generate: |random| (random.decades(-8.0, -3.0), random.decades(-8.0, -3.0)) },
    InputSet {
        name: "usual, 0.01..20",
        generate: |random| ((0.01 + 19.99 * random.unit()) as f32, (0.01 + 19.99 * random.unit()) as f32),
    },
    InputSet {
        name: "dense back, a > 1e4 b",
        generate: |random| {
            let a = random.decades(0.0, 6.0);
            (a, a * random.decades(-10.0, -4.0))
        },
    },
    InputSet {
        name: "dense front, b > 1e4 a",
        generate: |random| {
            let b = random.decades(0.0, 6.0);
            (b * random.decades(-10.0, -4.0), b)
        },
    },
    InputSet { name: "dense, 1e3..1e6", generate: |random| (random.decades(3.0, 6.0), random.decades(3.0, 6.0)) },
    InputSet {
        name: "one end empty",
        generate: |random| {
            let depth = random.decades(-8.0, 6.0);
            if random.unit() < 0.5 { (depth, 0.0) } else { (0.0, depth) }
        },
    },
];

/// The largest errors of (alpha, w_b, w_f) over a set; infinite where a method gave no finite number.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Measured {
    /// Largest relative error of any of the three.
    pub relative: f64,
    /// Largest absolute error of any of the three: the error of a colour for luminances up to 1.
    pub absolute: f64,
    /// Share of the inputs for which something was not finite, in [0, 1].
    pub not_finite: f64,
}

/// Measures a method over the first `count` points of a set.
pub fn measure(set: &InputSet, count: usize, method: impl Fn(f32, f32) -> [f32; 3]) -> Measured {
    let mut worst = Measured::default();
    for (a, b) in set.points(count) {
        let (result, exact) = (method(a, b), weights(f64::from(a), f64::from(b)));
        for (value, exact) in result.into_iter().zip([exact.alpha, exact.back, exact.front]) {
            let value = f64::from(value);
            let error = if value.is_finite() { (value - exact).abs() } else { f64::INFINITY };
            worst.absolute = worst.absolute.max(error);
            if exact >= SMALLEST || error >= SMALLEST {
                worst.relative = worst.relative.max(relative_error(value, exact));
            }
        }
        if result.iter().any(|value| !value.is_finite()) {
            worst.not_finite += 1.0 / count as f64;
        }
    }
    worst
}

/// |value - expected| / |expected|; 0 where both are equal, infinite where NaN: it must win over every finite error.
pub fn relative_error(value: f64, expected: f64) -> f64 {
    let error = if value == expected { 0.0 } else { ((value - expected) / expected).abs() };
    if error.is_nan() { f64::INFINITY } else { error }
}
