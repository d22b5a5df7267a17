// Cells without data: one luminance and extinction throughout, unlit.
//
// The twin in Rust is tetlux-optics, no_data_f32.
import package::lib::segment::{clean, opacity};

// Scalars, normalised to [0, 1], from here on stand for none. Such a cell has 2 throughout.
const NO_DATA_FROM = 1.5;
const NO_DATA = 2.0;

// Premultiplied colour and alpha of a segment of luminance and, in w, extinction per device unit, of a length in device units.
fn shade_no_data(no_data: vec4<f32>, length: f32) -> vec4<f32> {
    let alpha = opacity(clean(no_data.w * length));
    return vec4<f32>(no_data.rgb * alpha, alpha);
}
