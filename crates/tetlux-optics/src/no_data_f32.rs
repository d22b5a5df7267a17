//! Cells without data as devices have them, in f32: the twin of `shaders/lib/no_data.wgsl`.
//!
//! Scalars are normalised to [0, 1]: a cell without data has [`NO_DATA`] throughout, beyond all others, and a transfer
//! function that sees it one more piece there.

use crate::NoData;
use crate::segment_f32::{clean, opacity};
use crate::transfer_f32::{Piece, UNBOUNDED};

/// The scalar of a cell without data.
pub const NO_DATA: f32 = 2.0;

/// Scalars from here on count as [`NO_DATA`]: interpolation rounds them.
pub const NO_DATA_FROM: f32 = 1.5;

/// Luminance and, last, extinction per device unit; `extinction` is that of opacity 1.
pub fn no_data(look: &NoData, extinction: f64) -> [f32; 4] {
    let [r, g, b] = look.luminance().map(|c| c.min(f64::from(f32::MAX)) as f32);
    [r, g, b, (look.opacity() * extinction).min(1e15) as f32]
}

/// Premultiplied colour and alpha of a segment in a cell without data, of a length in device units.
pub fn shade_no_data(no_data: [f32; 4], length: f32) -> [f32; 4] {
    let alpha = opacity(clean(no_data[3] * length));
    [no_data[0] * alpha, no_data[1] * alpha, no_data[2] * alpha, alpha]
}

/// Adds the piece of cells without data to the [`pieces`](crate::transfer_f32::pieces) of a transfer function. Those that
/// begin beyond the data give way to it.
pub fn add_no_data(pieces: &mut Vec<Piece>, no_data: [f32; 4]) {
    pieces.retain(|piece| piece.s[0] <= 1.0);
    pieces.push(Piece { low: no_data, high: no_data, s: [NO_DATA_FROM, UNBOUNDED, 0.0, 0.0] });
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::transfer::{ColorNode, OpacityNode, TransferFunction};
    use crate::transfer_f32::{Weights, integrate, piece_at, pieces};

    /// Relative error of a single-precision exponential and a product.
    const TOLERANCE: f64 = 2e-6;

    #[test]
    fn both_ways_are_the_closed_form() {
        let look = NoData::new([0.25, 1.0, 3.0], 0.5).unwrap();
        let device = no_data(&look, 4.0);
        assert_eq!(device, [0.25, 1.0, 3.0, 2.0]);
        // Control points before, within and far beyond the data.
        let nodes = [(-3.0, 9.0), (0.5, 0.0), (0.9, 3.0), (2.0, 1.0), (40.0, 7.0)];
        let transfer = TransferFunction::new(
            vec![ColorNode { s: 0.0, rgb: [0.5; 3] }],
            nodes.map(|(s, opacity)| OpacityNode { s, opacity }).to_vec(),
        );
        let plain = pieces(&transfer.unwrap(), [0.0, 1.0], 4.0);
        let mut all = plain.clone();
        add_no_data(&mut all, device);
        let last = all.len() - 1;
        assert!([NO_DATA, NO_DATA - 0.25, NO_DATA + 0.25].iter().all(|&s| piece_at(&all, s) == last));
        for length in [0.0, 1e-12, 1e-3, 1.0, 1e6] {
            let alpha = -(-2.0 * f64::from(length)).exp_m1();
            for found in
                [shade_no_data(device, length), integrate(&all, [last; 2], Weights::Direct, NO_DATA, NO_DATA, length)]
            {
                for (found, factor) in found.into_iter().zip([0.25, 1.0, 3.0, 1.0]) {
                    let exact = factor * alpha;
                    assert!((f64::from(found) - exact).abs() <= TOLERANCE * exact, "{length}: {found}, {exact}");
                }
            }
        }
        // What has data is as it was, and so are pieces that reach beyond it.
        for s in [0.0, 0.3, 0.5, 0.77, 1.0] {
            assert_eq!(all[piece_at(&all, s)], plain[piece_at(&plain, s)]);
        }
    }
}
