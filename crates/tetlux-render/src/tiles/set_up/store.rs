//! Fields of many cells stored as records.

use fearless_simd::{Simd, SimdBase, SimdNarrow};

use crate::tiles::record::{FLOATS, Record};

/// Rows of numbers that are stored together.
pub(super) const ROWS: usize = FLOATS / 2;

/// Stores pairs of fields, the first of them in the first half of a record, the second in the second half, at the same
/// place; what has no pair is 0.
#[inline(always)]
pub(super) fn store<S: Simd>(simd: S, fields: [[S::f64s; 2]; 15], records: &mut [Record]) {
    let lanes = S::f64s::LEN;
    let width = 2 * lanes;
    // Every pass takes the first bit of a row's number for the last of a column's, and the first of that for the last of
    // the row's: then rows are runs of fields of one lane. Rows begin in the order that has all runs end in theirs.
    let passes = width.trailing_zeros();
    let left = ROWS.trailing_zeros() - passes;
    let mut rows = [S::f32s::splat(simd, 0.0); ROWS];
    for row in 0..ROWS {
        let field = (row & ((1 << left) - 1)) << passes | row >> left;
        if let Some([first, second]) = fields.get(field) {
            rows[row] = first.narrow(*second);
        }
    }
    rows = pass::<S>(rows);
    rows = pass::<S>(rows);
    if passes > 2 {
        rows = pass::<S>(rows);
    }
    if passes > 3 {
        rows = pass::<S>(rows);
    }
    for (row, values) in rows.iter().enumerate() {
        let (lane, half, run) = (row % lanes, row / lanes % 2, row / width);
        let place = half * ROWS + run * width;
        values.store_slice(&mut records[lane].floats_mut()[place..place + width]);
    }
}

/// Pairs every row of the first half with one of the second.
#[inline(always)]
fn pass<S: Simd>(rows: [S::f32s; ROWS]) -> [S::f32s; ROWS] {
    let mut paired = rows;
    for row in 0..ROWS / 2 {
        (paired[2 * row], paired[2 * row + 1]) = rows[row].interleave(rows[row + ROWS / 2]);
    }
    paired
}
