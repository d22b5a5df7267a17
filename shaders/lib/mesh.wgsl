// The cells of one draw call.
import package::lib::view::{Vertex, vertex};
import package::lib::mesh_buffers::{points, cells};
import package::axes::data::{scalars_of};

// The cells to draw, nearest first.
@group(0) @binding(5) var<storage, read> order: array<u32>;
// Where each point is seen, in pixels from the picture's middle: xy + zw.
@group(0) @binding(7) var<storage, read> pixels: array<vec4<f32>>;

struct Batch {
    // The batch is drawn back to front: its i-th cell is order[last - i].
    last: u32,
    count: u32,
    unused: vec2<u32>,
}

@group(1) @binding(0) var<uniform> batch: Batch;

struct Corners {
    vertices: array<Vertex, 4>,
    scalars: vec4<f32>,
    parity: f32,
}

// The place in the order of the i-th cell of the batch.
fn entry_of(i: u32) -> u32 {
    return batch.last - i;
}

// The i-th cell of the batch.
fn corners(i: u32) -> Corners {
    let index = order[entry_of(i)];
    var names = cells[index];
    var corners: Corners;
    corners.parity = select(1.0, -1.0, (names.x & 0x80000000u) != 0u);
    names.x &= 0x7fffffffu;
    for (var k = 0u; k < 4u; k++) {
        corners.vertices[k] = vertex(points[names[k]].xyz, pixels[names[k]]);
    }
    corners.scalars = scalars_of(index, names);
    return corners;
}
