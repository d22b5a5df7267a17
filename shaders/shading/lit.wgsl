// Classified by one scalar or two after their interpolation, and lit by the gradient.
import package::lib::view::{view, ORTHOGRAPHIC};
import package::lib::span::{Segment};
import package::lib::spent::{count_pieces};
import package::lib::look::{look};
import package::lib::no_data::{NO_DATA_FROM, shade_no_data};
import package::axes::lit::{pieces_met, integrate_lit};

fn pieces_between(low: f32, high: f32, entry: u32) -> vec2<u32> {
    return pieces_met(low, high);
}

fn shade(range: vec2<u32>, segment: Segment) -> vec4<f32> {
    if segment.front[0].x >= NO_DATA_FROM {
        count_pieces(segment.at, 1u);
        return shade_no_data(look.no_data, segment.length);
    }
    var eye = vec3<f32>(0.0, 0.0, -1.0);
    if !ORTHOGRAPHIC {
        eye = -normalize(vec3<f32>(segment.at * view.pixel, 1.0));
    }
    let result = integrate_lit(range, segment.front, segment.back, segment.length, eye);
    count_pieces(segment.at, result.pieces);
    return result.color;
}
