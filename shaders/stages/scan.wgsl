// Exclusive sums of blocks of numbers, in place, and each block's sum (Blelloch 1990): one workgroup a block.
import package::lib::scanned::{Scanned, SCANNED, THREADS, items, scanned};

@group(0) @binding(2) var<storage, read_write> sums: array<u32>;

var<workgroup> partial: array<u32, 256>;

@compute @workgroup_size(256)
fn scan(@builtin(workgroup_id) block: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    let each = SCANNED / THREADS;
    let first = block.x * SCANNED + lane * each;
    var total = 0u;
    for (var i = first; i < min(first + each, scanned.count); i++) {
        let item = items[i];
        items[i] = total;
        total += item;
    }
    partial[lane] = total;
    workgroupBarrier();
    for (var reach = 1u; reach < THREADS; reach *= 2u) {
        var sum = partial[lane];
        if lane >= reach {
            sum += partial[lane - reach];
        }
        workgroupBarrier();
        partial[lane] = sum;
        workgroupBarrier();
    }
    let before = partial[lane] - total;
    for (var i = first; i < min(first + each, scanned.count); i++) {
        items[i] += before;
    }
    if lane == THREADS - 1u {
        sums[block.x] = partial[lane];
    }
}
