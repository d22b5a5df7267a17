// An image at a point. The twin in Rust is tetlux-optics, image_f32.
import package::lib::look::{look};
import package::lib::image::{texels_around, bilinear, cell_of};

// Colour and, in w, extinction per device unit at a point of normalised scalars.
fn classify(at: vec2<f32>) -> vec4<f32> {
    let place = at * look.scale + look.origin;
    let last = look.size - 1u;
    let cell = vec2<u32>(cell_of(place.x, last.x), cell_of(place.y, last.y));
    return bilinear(texels_around(cell), place - vec2<f32>(cell));
}
