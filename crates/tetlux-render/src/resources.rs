//! What a picture took of a device.

/// Everything that was made for a picture, and nothing else: what a method does not need is not made.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Resources {
    /// Compute and render pipelines used.
    pub pipelines: usize,
    /// Buffers.
    pub buffers: usize,
    /// Textures, the picture itself included.
    pub textures: usize,
    /// Bytes of buffers and textures.
    pub bytes: u64,
    /// Cells drawn, counted once for every time that they are.
    pub cells: usize,
}
