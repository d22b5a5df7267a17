// A ray's segment from the planes of the cell's faces: exact whatever a rasteriser rounds.
import package::lib::view::{view, ORTHOGRAPHIC};
import package::lib::cell::{Reference};
import package::lib::span::{Segment};
import package::axes::quantity::{Quantity, Linear, linear_at};
import package::axes::surface::{cut};

// w at the front and at the back end of what the ray through `at`, in pixels from the picture's middle, crosses of a
// cell; it misses the cell unless the first is greater.
fn cell_span(planes: array<vec4<f32>, 4>, reference: Reference, at: vec2<f32>) -> vec2<f32> {
    let from_0 = at - reference.origins.xy;
    let from_1 = at - reference.origins.zw;
    var front = reference.w.y;
    var back = reference.w.x;
    for (var i = 0u; i < 4u; i++) {
        let plane = planes[i];
        let from_origin = select(from_0, from_1, i == 0u);
        let w = dot(plane.xy, from_origin) + plane.z;
        if plane.w > 0.0 {
            front = min(front, w);
        } else {
            back = max(back, w);
        }
    }
    return vec2<f32>(front, back);
}

// Depth of the middle of the segment from the pivot, in device units; `missed` where the ray misses the cell.
fn middle_depth(planes: array<vec4<f32>, 4>, reference: Reference, at: vec2<f32>, missed: f32) -> f32 {
    let span = cell_span(planes, reference, at);
    if !(span.x > span.y) {
        return missed;
    }
    if ORTHOGRAPHIC {
        return reference.level - 0.5 * (span.x + span.y);
    }
    let closer = span / (1.0 + span);
    return reference.level - 0.5 * reference.depth * (closer.x + closer.y);
}

// The segment of the ray through `at`, in pixels from the picture's middle.
fn cell_segment(planes: array<vec4<f32>, 4>, linear: Linear, reference: Reference, at: vec2<f32>) -> Segment {
    let span = cell_span(planes, reference, at);
    let front = span.x;
    let back = span.y;
    var segment: Segment;
    if !(front > back) {
        return segment;
    }
    segment.at = at;
    let across = (at - reference.origins.xy) * view.pixel;
    var ends: vec2<f32>;
    if ORTHOGRAPHIC {
        let direction = vec3<f32>(0.0, 0.0, 1.0);
        segment.length = front - back;
        segment.front = linear_at(linear, 1.0, across, direction, front);
        segment.back = linear_at(linear, 1.0, across, direction, back);
        ends = reference.level - span;
    } else {
        let direction = vec3<f32>(at * view.pixel, 1.0);
        let depth = reference.depth;
        segment.length = length(direction) * depth * (front - back) / ((1.0 + front) * (1.0 + back));
        segment.front = linear_at(linear, depth, across, direction, front / (1.0 + front));
        segment.back = linear_at(linear, depth, across, direction, back / (1.0 + back));
        ends = reference.level - depth * (span / (1.0 + span));
    }
    return cut(segment, ends, at);
}
