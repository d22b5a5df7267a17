// One field's transfer function, for light.
import package::lib::integrated::{Integrated};
import package::lib::one_field::{integrate};
import package::lib::transfer::{piece_at};

// The first and the last piece that first scalars from `low` to `high` meet.
fn pieces_met(low: f32, high: f32) -> vec2<u32> {
    return vec2<u32>(piece_at(low), piece_at(high));
}

// A part of a segment with both scalars at its ends, of a length in device units.
fn classified(range: vec2<u32>, front: vec2<f32>, back: vec2<f32>, length: f32) -> Integrated {
    return Integrated(integrate(range, front.x, back.x, length), 1u);
}
