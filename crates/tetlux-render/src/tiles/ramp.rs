//! Ray segments through pieces of the transfer function, a vector of pixels at a time.
//!
//! On a piece luminance and extinction are linear in the scalar, so that one polynomial in optical depth does
//! ([`tetlux_optics::symmetric_f32`]): no division, table or gather.

use fearless_simd::{Select, Simd, SimdBase, SimdFloat, SimdMask};
use tetlux_optics::symmetric_f32::{
    SHIFT_8_0, SHIFT_8_1, SHIFT_8_2, SHIFT_19_0, SHIFT_19_1, SHIFT_19_2, SHIFT_19_3, TWO_SINH_HALF,
};
use tetlux_optics::transfer_f32::{Piece, Weights};

use super::block::Part;

#[cfg(test)]
mod tests;

/// A piece of the transfer function as the tiles need it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ramp {
    /// Luminance and, last, extinction per device unit at the lower end.
    low: [f32; 4],
    /// Their change per unit of the scalar.
    slope: [f32; 4],
    /// Ends of the piece.
    pub(crate) ends: [f32; 2],
    /// Its width, of more digits than the ends.
    width: f32,
    /// Its luminance is constant: where in a segment the light comes from does not matter.
    flat: bool,
}

/// Luminances are limited to this value, so that slopes stay finite.
const BRIGHTEST: f32 = 1e25;

/// Scalars lie between 0 and 1: where pieces without an end may end.
const BEYOND: [f32; 2] = [-1.0, 2.0];

impl Ramp {
    /// With `all_weights` no luminance is taken to be constant.
    pub(crate) fn new(piece: &Piece, all_weights: bool) -> Ramp {
        let limited = |c: [f32; 4]| c.map(|x| x.min(BRIGHTEST));
        let (low, high) = (limited(piece.low), limited(piece.high));
        let slope = std::array::from_fn(|i| (high[i] - low[i]) * piece.s[2]);
        let flat = !all_weights && low[..3] == high[..3];
        let ends = [piece.s[0].max(BEYOND[0]), piece.s[1].min(BEYOND[1])];
        let width = if piece.s[3] > 0.0 { piece.s[3] } else { ends[1] - ends[0] };
        Ramp { low, slope, ends, width, flat }
    }

    /// Whether it is transparent throughout.
    pub(crate) fn is_empty(&self) -> bool {
        self.low[3] == 0.0 && self.slope[3] == 0.0
    }
}

/// The pieces of a transfer function, ascending.
#[derive(Debug)]
pub(crate) struct Ramps {
    pieces: Vec<Ramp>,
    /// Their upper ends, and as many more as a vector has lanes.
    uppers: Vec<f32>,
}

/// Most lanes of a vector.
const MOST_LANES: usize = 16;

impl Ramps {
    /// Of pieces in ascending order.
    pub(crate) fn new(pieces: Vec<Ramp>) -> Ramps {
        let uppers = pieces.iter().map(|ramp| ramp.ends[1]).chain([f32::MAX; MOST_LANES]).collect();
        Ramps { pieces, uppers }
    }

    /// The pieces from the first to the last.
    #[inline(always)]
    pub(crate) fn among(&self, [first, last]: [usize; 2]) -> &[Ramp] {
        &self.pieces[first..=last]
    }

    /// Those of the pieces from the first to the last on which segments lie that have a length. Scalars are less `base`.
    #[inline(always)]
    pub(crate) fn met<S: Simd>(&self, simd: S, [first, last]: [usize; 2], base: f32, part: &Part<S>) -> [usize; 2] {
        let far = part.rise.max(-part.rise);
        let seen = part.length.simd_gt(0.0);
        let low = seen.select(part.scalar - far, S::f32s::splat(simd, f32::MAX)).reduce_min();
        let high = seen.select(part.scalar + far, S::f32s::splat(simd, f32::MIN)).reduce_max();
        // Counted, not searched for: no branch depends on it, so that the processor has not to guess.
        let (mut below, mut begun, mut start) = (first, first, first);
        while start < last {
            let uppers = S::f32s::from_slice(simd, &self.uppers[start..start + S::f32s::LEN]) - base;
            below += uppers.simd_le(low).to_bitmask().count_ones() as usize;
            begun += uppers.simd_lt(high).to_bitmask().count_ones() as usize;
            start += S::f32s::LEN;
        }
        [below.min(last), begun.max(below).min(last)]
    }
}

/// Premultiplied colour and alpha of a vector of pixels.
pub(crate) type Pixels<S> = [<S as Simd>::f32s; 4];

/// (1 - e^-x) / x, coefficients ascending, for 0 <= x <= 1/8. Relative error 1.6e-8.
const ALPHA_FAINT: [f32; 4] = [1.0, -0.499_996_04, 0.166_508_91, -0.039_636_7];

/// w_b - w_f of [`tetlux_optics::symmetric_f32`] for x <= 1/8: its terms in e, e x, e x^2, e^2, e^2 x, e^3, x^2 and x^3.
/// Error 1.9e-6 of alpha.
const SHIFT_FAINT: [f32; 8] = [
    0.333_331_38,
    -0.166_522_56,
    0.047_644_343,
    0.033_305_32,
    -0.015_923_087,
    0.002_287_907_3,
    -0.166_506_36,
    0.079_121_81,
];

/// Optical depth up to which these hold.
const FAINT: f32 = 0.125;

/// e^y = polynomial in y, coefficients ascending, for -1/4 <= y <= 0. Relative error 3e-8.
const EXP_THIN: [f32; 5] = [1.0, 0.99999696, 0.49990398, 0.1655997, 0.03674677];

/// The same for -3/2 <= y <= 0. Relative error 3e-7.
const EXP: [f32; 8] = [1.0, 0.9999986, 0.49998263, 0.16658117, 0.041454468, 0.008038928, 0.0011533659, 9.22696e-5];

/// Optical depth up to which the shortest polynomials hold.
const THIN: f32 = 0.5;

/// Optical depth of the pieces that dense segments are cut into: what the polynomials hold for.
const CUT: f32 = 3.0;

/// Pieces of a dense segment that are looked at: what lies behind seven of them shows by e^-21.
const CUTS: usize = 7;

#[inline(always)]
fn horner<S: Simd, const N: usize>(simd: S, c: [f32; N], x: S::f32s) -> S::f32s {
    let mut sum = S::f32s::splat(simd, c[N - 1]);
    for i in (0..N - 1).rev() {
        sum = sum.mul_add(x, c[i]);
    }
    sum
}

/// Composites what lies behind the pixels so far: a segment on one piece of the transfer function, `middle` the scalar in
/// its middle less the piece's lower end, `rise` by how much it is more at the back end, of a length in device units, 0
/// where there is nothing.
#[inline(always)]
pub(crate) fn add_segment<S: Simd>(
    simd: S,
    ramp: &Ramp,
    model: Weights,
    middle: S::f32s,
    rise: S::f32s,
    length: S::f32s,
    pixels: &mut Pixels<S>,
) {
    let half = S::f32s::splat(simd, 0.5);
    // Optical depth and half the difference of the depths that the ends' extinctions would make.
    let x = (middle.mul_add(ramp.slope[3], ramp.low[3]) * length).max(0.0);
    let e = rise * ramp.slope[3] * length;
    if !x.simd_gt(FAINT).any_true() {
        let alpha = x * horner(simd, ALPHA_FAINT, x);
        let moment = if ramp.flat || model == Weights::Average {
            S::f32s::splat(simd, 0.0)
        } else {
            let [e1, ex, exx, ee, eex, eee, xx, xxx] = SHIFT_FAINT;
            let splat = |c: f32| S::f32s::splat(simd, c);
            let high = e.mul_add(eee, x.mul_add(eex, splat(ee)));
            let low = x.mul_add(x.mul_add(exx, splat(ex)), splat(e1));
            let square = x * x;
            square.mul_add(x.mul_add(xxx, splat(xx)), e * e.mul_add(high, low)) * rise
        };
        add(simd, ramp, alpha, moment, middle, pixels);
    } else if !x.simd_gt(THIN).any_true() {
        let root = horner(simd, EXP_THIN, x * -0.5);
        let square = x * x;
        let series = square.mul_add(TWO_SINH_HALF[2], TWO_SINH_HALF[1]).mul_add(square, TWO_SINH_HALF[0]);
        let shift = if ramp.flat || model == Weights::Average {
            S::f32s::splat(simd, 0.0)
        } else {
            let high = square.mul_add(SHIFT_8_2, horner(simd, SHIFT_8_1, e));
            square.mul_add(high, e * horner(simd, SHIFT_8_0, e))
        };
        add(simd, ramp, root * x * series, root * shift * rise, middle, pixels);
    } else if model == Weights::Average {
        // Squared five times; beyond a depth of 48 nothing is left.
        let mut left = horner(simd, EXP, (x * (-1.0 / 32.0)).max(-1.5));
        for _ in 0..5 {
            left = left * left;
        }
        let root = horner(simd, EXP, x.min(CUT) * -0.5);
        let thin = root * x * horner(simd, TWO_SINH_HALF, x * x);
        let alpha = x.simd_lt(THIN).select(thin, S::f32s::splat(simd, 1.0) - left);
        add(simd, ramp, alpha, S::f32s::splat(simd, 0.0), middle, pixels);
    } else if !x.simd_gt(CUT).any_true() {
        add_medium(simd, ramp, x, e, middle, rise, pixels);
    } else {
        // From the front pieces of depth CUT, until the end or nothing is left to be seen.
        let (depth, change) = (x - e, e + e);
        let front = middle - rise;
        let (step, one) = (rise + rise, S::f32s::splat(simd, 1.0));
        let mut from = S::f32s::splat(simd, 0.0);
        for _ in 0..CUTS {
            let start = change.mul_add(from, depth).max(0.0);
            let root = start.mul_add(start, change * (2.0 * CUT)).max(0.0).sqrt();
            let width = (S::f32s::splat(simd, 2.0 * CUT) / (start + root).max(1e-20)).min(one - from);
            let turn = change * width * width * half;
            let part = start.mul_add(width, turn).max(0.0).min(CUT);
            let center = step.mul_add(width.mul_add(half, from), front);
            add_medium(simd, ramp, part, turn, center, step * width * half, pixels);
            from += width;
            if !from.simd_lt(1.0).any_true() {
                break;
            }
        }
    }
}

/// A segment of depth x up to [`CUT`].
#[inline(always)]
fn add_medium<S: Simd>(
    simd: S,
    ramp: &Ramp,
    x: S::f32s,
    e: S::f32s,
    middle: S::f32s,
    rise: S::f32s,
    pixels: &mut Pixels<S>,
) {
    let root = horner(simd, EXP, x * -0.5);
    let square = x * x;
    let shift = if ramp.flat {
        S::f32s::splat(simd, 0.0)
    } else {
        let high = square.mul_add(horner(simd, SHIFT_19_3, e), horner(simd, SHIFT_19_2, e));
        let high = square.mul_add(high, horner(simd, SHIFT_19_1, e));
        square.mul_add(high, e * horner(simd, SHIFT_19_0, e))
    };
    add(simd, ramp, root * x * horner(simd, TWO_SINH_HALF, square), root * shift * rise, middle, pixels);
}

/// Adds opacity `alpha` with the luminance at scalar `middle`, and its slope times `moment`.
#[inline(always)]
fn add<S: Simd>(simd: S, ramp: &Ramp, alpha: S::f32s, moment: S::f32s, middle: S::f32s, pixels: &mut Pixels<S>) {
    #[cfg(feature = "planted")]
    let (alpha, moment) = crate::planted::segment(simd, alpha, moment);
    let left = S::f32s::splat(simd, 1.0) - pixels[3];
    let weight = left * alpha;
    let first = middle.mul_add(weight, left * moment);
    for i in 0..3 {
        pixels[i] = weight.mul_add(ramp.low[i], first.mul_add(ramp.slope[i], pixels[i]));
    }
    pixels[3] += weight;
}

/// Composites a segment that meets several pieces, `ramps` ascending. Its scalars are less `base`.
#[inline(always)]
pub(crate) fn add_cut_segment<S: Simd>(
    simd: S,
    ramps: &[Ramp],
    base: f32,
    model: Weights,
    part: &Part<S>,
    pixels: &mut Pixels<S>,
) {
    let (front, back) = (part.scalar - part.rise, part.scalar + part.rise);
    let change = part.rise + part.rise;
    let falling = change.simd_lt(0.0);
    let (zero, one) = (S::f32s::splat(simd, 0.0), S::f32s::splat(simd, 1.0));
    // Where the scalar is constant, any large slope makes the piece that begins at or below it the whole segment.
    let per_width = one / change.max(-change).max(1e-20);
    // Front to back the pieces ascend where the scalar rises, and descend where it falls.
    for (length, descend) in [(falling.select(zero, part.length), false), (falling.select(part.length, zero), true)] {
        if !length.simd_gt(0.0).any_true() {
            continue;
        }
        let per_scalar = if descend { -per_width } else { per_width };
        let mut begin = zero;
        for step in 1..=ramps.len() {
            let ramp = &ramps[if descend { ramps.len() - step } else { step - 1 }];
            let cut = ramp.ends[usize::from(!descend)] - base;
            let share = (S::f32s::splat(simd, cut) - front) * per_scalar;
            let end = if step < ramps.len() { share.max(0.0).min(1.0) } else { one };
            // Where a piece is entered and left it has its own width, however narrow it is.
            let (entered, left) = (begin.simd_gt(0.0), end.simd_lt(1.0));
            let length = (entered & left).select((per_width * ramp.width).min(1.0), end - begin) * length;
            if !ramp.is_empty() {
                let low = ramp.ends[0] - base;
                let inside = |s: S::f32s| (s - low).max(0.0).min(ramp.width) * 0.5;
                let (front, back) = (inside(front), inside(back));
                add_segment(simd, ramp, model, front + back, back - front, length, pixels);
            }
            begin = end;
        }
    }
}
