//! The pieces that shaders count, where there are two fields or light.

use super::frame::Maker;
use super::picture::mapped;
use super::variant::Binding;
use crate::look::Spent;

/// Counters of segments, then as many of pieces: shaders/lib/spent.wgsl.
const COUNTERS: usize = 4096;

/// Bytes of them all.
const BYTES: u64 = 2 * 4 * COUNTERS as u64;

/// The counters, all 0.
pub(super) fn counters(make: &Maker) -> wgpu::Buffer {
    make.empty("spent", BYTES, wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC)
}

/// What the counters are read back through.
pub(super) struct Count {
    counters: wgpu::Buffer,
    readback: wgpu::Buffer,
}

impl Count {
    /// Of the counters among the buffers of a scene, if there are any.
    pub(super) fn new(make: &Maker, scene: &[(Binding, wgpu::Buffer)]) -> Option<Count> {
        let (_, counters) = scene.iter().find(|(binding, _)| *binding == Binding::Spent)?;
        let usage = wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST;
        Some(Count { counters: counters.clone(), readback: make.empty("count", BYTES, usage) })
    }

    /// Records the copy that [`Count::read`] waits for.
    pub(super) fn copy(&self, encoder: &mut wgpu::CommandEncoder) {
        encoder.copy_buffer_to_buffer(&self.counters, 0, &self.readback, 0, BYTES);
    }

    /// The sums, once the device is done; the error is what the driver said.
    pub(super) fn read(&self, device: &wgpu::Device) -> Result<Spent, String> {
        let bytes = mapped(device, &self.readback)?;
        let counts: Vec<u32> = bytemuck::pod_collect_to_vec(&bytes);
        let (segments, pieces) = counts.split_at(COUNTERS.min(counts.len()));
        let sum = |counts: &[u32]| counts.iter().copied().map(u64::from).sum();
        Ok(Spent { segments: sum(segments), pieces: sum(pieces) })
    }
}
