// Colour of one field, opacity of another.
import package::lib::integrated::{Integrated};
import package::lib::two_fields::{integrate};

// Pieces are found for each segment.
fn pieces_met(low: f32, high: f32) -> vec2<u32> {
    return vec2<u32>(0u);
}

// A part of a segment with both scalars at its ends, of a length in device units.
fn classified(range: vec2<u32>, front: vec2<f32>, back: vec2<f32>, length: f32) -> Integrated {
    return Integrated(integrate(front, back, length), 1u);
}
