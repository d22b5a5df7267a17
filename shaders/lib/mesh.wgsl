// The mesh on the device, and the cells of one draw call.
import package::lib::view::{Vertex, vertex};

// Scalars belong to cells, not to points.
override CELL_DATA: bool = false;

// Position in device units relative to the mesh's origin; in w the scalar, normalised to its range.
@group(0) @binding(2) var<storage, read> points: array<vec4<f32>>;
// Vertices in ascending order; the top bit of the first is set if that order is negatively oriented.
@group(0) @binding(3) var<storage, read> cells: array<vec4<u32>>;
// One scalar a cell, if CELL_DATA.
@group(0) @binding(4) var<storage, read> cell_scalars: array<f32>;
// The cells to draw, nearest first.
@group(0) @binding(5) var<storage, read> order: array<u32>;

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

// The i-th cell of the batch.
fn corners(i: u32) -> Corners {
    let index = order[batch.last - i];
    var names = cells[index];
    var corners: Corners;
    corners.parity = select(1.0, -1.0, (names.x & 0x80000000u) != 0u);
    names.x &= 0x7fffffffu;
    for (var k = 0u; k < 4u; k++) {
        let point = points[names[k]];
        corners.vertices[k] = vertex(point.xyz);
        corners.scalars[k] = point.w;
    }
    if CELL_DATA {
        corners.scalars = vec4<f32>(cell_scalars[index]);
    }
    return corners;
}
