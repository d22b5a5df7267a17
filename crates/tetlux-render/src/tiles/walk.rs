//! A tile: its cells are walked front to back, its pixels held in vectors.

use fearless_simd::{Simd, SimdBase, SimdFloat, SimdMask};
use tetlux_optics::transfer_f32::Weights;

use super::bins::TILE;
use super::block::{Ends, Segments, WIDTH, crossing, places, segments};
use super::canvas::{COLUMNS, PIXELS, Tile};
use super::further::Linear;
use super::ramp::{Pixels, Ramp, add_cut_segment, add_segment, only};
use super::record::{Chunk, Record, at};
use super::sorted::Fragment;
use crate::backdrop::{BEYOND, Backdrop};
use crate::look::{Look, Spent};

/// Numbers of pixels.
const STEPS: [f32; TILE as usize] =
    [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0, 11.0, 12.0, 13.0, 14.0, 15.0];

/// Lanes of the widest vectors, and blocks of the narrowest.
const MOST_LANES: usize = 16;
const MOST_BLOCKS: usize = PIXELS / WIDTH;

/// Cells that are loaded at once, and then drawn block by block.
const TOGETHER: usize = u64::BITS as usize;

/// What all tiles of a picture have in common.
#[derive(Clone, Copy)]
pub(crate) struct Light<'a> {
    pub(crate) ramps: &'a [Ramp],
    pub(crate) model: Weights,
    /// Side of a pixel at unit depth, and the picture's middle; of use in perspective only.
    pub(crate) pixel: f32,
    pub(crate) middle: [f32; 2],
    /// A pixel of this alpha is done.
    pub(crate) opaque: f32,
    /// What ends rays, and the depth of the mesh's origin.
    pub(crate) backdrop: Option<(&'a Backdrop, f32)>,
    /// Pixels across the picture.
    pub(crate) width: usize,
    /// Segments are cut at all control points, whether their cells meet them or not.
    pub(crate) cut_all: bool,
    /// What there is beyond one field's transfer function, and the further fields of the cells.
    pub(crate) look: Option<&'a Look>,
    pub(crate) further: &'a [Linear],
}

impl Light<'_> {
    /// The deepest end of a tile's rays: a depth from the mesh's origin.
    fn deepest(&self, [left, top]: [u32; 2]) -> f32 {
        let Some((backdrop, _)) = self.backdrop else { return BEYOND };
        let left = left as usize;
        let right = (left + TILE as usize).min(self.width);
        let rows = backdrop.depths.chunks(self.width).skip(top as usize).take(TILE as usize);
        rows.flat_map(|row| &row[left..right]).fold(f32::MIN, |deepest, &depth| deepest.max(depth))
    }
}

/// A tile being drawn.
pub(crate) struct Walk<'a, S: Simd> {
    pub(super) simd: S,
    pub(super) light: &'a Light<'a>,
    /// The tile's first pixel.
    pub(super) origin: [u32; 2],
    tile: &'a mut Tile,
    /// Blocks with pixels that are not opaque.
    pub(super) alive: u64,
    /// The deepest end of a ray, if any ends: a depth from the mesh's origin.
    pub(super) deepest: f32,
    /// Of cells that are drawn together in a block, where the rays enter and leave those that they meet.
    crossings: [(S::f32s, S::f32s); TOGETHER],
    /// Of a run of cells without order: the blocks that each may cover, and a block's fragments. Kept for the next run.
    pub(super) masks: Vec<u64>,
    pub(super) fragments: Vec<Fragment<S>>,
    pub(crate) spent: Spent,
}

impl<'a, S: Simd> Walk<'a, S> {
    #[inline(always)]
    pub(crate) fn new(simd: S, light: &'a Light<'a>, origin: [u32; 2], tile: &'a mut Tile) -> Self {
        let zero = S::f32s::splat(simd, 0.0);
        let (masks, fragments, spent) = (Vec::new(), Vec::new(), Spent::default());
        let (alive, deepest) = (0, light.deepest(origin));
        let crossings = [(zero, zero); TOGETHER];
        let mut walk = Walk { simd, light, origin, tile, alive, deepest, crossings, masks, fragments, spent };
        for block in 0..PIXELS / S::f32s::LEN {
            let alpha = walk.pixels(block)[3];
            walk.alive |= u64::from(alpha.simd_lt(light.opaque).any_true()) << block;
        }
        walk
    }

    /// Whether every pixel is opaque.
    #[inline(always)]
    pub(crate) fn is_done(&self) -> bool {
        self.alive == 0
    }

    /// Places of a block's pixels, that of the tile's first being (x, y).
    #[inline(always)]
    pub(super) fn places(&self, block: usize, [x, y]: [f32; 2]) -> (S::f32s, S::f32s) {
        let (column, row) = (block % COLUMNS, block / COLUMNS % TILE as usize);
        places(self.simd, x + STEPS[column * WIDTH], y + STEPS[row * (S::f32s::LEN / WIDTH) % TILE as usize])
    }

    /// Places of a block's pixels, counted from the picture's middle.
    #[inline(always)]
    pub(super) fn places_in_view(&self, block: usize) -> (S::f32s, S::f32s) {
        self.places(block, [0, 1].map(|axis| self.origin[axis] as f32 + 0.5 - self.light.middle[axis]))
    }

    /// Length of a block's rays for a depth of 1.
    #[inline(always)]
    pub(super) fn stretch(&self, block: usize) -> S::f32s {
        let (x, y) = self.places_in_view(block);
        let (x, y) = (x * self.light.pixel, y * self.light.pixel);
        x.mul_add(x, y.mul_add(y, S::f32s::splat(self.simd, 1.0))).sqrt()
    }

    /// The part of an array of a tile's pixels that is a block.
    #[inline(always)]
    fn load(&self, values: &[f32; PIXELS], block: usize) -> S::f32s {
        let lanes = S::f32s::LEN;
        S::f32s::from_slice(self.simd, &values[block % (PIXELS / lanes) * lanes..][..lanes])
    }

    #[inline(always)]
    pub(super) fn pixels(&self, block: usize) -> Pixels<S> {
        let [r, g, b, a] = &self.tile;
        [self.load(r, block), self.load(g, block), self.load(b, block), self.load(a, block)]
    }

    /// Sets a block's pixels, and leaves it alone from now on if all are opaque.
    #[inline(always)]
    pub(super) fn store(&mut self, block: usize, pixels: &Pixels<S>) {
        let lanes = S::f32s::LEN;
        for i in 0..4 {
            pixels[i].store_slice(&mut self.tile[i][block % (PIXELS / lanes) * lanes..][..lanes]);
        }
        if pixels[3].simd_ge(self.light.opaque).all_true() {
            self.alive &= !(1 << block);
        }
    }

    /// Where a block's rays end, if any do.
    #[inline(always)]
    pub(super) fn ends(&self, block: usize) -> Option<Ends<S>> {
        let (backdrop, origin) = self.light.backdrop?;
        let (lanes, mut levels) = (S::f32s::LEN, [BEYOND; MOST_LANES]);
        let [left, top] = [block % COLUMNS * WIDTH, block / COLUMNS * (lanes / WIDTH)];
        let left = self.origin[0] as usize + left;
        for (row, levels) in levels[..lanes].chunks_exact_mut(WIDTH).enumerate() {
            let first = (self.origin[1] as usize + top + row) * self.light.width + left;
            let inside = self.light.width.saturating_sub(left).min(WIDTH);
            if let Some(depths) = backdrop.depths.get(first..first + inside) {
                levels[..inside].copy_from_slice(depths);
            }
        }
        Some(Ends { levels: S::f32s::from_slice(self.simd, &levels[..lanes]), origin })
    }

    /// Places of a block's pixels, counted from the middle of a cell's box.
    #[inline(always)]
    pub(super) fn places_in(&self, block: usize, record: &Record) -> (S::f32s, S::f32s) {
        self.places(block, self.from(record))
    }

    /// The tile's first pixel, counted from the middle of a cell's box.
    #[inline(always)]
    pub(super) fn from(&self, record: &Record) -> [f32; 2] {
        let [x, y] = record.middle();
        [self.origin[0] as f32 - f32::from(x), self.origin[1] as f32 - f32::from(y)]
    }

    /// Composites cells behind what is there, one behind the other.
    #[inline(always)]
    pub(crate) fn add<const ORTHOGRAPHIC: bool>(&mut self, chunks: &[Chunk], run: &[u32]) {
        for cells in run.chunks(TOGETHER) {
            touch(chunks, cells);
            // For each block a bit for each of the cells: the pixels of one block after the other stay in registers.
            let mut covering = [0u64; MOST_BLOCKS];
            for (bit, &i) in cells.iter().enumerate() {
                for block in Bits(self.blocks::<ORTHOGRAPHIC>(at(chunks, i))) {
                    covering[block] |= 1 << bit;
                }
            }
            let lit = self.light.look.is_some();
            for block in Bits(self.alive) {
                match covering[block] {
                    0 => {}
                    bits if lit => self.shade_cells::<ORTHOGRAPHIC>(chunks, cells, bits, block),
                    bits => self.add_cells::<ORTHOGRAPHIC>(chunks, cells, bits, block),
                }
            }
            if self.is_done() {
                return;
            }
        }
    }

    /// Composites those of some cells whose bit is set, in one block.
    #[inline(always)]
    fn add_cells<const ORTHOGRAPHIC: bool>(&mut self, chunks: &[Chunk], cells: &[u32], bits: u64, block: usize) {
        let (stretch, ends) = (self.stretch(block), self.ends(block));
        let (x, y) = self.places(block, self.origin.map(|first| first as f32));
        let places = |record: &Record| {
            let [across, down] = record.middle();
            (x - f32::from(across), y - f32::from(down))
        };
        // First which cells the rays meet: no branch depends on it, so that the processor has not to guess.
        let (mut met, mut count) = ([0; TOGETHER], 0);
        for bit in Bits(bits) {
            let record = at(chunks, cells[bit]);
            let (front, back) = crossing::<S, ORTHOGRAPHIC>(self.simd, record, places(record), ends);
            met[count % TOGETHER] = cells[bit];
            self.crossings[count % TOGETHER] = (front, back);
            count += usize::from(front.simd_gt(back).any_true());
        }
        let mut pixels = self.pixels(block);
        for (&cell, &crossing) in met[..count].iter().zip(&self.crossings) {
            let record = at(chunks, cell);
            let segments = segments::<S, ORTHOGRAPHIC>(self.simd, record, places(record), stretch, crossing);
            self.integrate(record, &segments, &mut pixels);
        }
        self.store(block, &pixels);
    }

    /// The same where segments are shaded one by one.
    #[inline(always)]
    fn shade_cells<const ORTHOGRAPHIC: bool>(&mut self, chunks: &[Chunk], cells: &[u32], bits: u64, block: usize) {
        let (stretch, ends) = (self.stretch(block), self.ends(block));
        let mut pixels = self.pixels(block);
        for bit in Bits(bits) {
            let record = at(chunks, cells[bit]);
            let places = self.places_in(block, record);
            let (front, back) = crossing::<S, ORTHOGRAPHIC>(self.simd, record, places, ends);
            if front.simd_gt(back).any_true() {
                let segments = segments::<S, ORTHOGRAPHIC>(self.simd, record, places, stretch, (front, back));
                self.shade(cells[bit], record, &segments, (block, places), &mut pixels);
            }
        }
        self.store(block, &pixels);
    }

    #[inline(always)]
    pub(super) fn integrate(&self, record: &Record, segments: &Segments<S>, pixels: &mut Pixels<S>) {
        let Segments { scalar, rise, length, .. } = *segments;
        let ramps = &self.light.ramps[record.pieces[0] as usize..=record.pieces[1] as usize];
        let ramp = match ramps {
            _ if self.light.cut_all => None,
            [ramp] => Some(ramp),
            ramps => only::<S>(ramps, record.base, scalar, rise, length),
        };
        if let Some(ramp) = ramp {
            if !ramp.is_empty() {
                let middle = scalar + (record.base - ramp.ends[0]);
                add_segment(self.simd, ramp, self.light.model, middle, rise, length, pixels);
            }
        } else {
            add_cut_segment(self.simd, ramps, record.base, self.light.model, scalar, rise, length, pixels);
        }
    }
}

/// The places of the bits that are set, ascending.
pub(super) struct Bits(pub(super) u64);

impl Iterator for Bits {
    type Item = usize;

    #[inline(always)]
    fn next(&mut self) -> Option<usize> {
        let bit = self.0.trailing_zeros() as usize;
        let rest = self.0 & self.0.wrapping_sub(1);
        (std::mem::replace(&mut self.0, rest) != 0).then_some(bit)
    }
}

/// Loads records before they are needed, so that the processor waits for all at once.
#[inline(always)]
fn touch(chunks: &[Chunk], cells: &[u32]) {
    let mut touched = 0;
    for &i in cells {
        let record = at(chunks, i);
        // In both of its cache lines.
        touched ^= record.planes[0][0].to_bits() ^ record.level.to_bits();
    }
    std::hint::black_box(touched);
}
