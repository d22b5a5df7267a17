// Moves keys and their values to where their digit's come, those of one digit in the order that they are in: one workgroup a
// block, one invocation a key of a row of 256 at a time.
//
// An invocation learns how many of its row before it have the same digit from bits that all have set for their digits:
// setting bits gives the same words in whatever order it is done, so that the sort is stable without subgroups.
import package::lib::radix::{Digit, SORTED, THREADS, digit, keys, digit_of};

@group(0) @binding(2) var<storage, read> values: array<u32>;
// For each digit and block where its first key comes.
@group(0) @binding(3) var<storage, read> starts: array<u32>;
@group(0) @binding(4) var<storage, read_write> sorted_keys: array<u32>;
@group(0) @binding(5) var<storage, read_write> sorted_values: array<u32>;

// Words of bits for a row.
const WORDS = 8u;

// Where the next key of each digit comes.
var<workgroup> places: array<u32, 256>;
// For each digit the invocations that have it.
var<workgroup> having: array<array<atomic<u32>, 8>, 256>;

@compute @workgroup_size(256)
fn scatter(@builtin(workgroup_id) block: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    if lane < 1u << digit.bits {
        places[lane] = starts[lane * digit.blocks + block.x];
    }
    let first = block.x * SORTED;
    let end = min(first + SORTED, digit.count);
    for (var row = first; row < end; row += THREADS) {
        for (var word = 0u; word < WORDS; word++) {
            atomicStore(&having[lane][word], 0u);
        }
        workgroupBarrier();
        let i = row + lane;
        var mine = 0u;
        if i < end {
            mine = digit_of(keys[i]);
            atomicOr(&having[mine][lane / 32u], 1u << (lane % 32u));
        }
        workgroupBarrier();
        if i < end {
            var place = places[mine];
            for (var word = 0u; word < lane / 32u; word++) {
                place += countOneBits(atomicLoad(&having[mine][word]));
            }
            place += countOneBits(atomicLoad(&having[mine][lane / 32u]) & ((1u << (lane % 32u)) - 1u));
            sorted_keys[place] = keys[i];
            sorted_values[place] = values[i];
        }
        workgroupBarrier();
        // One invocation a digit: what has been placed.
        for (var word = 0u; word < WORDS; word++) {
            places[lane] += countOneBits(atomicLoad(&having[lane][word]));
        }
    }
}
