// Perspective interpolation: Kraus, Qiao and Ebert 2004, section 2. Values divided by depth, and inverse depth itself, are
// linear in the picture; the front and the back end have each their own depth.
import package::axes::quantity::{Quantity};
import package::lib::view::{view, ORTHOGRAPHIC};
import package::lib::span::{Segment};
import package::lib::thick::{front_of, back_of, thickness};

// Beside edges, where a rasteriser may take one triangle for another, the planes of the faces tell the same.
const BY_PLANES = true;

// What is interpolated of a value at a point of that inverse depth.
fn carried(value: Quantity, inverse_depth: f32) -> Quantity {
    return value * inverse_depth;
}

// What is interpolated of a vertex's extent: see lib::thick.
fn carried_ends(ends: vec2<f32>, at: vec2<f32>) -> vec2<f32> {
    return ends;
}

fn segment_between(front: Quantity, back: Quantity, ends: vec2<f32>, at: vec2<f32>) -> Segment {
    return Segment(front / front_of(ends), back / back_of(ends), at, thickness(ends, at));
}

// Depths of both ends from the pivot.
fn depths_between(ends: vec2<f32>, at: vec2<f32>) -> vec2<f32> {
    if ORTHOGRAPHIC {
        return vec2<f32>(ends.x, ends.x + ends.y);
    }
    return vec2<f32>(1.0 / ends.x, 1.0 / back_of(ends)) - view.forward.w;
}
