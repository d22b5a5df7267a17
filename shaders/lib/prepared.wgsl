// A cell ready to be crossed by rays, as compute stages and whole-picture fragments take it: all that its segments and their
// shading need, found once for many pixels.
import package::lib::mesh::{corners, entry_of};
import package::lib::cell::{Reference, cell_reference};
import package::lib::ray::{cell_segment, middle_depth};
import package::axes::quantity::{Linear, linear_in};
import package::axes::shading::{pieces_between, shade};
import package::axes::source::{projected_cell};

struct Prepared {
    planes: array<vec4<f32>, 4>,
    linear: Linear,
    reference: Reference,
    // The pieces of the transfer function that the cell's scalars meet.
    pieces: vec2<u32>,
}

// The i-th cell of the batch.
fn prepared(i: u32) -> Prepared {
    let cell = projected_cell(i);
    let c = corners(i);
    let reference = cell_reference(c.vertices, c.scalars, cell.rise.w);
    let linear = linear_in(cell, reference, c);
    return Prepared(cell.planes, linear, reference, pieces_between(reference.s.x, reference.s.y, entry_of(i)));
}

// Colour and alpha of what the ray through `at` crosses of a cell; none where it misses.
fn color_through(cell: Prepared, at: vec2<f32>) -> vec4<f32> {
    let segment = cell_segment(cell.planes, cell.linear, cell.reference, at);
    if !(segment.length > 0.0) {
        return vec4<f32>(0.0);
    }
    return shade(cell.pieces, segment);
}

// Beyond every depth.
const FAR = 1e30;

// A cell of the batch on a pixel's ray, by the depth of the middle of its segment.
struct Hit {
    depth: f32,
    cell: u32,
}

// Of the i-th cell of the batch; its depth is FAR where the ray through `at` misses it.
fn hit_of(planes: array<vec4<f32>, 4>, reference: Reference, i: u32, at: vec2<f32>) -> Hit {
    return Hit(middle_depth(planes, reference, at, FAR), i);
}

// Whether a lies before b: at equal depths by their places in the batch.
fn is_before(a: Hit, b: Hit) -> bool {
    return a.depth < b.depth || (a.depth == b.depth && a.cell < b.cell);
}

// Of two hits the nearer that lies behind `last`, whichever is found first: `next` does already.
fn next_behind(last: Hit, next: Hit, hit: Hit) -> Hit {
    if is_before(last, hit) && is_before(hit, next) {
        return hit;
    }
    return next;
}
