//! One picture by tiles: cells are binned into tiles of pixels in their order, and every tile composites its cells front to
//! back in registers. No draw, no blending.
//!
//! Each batch of cells is projected, and counted into the tiles that it may be seen in; the host reads the sums of the
//! counts, so that buffers are as large as what is written to them, and cuts the batch into runs that fit. A run's pairs of
//! tile and cell are written in the order of the cells, sorted by tile ([`super::radix`]), and walked.

use std::ops::Range;
use std::sync::OnceLock;

use wgpu::BindingType;

use super::compute::{READ, Stage, UNIFORM, WRITE, dispatch, layout, pipeline};
use super::frame::{Batch, Maker, WORKGROUP, batch_size};
use super::picture::mapped;
use super::radix::{self, Pairs, Radix};
use super::stretch::sorted;
use super::surfaces;
use super::tables;
use super::variant::{Binding, CELL_BYTES, READY_BYTES, Variant};
use super::{Drawn, Open};
use crate::{Job, RenderError, Resources};

/// Pixels on a tile's side, as shaders/lib/tiles.wgsl has them.
const TILE: u32 = 16;

/// Invocations a workgroup of shaders/stages/bounds.wgsl.
const BOUNDS_WORKGROUP: u32 = 256;

/// Pairs of a run: 128 MiB of buffers.
const MOST_PAIRS: u32 = 1 << 23;

/// Laid out as the shader's `Tiling` (shaders/lib/tiling.wgsl).
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub(crate) struct Tiling {
    pub(crate) columns: u32,
    pub(crate) first: u32,
    pub(crate) end: u32,
    pub(crate) opaque: f32,
}

/// Laid out as the shader's `Sorted` (shaders/stages/bounds.wgsl).
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub(crate) struct Sorted {
    pub(crate) pairs: u32,
    pub(crate) tiles: u32,
    pub(crate) unused: [u32; 2],
}

/// How much is done at a time.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Room {
    /// Cells a batch.
    pub(super) cells: u32,
    /// Pairs of tile and cell a run.
    pub(super) pairs: u32,
}

impl Room {
    /// However much a device has room for.
    pub(super) const MOST: Room = Room { cells: u32::MAX, pairs: MOST_PAIRS };

    /// Of software drivers: Mesa's ends the loops of a shader after 65 535 turns in all, of which a cell takes a few.
    pub(super) const OF_SOFTWARE: Room = Room { cells: 1 << 14, pairs: MOST_PAIRS };

    /// The lesser of both.
    pub(super) fn within(self, other: Room) -> Room {
        Room { cells: self.cells.min(other.cells), pairs: self.pairs.min(other.pairs) }
    }

    /// What a device has room for.
    pub(super) fn of(limits: &wgpu::Limits, variant: &Variant, size: [u32; 2]) -> Room {
        let bytes = limits.max_storage_buffer_binding_size.min(limits.max_buffer_size);
        let [columns, rows] = tiles(size);
        let bindings = u32::try_from(bytes / 4).unwrap_or(u32::MAX);
        let dispatches = limits.max_compute_workgroups_per_dimension.saturating_mul(BOUNDS_WORKGROUP) - 1;
        Room {
            // The pairs of a batch are counted in 32 bits, and there is one sum more than cells.
            cells: batch_size(limits, &variant.geometry())
                .min(u32::try_from(bytes / READY_BYTES).unwrap_or(u32::MAX))
                .min(u32::MAX / (columns * rows))
                .min(bindings - 1)
                .max(1),
            pairs: bindings.min(dispatches).min(Radix::most(limits)),
        }
    }
}

/// Columns and rows of tiles.
fn tiles(size: [u32; 2]) -> [u32; 2] {
    size.map(|n| n.div_ceil(TILE))
}

#[derive(Debug)]
pub(super) struct Tiler {
    variant: Variant,
    scene: wgpu::BindGroupLayout,
    tables: Option<wgpu::BindGroupLayout>,
    /// Where surfaces end rays, if there are any.
    surfaces: Option<wgpu::BindGroupLayout>,
    /// Made when an order by centroid is first asked for.
    depths: OnceLock<Stage>,
    project: Stage,
    count: Stage,
    fill: Stage,
    bounds: Stage,
    walk: Stage,
}

/// Pipelines of a picture by tiles.
const PIPELINES: usize = 5 + radix::PIPELINES;

impl Tiler {
    pub(super) fn new(device: &wgpu::Device, variant: Variant) -> Result<Tiler, RenderError> {
        let of = |binding| (binding as u32, if binding == Binding::View { UNIFORM } else { READ });
        let scene: Vec<_> = variant.bindings().into_iter().map(of).collect();
        let scene = layout(device, "scene", &scene);
        let tables = tables::layout(device, &variant, wgpu::ShaderStages::COMPUTE);
        let surfaces = variant.surfaces.then(|| surfaces::layout(device, wgpu::ShaderStages::COMPUTE));
        let stage = |name, bindings: &[(u32, BindingType)]| {
            let further = [&tables, &surfaces].map(|layout| layout.as_ref().filter(|_| name == "stages::tiles"));
            stage(device, &variant, &scene, further, name, bindings)
        };
        let bounds = layout(device, "stages::bounds", &[(0, UNIFORM), (1, READ), (2, WRITE)]);
        let project = stage("stages::project", &[(0, UNIFORM), (1, WRITE)])?;
        let count = stage("stages::count", &[(0, UNIFORM), (1, READ), (2, WRITE), (3, WRITE)])?;
        let fill = stage("stages::fill", &[(0, UNIFORM), (2, UNIFORM), (3, READ), (4, READ), (5, WRITE), (6, WRITE)])?;
        let walk = stage("stages::tiles", &[(0, UNIFORM), (2, UNIFORM), (3, READ), (4, READ), (5, READ), (6, WRITE)])?;
        let bounds =
            Stage { pipeline: pipeline(device, "stages::bounds", &[], &[], &[Some(&bounds)])?, layout: bounds };
        Ok(Tiler { variant, scene, tables, surfaces, depths: OnceLock::new(), project, count, fill, bounds, walk })
    }

    /// Makes the picture; the order is found first if it is to be by centroid.
    pub(super) fn draw(
        &self,
        open: &Open,
        radix: &Radix,
        variant: &Variant,
        job: &Job,
        by_centroid: bool,
        room: Room,
        adapter: &str,
    ) -> Result<Drawn, RenderError> {
        let Open { device, queue, resident, .. } = open;
        let failed = |reason| RenderError::Device { adapter: adapter.into(), reason };
        let too_small =
            |what, unit, needed, limit| RenderError::Limit { what, needed, unit, limit, adapter: adapter.into() };
        let cells = job.order.len() as u32;
        let make =
            Maker::new(device, Resources { pipelines: PIPELINES, cells: job.order.len(), ..Resources::default() });
        let to_sort = by_centroid.then(|| Pairs::new(&make, cells));
        let scene_buffer = |binding| match &to_sort {
            Some(pairs) if binding == Binding::Order => pairs.values[0].clone(),
            _ => make.scene(binding, job, resident),
        };
        let scene: Vec<_> = variant.bindings().into_iter().map(|b| (b as u32, scene_buffer(b))).collect();
        let scene: Vec<_> = scene.iter().map(|(binding, buffer)| (*binding, buffer)).collect();
        let scene = make.bind(&self.scene, &scene);
        if let Some(pairs) = &to_sort {
            self.sort(open, &make, radix, &scene, job, pairs)?;
        }
        let tables = self.tables.as_ref().map(|layout| tables::bind(&make, queue, layout, job));
        let surfaces = self.surfaces.as_ref().map(|layout| surfaces::bound(open, &make, layout, job));
        let bytes = u64::from(job.size[0]) * u64::from(job.size[1]) * 16;
        let binding = device.limits().max_storage_buffer_binding_size;
        if bytes > binding {
            return Err(too_small("the picture", "bytes", bytes, binding));
        }
        let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC;
        let picture = make.empty("picture", bytes, usage);

        let groups: Vec<_> = if variant.group { sorted(job.groups).cloned().collect() } else { Vec::new() };
        let batches = runs(cells, |i| i, &groups, room.cells)
            .map_err(|needed| too_small("a cycle of cells", "cells a batch", needed.into(), room.cells.into()))?;
        let largest = batches.iter().map(|batch| batch.end - batch.start).max().unwrap_or(0);
        let largest = u64::from(largest.max(1));
        let projected = make.empty("projected cells", largest * CELL_BYTES, wgpu::BufferUsages::STORAGE);
        let ready = make.empty("cells ready", largest * READY_BYTES, wgpu::BufferUsages::STORAGE);
        for batch in batches {
            let count = batch.end - batch.start;
            let uniform = Batch { last: batch.end - 1, count, unused: [0; 2] };
            let uniform = make.filled("batch", bytemuck::bytes_of(&uniform), wgpu::BufferUsages::UNIFORM);
            let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC;
            let offsets = make.empty("tiles of cells", u64::from(count + 1) * 4, usage);
            let usage = wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST;
            let readback = make.empty("tiles of cells, read", u64::from(count + 1) * 4, usage);

            let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
            let workgroups = [count.div_ceil(WORKGROUP), 1];
            let group = make.bind(&self.project.layout, &[(0, &uniform), (1, &projected)]);
            dispatch(&mut encoder, &self.project.pipeline, &[Some(&scene), Some(&group)], workgroups);
            let group = make.bind(&self.count.layout, &[(0, &uniform), (1, &projected), (2, &ready), (3, &offsets)]);
            dispatch(&mut encoder, &self.count.pipeline, &[Some(&scene), Some(&group)], workgroups);
            radix.scan.run(&make, &mut encoder, &offsets, count + 1);
            encoder.copy_buffer_to_buffer(&offsets, 0, &readback, 0, offsets.size());
            queue.submit([encoder.finish()]);
            let sums: Vec<u32> = bytemuck::pod_collect_to_vec(&mapped(device, &readback).map_err(failed)?);

            let groups: Vec<_> = groups_in(&groups, &batch);
            let before = |i: u32| sums.get(i as usize).copied().unwrap_or(0);
            let runs = runs(count, before, &groups, room.pairs).map_err(|needed| {
                too_small("the tiles of a cell or a cycle of cells", "pairs", needed.into(), room.pairs.into())
            })?;
            let pairs_of = |run: &Range<u32>| before(run.end).saturating_sub(before(run.start));
            let pairs = Pairs::new(&make, runs.iter().map(pairs_of).max().unwrap_or(0));
            for run in runs.iter().filter(|run| pairs_of(run) > 0) {
                let further = [tables.as_ref(), surfaces.as_ref()];
                let step = Step { make: &make, scene: &scene, further, radix, job };
                let buffers = [&uniform, &ready, &offsets, &picture];
                queue.submit([self.record(&step, device, run, pairs_of(run), buffers, &pairs)]);
            }
        }
        let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let usage = wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST;
        let readback = make.empty("readback", bytes, usage);
        encoder.copy_buffer_to_buffer(&picture, 0, &readback, 0, bytes);
        queue.submit([encoder.finish()]);
        let pixels = bytemuck::pod_collect_to_vec(&mapped(device, &readback).map_err(failed)?);
        Ok(Drawn { pixels, resources: make.made(), spent: None })
    }

    /// Sorts the order by centroid, in the first buffer of values.
    fn sort(
        &self,
        open: &Open,
        make: &Maker,
        radix: &Radix,
        scene: &wgpu::BindGroup,
        job: &Job,
        pairs: &Pairs,
    ) -> Result<(), RenderError> {
        let Open { device, queue, .. } = open;
        let depths = match self.depths.get() {
            Some(depths) => depths,
            None => {
                let made = stage(device, &self.variant, &self.scene, [None; 2], "stages::depths", &[(1, WRITE)])?;
                self.depths.get_or_init(|| made)
            }
        };
        make.count_pipelines(1);
        queue.write_buffer(&pairs.values[0], 0, bytemuck::cast_slice(job.order));
        let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let count = job.order.len() as u32;
        let workgroups = count.div_ceil(WORKGROUP).min(device.limits().max_compute_workgroups_per_dimension);
        let group = make.bind(&depths.layout, &[(1, &pairs.keys[0])]);
        dispatch(&mut encoder, &depths.pipeline, &[Some(scene), Some(&group)], [workgroups, 1]);
        // Passes over all bits are even in number: the values are where they were.
        radix.sort(make, &mut encoder, pairs, count, u32::BITS);
        queue.submit([encoder.finish()]);
        Ok(())
    }

    /// The commands that composite a run of a batch's cells behind what the picture holds.
    fn record(
        &self,
        step: &Step,
        device: &wgpu::Device,
        run: &Range<u32>,
        count: u32,
        [batch, ready, offsets, picture]: [&wgpu::Buffer; 4],
        pairs: &Pairs,
    ) -> wgpu::CommandBuffer {
        let Step { make, scene, further: [tables, surfaces], radix, job } = *step;
        let [columns, rows] = tiles(job.size);
        let tiling = Tiling { columns, first: run.start, end: run.end, opaque: job.opaque };
        let tiling = make.filled("tiling", bytemuck::bytes_of(&tiling), wgpu::BufferUsages::UNIFORM);
        let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let buffers = [(0, batch), (2, &tiling), (3, ready), (4, offsets), (5, &pairs.keys[0]), (6, &pairs.values[0])];
        let group = make.bind(&self.fill.layout, &buffers);
        let workgroups = (run.end - run.start).div_ceil(WORKGROUP);
        dispatch(&mut encoder, &self.fill.pipeline, &[Some(scene), Some(&group)], [workgroups, 1]);

        let tiles = columns * rows;
        let at = radix.sort(make, &mut encoder, pairs, count, u32::BITS - (tiles - 1).leading_zeros());
        let bounds = Sorted { pairs: count, tiles, unused: [0; 2] };
        let bounds = make.filled("sorted", bytemuck::bytes_of(&bounds), wgpu::BufferUsages::UNIFORM);
        let starts = make.empty("tiles", u64::from(tiles + 1) * 4, wgpu::BufferUsages::STORAGE);
        let group = make.bind(&self.bounds.layout, &[(0, &bounds), (1, &pairs.keys[at]), (2, &starts)]);
        dispatch(&mut encoder, &self.bounds.pipeline, &[Some(&group)], [(count + 1).div_ceil(BOUNDS_WORKGROUP), 1]);

        let buffers = [(0, batch), (2, &tiling), (3, ready), (4, &pairs.values[at]), (5, &starts), (6, picture)];
        let group = make.bind(&self.walk.layout, &buffers);
        let groups = [Some(scene), Some(&group), tables, surfaces];
        dispatch(&mut encoder, &self.walk.pipeline, &groups, [columns, rows]);
        encoder.finish()
    }
}

/// A stage that sees the scene and further groups: tables and surfaces, if there are any.
fn stage(
    device: &wgpu::Device,
    variant: &Variant,
    scene: &wgpu::BindGroupLayout,
    [tables, surfaces]: [Option<&wgpu::BindGroupLayout>; 2],
    name: &str,
    bindings: &[(u32, BindingType)],
) -> Result<Stage, RenderError> {
    let layout = layout(device, name, bindings);
    let groups = [Some(scene), Some(&layout), tables, surfaces];
    let constants = [("ORTHOGRAPHIC", f64::from(u8::from(variant.orthographic)))];
    Ok(Stage { pipeline: pipeline(device, name, &variant.choices(), &constants, &groups)?, layout })
}

/// What all runs of a picture share.
struct Step<'a> {
    make: &'a Maker<'a>,
    scene: &'a wgpu::BindGroup,
    /// Tables and surfaces, if there are any.
    further: [Option<&'a wgpu::BindGroup>; 2],
    radix: &'a Radix,
    job: &'a Job<'a>,
}

/// Ranges of `count` cells of at most `most` things each that cut no group; `before` counts the things of all cells before
/// one. The error is how many things a range would have to hold.
fn runs(count: u32, before: impl Fn(u32) -> u32, groups: &[Range<u32>], most: u32) -> Result<Vec<Range<u32>>, u32> {
    let mut runs = Vec::new();
    let mut start = 0;
    while start < count {
        // The last end that fits, between one that does and one that does not.
        let (mut end, mut over) = (start, count + 1);
        while over - end > 1 {
            let middle = end + (over - end) / 2;
            if before(middle).saturating_sub(before(start)) <= most {
                end = middle;
            } else {
                over = middle;
            }
        }
        let next = groups.partition_point(|group| group.end <= end);
        let cut = groups.get(next).filter(|group| group.start < end);
        let fits = cut.map_or(end, |group| group.start);
        if fits <= start {
            let needed = cut.map_or(start + 1, |group| group.end);
            return Err(before(needed).saturating_sub(before(start)));
        }
        runs.push(start..fits);
        start = fits;
    }
    Ok(runs)
}

/// The groups of a batch, counted from its first cell.
fn groups_in(groups: &[Range<u32>], batch: &Range<u32>) -> Vec<Range<u32>> {
    let inside = groups.iter().filter(|group| batch.contains(&group.start));
    inside.map(|group| group.start - batch.start..group.end - batch.start).collect()
}

#[cfg(test)]
mod tests;
