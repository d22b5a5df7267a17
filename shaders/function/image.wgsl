// An image over two fields, to the scene's budget.
import package::lib::integrated::{Integrated};
import package::lib::look::{look};
import package::lib::image::{integrate_counted};

// A part of a segment with both scalars at its ends, of a length in device units.
fn classified(front: vec2<f32>, back: vec2<f32>, length: f32) -> Integrated {
    return integrate_counted(front, back, length, look.errors.x);
}
