//! For each tile the cells that reach into it, in their order.

use std::sync::atomic::{AtomicU32, Ordering};

use rayon::prelude::*;

use super::record::Record;

/// Side of a tile in pixels.
pub(crate) const TILE: u32 = 16;

/// Cells that are counted together by one core.
const CHUNK: usize = 1 << 14;

/// The cells of all tiles, one tile after another.
pub(crate) struct Bins {
    /// Where each tile's cells begin, and the end of the last's.
    starts: Vec<usize>,
    cells: Vec<u32>,
}

/// Tiles of a picture in x and y.
pub(crate) fn tiles(size: [u32; 2]) -> [u32; 2] {
    size.map(|n| n.div_ceil(TILE))
}

impl Bins {
    /// The positions of `records` for each tile, ascending.
    pub(crate) fn new(records: &[Record], size: [u32; 2]) -> Bins {
        let [columns, rows] = tiles(size).map(|n| n as usize);
        // Every chunk of records has its own place in every tile's list, so that chunks can be filled in any order.
        let mut places: Vec<Vec<usize>> = records
            .par_chunks(CHUNK)
            .map(|chunk| {
                let mut counts = vec![0; columns * rows];
                chunk.iter().for_each(|record| for_each_tile(record, columns, |tile| counts[tile] += 1));
                counts
            })
            .collect();
        let mut starts = Vec::with_capacity(columns * rows + 1);
        let mut total = 0;
        for tile in 0..columns * rows {
            starts.push(total);
            for counts in &mut places {
                total += std::mem::replace(&mut counts[tile], total);
            }
        }
        starts.push(total);
        let cells: Vec<AtomicU32> = (0..total).map(|_| AtomicU32::new(0)).collect();
        records.par_chunks(CHUNK).zip(&mut places).enumerate().for_each(|(chunk, (records, places))| {
            for (i, record) in records.iter().enumerate() {
                for_each_tile(record, columns, |tile| {
                    cells[places[tile]].store((chunk * CHUNK + i) as u32, Ordering::Relaxed);
                    places[tile] += 1;
                });
            }
        });
        Bins { starts, cells: cells.into_iter().map(AtomicU32::into_inner).collect() }
    }

    /// The cells of a tile.
    pub(crate) fn of(&self, tile: usize) -> &[u32] {
        &self.cells[self.starts[tile]..self.starts[tile + 1]]
    }
}

fn for_each_tile(record: &Record, columns: usize, mut f: impl FnMut(usize)) {
    let [x, y] = [0, 1].map(|axis| record.first[axis] / TILE..record.end[axis].div_ceil(TILE));
    if record.first[0] < record.end[0] {
        y.for_each(|row| x.clone().for_each(|column| f(row as usize * columns + column as usize)));
    }
}
