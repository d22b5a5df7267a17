//! The CPU back end: tile-binned cell projection.
//!
//! Cells are set up in double precision ([`record`]), binned into tiles of pixels in their order ([`bins`]), and every
//! tile walks its cells front to back with a vector of pixels at a time ([`walk`]): a block's rays are met with a
//! cell's planes ([`block`]), and the segments are integrated exactly ([`ramp`]). Where cells have no order a tile
//! sorts its fragments by depth. A block whose pixels are opaque is left alone. Where a scene looks at more than one
//! scalar, its further fields are set up beside the records ([`further`]) and segments are shaded one by one
//! ([`crate::look`]).
//!
//! The instruction set is chosen at run time. A picture is the same bit for bit every time and on any number of
//! threads; on other instruction sets it may differ by roundings, where multiplications and additions are not fused.

mod bins;
mod block;
mod further;
mod ramp;
mod record;
#[cfg(test)]
mod tests;
mod vector;
mod walk;

use std::ops::Range;

use fearless_simd::{Level, Simd, dispatch};
use rayon::prelude::*;
use tetlux_scene::Skip;

use crate::Job;
use crate::look::Spent;
use crate::stage::Stages;
use bins::{Bins, TILE};
use ramp::Ramp;
use record::{CHUNK, Chunk, SetUp};
use walk::{Light, Walk};

/// Bytes of a cell that is set up: its record, and the tiles of its box.
pub(crate) const CELL_BYTES: u64 = (size_of::<Chunk>() / CHUNK) as u64;

/// Cells that are set up at a time: bounds the memory of their records, 136 bytes a cell.
const BATCH: usize = 1 << 20;

/// Draws a picture: premultiplied pixels, top row first; and what segments took that were shaded one by one.
pub(crate) fn draw(level: Level, job: &Job, stages: &mut Stages) -> (Vec<[f32; 4]>, Spent) {
    let eye = &job.eye;
    let all_weights = job.kept.contains(Skip::Weights);
    let ramps: Vec<Ramp> = job.pieces.iter().map(|piece| Ramp::new(piece, all_weights)).collect();
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
    let points = stages.run("project", || record::points(job.mesh, job.scalar, eye));
    let set_up =
        SetUp { mesh: job.mesh, points: &points, eye, pieces: job.pieces, cut_all: light.cut_all, size: job.size };
    let columns = bins::tiles(job.size)[0] as usize;
    let fields = job.look.as_ref().map_or(&[][..], |look| &look.further);
    let mut pixels = vec![[0.0; 4]; job.size[0] as usize * job.size[1] as usize];
    let mut spent = Spent::default();
    for batch in batches(job.order.len(), job.groups) {
        let cells = &job.order[batch.clone()];
        let (chunks, further) = stages.run("set up", || {
            let chunks = set_up.chunks(level, cells);
            let further = further::further(&set_up, fields, cells, &chunks);
            (chunks, further)
        });
        let light = Light { further: &further, ..light };
        let bins = stages.run("bin", || Bins::new(&chunks, job.size));
        let groups = groups_in(job.groups, &batch);
        let drawn = stages.run("draw", || {
            rows_of_tiles(&mut pixels, job.size).into_par_iter().enumerate().map(|(index, mut rows)| {
                let origin = [index % columns, index / columns].map(|i| i as u32 * TILE);
                let cells = bins.of(index);
                if eye.orthographic {
                    dispatch!(level, simd => draw_tile::<_, true>(simd, &light, origin, &chunks, cells, &groups, &mut rows))
                } else {
                    dispatch!(level, simd => draw_tile::<_, false>(simd, &light, origin, &chunks, cells, &groups, &mut rows))
                }
            }).reduce(Spent::default, Spent::and)
        });
        spent = spent.and(drawn);
    }
    (pixels, spent)
}

/// For each tile its rows of the picture.
fn rows_of_tiles(pixels: &mut [[f32; 4]], size: [u32; 2]) -> Vec<Vec<&mut [[f32; 4]]>> {
    let [columns, rows] = bins::tiles(size).map(|n| n as usize);
    let mut tiles: Vec<Vec<&mut [[f32; 4]]>> = Vec::new();
    tiles.resize_with(columns * rows, || Vec::with_capacity(TILE as usize));
    for (y, row) in pixels.chunks_mut(size[0] as usize).enumerate() {
        for (part, tile) in row.chunks_mut(TILE as usize).zip(&mut tiles[y / TILE as usize * columns..]) {
            tile.push(part);
        }
    }
    tiles
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
    rows: &mut [&mut [[f32; 4]]],
) -> Spent {
    let mut walk = Walk::new(simd, light, origin, rows);
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
    walk.finish(rows);
    walk.spent
}
