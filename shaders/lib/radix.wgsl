// One pass of a radix sort: by one digit of the keys, least significant digits first.

struct Digit {
    // Keys in all, and blocks of them.
    count: u32,
    blocks: u32,
    // The digit's lowest bit, and how many bits it has: at most 8.
    shift: u32,
    bits: u32,
}

@group(0) @binding(0) var<uniform> digit: Digit;
@group(0) @binding(1) var<storage, read> keys: array<u32>;

// Keys a block.
const SORTED = 4096u;
const THREADS = 256u;

fn digit_of(key: u32) -> u32 {
    return key >> digit.shift & ((1u << digit.bits) - 1u);
}
