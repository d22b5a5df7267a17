// All cells have their order.

// One past the last entry of the order that has none against this one.
fn group_end(entry: u32) -> u32 {
    return entry + 1u;
}
