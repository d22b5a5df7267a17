//! A tile: its cells are walked front to back, its pixels held in vectors.

use fearless_simd::{Simd, SimdBase, SimdFloat, SimdMask};
use tetlux_optics::transfer_f32::Weights;

use super::bins::TILE;
use super::block::{Crossing, Ends, Part, WIDTH, crossing, places, segments};
use super::canvas::{COLUMNS, PIXELS, Tile};
use super::further::Linear;
use super::ramp::{Pixels, Ramps, add_cut_segment, add_segment};
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
    pub(crate) ramps: &'a Ramps,
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
    /// The first and the last piece of the transfer function on which segments in a cell lie.
    #[inline(always)]
    pub(super) fn pieces<S: Simd>(&self, simd: S, record: &Record, part: &Part<S>) -> [usize; 2] {
        let [first, last] = record.pieces.map(|piece| piece as usize);
        if first < last && !self.cut_all {
            self.ramps.met(simd, [first, last], record.base, part)
        } else {
            [first, last]
        }
    }

    /// Composites the parts of rays in a cell behind what is there, on the first to the last of some pieces.
    #[inline(always)]
    pub(super) fn add<S: Simd>(
        &self,
        simd: S,
        record: &Record,
        part: &Part<S>,
        pieces: [usize; 2],
        pixels: &mut Pixels<S>,
    ) {
        match self.ramps.among(pieces) {
            [ramp] if !self.cut_all => {
                if !ramp.is_empty() {
                    let middle = part.scalar + (record.base - ramp.ends[0]);
                    add_segment(simd, ramp, self.model, middle, part.rise, part.length, pixels);
                }
            }
            ramps => add_cut_segment(simd, ramps, record.base, self.model, part, pixels),
        }
    }

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
    /// Of cells that are drawn together in a block, those that its rays meet: where, and what integrals need.
    crossings: [Crossing<S>; TOGETHER],
    parts: [Part<S>; TOGETHER],
    /// Of a run of cells without order: the blocks that each may cover, and a block's fragments. Kept for the next run.
    pub(super) masks: Vec<u64>,
    pub(super) fragments: Vec<Fragment<S>>,
    pub(crate) spent: Spent,
}

impl<'a, S: Simd> Walk<'a, S> {
    #[inline(always)]
    pub(crate) fn new(simd: S, light: &'a Light<'a>, origin: [u32; 2], tile: &'a mut Tile) -> Self {
        let (masks, fragments, spent) = (Vec::new(), Vec::new(), Spent::default());
        let (alive, deepest) = (0, light.deepest(origin));
        let (crossings, parts) = ([Crossing::none(simd); TOGETHER], [Part::none(simd); TOGETHER]);
        let mut walk = Walk { simd, light, origin, tile, alive, deepest, crossings, parts, masks, fragments, spent };
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
        [self.origin[0] as f32 - record.middle[0], self.origin[1] as f32 - record.middle[1]]
    }

    /// Composites cells behind what is there, one behind the other.
    #[inline(always)]
    pub(crate) fn add<const ORTHOGRAPHIC: bool>(&mut self, chunks: &[Chunk], run: &[u32]) {
        let Some(first) = run.first() else { return };
        for cells in run.chunks(TOGETHER) {
            let mut records = [at(chunks, *first); TOGETHER];
            for (record, &cell) in records.iter_mut().zip(cells) {
                *record = at(chunks, cell);
            }
            touch(&records);
            // For each block a bit for each of the cells: the pixels of one block after the other stay in registers.
            let mut covering = [0u64; MOST_BLOCKS];
            for (bit, record) in records[..cells.len()].iter().enumerate() {
                for block in Bits(self.blocks::<ORTHOGRAPHIC>(record)) {
                    covering[block % MOST_BLOCKS] |= 1 << bit;
                }
            }
            let lit = self.light.look.is_some();
            for block in Bits(self.alive) {
                match covering[block] {
                    0 => {}
                    bits if lit => self.shade_cells::<ORTHOGRAPHIC>(&records, cells, bits, block),
                    bits => self.add_cells::<ORTHOGRAPHIC>(&records, bits, block),
                }
            }
            if self.is_done() {
                return;
            }
        }
    }

    /// Composites those of some cells whose bit is set, in one block.
    #[inline(always)]
    fn add_cells<const ORTHOGRAPHIC: bool>(&mut self, records: &[&Record; TOGETHER], bits: u64, block: usize) {
        let (stretch, ends) = (self.stretch(block), self.ends(block));
        let (x, y) = self.places(block, self.origin.map(|first| first as f32));
        let places = |record: &Record| (x - record.middle[0], y - record.middle[1]);
        // One step after the other for all cells, so that the processor has many to work at and none to wait for. First
        // which cells the rays meet: no branch depends on it, so that there is nothing to guess.
        let (mut met, mut count) = ([0; TOGETHER], 0);
        for bit in Bits(bits) {
            let record = records[bit % TOGETHER];
            let crossing = crossing::<S, ORTHOGRAPHIC>(self.simd, record, places(record), ends);
            met[count % TOGETHER] = bit as u8;
            self.crossings[count % TOGETHER] = crossing;
            count += usize::from(crossing.is_met());
        }
        let met = || met[..count].iter().map(|&bit| records[usize::from(bit) % TOGETHER]);
        let mut pieces = [[0; 2]; TOGETHER];
        for (((record, &crossing), part), pieces) in met().zip(&self.crossings).zip(&mut self.parts).zip(&mut pieces) {
            *part = segments::<S, ORTHOGRAPHIC>(self.simd, record, places(record), stretch, crossing).part;
            *pieces = self.light.pieces(self.simd, record, part);
        }
        let mut pixels = self.pixels(block);
        for ((record, part), &pieces) in met().zip(&self.parts).zip(&pieces) {
            self.light.add(self.simd, record, part, pieces, &mut pixels);
        }
        self.store(block, &pixels);
    }

    /// The same where segments are shaded one by one.
    #[inline(always)]
    fn shade_cells<const ORTHOGRAPHIC: bool>(
        &mut self,
        records: &[&Record; TOGETHER],
        cells: &[u32],
        bits: u64,
        block: usize,
    ) {
        let (stretch, ends) = (self.stretch(block), self.ends(block));
        let mut pixels = self.pixels(block);
        for bit in Bits(bits) {
            let record = records[bit % TOGETHER];
            let places = self.places_in(block, record);
            let crossing = crossing::<S, ORTHOGRAPHIC>(self.simd, record, places, ends);
            if crossing.is_met() {
                let segments = segments::<S, ORTHOGRAPHIC>(self.simd, record, places, stretch, crossing);
                self.shade(cells[bit], record, &segments, (block, places), &mut pixels);
            }
        }
        self.store(block, &pixels);
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
fn touch(records: &[&Record; TOGETHER]) {
    let mut touched = 0;
    for record in records {
        // In both of its cache lines.
        touched ^= record.planes[0][0].to_bits() ^ record.level.to_bits();
    }
    std::hint::black_box(touched);
}
