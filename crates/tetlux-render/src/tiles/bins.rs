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
        let [columns, rows] = tiles(size);
        let count = columns as usize * rows as usize;
        // Every share of the cells has its own place in every tile's list, so that shares can be filled in any order.
        let mut shares: Vec<(Vec<Pair>, Vec<usize>)> = chunks
            .par_chunks(SHARE)
            .enumerate()
            .map(|(share, chunks)| {
                let pairs = pairs(chunks, share * SHARE * CHUNK, columns);
                let mut counts = vec![0; count];
                pairs.iter().for_each(|pair| counts[pair.tile as usize] += 1);
                (pairs, counts)
            })
            .collect();
        let mut starts = Vec::with_capacity(count + 1);
        let mut total = 0;
        for tile in 0..count {
            starts.push(total);
            for (_, counts) in &mut shares {
                total += std::mem::replace(&mut counts[tile], total);
            }
        }
        starts.push(total);
        let cells: Vec<AtomicU32> = (0..total).map(|_| AtomicU32::new(0)).collect();
        shares.par_iter_mut().for_each(|(pairs, places)| {
            for pair in pairs {
                let place = &mut places[pair.tile as usize];
                cells[*place].store(pair.cell, Ordering::Relaxed);
                *place += 1;
            }
        });
        Bins { starts, cells: cells.into_iter().map(AtomicU32::into_inner).collect() }
    }

    /// The cells of a tile.
    pub(crate) fn of(&self, tile: usize) -> &[u32] {
        &self.cells[self.starts[tile]..self.starts[tile + 1]]
    }
}

/// A tile and the position of a cell that reaches into it.
#[derive(Clone, Copy)]
struct Pair {
    tile: u32,
    cell: u32,
}

/// The pairs of some chunks' cells, whose positions begin with `first`, cell by cell.
fn pairs(chunks: &[Chunk], first: usize, columns: u32) -> Vec<Pair> {
    let mut pairs = Vec::with_capacity(3 * CHUNK * chunks.len());
    for (i, &tiles) in chunks.iter().flat_map(|chunk| &chunk.tiles).enumerate() {
        let [left, top, right, bottom] = tiles.map(u32::from);
        let (width, height) = (right - left, bottom - top);
        let pair = |x: u32, y: u32| Pair { tile: (top + y) * columns + left + x, cell: (first + i) as u32 };
        if width <= 2 && height <= 2 {
            // As most are: all four are written, and those that there are kept, for want of anything to guess.
            let kept = pairs.len() + (width * height) as usize;
            let turn = width.wrapping_sub(1) & 1;
            pairs.extend([0, 1, 2, 3].map(|k| pair(k & turn, k >> turn)));
            pairs.truncate(kept);
        } else {
            for y in 0..height {
                pairs.extend((0..width).map(|x| pair(x, y)));
            }
        }
    }
    pairs
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_tile_of_a_box_has_its_cell() {
        // Boxes of every width and height from none to three, and more cells than one share holds.
        let mut chunks = vec![Chunk::default(); SHARE + 2];
        let boxes = |i: usize| -> [u16; 4] {
            let [left, top] = [i % 5, i / 5 % 4].map(|n| n as u16);
            let [width, height] = [i / 3 % 4, i / 7 % 4].map(|n| n as u16);
            if width == 0 || height == 0 { [0; 4] } else { [left, top, left + width, top + height] }
        };
        for (c, chunk) in chunks.iter_mut().enumerate() {
            chunk.tiles = std::array::from_fn(|i| boxes(c * CHUNK + i));
        }
        let bins = Bins::new(&chunks, [8 * TILE - 3, 7 * TILE]);
        for tile in 0..56 {
            let (x, y) = (tile as u16 % 8, tile as u16 / 8);
            let reaches = |&i: &u32| {
                let [left, top, right, bottom] = boxes(i as usize);
                (left..right).contains(&x) && (top..bottom).contains(&y)
            };
            let expected: Vec<u32> = (0..(chunks.len() * CHUNK) as u32).filter(reaches).collect();
            assert_eq!(bins.of(tile), expected, "tile {x} {y}");
        }
    }
}
