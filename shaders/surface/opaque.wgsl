// Opaque surfaces: a ray ends where it first meets one. Their colour is composited behind the picture when it is done.
import package::lib::view::{view};
import package::lib::span::{Segment};
import package::lib::segment::{share_before};

// For every pixel the depth of that place from the pivot, in device units; beyond every depth if there is none.
@group(3) @binding(0) var surface_depths: texture_2d<f32>;

// The depth on the ray through `at`, in pixels from the picture's middle.
fn surface_depth(at: vec2<f32>) -> f32 {
    return textureLoad(surface_depths, vec2<u32>(at + view.size * 0.5), 0).x;
}

// Whether a depth from the pivot lies behind what ends the ray through `at`.
fn is_hidden(depth: f32, at: vec2<f32>) -> bool {
    return depth >= surface_depth(at);
}

// What of a segment between the depths `ends` from the pivot, front and back, lies before that.
fn cut(segment: Segment, ends: vec2<f32>, at: vec2<f32>) -> Segment {
    let share = share_before(surface_depth(at), ends);
    var result = segment;
    result.back = (1.0 - share) * segment.front + share * segment.back;
    result.length *= share;
    return result;
}
