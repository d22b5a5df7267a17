// Classified after interpolation, exactly.
import package::lib::span::{Segment};
import package::lib::transfer::{piece_at};
import package::lib::one_field::{integrate};

// The first and the last piece that scalars from `low` to `high` meet.
fn pieces_between(low: f32, high: f32, entry: u32) -> vec2<u32> {
    return vec2<u32>(piece_at(low), piece_at(high));
}

fn shade(range: vec2<u32>, segment: Segment) -> vec4<f32> {
    return integrate(range, segment.front, segment.back, segment.length);
}
