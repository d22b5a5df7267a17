// Nothing ends a ray.
import package::lib::span::{Segment};

// Whether a depth from the pivot lies behind what ends the ray through `at`.
fn is_hidden(depth: f32, at: vec2<f32>) -> bool {
    return false;
}

// What of a segment between the depths `ends` from the pivot, front and back, lies before that.
fn cut(segment: Segment, ends: vec2<f32>, at: vec2<f32>) -> Segment {
    return segment;
}
