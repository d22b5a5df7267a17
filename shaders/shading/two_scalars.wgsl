// Classified by two scalars after their interpolation.
import package::lib::span::{Segment};
import package::lib::spent::{count_pieces};
import package::lib::look::{look};
import package::lib::no_data::{NO_DATA_FROM, shade_no_data};
import package::axes::function::{classified};

// The pieces of a function of one scalar do not matter here.
fn pieces_between(low: f32, high: f32, entry: u32) -> vec2<u32> {
    return vec2<u32>(0u);
}

fn shade(range: vec2<u32>, segment: Segment) -> vec4<f32> {
    if segment.front.x >= NO_DATA_FROM {
        count_pieces(segment.at, 1u);
        return shade_no_data(look.no_data, segment.length);
    }
    let result = classified(segment.front, segment.back, segment.length);
    count_pieces(segment.at, result.pieces);
    return result.color;
}
