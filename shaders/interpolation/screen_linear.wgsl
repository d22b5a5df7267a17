// Linear interpolation over the picture of the values at both ends and of the thickness, as in the original algorithm
// (Shirley and Tuchman 1990): wrong wherever a cell's depth varies.
import package::axes::quantity::{Quantity};
import package::lib::view::{view, ORTHOGRAPHIC};
import package::lib::span::{Segment};
import package::lib::thick::{thickness};

// Beside edges, where a rasteriser may take one triangle for another, the planes of the faces would tell something else.
const BY_PLANES = false;

// What is interpolated of a value at a point of that inverse depth.
fn carried(value: Quantity, inverse_depth: f32) -> Quantity {
    return value;
}

// What is interpolated of a vertex's extent: its thickness, and the depth of its front end from the pivot.
fn carried_ends(ends: vec2<f32>, at: vec2<f32>) -> vec2<f32> {
    if ORTHOGRAPHIC {
        return ends.yx;
    }
    return vec2<f32>(thickness(ends, at), 1.0 / ends.x - view.forward.w);
}

fn segment_between(front: Quantity, back: Quantity, ends: vec2<f32>, at: vec2<f32>) -> Segment {
    return Segment(front, back, at, ends.x);
}

// Depths of both ends from the pivot.
fn depths_between(ends: vec2<f32>, at: vec2<f32>) -> vec2<f32> {
    let stretch = select(length(vec3<f32>(at * view.pixel, 1.0)), 1.0, ORTHOGRAPHIC);
    return vec2<f32>(ends.y, ends.y + ends.x / stretch);
}
