// Where each tile's cells begin among those sorted by tile: one invocation a pair, and one more for what follows the last.
struct Sorted {
    pairs: u32,
    tiles: u32,
    unused: vec2<u32>,
}

@group(0) @binding(0) var<uniform> sorted: Sorted;
@group(0) @binding(1) var<storage, read> tiles: array<u32>;
// One more than tiles, for the end of the last.
@group(0) @binding(2) var<storage, read_write> starts: array<u32>;

@compute @workgroup_size(256)
fn bounds(@builtin(global_invocation_id) id: vec3<u32>) {
    let i = id.x;
    if i > sorted.pairs {
        return;
    }
    var first = 0u;
    if i > 0u {
        first = tiles[i - 1u] + 1u;
    }
    var last = sorted.tiles;
    if i < sorted.pairs {
        last = tiles[i];
    }
    for (var tile = first; tile <= last; tile++) {
        starts[tile] = i;
    }
}
