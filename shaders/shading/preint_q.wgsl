// Pre-integrated with exact opacity: the mean extinction between two scalars needs no axis for the thickness, and colour /
// alpha is bounded and smooth along it. The twin in Rust is tetlux-tables, sample_color_ratio.
import package::lib::span::{Segment};
import package::lib::segment::{clean, opacity};
import package::lib::lookup::{lookup};
import package::lib::plane::{interpolate_plane};
import package::lib::volume::{interpolate_volume};

// Pieces do not matter here: the tables know the function.
fn pieces_between(low: f32, high: f32, entry: u32) -> vec2<u32> {
    return vec2<u32>(0u);
}

fn sample_color_ratio(s_f: f32, s_b: f32, length: f32) -> vec4<f32> {
    let x = clean(interpolate_plane(vec2<f32>(s_f, s_b)).x * (length * lookup.length.x));
    let alpha = opacity(x);
    let ratio = interpolate_volume(vec3<f32>(s_f, s_b, 1.0 - 1.0 / sqrt(sqrt(1.0 + x)))).rgb;
    return vec4<f32>(alpha * ratio, alpha);
}

fn shade(range: vec2<u32>, segment: Segment) -> vec4<f32> {
    return sample_color_ratio(segment.front, segment.back, segment.length);
}
