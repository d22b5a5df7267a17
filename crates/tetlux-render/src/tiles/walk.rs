//! A tile: its cells are walked front to back, its pixels held in vectors.

use fearless_simd::{Select, Simd, SimdBase, SimdFloat, SimdMask};
use tetlux_optics::transfer_f32::Weights;

use super::bins::TILE;
use super::block::{Ends, Segments, WIDTH, places, segments};
use super::further::{Inside, Linear};
use super::ramp::{Pixels, Ramp, add_cut_segment, add_segment, only};
use super::record::{Chunk, Record, at};
use crate::backdrop::{BEYOND, Backdrop};
use crate::look::{self, Look, Segment, Spent};

/// Pixels of a tile.
pub(crate) const PIXELS: usize = (TILE * TILE) as usize;

/// Blocks across a tile.
const COLUMNS: u32 = TILE / WIDTH as u32;

/// The first block of every row of blocks.
const FIRST_COLUMN: u64 = 0x1111_1111_1111_1111;

/// Numbers of pixels.
const STEPS: [f32; TILE as usize] =
    [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0, 11.0, 12.0, 13.0, 14.0, 15.0];

/// Column in pixels, and row in blocks, of as many blocks as there are lanes.
const BLOCK_COLUMNS: [f32; 16] = [0.0, 4.0, 8.0, 12.0, 0.0, 4.0, 8.0, 12.0, 0.0, 4.0, 8.0, 12.0, 0.0, 4.0, 8.0, 12.0];
const BLOCK_ROWS: [f32; 16] = [0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0, 2.0, 2.0, 2.0, 2.0, 3.0, 3.0, 3.0, 3.0];

/// Records that are loaded at once.
const AHEAD: usize = 32;

/// So few blocks are sooner tried than sorted out.
const FEW: u32 = 2;

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

/// A tile being drawn.
pub(crate) struct Walk<'a, S: Simd> {
    simd: S,
    light: &'a Light<'a>,
    /// The tile's first pixel.
    origin: [u32; 2],
    /// Premultiplied colour and alpha of the pixels, block by block.
    tile: [[f32; PIXELS]; 4],
    /// Blocks with pixels that are not opaque.
    alive: u64,
    /// Length of the rays for a depth of 1.
    stretch: [f32; PIXELS],
    /// Where the rays end, if any do, and the deepest of them: depths from the mesh's origin.
    ends: [f32; PIXELS],
    deepest: f32,
    /// Of a run of cells without order: the blocks that each may cover, and a block's fragments. Kept for the next run.
    masks: Vec<u64>,
    fragments: Vec<Fragment<S>>,
    pub(crate) spent: Spent,
}

/// Where in a tile's vectors of so many lanes the pixel at (x, y) is.
#[inline(always)]
fn place(x: usize, y: usize, lanes: usize) -> usize {
    let rows = lanes / WIDTH;
    (y / rows * COLUMNS as usize + x / WIDTH) * lanes + y % rows * WIDTH + x % WIDTH
}

impl<'a, S: Simd> Walk<'a, S> {
    #[inline(always)]
    pub(crate) fn new(simd: S, light: &'a Light<'a>, origin: [u32; 2], rows: &[&mut [[f32; 4]]]) -> Self {
        let lanes = S::f32s::LEN;
        let blocks = PIXELS / lanes;
        let alive = u64::MAX >> (64 - blocks);
        let (tile, stretch) = ([[0.0; PIXELS]; 4], [1.0; PIXELS]);
        let (masks, fragments, spent) = (Vec::new(), Vec::new(), Spent::default());
        let (ends, deepest) = ([BEYOND; PIXELS], BEYOND);
        let mut walk = Walk { simd, light, origin, tile, alive, stretch, ends, deepest, masks, fragments, spent };
        for (y, row) in rows.iter().enumerate() {
            for (x, pixel) in row.iter().enumerate() {
                for i in 0..4 {
                    walk.tile[i][place(x, y, lanes)] = pixel[i];
                }
            }
        }
        if let Some((backdrop, _)) = light.backdrop {
            walk.deepest = f32::MIN;
            for (y, row) in rows.iter().enumerate() {
                let first = (origin[1] as usize + y) * light.width + origin[0] as usize;
                for (x, &depth) in backdrop.depths[first..][..row.len()].iter().enumerate() {
                    walk.ends[place(x, y, lanes)] = depth;
                    walk.deepest = walk.deepest.max(depth);
                }
            }
        }
        let [x, y] = [0, 1].map(|axis| origin[axis] as f32 + 0.5 - light.middle[axis]);
        for block in 0..blocks {
            let (x, y) = walk.places(block, x, y);
            let (x, y) = (x * light.pixel, y * light.pixel);
            let stretch = x.mul_add(x, y.mul_add(y, S::f32s::splat(simd, 1.0))).sqrt();
            stretch.store_slice(&mut walk.stretch[block * lanes..][..lanes]);
            let pixels = walk.pixels(block);
            walk.store(block, &pixels);
        }
        walk
    }

    /// Writes the pixels to the tile's rows of the picture.
    #[inline(always)]
    pub(crate) fn finish(&self, rows: &mut [&mut [[f32; 4]]]) {
        for (y, row) in rows.iter_mut().enumerate() {
            for (x, pixel) in row.iter_mut().enumerate() {
                #[cfg(feature = "planted")]
                if crate::planted::is_lost(x, y) {
                    continue;
                }
                let at = place(x, y, S::f32s::LEN);
                *pixel = [self.tile[0][at], self.tile[1][at], self.tile[2][at], self.tile[3][at]];
            }
        }
    }

    /// Whether every pixel is opaque.
    #[inline(always)]
    pub(crate) fn is_done(&self) -> bool {
        self.alive == 0
    }

    /// Places of a block's pixels, that of the tile's first being (x, y).
    #[inline(always)]
    fn places(&self, block: usize, x: f32, y: f32) -> (S::f32s, S::f32s) {
        let (column, row) = (block % COLUMNS as usize, block / COLUMNS as usize % TILE as usize);
        places(self.simd, x + STEPS[column * WIDTH], y + STEPS[row * (S::f32s::LEN / WIDTH) % TILE as usize])
    }

    /// The part of an array of a tile's pixels that is a block.
    #[inline(always)]
    fn load(&self, values: &[f32; PIXELS], block: usize) -> S::f32s {
        let lanes = S::f32s::LEN;
        S::f32s::from_slice(self.simd, &values[block % (PIXELS / lanes) * lanes..][..lanes])
    }

    #[inline(always)]
    fn pixels(&self, block: usize) -> Pixels<S> {
        let [r, g, b, a] = &self.tile;
        [self.load(r, block), self.load(g, block), self.load(b, block), self.load(a, block)]
    }

    /// Sets a block's pixels, and leaves it alone from now on if all are opaque.
    #[inline(always)]
    fn store(&mut self, block: usize, pixels: &Pixels<S>) {
        let lanes = S::f32s::LEN;
        for i in 0..4 {
            pixels[i].store_slice(&mut self.tile[i][block % (PIXELS / lanes) * lanes..][..lanes]);
        }
        if pixels[3].simd_ge(self.light.opaque).all_true() {
            self.alive &= !(1 << block);
        }
    }

    #[inline(always)]
    fn ends(&self, block: usize) -> Option<Ends<S>> {
        self.light.backdrop.map(|(_, origin)| Ends { levels: self.load(&self.ends, block), origin })
    }

    /// The tile's first pixel, counted from the middle of a cell's box.
    #[inline(always)]
    fn from(&self, record: &Record) -> (f32, f32) {
        let [x, y] = record.middle();
        (self.origin[0] as f32 - x as f32, self.origin[1] as f32 - y as f32)
    }

    /// The blocks alive that a cell may cover.
    #[inline(always)]
    fn blocks<const ORTHOGRAPHIC: bool>(&self, record: &Record) -> u64 {
        if self.light.backdrop.is_some() && record.nearest_level(ORTHOGRAPHIC) > self.deepest {
            return 0;
        }
        let rows = (S::f32s::LEN / WIDTH) as u32;
        let span = |axis: usize, side: u32| {
            let first = record.first[axis].max(self.origin[axis]) - self.origin[axis];
            let last = (record.end[axis] - 1 - self.origin[axis]).min(TILE - 1);
            [first / side, last / side]
        };
        let ([left, right], [top, bottom]) = (span(0, WIDTH as u32), span(1, rows));
        let columns = (1 << (right + 1)) - (1 << left);
        let below = u64::MAX << (COLUMNS * top);
        let above = u64::MAX >> (63 - (COLUMNS * bottom + COLUMNS - 1));
        let boxed = ((FIRST_COLUMN & below & above) * columns) & self.alive;
        if boxed.count_ones() <= FEW { boxed } else { self.silhouette(record, boxed) }
    }

    /// Those of some blocks that meet a cell's silhouette: where every front face is before every back face.
    #[inline(always)]
    fn silhouette(&self, record: &Record, boxed: u64) -> u64 {
        let lanes = S::f32s::LEN;
        let rows = (lanes / WIDTH) as f32;
        let (x, y) = self.from(record);
        let (columns, step) = (&BLOCK_COLUMNS[..lanes], (lanes / COLUMNS as usize) as f32 * rows);
        let columns = S::f32s::from_slice(self.simd, columns) + x;
        let mut y = S::f32s::from_slice(self.simd, &BLOCK_ROWS[..lanes]).mul_add(rows, S::f32s::splat(self.simd, y));
        let [p, q, r, s] = &record.planes;
        let mut seen = 0;
        for first in (0..PIXELS / lanes).step_by(lanes) {
            if boxed >> first & (u64::MAX >> (64 - lanes)) != 0 {
                let at = (self.simd, columns, y);
                let least = match record.fronts {
                    1 => most(p, q, at).min(most(p, r, at)).min(most(p, s, at)),
                    2 => most(p, r, at).min(most(p, s, at)).min(most(q, r, at).min(most(q, s, at))),
                    3 => most(p, s, at).min(most(q, s, at)).min(most(r, s, at)),
                    _ => S::f32s::splat(self.simd, 1.0),
                };
                seen |= least.simd_gt(0.0).to_bitmask() << first;
            }
            y += step;
        }
        seen & boxed
    }

    /// Composites cells behind what is there, one behind the other.
    #[inline(always)]
    pub(crate) fn add<const ORTHOGRAPHIC: bool>(&mut self, chunks: &[Chunk], run: &[u32]) {
        for cells in run.chunks(AHEAD) {
            touch(chunks, cells);
            for &i in cells {
                let record = at(chunks, i);
                let mut blocks = self.blocks::<ORTHOGRAPHIC>(record);
                let (x, y) = self.from(record);
                while blocks != 0 {
                    let block = blocks.trailing_zeros() as usize;
                    blocks &= blocks - 1;
                    let (places, stretch) = (self.places(block, x, y), self.load(&self.stretch, block));
                    let ends = self.ends(block);
                    if let Some(segments) = segments::<S, ORTHOGRAPHIC>(self.simd, record, places, stretch, ends) {
                        let mut pixels = self.pixels(block);
                        if self.light.look.is_some() {
                            self.shade(i, record, &segments, (block, places), &mut pixels);
                        } else {
                            self.integrate(record, &segments, &mut pixels);
                        }
                        self.store(block, &pixels);
                    }
                }
            }
            if self.is_done() {
                return;
            }
        }
    }

    #[inline(always)]
    fn integrate(&self, record: &Record, segments: &Segments<S>, pixels: &mut Pixels<S>) {
        let Segments { front, back, length, .. } = *segments;
        let ramps = &self.light.ramps[record.pieces[0] as usize..=record.pieces[1] as usize];
        let ramp = match ramps {
            _ if self.light.cut_all => None,
            [ramp] => Some(ramp),
            ramps => only::<S>(ramps, record.base, front, back, length),
        };
        if let Some(ramp) = ramp {
            if !ramp.is_empty() {
                let shift = record.base - ramp.ends[0];
                add_segment(self.simd, ramp, self.light.model, front + shift, back + shift, length, pixels);
            }
        } else {
            add_cut_segment(self.simd, ramps, record.base, self.light.model, front, back, length, pixels);
        }
    }
}

/// Most lanes of a vector.
const LANES: usize = 16;

/// A block's segments, lane by lane.
#[derive(Default)]
struct Lanes {
    front: [f32; LANES],
    back: [f32; LANES],
    length: [f32; LANES],
    middle: [f32; LANES],
    extent: [f32; LANES],
    /// The pixels, from the middle of the cell's box, and from the picture's.
    place: [[f32; LANES]; 2],
    pixel: [[f32; LANES]; 2],
    stretch: [f32; LANES],
}

impl<S: Simd> Walk<'_, S> {
    /// Composites segments of more than one field behind what is there, one pixel at a time.
    #[cold]
    #[inline(never)]
    fn shade(
        &mut self,
        cell: u32,
        record: &Record,
        segments: &Segments<S>,
        (block, places): (usize, (S::f32s, S::f32s)),
        pixels: &mut Pixels<S>,
    ) {
        let Some(look) = self.light.look else { return };
        let count = S::f32s::LEN;
        let [x, y] = [0, 1].map(|axis| self.origin[axis] as f32 + 0.5 - self.light.middle[axis]);
        let pixel = self.places(block, x, y);
        let mut lanes = Lanes::default();
        let [x, y] = &mut lanes.place;
        let [across, down] = &mut lanes.pixel;
        for (values, to) in [
            (segments.front, &mut lanes.front),
            (segments.back, &mut lanes.back),
            (segments.length, &mut lanes.length),
            (segments.middle, &mut lanes.middle),
            (segments.extent, &mut lanes.extent),
            (places.0, x),
            (places.1, y),
            (pixel.0, across),
            (pixel.1, down),
            (self.load(&self.stretch, block), &mut lanes.stretch),
        ] {
            values.store_slice(&mut to[..count]);
        }
        let mut colors = [[0.0; LANES]; 4];
        for i in 0..4 {
            pixels[i].store_slice(&mut colors[i][..count]);
        }
        let fields = look.further.len();
        let further = &self.light.further[cell as usize * fields..][..fields];
        let spent = shade_lanes(look, self.light, record, further, &lanes, count, &mut colors);
        self.spent = self.spent.and(spent);
        for i in 0..4 {
            pixels[i] = S::f32s::from_slice(self.simd, &colors[i][..count]);
        }
    }
}

/// Composites the segments of so many lanes behind `colors`, but for pixels that are done.
fn shade_lanes(
    look: &Look,
    light: &Light,
    record: &Record,
    further: &[Linear],
    lanes: &Lanes,
    count: usize,
    colors: &mut [[f32; LANES]; 4],
) -> Spent {
    let mut spent = Spent::default();
    let orthographic = light.pixel == 0.0;
    for i in (0..count).filter(|&i| lanes.length[i] > 0.0) {
        if colors[3][i] >= light.opaque {
            continue;
        }
        let place = lanes.place.map(|axis| axis[i]);
        let inside = Inside { place, middle: lanes.middle[i], extent: lanes.extent[i] };
        let first = [lanes.front[i], lanes.back[i]].map(|s| record.base + s);
        let look::Ends { scalars: [front, back], colors: ends, gradients } =
            look.values(first, further.iter().map(|field| field.ends(&inside, orthographic)));
        let [x, y] = lanes.pixel.map(|axis| -axis[i] * light.pixel / lanes.stretch[i]);
        let view = [x, y, -1.0 / lanes.stretch[i]];
        let pieces = record.pieces.map(|piece| piece as usize);
        let part = look.shade(&Segment { front, back, colors: ends, gradients, length: lanes.length[i], view, pieces });
        let left = 1.0 - colors[3][i];
        for channel in 0..4 {
            colors[channel][i] += left * part.color[channel];
        }
        spent.segments += 1;
        spent.pieces += u64::from(part.pieces);
    }
    spent
}

/// By how much a front face's plane is before a back face's, at most, in blocks whose first pixels are at (x, y).
#[inline(always)]
fn most<S: Simd>(front: &[f32; 3], back: &[f32; 3], (simd, x, y): (S, S::f32s, S::f32s)) -> S::f32s {
    let (dx, dy) = (front[0] - back[0], front[1] - back[1]);
    let rows = (S::f32s::LEN / WIDTH) as f32;
    // At the corner of a block where the difference is largest.
    let corner = front[2] - back[2] + (dx * (WIDTH - 1) as f32).max(0.0) + (dy * (rows - 1.0)).max(0.0);
    x.mul_add(dx, y.mul_add(dy, S::f32s::splat(simd, corner)))
}

/// Loads records before they are needed, so that the processor waits for all at once.
#[inline(always)]
fn touch(chunks: &[Chunk], cells: &[u32]) {
    let mut sum = 0.0;
    for &i in cells {
        let record = at(chunks, i);
        // In both of its cache lines.
        sum += record.planes[0][0] + record.level;
    }
    std::hint::black_box(sum);
}

/// A cell's contribution to a block: the middle's depth, premultiplied colour and alpha.
#[derive(Clone, Copy)]
struct Fragment<S: Simd> {
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
        while blocks != 0 {
            let block = blocks.trailing_zeros() as usize;
            blocks &= blocks - 1;
            let (stretch, ends) = (self.load(&self.stretch, block), self.ends(block));
            fragments.clear();
            let mut before = S::f32s::splat(self.simd, f32::MIN);
            for (&i, mask) in run.iter().zip(&masks) {
                if mask >> block & 1 == 0 {
                    continue;
                }
                let record = at(chunks, i);
                let (x, y) = self.from(record);
                let places = self.places(block, x, y);
                if let Some(segments) = segments::<S, ORTHOGRAPHIC>(self.simd, record, places, stretch, ends) {
                    let mut color = [S::f32s::splat(self.simd, 0.0); 4];
                    if self.light.look.is_some() {
                        self.shade(i, record, &segments, (block, places), &mut color);
                    } else {
                        self.integrate(record, &segments, &mut color);
                    }
                    // Where the ray misses the cell nothing has to move.
                    before = segments.length.simd_gt(0.0).select(segments.depth, before);
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
