// Writes for each cell of a run the tiles that it may be seen in, nearest cell first: one invocation a cell.
import package::lib::mesh::{batch};
import package::lib::ready::{Ready};
import package::lib::tiles::{TILE, reaches};
import package::lib::tiling::{Tiling};

@group(1) @binding(2) var<uniform> tiling: Tiling;
@group(1) @binding(3) var<storage, read> ready: array<Ready>;
// Tiles of all cells of lower rank.
@group(1) @binding(4) var<storage, read> offsets: array<u32>;
@group(1) @binding(5) var<storage, read_write> tiles: array<u32>;
// The cell of each, by its place in the batch.
@group(1) @binding(6) var<storage, read_write> tile_cells: array<u32>;

@compute @workgroup_size(64)
fn fill(@builtin(global_invocation_id) id: vec3<u32>) {
    let rank = tiling.first + id.x;
    if rank >= tiling.end || offsets[rank] == offsets[rank + 1u] {
        return;
    }
    let i = batch.count - 1u - rank;
    let f = ready[i].footprint;
    var next = offsets[rank] - offsets[tiling.first];
    for (var y = f.first.y / TILE; y * TILE < f.end.y; y++) {
        for (var x = f.first.x / TILE; x * TILE < f.end.x; x++) {
            if reaches(f.corners, vec2<u32>(x, y) * TILE, vec2<u32>(TILE)) {
                tiles[next] = y * tiling.columns + x;
                tile_cells[next] = i;
                next++;
            }
        }
    }
}
