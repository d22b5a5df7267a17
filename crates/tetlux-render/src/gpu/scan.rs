//! Exclusive sums on the device.

use super::compute::{READ, Stage, UNIFORM, WRITE, dispatch, layout, pipeline};
use super::frame::Maker;
use crate::RenderError;

/// Numbers a workgroup sums up, as shaders/lib/scanned.wgsl has them.
const BLOCK: u32 = 1024;

/// Laid out as the shader's `Scanned` (shaders/lib/scanned.wgsl).
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub(crate) struct Scanned {
    pub(crate) count: u32,
    pub(crate) unused: u32,
    pub(crate) unused_pair: [u32; 2],
}

/// Sums blocks of numbers, then the blocks' sums, and so on.
#[derive(Debug)]
pub(super) struct Scan {
    blocks: Stage,
    add: Stage,
}

/// Pipelines of a scan.
pub(super) const PIPELINES: usize = 2;

impl Scan {
    pub(super) fn new(device: &wgpu::Device) -> Result<Scan, RenderError> {
        let stage = |name, sums| {
            let layout = layout(device, name, &[(0, UNIFORM), (1, WRITE), (2, sums)]);
            Ok::<_, RenderError>(Stage { pipeline: pipeline(device, name, &[], &[], &[Some(&layout)])?, layout })
        };
        Ok(Scan { blocks: stage("stages::scan", WRITE)?, add: stage("stages::add", READ)? })
    }

    /// Records that each of the first `count` numbers becomes the sum of those before it, modulo 2^32.
    pub(super) fn run(&self, make: &Maker, encoder: &mut wgpu::CommandEncoder, items: &wgpu::Buffer, count: u32) {
        let blocks = count.div_ceil(BLOCK);
        if blocks == 0 {
            return;
        }
        let scanned = Scanned { count, unused: 0, unused_pair: [0; 2] };
        let scanned = make.filled("scanned", bytemuck::bytes_of(&scanned), wgpu::BufferUsages::UNIFORM);
        let sums = make.empty("sums of blocks", u64::from(blocks) * 4, wgpu::BufferUsages::STORAGE);
        let buffers = [(0, &scanned), (1, items), (2, &sums)];
        let group = make.bind(&self.blocks.layout, &buffers);
        dispatch(encoder, &self.blocks.pipeline, &[Some(&group)], [blocks, 1]);
        if blocks > 1 {
            self.run(make, encoder, &sums, blocks);
            let group = make.bind(&self.add.layout, &buffers);
            dispatch(encoder, &self.add.pipeline, &[Some(&group)], [blocks, 1]);
        }
    }
}
