// Some cells have no order among themselves: they follow one another in the order, and every pixel sorts them by depth.
@group(0) @binding(15) var<storage, read> group_ends: array<u32>;

// One past the last entry of the order that has none against this one.
fn group_end(entry: u32) -> u32 {
    return group_ends[entry];
}
