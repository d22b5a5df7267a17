//! Segments through any number of widgets in f32, function by function, as a shader has them.
//!
//! Extinctions add, so the optical depth is the sum of closed forms and alpha is exact. The colour of one widget, or of
//! several of one colour, is that colour times alpha. Else the segment is cut into pieces. On a piece of the share h
//! let X_i be the exact depth of widget i, X their sum, c the colours' mean weighted by X_i, and r_i the growth of
//! h tau_i from the piece's middle to its end. With emission-absorption the piece's light is
//!
//! ```text
//! c (1 - exp(-X)) + sum_i (c_i - c) r_i K(X),  K(X) = int_0^1 (2v - 1) exp(-X v) dv
//! ```
//!
//! which is exact for thin pieces, for one colour, and where all extinctions keep their ratio.
//!
//! # How many pieces
//!
//! Let L and M bound the first and the second derivative of the sum of all extinctions over the segment (times its length,
//! u from 0 to 1), R the extinction itself, and d the largest difference of two colours. Between kinks the cumulative
//! depth of a widget differs from the parabola that r_i gives by at most h^3 M / 96 (the kernel of the error has the
//! integral v (1 - v) (v^2 + (1-v)^2) / 12); the transmittance, from exp(-X v) by a part that is even about the middle,
//! of which K sees only R h / 60, and a rest. Summed over n = 1 / h pieces, none of which lets more light through than
//! all of it, the error of a channel is at most
//!
//! ```text
//! h^3 alpha d M / 96 + h^4 (d L L R / 240 + d L M / 384) + h^5 e d L^3 / 512,   h^2 L <= 8
//! ```
//!
//! [`integrate`] takes about the smallest such n up to [`MAX_PIECES`], so the bound holds; besides, no colour leaves the
//! range of the colours. Of a wave with more kinks than that in one segment the pieces hold whole periods each, which
//! no bound here covers: there the depth alone is exact.

#[cfg(test)]
mod tests;

use crate::segment_f32::opacity;
use crate::widget_f32::{Widget, kinks, next_kink, track, track_depth, track_rate, track_slopes};

/// No segment is cut into more pieces than about this.
pub const MAX_PIECES: u32 = 512;

/// An error that thousands of segments do not make visible.
const LEAST_BOUND: f32 = 1e-12;

/// Premultiplied colour and alpha, and the pieces that it took.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Integrated {
    /// Linear RGB and alpha.
    pub color: [f32; 4],
    /// 1 where the colour has a closed form, 0 where nothing is seen.
    pub pieces: u32,
}

/// What decides how finely a segment is cut.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Summary {
    depth: f32,
    /// Sums over the widgets: largest extinction, first and second derivative.
    rate: f32,
    slope: f32,
    curvature: f32,
    /// Kinks, about.
    kinks: f32,
    /// The least and the largest colour.
    low: [f32; 3],
    high: [f32; 3],
}

fn summary(widgets: &[Widget], front: [f32; 2], back: [f32; 2], length: f32) -> Summary {
    let mut sum = Summary { low: [1e30; 3], high: [0.0; 3], ..Summary::default() };
    for widget in widgets {
        let track = track(widget, front, back, length);
        let depth = track_depth(&track, track.from, track.to);
        if depth > 0.0 {
            let [slope, curvature] = track_slopes(&track);
            sum.depth += depth;
            sum.rate += track.scale;
            sum.slope += slope;
            sum.curvature += curvature;
            sum.kinks += kinks(&track);
            for channel in 0..3 {
                sum.low[channel] = sum.low[channel].min(widget.color[channel]);
                sum.high[channel] = sum.high[channel].max(widget.color[channel]);
            }
        }
    }
    sum
}

/// Optical depth of a segment from `front` to `back` of a length in device units: exact.
pub fn optical_depth(widgets: &[Widget], front: [f32; 2], back: [f32; 2], length: f32) -> f32 {
    summary(widgets, front, back, length).depth
}

/// The number of equal pieces, cut at kinks besides, at which the error of every channel is at most `bound`.
fn piece_count(sum: &Summary, spread: f32, alpha: f32, bound: f32) -> u32 {
    let third = alpha * spread * sum.curvature / 96.0;
    let fourth = spread * sum.slope * (sum.slope * sum.rate / 240.0 + sum.curvature / 384.0);
    let fifth = 0.0053091 * spread * sum.slope * sum.slope * sum.slope;
    let mut count = (0.125 * sum.slope).sqrt().clamp(1.0, MAX_PIECES as f32).ceil();
    for _ in 0..64 {
        let h = 1.0 / count;
        if h * h * h * (third + h * (fourth + h * fifth)) <= bound {
            break;
        }
        count += (0.125 * count).floor().max(1.0);
    }
    count.min(MAX_PIECES as f32) as u32
}

/// int_0^1 (2v - 1) exp(-x v) dv for x >= 0, `alpha` = 1 - exp(-x).
fn tilt(x: f32, alpha: f32) -> f32 {
    if x < 0.6 {
        let series = 1.0 / 40.0 - x * (1.0 / 180.0 - x * (1.0 / 1008.0 - x / 6720.0));
        return -x * (1.0 / 6.0 - x * (1.0 / 12.0 - x * series));
    }
    (2.0 * alpha - x * (2.0 - alpha)) / (x * x)
}

/// Composites pieces of the share `step` front to back, cut where a widget begins or ends and, if `kinks`, at kinks.
fn composite(widgets: &[Widget], front: [f32; 2], back: [f32; 2], length: f32, step: f32, kinks: bool) -> Integrated {
    let mut result = Integrated::default();
    let mut transmittance = 1.0;
    let mut u = 0.0;
    while u < 1.0 && result.pieces < 2 * MAX_PIECES {
        // Up to where something begins, ends or has a kink.
        let mut end = 1.0_f32;
        let mut seen = false;
        for widget in widgets {
            let track = track(widget, front, back, length);
            if track.from < track.to && track.to > u {
                if track.from > u {
                    end = end.min(track.from);
                } else {
                    seen = true;
                    end = end.min(track.to);
                    if kinks {
                        end = end.min(next_kink(&track, u));
                    }
                }
            }
        }
        if seen {
            end = end.min(u + step);
        }
        // Never less than f32 resolves.
        end = end.max(u + 1e-6).min(1.0);
        if seen {
            let piece = piece(widgets, front, back, length, u, end);
            for channel in 0..3 {
                result.color[channel] += transmittance * piece[channel];
            }
            transmittance *= (-piece[3]).exp();
            result.pieces += 1;
        }
        u = end;
    }
    result
}

/// Colour and, last, optical depth of the piece from u to `end`, on which no widget begins or ends.
fn piece(widgets: &[Widget], front: [f32; 2], back: [f32; 2], length: f32, u: f32, end: f32) -> [f32; 4] {
    let width = end - u;
    let mut depth = 0.0;
    let mut growth = 0.0;
    let mut emission = [0.0; 3];
    let mut emission_growth = [0.0; 3];
    for widget in widgets {
        let track = track(widget, front, back, length);
        if track.from <= u && track.to > u {
            let own = track_depth(&track, u, end);
            let own_growth = 0.5 * width * (track_rate(&track, end) - track_rate(&track, u));
            depth += own;
            growth += own_growth;
            for channel in 0..3 {
                emission[channel] += widget.color[channel] * own;
                emission_growth[channel] += widget.color[channel] * own_growth;
            }
        }
    }
    if depth < 1e-30 {
        return [0.0; 4];
    }
    let alpha = opacity(depth);
    let shift = tilt(depth, alpha);
    let mut result = [0.0, 0.0, 0.0, depth];
    for channel in 0..3 {
        let mean = emission[channel] / depth;
        result[channel] = mean * alpha + (emission_growth[channel] - mean * growth) * shift;
    }
    result
}

/// Premultiplied colour and alpha of a segment with coordinates `front` and `back`, of a length in device units: alpha
/// exact, the error of every channel at most `bound` (and what f32 cannot hold, some 1e-5).
pub fn integrate(widgets: &[Widget], front: [f32; 2], back: [f32; 2], length: f32, bound: f32) -> Integrated {
    let sum = summary(widgets, front, back, length);
    integrate_summed(widgets, front, back, length, &sum, bound)
}

/// The same with an error of at most `share` of the segment's alpha. The alphas of a ray's segments, each as far as it is
/// seen, add up to the ray's: the ray errs by at most `share` of that, however many segments it has.
pub fn integrate_share(widgets: &[Widget], front: [f32; 2], back: [f32; 2], length: f32, share: f32) -> Integrated {
    let sum = summary(widgets, front, back, length);
    integrate_summed(widgets, front, back, length, &sum, (share * opacity(sum.depth)).max(LEAST_BOUND))
}

fn integrate_summed(
    widgets: &[Widget],
    front: [f32; 2],
    back: [f32; 2],
    length: f32,
    sum: &Summary,
    bound: f32,
) -> Integrated {
    if sum.depth <= 0.0 {
        return Integrated::default();
    }
    let alpha = opacity(sum.depth);
    let mut result = Integrated { color: [0.0, 0.0, 0.0, alpha], pieces: 1 };
    let spread = (sum.high[0] - sum.low[0]).max((sum.high[1] - sum.low[1]).max(sum.high[2] - sum.low[2]));
    if spread > 0.0 {
        // The colour stays between the least and the largest whatever the pieces: kinks may not matter.
        let matters = spread * alpha > bound;
        let few = sum.kinks <= MAX_PIECES as f32;
        let mut step = 1.0;
        if matters {
            let count = if few { piece_count(sum, spread, alpha, bound) } else { MAX_PIECES };
            step = 1.0 / count as f32;
        }
        let cut = composite(widgets, front, back, length, step, matters && few);
        result.pieces = cut.pieces;
        for channel in 0..3 {
            result.color[channel] = cut.color[channel];
        }
    }
    for channel in 0..3 {
        result.color[channel] = result.color[channel].clamp(sum.low[channel] * alpha, sum.high[channel] * alpha);
    }
    result
}

/// Colour and, last, extinction per device unit of widgets at a point: of several the extinction-weighted mean colour.
pub fn classify(widgets: &[Widget], point: [f32; 2]) -> [f32; 4] {
    let mut sum = [0.0; 4];
    for widget in widgets {
        let track = track(widget, point, point, 1.0);
        if track.from < track.to {
            let rate = track_rate(&track, 0.0);
            for channel in 0..3 {
                sum[channel] += widget.color[channel] * rate;
            }
            sum[3] += rate;
        }
    }
    if sum[3] > 0.0 {
        for channel in 0..3 {
            sum[channel] /= sum[3];
        }
    }
    sum
}
