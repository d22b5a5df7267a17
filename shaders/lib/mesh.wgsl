// The cells of one draw call.
import package::lib::view::{Seen, vertex};
import package::lib::cell::{Corners};
import package::lib::mesh_buffers::{points, cells};
import package::axes::data::{scalars_of};

// The cells to draw, nearest first.
@group(0) @binding(5) var<storage, read> order: array<u32>;
// The points as they are seen.
@group(0) @binding(14) var<storage, read> seen: array<Seen>;

struct Batch {
    // The batch is drawn back to front: its i-th cell is order[last - i].
    last: u32,
    count: u32,
    unused: vec2<u32>,
}

@group(1) @binding(0) var<uniform> batch: Batch;

// The place in the order of the i-th cell of the batch.
fn entry_of(i: u32) -> u32 {
    return batch.last - i;
}

// What is seen of a cell's corners, and no more.
struct SeenCorners {
    points: array<Seen, 4>,
    scalars: vec4<f32>,
    parity: f32,
}

fn seen_corners(i: u32) -> SeenCorners {
    let index = order[entry_of(i)];
    var names = cells[index];
    var corners: SeenCorners;
    corners.parity = select(1.0, -1.0, (names.x & 0x80000000u) != 0u);
    names.x &= 0x7fffffffu;
    corners.points = array<Seen, 4>(seen[names.x], seen[names.y], seen[names.z], seen[names.w]);
    corners.scalars = scalars_of(index, names);
    return corners;
}

// The i-th cell of the batch.
fn corners(i: u32) -> Corners {
    let index = order[entry_of(i)];
    var names = cells[index];
    var corners: Corners;
    corners.parity = select(1.0, -1.0, (names.x & 0x80000000u) != 0u);
    names.x &= 0x7fffffffu;
    for (var k = 0u; k < 4u; k++) {
        corners.vertices[k] = vertex(points[names[k]].xyz, seen[names[k]]);
    }
    corners.scalars = scalars_of(index, names);
    corners.cell = index;
    corners.names = names;
    return corners;
}
