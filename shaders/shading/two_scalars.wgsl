// Classified by two scalars after their interpolation.
import package::lib::span::{Segment};
import package::lib::spent::{count_pieces};
import package::axes::function::{classified};

// The pieces of a function of one scalar do not matter here.
fn pieces_between(low: f32, high: f32, entry: u32) -> vec2<u32> {
    return vec2<u32>(0u);
}

fn shade(range: vec2<u32>, segment: Segment) -> vec4<f32> {
    let result = classified(segment.front, segment.back, segment.length);
    count_pieces(segment.at, result.pieces);
    return result.color;
}
