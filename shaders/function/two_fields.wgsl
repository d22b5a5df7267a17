// Colour of one field, opacity of another.
import package::lib::integrated::{Integrated};
import package::lib::two_fields::{integrate};

// A part of a segment with both scalars at its ends, of a length in device units.
fn classified(front: vec2<f32>, back: vec2<f32>, length: f32) -> Integrated {
    return Integrated(integrate(front, back, length), 1u);
}
