// Draws cells that have no order among themselves, in a cycle or overlapping: every pixel composites its segments by
// the depths of their middles, nearest first (Kraus and Ertl 2001). Meant for few cells: a pixel looks at all of them
// once for each segment.
import package::lib::view::{view};
import package::lib::mesh::{batch, corners, entry_of};
import package::lib::cell::{Cell, Reference, HIDDEN, cell_reference};
import package::lib::span::{Segment};
import package::lib::ray::{cell_segment, middle_depth};
import package::axes::quantity::{linear_in};
import package::axes::shading::{pieces_between, shade};
import package::axes::output::{stored};

@group(1) @binding(1) var<storage, read> projected: array<Cell>;

// Beyond every depth.
const FAR = 1e30;

// A cell of the batch on a pixel's ray.
struct Hit {
    depth: f32,
    cell: u32,
}

@vertex
fn cover(@builtin(vertex_index) vertex: u32) -> @builtin(position) vec4<f32> {
    // One triangle over the whole picture.
    return vec4<f32>(f32(vertex & 1u) * 4.0 - 1.0, f32(vertex >> 1u) * 4.0 - 1.0, 0.5, 1.0);
}

// The nearest cell behind `last`; at equal depth the one that comes later in the batch. Its depth is FAR if there is none.
fn hit_behind(last: Hit, at: vec2<f32>) -> Hit {
    var next = Hit(FAR, 0u);
    for (var i = 0u; i < batch.count; i++) {
        let kind = projected[i].gradient.w;
        if kind == HIDDEN {
            continue;
        }
        let c = corners(i);
        let reference = cell_reference(c.vertices, c.scalars, kind);
        let depth = middle_depth(projected[i].planes, reference, at, FAR);
        let behind = depth > last.depth || (depth == last.depth && i > last.cell);
        if behind && depth < next.depth {
            next = Hit(depth, i);
        }
    }
    return next;
}

// Colour and alpha of the batch's i-th cell.
fn color_of(i: u32, at: vec2<f32>) -> vec4<f32> {
    let c = corners(i);
    let reference = cell_reference(c.vertices, c.scalars, projected[i].gradient.w);
    let linear = linear_in(projected[i], reference, c);
    let segment = cell_segment(projected[i].planes, linear, reference, at);
    return shade(pieces_between(reference.s.x, reference.s.y, entry_of(i)), segment);
}

@fragment
fn color(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    let at = position.xy - view.size * 0.5;
    var sum = vec4<f32>(0.0);
    var hit = Hit(-FAR, 0u);
    for (var n = 0u; n < batch.count; n++) {
        hit = hit_behind(hit, at);
        if hit.depth >= FAR {
            break;
        }
        sum += (1.0 - sum.w) * color_of(hit.cell, at);
    }
    return stored(sum, position.xy, batch.last);
}
