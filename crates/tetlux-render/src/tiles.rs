//! The CPU back end: tile-binned cell projection.
//!
//! Cells are set up in double precision ([`set_up`], [`record`]), binned into tiles of pixels in their order ([`bins`]), and
//! every tile of the picture ([`canvas`]) walks its cells front to back, some at a time ([`walk`]): in which blocks of
//! pixels they may be seen ([`cover`]), and for each block, a vector of pixels, where its rays are inside a cell
//! ([`block`]) and the exact integral there ([`ramp`]). Where cells have no order a tile sorts its fragments by depth
//! ([`sorted`]). A block whose pixels are opaque is left alone. Where a scene looks at more than one scalar, its further
//! fields are set up beside the records ([`further`]) and segments are shaded one by one ([`lanes`], [`crate::look`]).
//!
//! The instruction set is chosen at run time. A picture is the same bit for bit every time and on any number of
//! threads; on other instruction sets it may differ by roundings, where multiplications and additions are not fused.

mod bins;
mod block;
mod canvas;
mod cover;
mod further;
mod lanes;
mod ramp;
mod record;
mod set_up;
mod sorted;
#[cfg(test)]
mod tests;
mod vector;
mod walk;

use std::ops::Range;
use std::sync::{Mutex, PoisonError};

use fearless_simd::{Level, Simd, SimdBase, dispatch};
use rayon::prelude::*;
use tetlux_scene::Skip;

use crate::Job;
use crate::look::Spent;
use crate::stage::Stages;
use bins::{Bins, TILE};
use canvas::{Canvas, Tile};
use ramp::{Ramp, Ramps};
use record::{CHUNK, Chunk};
use set_up::SetUp;
use walk::{Light, Walk};

/// Cells that are set up at a time: their records, 136 bytes a cell, are still in a cache when they are drawn, and their
/// memory is taken once.
const BATCH: usize = 1 << 16;

/// Bytes of memory that a picture of so many cells takes for them while they are set up.
pub(crate) fn bytes_set_up(cells: u64) -> u64 {
    cells.min(BATCH as u64) * (size_of::<Chunk>() / CHUNK) as u64
}

/// The memory of cells that are set up, kept from picture to picture: fresh memory costs as much as its contents.
#[derive(Debug, Default)]
pub(crate) struct Room(Mutex<Vec<Chunk>>);

/// Draws a picture: premultiplied pixels, top row first; and what segments took that were shaded one by one.
pub(crate) fn draw(level: Level, job: &Job, room: &Room, stages: &mut Stages) -> (Vec<[f32; 4]>, Spent) {
    // Another picture that is drawn at the same time finds none, and makes its own.
    let lock = || room.0.lock().unwrap_or_else(PoisonError::into_inner);
    let mut chunks = std::mem::take(&mut *lock());
    let drawn = draw_on(level, job, &mut chunks, stages);
    chunks.truncate(BATCH / CHUNK);
    chunks.shrink_to_fit();
    *lock() = chunks;
    drawn
}

/// The same in memory of its own.
fn draw_on(level: Level, job: &Job, chunks: &mut Vec<Chunk>, stages: &mut Stages) -> (Vec<[f32; 4]>, Spent) {
    let eye = &job.eye;
    let all_weights = job.kept.contains(Skip::Weights);
    let ramps = Ramps::new(job.pieces.iter().map(|piece| Ramp::new(piece, all_weights)).collect());
    let light = Light {
        ramps: &ramps,
        model: job.weights,
        pixel: if eye.orthographic { 0.0 } else { eye.pixel as f32 },
        middle: eye.middle.map(|m| m as f32),
        opaque: job.opaque,
        backdrop: job.backdrop.as_ref().map(|backdrop| (backdrop, eye.offset.z as f32)),
        width: job.size[0] as usize,
        cut_all: job.kept.contains(Skip::Cuts),
        look: job.look.as_ref(),
        further: &[],
    };
    let points = stages.run("project", || set_up::points(job.mesh, job.scalar, eye));
    let set_up = SetUp::new(job, &points, light.cut_all);
    let columns = bins::tiles(job.size)[0] as usize;
    let fields = job.look.as_ref().map_or(&[][..], |look| &look.further);
    let mut canvas = Canvas::new(job.size);
    let mut spent = Spent::default();
    for batch in batches(job.order.len(), job.groups) {
        let cells = &job.order[batch.clone()];
        let count = cells.len().div_ceil(CHUNK);
        let further = stages.run("set up", || {
            if chunks.len() < count {
                chunks.resize(count, Chunk::default());
            }
            set_up.chunks(level, cells, &mut chunks[..count]);
            further::further(&set_up, fields, cells, chunks)
        });
        let chunks = &chunks[..count];
        let light = Light { further: &further, ..light };
        let bins = stages.run("bin", || Bins::new(chunks, job.size));
        let groups = groups_in(job.groups, &batch);
        let drawn = stages.run("draw", || {
            let draw = |(index, tile): (usize, &mut Tile)| {
                let origin = [index % columns, index / columns].map(|i| i as u32 * TILE);
                let cells = bins.of(index);
                if cells.is_empty() {
                    Spent::default()
                } else if eye.orthographic {
                    dispatch!(level, simd => draw_tile::<_, true>(simd, &light, origin, chunks, cells, &groups, tile))
                } else {
                    dispatch!(level, simd => draw_tile::<_, false>(simd, &light, origin, chunks, cells, &groups, tile))
                }
            };
            canvas.tiles().enumerate().map(draw).reduce(Spent::default, Spent::and)
        });
        spent = spent.and(drawn);
    }
    let lanes = dispatch!(level, simd => lanes(simd));
    (stages.run("draw", || canvas.into_pixels(lanes)), spent)
}

/// Lanes of a vector.
#[inline(always)]
fn lanes<S: Simd>(_: S) -> usize {
    S::f32s::LEN
}

/// Ranges of the order of about [`BATCH`] cells that cut no group.
fn batches(cells: usize, groups: &[Range<u32>]) -> Vec<Range<usize>> {
    let mut batches = Vec::new();
    let mut start = 0;
    while start < cells {
        let end = (start + BATCH).min(cells);
        let group = groups.partition_point(|group| (group.end as usize) < end);
        let cut = groups.get(group).filter(|group| (group.start as usize) < end);
        let end = cut.map_or(end, |group| (group.end as usize).min(cells));
        batches.push(start..end);
        start = end;
    }
    batches
}

/// The groups of a batch, counted from its first cell.
fn groups_in(groups: &[Range<u32>], batch: &Range<usize>) -> Vec<Range<u32>> {
    let inside = groups.iter().filter(|group| batch.contains(&(group.start as usize)));
    inside.map(|group| group.start - batch.start as u32..group.end - batch.start as u32).collect()
}

/// Walks a tile's cells, which are in their order.
#[inline(always)]
fn draw_tile<S: Simd, const ORTHOGRAPHIC: bool>(
    simd: S,
    light: &Light,
    origin: [u32; 2],
    chunks: &[Chunk],
    cells: &[u32],
    groups: &[Range<u32>],
    tile: &mut Tile,
) -> Spent {
    let mut walk = Walk::new(simd, light, origin, tile);
    let mut rest = cells;
    let mut groups = groups;
    while let [cell, ..] = rest
        && !walk.is_done()
    {
        while groups.first().is_some_and(|group| group.end <= *cell) {
            groups = &groups[1..];
        }
        let start = groups.first().map_or(u32::MAX, |group| group.start);
        let until = |end: u32| rest.partition_point(|&i| i < end);
        if let Some(group) = groups.first().filter(|group| group.start <= *cell) {
            let (run, after) = rest.split_at(until(group.end));
            walk.add_sorted::<ORTHOGRAPHIC>(chunks, run);
            rest = after;
        } else {
            let (run, after) = rest.split_at(until(start));
            walk.add::<ORTHOGRAPHIC>(chunks, run);
            rest = after;
        }
    }
    walk.spent
}
