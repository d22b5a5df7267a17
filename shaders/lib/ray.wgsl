// A ray's segment from the planes of the cell's faces: exact whatever a rasteriser rounds.
import package::lib::view::{view, ORTHOGRAPHIC};
import package::lib::cell::{Reference};
import package::lib::span::{Segment};
import package::axes::quantity::{Quantity, Linear, linear_at};
import package::axes::surface::{cut};

// Where a ray meets the planes of a cell.
struct Crossings {
    // w of the cell's lean, if it has one.
    lean: f32,
    // By how much w exceeds that on the planes.
    beyond: vec4<f32>,
}

// Of the ray through `at`, in pixels from the picture's middle.
fn crossings(planes: array<vec4<f32>, 4>, origins: vec4<f32>, at: vec2<f32>) -> Crossings {
    let from_0 = at - origins.xy;
    let from_1 = at - origins.zw;
    let w = vec4<f32>(
        dot(planes[0].xy, from_1) + planes[0].z,
        dot(planes[1].xy, from_0) + planes[1].z,
        dot(planes[2].xy, from_0) + planes[2].z,
        dot(planes[3].xy, from_0) + planes[3].z,
    );
    let marks = abs(vec4<f32>(planes[0].w, planes[1].w, planes[2].w, planes[3].w));
    let none = vec4<f32>(0.0);
    let lean = dot(select(none, w, marks == vec4<f32>(2.0)), vec4<f32>(1.0));
    return Crossings(lean, w - select(vec4<f32>(lean), none, marks > vec4<f32>(2.0)));
}

// What a ray crosses of a cell: w on the cell's lean, if it has one, and by how much w exceeds that at the front and at the
// back end. The ray misses the cell unless the first end is greater.
struct Span {
    lean: f32,
    front: f32,
    back: f32,
}

fn cell_span(planes: array<vec4<f32>, 4>, reference: Reference, at: vec2<f32>) -> Span {
    let met = crossings(planes, reference.origins, at);
    var front = reference.w.y - met.lean;
    var back = reference.w.x - met.lean;
    for (var i = 0u; i < 4u; i++) {
        if planes[i].w > 0.0 {
            front = min(front, met.beyond[i]);
        } else {
            back = max(back, met.beyond[i]);
        }
    }
    return Span(met.lean, front, back);
}

// How much nearer than the reference vertex the ends of a span are, front and back, in its depths (orthographic: in device
// units).
fn nearer(span: Span) -> vec2<f32> {
    let w = span.lean + vec2<f32>(span.front, span.back);
    if ORTHOGRAPHIC {
        return w;
    }
    return w / (1.0 + w);
}

// Depth of the middle of the segment from the pivot, in device units; `missed` where the ray misses the cell.
fn middle_depth(planes: array<vec4<f32>, 4>, reference: Reference, at: vec2<f32>, missed: f32) -> f32 {
    let span = cell_span(planes, reference, at);
    if !(span.front > span.back) {
        return missed;
    }
    let closer = nearer(span);
    return reference.level - 0.5 * select(reference.depth, 1.0, ORTHOGRAPHIC) * (closer.x + closer.y);
}

// The segment of the ray through `at`, in pixels from the picture's middle.
fn cell_segment(planes: array<vec4<f32>, 4>, linear: Linear, reference: Reference, at: vec2<f32>) -> Segment {
    let span = cell_span(planes, reference, at);
    var segment: Segment;
    if !(span.front > span.back) {
        return segment;
    }
    segment.at = at;
    segment.length = span.front - span.back;
    var share = vec2<f32>(1.0);
    if !ORTHOGRAPHIC {
        share = 1.0 / (1.0 + (span.lean + vec2<f32>(span.front, span.back)));
        segment.length *= length(vec3<f32>(at * view.pixel, 1.0)) * reference.depth * share.x * share.y;
    }
    let place = at - reference.origins.xy;
    segment.front = linear_at(linear, place, span.front, share.x);
    segment.back = linear_at(linear, place, span.back, share.y);
    let ends = reference.level - select(reference.depth, 1.0, ORTHOGRAPHIC) * nearer(span);
    return cut(segment, ends, at);
}
