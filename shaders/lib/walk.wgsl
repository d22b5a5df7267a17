// Where a ray crosses triangles, told by areas.
//
// Seen along the ray, that is in the oblique projection along it, a vertex has an offset from the ray, and the ray crosses
// a triangle if the offsets of its vertices surround the origin. The sign of the area between two offsets is one
// comparison of two products of the vertices' own numbers: all triangles at an edge agree on which side of it the ray
// passes, so that no ray is lost between them. The areas are also the barycentric coordinates of the crossing, in space
// and not only in the picture, wherever the vertices lie, even behind the eye.
//
// The twin in Rust is tetlux-render, march.
import package::lib::view::{view, ORTHOGRAPHIC};
import package::lib::cell::{NUDGE};
import package::axes::quantity::{Quantity};

struct Ray {
    // The direction's components across the view; the one along it is 1.
    slope: vec2<f32>,
    // Offset of the view's pivot.
    pivot: vec2<f32>,
}

// A vertex as a ray sees it.
struct Corner {
    name: u32,
    offset: vec2<f32>,
    // Depth from the pivot, in device units.
    depth: f32,
    value: Quantity,
}

// The ray through a place in pixels from the picture's middle.
fn ray_through(at: vec2<f32>) -> Ray {
    let aside = at * view.pixel;
    let pivot = vec2<f32>(view.right.w, view.down.w);
    if ORTHOGRAPHIC {
        return Ray(vec2<f32>(0.0), pivot - aside);
    }
    return Ray(aside, pivot - aside * view.forward.w);
}

// The offset of a position relative to the pivot, in the axes of eye space.
fn offset_from(ray: Ray, frame: vec3<f32>) -> vec2<f32> {
    return frame.xy - frame.z * ray.slope + ray.pivot;
}

// Whether the way from a to b turns from x towards y about the ray: exactly one of (a, b) and (b, a) does. Where the ray
// meets the edge, as if it were moved aside by next to nothing, in a direction that no edge of a grid has.
fn turns(a: Corner, b: Corner) -> bool {
    let left = a.offset.x * b.offset.y;
    let right = a.offset.y * b.offset.x;
    if left != right {
        return left > right;
    }
    let along = NUDGE * (a.offset - b.offset).yx;
    if along.x != along.y {
        return along.x > along.y;
    }
    return a.name < b.name;
}

fn area(a: Corner, b: Corner) -> f32 {
    return a.offset.x * b.offset.y - a.offset.y * b.offset.x;
}

// Barycentric coordinates of the crossing of a triangle that the ray is known to cross. One that is seen edge-on is
// crossed in its middle.
fn crossing(a: Corner, b: Corner, c: Corner) -> vec3<f32> {
    let areas = max(vec3<f32>(area(b, c), area(c, a), area(a, b)), vec3<f32>(0.0));
    let sum = areas.x + areas.y + areas.z;
    if sum > 1e-30 {
        return areas / sum;
    }
    return vec3<f32>(1.0 / 3.0);
}
