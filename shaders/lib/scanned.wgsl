// Numbers that are being summed up.

struct Scanned {
    count: u32,
    unused: u32,
    unused_pair: vec2<u32>,
}

@group(0) @binding(0) var<uniform> scanned: Scanned;
@group(0) @binding(1) var<storage, read_write> items: array<u32>;

// Numbers a block, and invocations that share it.
const SCANNED = 1024u;
const THREADS = 256u;
