// Counts how often each digit occurs in each block of keys: one workgroup a block.
import package::lib::radix::{Digit, SORTED, THREADS, digit, keys, digit_of};

// For each digit its count in each block.
@group(0) @binding(2) var<storage, read_write> counts: array<u32>;

var<workgroup> found: array<atomic<u32>, 256>;

@compute @workgroup_size(256)
fn histogram(@builtin(workgroup_id) block: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    atomicStore(&found[lane], 0u);
    workgroupBarrier();
    let first = block.x * SORTED;
    for (var i = first + lane; i < min(first + SORTED, digit.count); i += THREADS) {
        atomicAdd(&found[digit_of(keys[i])], 1u);
    }
    workgroupBarrier();
    if lane < 1u << digit.bits {
        counts[lane * digit.blocks + block.x] = atomicLoad(&found[lane]);
    }
}
