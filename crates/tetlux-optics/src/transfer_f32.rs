//! Transfer functions as the shader has them, integrated in f32: the twin of `shaders/lib/transfer.wgsl`.
//!
//! Scalars are normalised to the field's range and lengths measured in device units, so that neither large nor small
//! units cost digits.

use crate::segment_f32::{weights_average, weights_direct};
use crate::transfer::TransferFunction;

/// An interval of the scalar on which luminance and extinction are linear; laid out as the shader's `Piece`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C)]
pub struct Piece {
    /// Luminance and, last, extinction per device unit at the lower end.
    pub low: [f32; 4],
    /// The same at the upper end.
    pub high: [f32; 4],
    /// Lower end, upper end, 1 / (upper - lower) or 0 if the piece is unbounded, unused.
    pub s: [f32; 4],
}

/// Which integral is evaluated on each piece.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Weights {
    /// [`weights_direct`].
    Direct,
    /// [`weights_average`].
    Average,
}

/// Where unbounded pieces end.
const UNBOUNDED: f32 = 1e30;

/// The pieces of a transfer function over the whole axis, ascending and without gaps, for [`integrate`].
///
/// `range` is mapped to [0, 1] (a range of no width to 0); `extinction` is the extinction per device unit of opacity 1.
pub fn pieces(transfer: &TransferFunction, range: [f64; 2], extinction: f64) -> Vec<Piece> {
    let scale = if range[1] > range[0] { 1.0 / (range[1] - range[0]) } else { 1.0 };
    let place = |s: f64| (((s - range[0]) * scale) as f32).clamp(-UNBOUNDED, UNBOUNDED);
    let end = |luminance: [f64; 3], opacity: f64| {
        let [r, g, b] = luminance.map(|c| c.min(f64::from(f32::MAX)) as f32);
        // Above MAX_DEPTH everything is opaque; below, the product with any length stays finite.
        [r, g, b, (opacity * extinction).min(1e15) as f32]
    };
    let mut pieces = vec![Piece { s: [-UNBOUNDED, UNBOUNDED, 0.0, 0.0], ..Piece::default() }];
    for piece in transfer.pieces() {
        let [low, high] = piece.s.map(place);
        // Control points that are one in f32 make a step.
        if low < high {
            let [at_low, at_high] = [0, 1].map(|i| end(piece.luminance[i], piece.opacity[i]));
            pieces.push(Piece { low: at_low, high: at_high, s: [low, high, 1.0 / (high - low), 0.0] });
        }
    }
    let points = transfer.control_points();
    // A transfer function has at least one control point.
    let (first, last) = (points[0], points[points.len() - 1]);
    let below = end(transfer.luminance_below(first), transfer.opacity_below(first));
    let above = end(transfer.luminance(last), transfer.opacity(last));
    let (first, last) = (place(first), place(last));
    pieces[0] = Piece { low: below, high: below, s: [-UNBOUNDED, first, 0.0, 0.0] };
    pieces.push(Piece { low: above, high: above, s: [last, UNBOUNDED, 0.0, 0.0] });
    pieces
}

/// The last piece that begins at or below s.
pub fn piece_at(pieces: &[Piece], s: f32) -> usize {
    piece_among(pieces, [0, pieces.len() - 1], s)
}

/// The same, known to be among the pieces from `range[0]` to `range[1]`.
fn piece_among(pieces: &[Piece], range: [usize; 2], s: f32) -> usize {
    let mut low = range[0];
    let mut high = range[1] + 1;
    while high - low > 1 {
        let middle = (low + high) / 2;
        if pieces[middle].s[0] <= s {
            low = middle;
        } else {
            high = middle;
        }
    }
    low
}

pub(crate) fn classify(piece: &Piece, s: f32) -> [f32; 4] {
    let t = ((s - piece.s[0]) * piece.s[2]).clamp(0.0, 1.0);
    std::array::from_fn(|i| piece.low[i] + (piece.high[i] - piece.low[i]) * t)
}

/// Premultiplied colour and alpha of a segment with scalars `s_front` and `s_back`, of a length in device units, on
/// which the scalar is linear: cut at the control points, composited front to back.
///
/// `range` are the first and the last piece that scalars of the segment's cell meet ([`piece_at`]): for most cells one.
pub fn integrate(
    pieces: &[Piece],
    range: [usize; 2],
    model: Weights,
    s_front: f32,
    s_back: f32,
    length: f32,
) -> [f32; 4] {
    let weights = |a, b| match model {
        Weights::Direct => weights_direct(a, b),
        Weights::Average => weights_average(a, b),
    };
    let rise = s_back - s_front;
    let mut k = piece_among(pieces, range, s_front);
    // Below this the scalar is constant, and dividing by it might overflow.
    if rise.abs() < 1e-20 {
        let c = classify(&pieces[k], s_front);
        let w = weights(c[3] * length, c[3] * length);
        return [c[0] * w[0], c[1] * w[0], c[2] * w[0], w[0]];
    }
    let mut color = [0.0; 3];
    let mut alpha = 0.0;
    let mut begin = 0.0;
    for _ in range[0]..=range[1] {
        let bound = if rise > 0.0 { pieces[k].s[1] } else { pieces[k].s[0] };
        let end = ((bound - s_front) / rise).max(begin).min(1.0);
        if end > begin {
            let front = classify(&pieces[k], s_front + rise * begin);
            let back = classify(&pieces[k], s_front + rise * end);
            let part = (end - begin) * length;
            let w = weights(back[3] * part, front[3] * part);
            for i in 0..3 {
                color[i] += (1.0 - alpha) * (front[i] * w[2] + back[i] * w[1]);
            }
            alpha += (1.0 - alpha) * w[0];
        }
        begin = end;
        if begin >= 1.0 {
            break;
        }
        // A segment that has not ended has a next piece.
        k = if rise > 0.0 { (k + 1).min(range[1]) } else { k.saturating_sub(1).max(range[0]) };
    }
    [color[0], color[1], color[2], alpha]
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::segment::segment;
    use crate::transfer::{ColorNode, OpacityNode};

    /// Steps, a narrow peak, separate nodes, a stretch of zero.
    fn lively() -> TransferFunction {
        let color = [(-1.0, [0.1, 0.2, 0.9]), (0.4, [0.9, 0.1, 0.3]), (0.4, [0.2, 1.0, 0.1]), (3.0, [1.0, 0.8, 0.0])];
        let opacity = [(-0.5, 0.3), (0.1, 0.0), (0.7, 0.0), (0.75, 4.0), (0.8, 0.0), (2.0, 0.5), (2.0, 1.5)];
        TransferFunction::new(
            color.map(|(s, rgb)| ColorNode { s, rgb }).to_vec(),
            opacity.map(|(s, opacity)| OpacityNode { s, opacity }).to_vec(),
        )
        .unwrap()
    }

    /// f32 segment weights (1e-5 of alpha) and f32 cuts: a cut is off by 1e-7 of the scalar's normalised range of up
    /// to 4, which a peak of slope 80 an optical depth of up to 10 turns into 4e-5.
    const TOLERANCE: f64 = 1e-4;

    /// The range of pieces found as a renderer does for a cell.
    fn whole(pieces: &[Piece], s_front: f32, s_back: f32, length: f32) -> [f32; 4] {
        let range = [s_front.min(s_back), s_front.max(s_back)].map(|s| piece_at(pieces, s));
        integrate(pieces, range, Weights::Direct, s_front, s_back, length)
    }

    fn error(range: [f64; 2], s_front: f64, s_back: f64, length: f64) -> f64 {
        let transfer = lively();
        let exact = segment(&transfer, 1.0, s_front, s_back, length);
        let place = |s: f64| ((s - range[0]) / (range[1] - range[0])) as f32;
        let pieces = pieces(&transfer, range, 1.0);
        let got = whole(&pieces, place(s_front), place(s_back), length as f32);
        let color = (0..3).map(|i| (f64::from(got[i]) - exact.color[i]).abs()).fold(0.0, f64::max);
        color.max((f64::from(got[3]) - exact.alpha).abs())
    }

    proptest! {
        #[test]
        fn agrees_with_f64(front in -1.5f64..3.5, back in -1.5f64..3.5, length in 0.0f64..10.0) {
            let e = error([-1.5, 3.5], front, back, length);
            prop_assert!(e < TOLERANCE, "error {e}");
        }

        #[test]
        fn never_leaves_the_unit_interval_or_the_finite(front in proptest::num::f32::ANY, back in proptest::num::f32::ANY, length in proptest::num::f32::ANY) {
            let s = |x: f32| if x.is_finite() { x.clamp(0.0, 1.0) } else { 0.5 };
            let length = if length.is_finite() { length.abs() } else { 1.0 };
            let result = whole(&pieces(&lively(), [-1.5, 3.5], 1.0), s(front), s(back), length);
            for v in result {
                prop_assert!((0.0..=1.0 + 1e-5).contains(&v), "{result:?}");
            }
        }
    }

    #[test]
    fn constant_and_steps_at_the_ends() {
        for (front, back) in [(0.75, 0.75), (0.4, 0.4), (0.4, 3.5), (3.5, 0.4), (2.0, 2.0), (2.0, 0.0), (-1.5, -1.5)] {
            let e = error([-1.5, 3.5], front, back, 1.0);
            assert!(e < TOLERANCE, "{front} to {back}: {e}");
        }
    }

    #[test]
    fn pieces_cover_the_axis_without_gaps() {
        let pieces = pieces(&lively(), [0.0, 1.0], 2.0);
        assert_eq!(pieces[0].s[0], -UNBOUNDED);
        assert_eq!(pieces[pieces.len() - 1].s[1], UNBOUNDED);
        for pair in pieces.windows(2) {
            assert_eq!(pair[0].s[1], pair[1].s[0]);
        }
        // Opacity 1.5 above the last node, at an extinction of 2 a unit.
        assert_eq!(pieces[pieces.len() - 1].low[3], 3.0);
    }

    #[test]
    fn a_range_of_no_width_is_one_value() {
        let pieces = pieces(&lively(), [0.75, 0.75], 1.0);
        let got = whole(&pieces, 0.0, 0.0, 0.5);
        assert!((f64::from(got[3]) - (1.0 - (-2.0f64).exp())).abs() < TOLERANCE, "opacity 4 over half a unit: {got:?}");
    }
}
