//! Colour of one scalar and opacity of another in f32, function by function, as a shader has them.
//!
//! Both scalars are linear along a segment. It is cut at the nodes of both functions, so that on each piece luminance
//! and extinction are linear and [`crate::segment_f32::weights_direct`] is exact: relative error 1e-5.

#[cfg(test)]
mod tests;

use crate::segment_f32::weights_direct;
use crate::transfer::{ColorNode, OpacityNode, TransferFunction};
use crate::transfer_f32::{Piece, classify, piece_at, pieces};

/// The pieces of the luminance over the first scalar and of the extinction over the second, as
/// [`crate::transfer_f32::pieces`] makes them, each scalar's range mapped to [0, 1].
pub fn axes(transfer: &TransferFunction, ranges: [[f64; 2]; 2], extinction: f64) -> [Vec<Piece>; 2] {
    let clear = vec![OpacityNode { s: transfer.color_nodes()[0].s, opacity: 0.0 }];
    let black = vec![ColorNode { s: transfer.opacity_nodes()[0].s, rgb: [0.0; 3] }];
    let color = TransferFunction::new(transfer.color_nodes().to_vec(), clear);
    let opacity = TransferFunction::new(black, transfer.opacity_nodes().to_vec());
    // Lists of a transfer function, each with one node of its own: both are transfer functions.
    [(color, ranges[0]), (opacity, ranges[1])]
        .map(|(function, range)| pieces(&function.unwrap_or_else(|_| transfer.clone()), range, extinction))
}

/// Where a scalar that rises by `rise` from `front` leaves a piece; 2 if it does not move.
pub(crate) fn leaves(piece: &Piece, front: f32, rise: f32) -> f32 {
    if rise.abs() < 1e-20 {
        return 2.0;
    }
    let bound = if rise > 0.0 { piece.s[1] } else { piece.s[0] };
    (bound - front) / rise
}

/// The piece after this one in the direction of a scalar, within the list.
pub(crate) fn next(k: usize, rise: f32, count: usize) -> usize {
    if rise > 0.0 { (k + 1).min(count - 1) } else { k.max(1) - 1 }
}

/// Premultiplied colour and alpha of a segment with both scalars at its ends, of a length in device units.
///
/// `color` and `opacity` are the pieces of [`axes`].
pub fn integrate(color: &[Piece], opacity: &[Piece], front: [f32; 2], back: [f32; 2], length: f32) -> [f32; 4] {
    let rise = [back[0] - front[0], back[1] - front[1]];
    let mut i = piece_at(color, front[0]);
    let mut j = piece_at(opacity, front[1]);
    let mut result = [0.0; 4];
    let mut begin = 0.0_f32;
    for _ in 0..color.len() + opacity.len() {
        let leave_color = leaves(&color[i], front[0], rise[0]);
        let leave_opacity = leaves(&opacity[j], front[1], rise[1]);
        let end = leave_color.min(leave_opacity).max(begin).min(1.0);
        if end > begin {
            let light_f = classify(&color[i], front[0] + rise[0] * begin);
            let light_b = classify(&color[i], front[0] + rise[0] * end);
            let tau_f = classify(&opacity[j], front[1] + rise[1] * begin)[3];
            let tau_b = classify(&opacity[j], front[1] + rise[1] * end)[3];
            let part = (end - begin) * length;
            let w = weights_direct(tau_b * part, tau_f * part);
            for channel in 0..3 {
                result[channel] += (1.0 - result[3]) * (light_f[channel] * w[2] + light_b[channel] * w[1]);
            }
            result[3] += (1.0 - result[3]) * w[0];
        }
        begin = end;
        if begin >= 1.0 {
            break;
        }
        if leave_color <= leave_opacity {
            i = next(i, rise[0], color.len());
        } else {
            j = next(j, rise[1], opacity.len());
        }
    }
    result
}
