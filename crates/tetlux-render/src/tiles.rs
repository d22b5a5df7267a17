//! The CPU back end: tile-binned cell projection.
//!
//! Cells are set up in double precision ([`record`]), binned into tiles of pixels in their order ([`bins`]), and every
//! tile walks its cells front to back with a vector of pixels at a time ([`walk`]): a block's rays are met with a
//! cell's planes ([`block`]), and the segments are integrated exactly ([`ramp`]). Where cells have no order a tile
//! sorts its fragments by depth. A block whose pixels are opaque is left alone.
//!
//! The instruction set is chosen at run time. A picture is the same bit for bit every time and on any number of
//! threads; on other instruction sets it may differ by roundings, where multiplications and additions are not fused.

mod bins;
mod block;
mod ramp;
mod record;
#[cfg(test)]
mod tests;
mod walk;

use std::ops::Range;

use fearless_simd::{Level, Simd, SimdBase, dispatch};
use rayon::prelude::*;

use crate::Job;
use crate::stage::Stages;
use bins::{Bins, TILE};
use ramp::Ramp;
use record::{Record, SetUp};
use walk::{Light, PIXELS, Tile, Walk};

/// Cells that are set up at a time: bounds the memory of their records, 128 bytes a cell.
const BATCH: usize = 1 << 20;

/// Share of the allowed error that may lie behind pixels that count as opaque.
const HIDDEN_ERROR: f64 = 1e-3;

/// Draws a picture: premultiplied pixels, top row first.
pub(crate) fn draw(job: &Job, stages: &mut Stages) -> Vec<[f32; 4]> {
    draw_on(Level::new(), job, stages)
}

/// The same with a given instruction set.
fn draw_on(level: Level, job: &Job, stages: &mut Stages) -> Vec<[f32; 4]> {
    let eye = &job.eye;
    let ramps: Vec<Ramp> = job.pieces.iter().map(Ramp::new).collect();
    let brightest = job.pieces.iter().flat_map(|p| [p.low, p.high]).flat_map(|c| [c[0], c[1], c[2]]).fold(1.0, f32::max);
    let light = Light {
        ramps: &ramps,
        model: job.weights,
        pixel: if eye.orthographic { 0.0 } else { eye.pixel as f32 },
        middle: eye.middle.map(|m| m as f32),
        opaque: (1.0 - HIDDEN_ERROR * job.max_error / f64::from(brightest)) as f32,
    };
    let points = stages.run("project", || record::points(job.mesh, eye));
    let set_up = SetUp { mesh: job.mesh, points: &points, eye, pieces: job.pieces, size: job.size };
    let [columns, rows] = bins::tiles(job.size).map(|n| n as usize);
    let mut tiles = vec![Tile([[0.0; PIXELS]; 4]); columns * rows];
    for batch in batches(job.order.len(), job.groups) {
        let records: Vec<Record> =
            stages.run("set up", || job.order[batch.clone()].par_iter().map(|&cell| set_up.record(cell)).collect());
        let bins = stages.run("bin", || Bins::new(&records, job.size));
        let groups = groups_in(job.groups, &batch);
        stages.run("draw", || {
            tiles.par_iter_mut().enumerate().for_each(|(index, tile)| {
                let origin = [index % columns, index / columns].map(|i| i as u32 * TILE);
                let cells = bins.of(index);
                if eye.orthographic {
                    dispatch!(level, simd => draw_tile::<_, true>(simd, &light, origin, &records, cells, &groups, tile));
                } else {
                    dispatch!(level, simd => draw_tile::<_, false>(simd, &light, origin, &records, cells, &groups, tile));
                }
            });
        });
    }
    let lanes = dispatch!(level, simd => lanes(simd));
    stages.run("resolve", || resolve(&tiles, job.size, lanes))
}

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
    records: &[Record],
    cells: &[u32],
    groups: &[Range<u32>],
    tile: &mut Tile,
) {
    let mut walk = Walk::new(simd, light, origin, tile);
    let mut rest = cells;
    let mut groups = groups;
    while let [cell, after @ ..] = rest
        && !walk.is_done()
    {
        while groups.first().is_some_and(|group| group.end <= *cell) {
            groups = &groups[1..];
        }
        if let Some(group) = groups.first().filter(|group| group.start <= *cell) {
            let (run, after) = rest.split_at(rest.partition_point(|&i| i < group.end));
            walk.add_sorted::<ORTHOGRAPHIC>(records, run);
            rest = after;
        } else {
            walk.add::<ORTHOGRAPHIC>(&records[*cell as usize]);
            rest = after;
        }
    }
}

/// The pixels of all tiles, row by row.
fn resolve(tiles: &[Tile], size: [u32; 2], lanes: usize) -> Vec<[f32; 4]> {
    let [width, height] = size.map(|n| n as usize);
    let columns = width.div_ceil(TILE as usize);
    // Where each pixel of a tile, row by row, is in its vectors.
    let mut places = [[0; TILE as usize]; TILE as usize];
    for index in 0..PIXELS {
        let [x, y] = walk::place(index, lanes);
        places[y][x] = index;
    }
    let mut pixels = vec![[0.0; 4]; width * height];
    pixels.par_chunks_mut(width).enumerate().for_each(|(y, row)| {
        let tiles = &tiles[y / TILE as usize * columns..][..columns];
        for (part, tile) in row.chunks_mut(TILE as usize).zip(tiles) {
            for (pixel, &i) in part.iter_mut().zip(&places[y % TILE as usize]) {
                *pixel = [0, 1, 2, 3].map(|c| tile.0[c][i]);
            }
        }
    });
    pixels
}
