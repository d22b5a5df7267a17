// Adds to the sums within blocks what all blocks before have come to: one invocation a number.
import package::lib::scanned::{Scanned, SCANNED, items, scanned};

@group(0) @binding(2) var<storage, read> sums: array<u32>;

@compute @workgroup_size(256)
fn add(@builtin(workgroup_id) block: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    for (var i = block.x * SCANNED + lane; i < min((block.x + 1u) * SCANNED, scanned.count); i += 256u) {
        items[i] += sums[block.x];
    }
}
