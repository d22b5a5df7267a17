//! Cells of a tile whose order is not known: their fragments are sorted by depth in every pixel.

use fearless_simd::{Select, Simd, SimdBase, SimdFloat, SimdMask};

use super::block::{crossing, segments};
use super::ramp::Pixels;
use super::record::{Chunk, at};
use super::walk::{Bits, Walk};

/// A cell's contribution to a block: the middle's depth, premultiplied colour and alpha.
#[derive(Clone, Copy)]
pub(super) struct Fragment<S: Simd> {
    depth: S::f32s,
    color: Pixels<S>,
}

impl<S: Simd> Walk<'_, S> {
    /// Composites cells whose order is not known behind what is there: by depth in every pixel.
    #[inline(always)]
    pub(crate) fn add_sorted<const ORTHOGRAPHIC: bool>(&mut self, chunks: &[Chunk], run: &[u32]) {
        let (mut masks, mut fragments) = (std::mem::take(&mut self.masks), std::mem::take(&mut self.fragments));
        masks.clear();
        let mut blocks = 0;
        for &i in run {
            let mask = self.blocks::<ORTHOGRAPHIC>(at(chunks, i));
            blocks |= mask;
            masks.push(mask);
        }
        for block in Bits(blocks) {
            let (stretch, ends) = (self.stretch(block), self.ends(block));
            fragments.clear();
            let mut before = S::f32s::splat(self.simd, f32::MIN);
            for (&i, mask) in run.iter().zip(&masks) {
                if mask >> block & 1 == 0 {
                    continue;
                }
                let record = at(chunks, i);
                let places = self.places_in(block, record);
                let crossing = crossing::<S, ORTHOGRAPHIC>(self.simd, record, places, ends);
                if crossing.is_met() {
                    let segments = segments::<S, ORTHOGRAPHIC>(self.simd, record, places, stretch, crossing);
                    let mut color = [S::f32s::splat(self.simd, 0.0); 4];
                    if self.light.look.is_some() {
                        self.shade(i, record, &segments, (block, places), &mut color);
                    } else {
                        let pieces = self.light.pieces(self.simd, record, &segments.part);
                        self.light.add(self.simd, record, &segments.part, pieces, &mut color);
                    }
                    // Where the ray misses the cell nothing has to move.
                    let depth = segments.depth::<ORTHOGRAPHIC>(self.simd, record);
                    before = segments.part.length.simd_gt(0.0).select(depth, before);
                    fragments.push(Fragment { depth: before, color });
                }
            }
            sort(&mut fragments);
            let mut pixels = self.pixels(block);
            for fragment in &fragments {
                let left = S::f32s::splat(self.simd, 1.0) - pixels[3];
                for i in 0..4 {
                    pixels[i] = left.mul_add(fragment.color[i], pixels[i]);
                }
            }
            self.store(block, &pixels);
        }
        (self.masks, self.fragments) = (masks, fragments);
    }
}

/// Gaps of a Shell sort (Ciura 2001).
const GAPS: [usize; 8] = [701, 301, 132, 57, 23, 10, 4, 1];

/// Moves a fragment that are tried before fragments count as unsorted.
const PATIENCE: usize = 8;

/// Sorts every lane by depth: by insertion if the fragments are nearly sorted, as they are if their cells are.
#[inline(always)]
fn sort<S: Simd>(fragments: &mut [Fragment<S>]) {
    if !insert(fragments, 1, PATIENCE * fragments.len()) {
        for gap in GAPS {
            insert(fragments, gap, usize::MAX);
        }
    }
}

/// Sorts those that are `gap` apart by insertion; false if that would take more than so many moves.
#[inline(always)]
fn insert<S: Simd>(fragments: &mut [Fragment<S>], gap: usize, moves: usize) -> bool {
    let mut left = moves;
    for end in gap..fragments.len() {
        let mut moved = fragments[end];
        let mut i = end;
        while i >= gap {
            let near = fragments[i - gap];
            let swap = near.depth.simd_gt(moved.depth);
            if !swap.any_true() {
                break;
            }
            fragments[i].depth = swap.select(near.depth, moved.depth);
            moved.depth = swap.select(moved.depth, near.depth);
            for k in 0..4 {
                fragments[i].color[k] = swap.select(near.color[k], moved.color[k]);
                moved.color[k] = swap.select(moved.color[k], near.color[k]);
            }
            i -= gap;
        }
        if i < end {
            fragments[i] = moved;
            let count = (end - i) / gap;
            if count > left {
                return false;
            }
            left -= count;
        }
    }
    true
}
