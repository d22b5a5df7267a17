//! A stable radix sort of keys and values on the device, without subgroups: digits from the least significant on, each in
//! three stages (Merrill and Grimshaw 2011): blocks count their digits, the counts are summed up, and blocks move their keys
//! to where the sums say. Nothing depends on the order in which invocations run.

use super::Open;
use super::compute::{READ, Stage, UNIFORM, WRITE, dispatch, layout, pipeline};
use super::frame::Maker;
use super::picture::mapped;
use super::scan::{self, Scan};
use crate::{RenderError, Resources};

/// Keys a workgroup sorts, as shaders/lib/radix.wgsl has them.
const BLOCK: u32 = 4096;

/// Bits of the widest digit.
const WIDEST: u32 = 8;

/// Laid out as the shader's `Digit` (shaders/lib/radix.wgsl).
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub(crate) struct Digit {
    pub(crate) count: u32,
    pub(crate) blocks: u32,
    pub(crate) shift: u32,
    pub(crate) bits: u32,
}

/// Keys and values, and room for the same again.
#[derive(Debug)]
pub(super) struct Pairs {
    pub(super) keys: [wgpu::Buffer; 2],
    pub(super) values: [wgpu::Buffer; 2],
}

impl Pairs {
    /// Room for `count` pairs.
    pub(super) fn new(make: &Maker, count: u32) -> Pairs {
        // Who owns them may fill and read them.
        let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC | wgpu::BufferUsages::COPY_DST;
        let buffers = |label| [0, 1].map(|_| make.empty(label, u64::from(count.max(1)) * 4, usage));
        Pairs { keys: buffers("keys"), values: buffers("values") }
    }
}

#[derive(Debug)]
pub(super) struct Radix {
    histogram: Stage,
    scatter: Stage,
    pub(super) scan: Scan,
}

/// Pipelines of a sort.
pub(super) const PIPELINES: usize = 2 + scan::PIPELINES;

impl Radix {
    pub(super) fn new(device: &wgpu::Device) -> Result<Radix, RenderError> {
        let stage = |name, bindings: &[(u32, wgpu::BindingType)]| {
            let layout = layout(device, name, bindings);
            Ok::<_, RenderError>(Stage { pipeline: pipeline(device, name, &[], &[], &[Some(&layout)])?, layout })
        };
        Ok(Radix {
            histogram: stage("stages::histogram", &[(0, UNIFORM), (1, READ), (2, WRITE)])?,
            scatter: stage(
                "stages::scatter",
                &[(0, UNIFORM), (1, READ), (2, READ), (3, READ), (4, WRITE), (5, WRITE)],
            )?,
            scan: Scan::new(device)?,
        })
    }

    /// The stable order of some keys, each of `key_bits` bits at most: where in `keys` the least is, and so on.
    pub(super) fn order(&self, open: &Open, keys: &[u32], key_bits: u32) -> Result<Vec<u32>, String> {
        let Open { device, queue, .. } = open;
        let make = Maker::new(device, Resources::default());
        let count = keys.len() as u32;
        let pairs = Pairs::new(&make, count);
        let values: Vec<u32> = (0..count).collect();
        queue.write_buffer(&pairs.keys[0], 0, bytemuck::cast_slice(keys));
        queue.write_buffer(&pairs.values[0], 0, bytemuck::cast_slice(&values));
        let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let at = self.sort(&make, &mut encoder, &pairs, count, key_bits);
        let usage = wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST;
        let readback = make.empty("sorted", pairs.values[at].size(), usage);
        encoder.copy_buffer_to_buffer(&pairs.values[at], 0, &readback, 0, readback.size());
        queue.submit([encoder.finish()]);
        let mut order: Vec<u32> = bytemuck::pod_collect_to_vec(&mapped(device, &readback)?);
        order.truncate(keys.len());
        Ok(order)
    }

    /// The most pairs that one sort can hold.
    pub(super) fn most(limits: &wgpu::Limits) -> u32 {
        limits.max_compute_workgroups_per_dimension.saturating_mul(BLOCK)
    }

    /// Records that the first `count` pairs, at most [`Radix::most`], are sorted by their keys, which have `key_bits` bits at
    /// most; tells in which buffers of the two they are then.
    pub(super) fn sort(
        &self,
        make: &Maker,
        encoder: &mut wgpu::CommandEncoder,
        pairs: &Pairs,
        count: u32,
        key_bits: u32,
    ) -> usize {
        let passes = if count < 2 { 0 } else { key_bits.div_ceil(WIDEST) };
        if passes == 0 {
            return 0;
        }
        let blocks = count.div_ceil(BLOCK);
        let bits = key_bits.div_ceil(passes);
        let counts = blocks << bits;
        let starts = make.empty("digits", u64::from(counts) * 4, wgpu::BufferUsages::STORAGE);
        for pass in 0..passes {
            let from = pass as usize % 2;
            let (keys, values) = (&pairs.keys[from], &pairs.values[from]);
            let digit = Digit { count, blocks, shift: pass * bits, bits };
            let digit = make.filled("digit", bytemuck::bytes_of(&digit), wgpu::BufferUsages::UNIFORM);
            let group = make.bind(&self.histogram.layout, &[(0, &digit), (1, keys), (2, &starts)]);
            dispatch(encoder, &self.histogram.pipeline, &[Some(&group)], [blocks, 1]);
            self.scan.run(make, encoder, &starts, counts);
            let to = [&pairs.keys[1 - from], &pairs.values[1 - from]];
            let buffers = [(0, &digit), (1, keys), (2, values), (3, &starts), (4, to[0]), (5, to[1])];
            let group = make.bind(&self.scatter.layout, &buffers);
            dispatch(encoder, &self.scatter.pipeline, &[Some(&group)], [blocks, 1]);
        }
        passes as usize % 2
    }
}

#[cfg(test)]
mod tests;
