// Makes the cells of a batch ready, and counts the tiles that each may be seen in, nearest first: one invocation a cell.
import package::lib::mesh::{batch, corners};
import package::lib::prepared::{prepared};
import package::lib::ready::{Ready};
import package::lib::tiles::{TILE, footprint, reaches};
import package::axes::source::{projected_cell};

@group(1) @binding(2) var<storage, read_write> ready: array<Ready>;
// One more than cells: the last stays zero, for the sum of all.
@group(1) @binding(3) var<storage, read_write> counts: array<u32>;

@compute @workgroup_size(64)
fn count(@builtin(global_invocation_id) id: vec3<u32>) {
    let rank = id.x;
    if rank >= batch.count {
        return;
    }
    let i = batch.count - 1u - rank;
    let f = footprint(projected_cell(i), corners(i).vertices);
    var tiles = 0u;
    for (var y = f.first.y / TILE; y * TILE < f.end.y; y++) {
        for (var x = f.first.x / TILE; x * TILE < f.end.x; x++) {
            tiles += u32(reaches(f.corners, vec2<u32>(x, y) * TILE, vec2<u32>(TILE)));
        }
    }
    counts[rank] = tiles;
    if tiles > 0u {
        ready[i] = Ready(prepared(i), f);
    }
}
