//! Transfer functions as the shader has them, integrated in f32: the twin of `shaders/lib/transfer.wgsl`.
//!
//! Scalars are normalised to the field's range and lengths measured in device units, so that neither large nor small
//! units cost digits.

use crate::segment_f32::{weights_average, weights_direct};
use crate::transfer::{self, TransferFunction};

/// An interval of the scalar on which luminance and extinction are linear; laid out as the shader's `Piece`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C)]
pub struct Piece {
    /// Luminance and, last, extinction per device unit at the lower end.
    pub low: [f32; 4],
    /// The same at the upper end.
    pub high: [f32; 4],
    /// Lower end, upper end, 1 / width, width: of more digits than the ends, which may be one number. Both 0 if the piece is
    /// unbounded.
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
pub(crate) const UNBOUNDED: f32 = 1e30;

/// No scalar is further from [0, 1]: what lies beyond of a piece is left out.
const WINDOW: [f64; 2] = [-1.0, 2.0];

/// Pieces narrower than this share of the range are left out: slopes stay finite.
const LEAST_WIDTH: f64 = 1e-12;

/// A scalar with `range`, lower end first, mapped to [0, 1]; a range of no width to 0.
pub fn normalise([low, high]: [f64; 2], s: f64) -> f64 {
    let width = high - low;
    if width.is_nan() || width <= 0.0 {
        s - low
    } else if width.is_finite() {
        (s - low) / width
    } else {
        // Halves, so that differences of the largest numbers do not overflow.
        (0.5 * s - 0.5 * low) / (0.5 * high - 0.5 * low)
    }
}

/// The pieces of a transfer function over the whole axis, ascending and without gaps, for [`integrate`].
///
/// `range` is mapped to [0, 1] ([`normalise`]); `extinction` is the extinction per device unit of opacity 1.
pub fn pieces(transfer: &TransferFunction, range: [f64; 2], extinction: f64) -> Vec<Piece> {
    let far = f64::from(UNBOUNDED);
    let place = |s: f64| normalise(range, s).clamp(-far, far);
    let end = |[r, g, b, opacity]: [f64; 4]| {
        let [r, g, b] = [r, g, b].map(|c| c.min(f64::from(f32::MAX)) as f32);
        // Above MAX_DEPTH everything is opaque; below, the product with any length stays finite.
        [r, g, b, (opacity * extinction).min(1e15) as f32]
    };
    let points = transfer.control_points();
    // A transfer function has at least one control point.
    let (first, last) = (points[0], points[points.len() - 1]);
    let [below, above] = [
        (transfer.luminance_below(first), transfer.opacity_below(first)),
        (transfer.luminance(last), transfer.opacity(last)),
    ]
    .map(|([r, g, b], opacity)| end([r, g, b, opacity]));
    let single = |place: f64| place.clamp(WINDOW[0], WINDOW[1]) as f32;
    let mut at = single(place(first));
    let mut pieces = vec![Piece { low: below, high: below, s: [-UNBOUNDED, at, 0.0, 0.0] }];
    for piece in transfer.pieces() {
        let ends = piece.s.map(place);
        let inside = ends.map(|end| end.clamp(WINDOW[0], WINDOW[1]));
        let width = inside[1] - inside[0];
        // Narrower ones make a step.
        if width >= LEAST_WIDTH {
            let [low, high] = inside.map(|place| end(value_at(&piece, (place - ends[0]) / (ends[1] - ends[0]))));
            let next = single(ends[1]);
            pieces.push(Piece { low, high, s: [at, next, (1.0 / width) as f32, width as f32] });
            at = next;
        }
    }
    pieces.push(Piece { low: above, high: above, s: [at, UNBOUNDED, 0.0, 0.0] });
    pieces
}

/// Luminance and, last, opacity of a piece at a share of its width.
fn value_at(piece: &transfer::Piece, share: f64) -> [f64; 4] {
    let mix = |low: f64, high: f64| if low == high { low } else { low * (1.0 - share) + high * share };
    let [low, high] = piece.luminance;
    let [r, g, b] = [0, 1, 2].map(|channel| mix(low[channel], high[channel]));
    [r, g, b, mix(piece.opacity[0], piece.opacity[1])]
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
        let piece = &pieces[k];
        let bound = if rise > 0.0 { piece.s[1] } else { piece.s[0] };
        let end = ((bound - s_front) / rise).max(begin).min(1.0);
        // Where a piece is entered and left it has its own ends and width, however narrow it is.
        let (entered, left) = (begin > 0.0, end < 1.0);
        let mut part = end - begin;
        if entered && left {
            part = (piece.s[3] / rise.abs()).min(1.0);
        }
        if part > 0.0 {
            let mut front = if rise > 0.0 { piece.low } else { piece.high };
            let mut back = if rise > 0.0 { piece.high } else { piece.low };
            if !entered {
                front = classify(piece, s_front);
            }
            if !left {
                back = classify(piece, s_back);
            }
            part *= length;
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
    fn narrow_pieces_keep_their_area() {
        // Triangles of area 1, down to where single precision does not tell their ends apart; in 0.9 of a range over a
        // length of 0.9 each is an optical depth of 1.
        for half in [1e-3, 1e-6, 1e-9, 2e-12] {
            let heights = [(0.4321 - half, 0.0), (0.4321, 1.0 / half), (0.4321 + half, 0.0)];
            let peak = TransferFunction::new(
                vec![ColorNode { s: 0.0, rgb: [0.5, 1.0, 0.0] }],
                heights.map(|(s, opacity)| OpacityNode { s, opacity }).to_vec(),
            );
            let pieces = pieces(&peak.unwrap(), [0.0, 1.0], 1.0);
            for [front, back] in [[0.05, 0.95], [0.95, 0.05]] {
                let found = whole(&pieces, front, back, 0.9);
                let alpha = -(-1.0f64).exp_m1();
                for (found, expected) in found.into_iter().zip([0.5 * alpha, alpha, 0.0, alpha]) {
                    assert!((f64::from(found) - expected).abs() < 1e-5, "{half:e}: {found}, not {expected}");
                }
            }
        }
    }

    #[test]
    fn pieces_that_reach_beyond_the_data_are_what_they_were() {
        for wide in [1.0, 1e3, 1e9] {
            let ends = [(0.5 - 10.0 * wide, 0.0), (0.5 + 30.0 * wide, 8.0)];
            let ramp = TransferFunction::new(
                ends.map(|(s, opacity)| ColorNode { s, rgb: [opacity; 3] }).to_vec(),
                ends.map(|(s, opacity)| OpacityNode { s, opacity }).to_vec(),
            )
            .unwrap();
            let pieces = pieces(&ramp, [0.0, 1.0], 1.0);
            for s in [0.0, 0.25, 1.0] {
                let [red, .., opacity] = classify(&pieces[piece_at(&pieces, s)], s);
                let exact = ramp.opacity(f64::from(s));
                assert!((f64::from(opacity) - exact).abs() < 1e-6 * exact && red == opacity, "{opacity}, not {exact}");
            }
        }
    }

    #[test]
    fn scalars_of_any_range_are_normalised() {
        for [low, high] in [[0.0, 1.0], [-1e-310, 1e-310], [-1.7e308, 1.7e308], [5.0, 5.0 + 1e-12], [-1e30, 2e30]] {
            for share in [0.0, 0.25, 0.5, 1.0] {
                let found = normalise([low, high], low * (1.0 - share) + high * share);
                assert!((found - share).abs() < 1e-3, "{low:e} to {high:e}: {found}, not {share}");
            }
        }
        assert_eq!([normalise([7.0, 7.0], 7.0), normalise([7.0, 7.0], 7.5)], [0.0, 0.5]);
    }

    #[test]
    fn a_range_of_no_width_is_one_value() {
        let pieces = pieces(&lively(), [0.75, 0.75], 1.0);
        let got = whole(&pieces, 0.0, 0.0, 0.5);
        assert!((f64::from(got[3]) - (1.0 - (-2.0f64).exp())).abs() < TOLERANCE, "opacity 4 over half a unit: {got:?}");
    }
}
