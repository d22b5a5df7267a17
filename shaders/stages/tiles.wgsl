// Every tile walks its list of cells front to back and composites in registers: no blending, and no target that
// is read and written for every cell. One workgroup a tile, one invocation a pixel.
//
// The workgroup looks at the outlines of its cells a round at a time, one cell an invocation; each block of pixels then
// visits those alone that reach into it. A tile ends when all its pixels are opaque.
import package::lib::view::{view};
import package::lib::mesh::{batch, entry_of};
import package::lib::tiles::{TILE, reaches};
import package::lib::tiling::{Tiling};
import package::lib::prepared::{Hit, FAR, color_through, hit_of, next_behind};
import package::lib::ready::{Ready};
import package::axes::grouping::{group_end};

@group(1) @binding(2) var<uniform> tiling: Tiling;
@group(1) @binding(3) var<storage, read> ready: array<Ready>;
// The cells of each tile, nearest first, by their places in the batch, and where each tile's begin.
@group(1) @binding(4) var<storage, read> tile_cells: array<u32>;
@group(1) @binding(5) var<storage, read> starts: array<u32>;
// Row by row: what lies before this run of cells, and then that with them.
@group(1) @binding(6) var<storage, read_write> picture: array<vec4<f32>>;

// Cells a round, and words of a bit each.
const ROUND = 256u;
const WORDS = 8u;
// Pixels of a block, and blocks in a row of a tile: neighbours among the invocations.
const BLOCK = vec2<u32>(4u, 2u);
const BLOCKS = 4u;

// For each block the cells of the round that reach into it.
var<workgroup> reaching: array<atomic<u32>, 256>;
// Whether any pixel is not opaque yet.
var<workgroup> alive: atomic<u32>;
// The first cell of the round that has no order among its neighbours.
var<workgroup> unordered: atomic<u32>;

// Notes the blocks of the tile that a cell reaches into.
fn note(lane: u32, i: u32, corner: vec2<u32>) {
    let f = ready[i].footprint;
    let first = (max(f.first, corner) - corner) / BLOCK;
    let end = (min(f.end, corner + TILE) - corner + BLOCK - 1u) / BLOCK;
    for (var y = first.y; y < end.y; y++) {
        for (var x = first.x; x < end.x; x++) {
            if reaches(f.corners, corner + vec2<u32>(x, y) * BLOCK, BLOCK) {
                atomicOr(&reaching[(y * BLOCKS + x) * WORDS + lane / 32u], 1u << (lane % 32u));
            }
        }
    }
    let entry = entry_of(i);
    if group_end(entry) > entry + 1u {
        atomicMin(&unordered, lane);
    }
}

// Composites cells that have no order among themselves, from `position` up to `end` in the lists, behind `color`.
fn composite_group(color: vec4<f32>, position: u32, end: u32, at: vec2<f32>) -> vec4<f32> {
    var sum = color;
    var last = Hit(-FAR, 0u);
    for (var n = position; n < end; n++) {
        var next = Hit(FAR, 0u);
        for (var p = position; p < end; p++) {
            let i = tile_cells[p];
            next = next_behind(last, next, hit_of(ready[i].cell.planes, ready[i].cell.reference, i, at));
        }
        if next.depth >= FAR {
            break;
        }
        sum += (1.0 - sum.a) * color_through(ready[next.cell].cell, at);
        last = next;
    }
    return sum;
}

@compute @workgroup_size(256)
fn composite(@builtin(workgroup_id) tile: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    let corner = tile.xy * TILE;
    let block = lane / 8u;
    let pixel = corner + vec2<u32>(block % BLOCKS, block / BLOCKS) * BLOCK + vec2<u32>(lane % 4u, lane / 4u % 2u);
    let inside = all(pixel < vec2<u32>(view.size));
    let at = vec2<f32>(pixel) + 0.5 - view.size * 0.5;
    var color = vec4<f32>(0.0);
    if inside {
        color = picture[pixel.y * u32(view.size.x) + pixel.x];
    }
    let index = tile.y * tiling.columns + tile.x;
    let end = starts[index + 1u];
    var position = starts[index];
    // A pixel whose cells were not all visited: the driver has ended a loop. The host is told.
    var is_cut = color.a < 0.0;
    var is_over = false;
    while position < end {
        if lane == 0u {
            atomicStore(&alive, 0u);
            atomicStore(&unordered, ROUND);
        }
        atomicStore(&reaching[lane], 0u);
        workgroupBarrier();
        let count = min(end - position, ROUND);
        if inside && color.a < tiling.opaque {
            atomicStore(&alive, 1u);
        }
        if lane < count {
            note(lane, tile_cells[position + lane], corner);
        }
        if workgroupUniformLoad(&alive) == 0u {
            is_over = true;
            break;
        }
        let ordered = min(workgroupUniformLoad(&unordered), count);
        var word = 0u;
        var bits = atomicLoad(&reaching[block * WORDS]);
        var is_visited = false;
        while color.a < tiling.opaque {
            while bits == 0u && (word + 1u) * 32u < ordered {
                word++;
                bits = atomicLoad(&reaching[block * WORDS + word]);
            }
            let k = word * 32u + firstTrailingBit(bits);
            if bits == 0u || k >= ordered {
                is_visited = true;
                break;
            }
            bits &= bits - 1u;
            color += (1.0 - color.a) * color_through(ready[tile_cells[position + k]].cell, at);
        }
        is_cut |= !is_visited && color.a < tiling.opaque;
        position += ordered;
        if ordered < count {
            // The rest of the group: cells behind it have ranks beyond its end.
            let group = group_end(entry_of(tile_cells[position]));
            var after = position + 1u;
            while after < end && entry_of(tile_cells[after]) < group {
                after++;
            }
            if color.a < tiling.opaque {
                color = composite_group(color, position, after, at);
            }
            position = after;
        }
        workgroupBarrier();
    }
    is_cut |= position < end && !is_over;
    if inside {
        picture[pixel.y * u32(view.size.x) + pixel.x] = select(color, vec4<f32>(0.0, 0.0, 0.0, -1.0), is_cut);
    }
}
