//! For each tile the cells that reach into it, in their order.

use std::sync::atomic::{AtomicU32, Ordering};

use rayon::prelude::*;

use super::record::{CHUNK, Chunk};

/// Side of a tile in pixels.
pub(crate) const TILE: u32 = 16;

/// Chunks of cells that are counted together by one core.
const SHARE: usize = 256;

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
    /// The positions of cells for each tile, ascending.
    pub(crate) fn new(chunks: &[Chunk], size: [u32; 2]) -> Bins {
        let [columns, rows] = tiles(size).map(|n| n as usize);
        // Every share of the cells has its own place in every tile's list, so that shares can be filled in any order.
        let mut places: Vec<Vec<usize>> = chunks
            .par_chunks(SHARE)
            .map(|chunks| {
                let mut counts = vec![0; columns * rows];
                for tiles in chunks.iter().flat_map(|chunk| &chunk.tiles) {
                    for_each_tile(tiles, columns, |tile| counts[tile] += 1);
                }
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
        chunks.par_chunks(SHARE).zip(&mut places).enumerate().for_each(|(share, (chunks, places))| {
            for (i, tiles) in chunks.iter().flat_map(|chunk| &chunk.tiles).enumerate() {
                for_each_tile(tiles, columns, |tile| {
                    cells[places[tile]].store((share * SHARE * CHUNK + i) as u32, Ordering::Relaxed);
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

#[inline]
fn for_each_tile(&[left, top, right, bottom]: &[u16; 4], columns: usize, mut f: impl FnMut(usize)) {
    for y in top..bottom {
        for x in left..right {
            f(y as usize * columns + x as usize);
        }
    }
}
