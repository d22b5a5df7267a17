//! Which blocks of a tile a cell may cover.

use fearless_simd::{Simd, SimdBase, SimdFloat, SimdMask};

use super::bins::TILE;
use super::block::WIDTH;
use super::canvas::{COLUMNS, PIXELS};
use super::record::Record;
use super::walk::Walk;

/// The first block of every row of blocks.
const FIRST_COLUMN: u64 = 0x1111_1111_1111_1111;

/// Column in pixels, and row in blocks, of as many blocks as there are lanes.
const BLOCK_COLUMNS: [f32; 16] = [0.0, 4.0, 8.0, 12.0, 0.0, 4.0, 8.0, 12.0, 0.0, 4.0, 8.0, 12.0, 0.0, 4.0, 8.0, 12.0];
const BLOCK_ROWS: [f32; 16] = [0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0, 2.0, 2.0, 2.0, 2.0, 3.0, 3.0, 3.0, 3.0];

/// So few blocks are sooner tried than sorted out.
const FEW: u32 = 4;

impl<S: Simd> Walk<'_, S> {
    /// The blocks alive that a cell may cover.
    #[inline(always)]
    pub(super) fn blocks<const ORTHOGRAPHIC: bool>(&self, record: &Record) -> u64 {
        if self.light.backdrop.is_some() && record.nearest_level(ORTHOGRAPHIC) > self.deepest {
            return 0;
        }
        let rows = (S::f32s::LEN / WIDTH) as u32;
        let span = |axis: usize, side: u32| {
            let first = u32::from(record.first[axis]).max(self.origin[axis]) - self.origin[axis];
            let last = (u32::from(record.end[axis]) - 1 - self.origin[axis]).min(TILE - 1);
            [first / side, last / side]
        };
        let ([left, right], [top, bottom]) = (span(0, WIDTH as u32), span(1, rows));
        let columns = (1 << (right + 1)) - (1 << left);
        let below = u64::MAX << (COLUMNS as u32 * top);
        let above = u64::MAX >> (63 - (COLUMNS as u32 * (bottom + 1) - 1));
        let boxed = ((FIRST_COLUMN & below & above) * columns) & self.alive;
        if boxed.count_ones() <= FEW { boxed } else { self.silhouette(record, boxed) }
    }

    /// Those of some blocks that meet a cell's silhouette: where every front face is before every back face.
    #[inline(always)]
    fn silhouette(&self, record: &Record, boxed: u64) -> u64 {
        let lanes = S::f32s::LEN;
        let rows = (lanes / WIDTH) as f32;
        let [x, y] = self.from(record);
        let (columns, step) = (&BLOCK_COLUMNS[..lanes], (lanes / COLUMNS) as f32 * rows);
        let columns = S::f32s::from_slice(self.simd, columns) + x;
        let mut y = S::f32s::from_slice(self.simd, &BLOCK_ROWS[..lanes]).mul_add(rows, S::f32s::splat(self.simd, y));
        let [p, q, r, s] = EDGES[record.fronts as usize % EDGES.len()];
        let [p, q] = [by_most(record, p, rows), by_most(record, q, rows)];
        let [r, s] = [by_most(record, r, rows), by_most(record, s, rows)];
        let at = |[dx, dy, c]: [f32; 3], y: S::f32s| columns.mul_add(dx, y.mul_add(dy, S::f32s::splat(self.simd, c)));
        let mut seen = 0;
        for first in (0..PIXELS / lanes).step_by(lanes) {
            let least = at(p, y).min(at(q, y)).min(at(r, y).min(at(s, y)));
            seen |= least.simd_gt(0.0).to_bitmask() << first;
            y += step;
        }
        if matches!(record.fronts, 1..=3) { seen & boxed } else { boxed }
    }
}

/// Pairs of a front face and a back face, by how many are front faces: the edges of the silhouette, and a diagonal.
const EDGES: [[[usize; 2]; 4]; 4] =
    [[[0, 3]; 4], [[0, 1], [0, 2], [0, 3], [0, 3]], [[0, 2], [0, 3], [1, 2], [1, 3]], [[0, 3], [1, 3], [2, 3], [2, 3]]];

/// By how much a front face's plane is before a back face's, at most, in blocks of so many rows: per pixel in x and y
/// of the first, and there.
#[inline(always)]
fn by_most(record: &Record, [front, back]: [usize; 2], rows: f32) -> [f32; 3] {
    let (front, back) = (&record.planes[front], &record.planes[back]);
    let (dx, dy) = (front[0] - back[0], front[1] - back[1]);
    // At the corner of a block where the difference is largest.
    [dx, dy, front[2] - back[2] + (dx * (WIDTH - 1) as f32).max(0.0) + (dy * (rows - 1.0)).max(0.0)]
}
