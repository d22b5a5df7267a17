// A vertex has the luminance and, in w, the extinction of its scalar.
import package::lib::transfer::{piece_at, classify};

fn attributes_of(scalar: f32, name: u32) -> vec4<f32> {
    return classify(piece_at(scalar), scalar);
}
