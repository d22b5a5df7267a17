// Pre-integrated, slices of doubling thickness: Kraus, Qiao and Ebert 2004, equation 1.
// The twin in Rust is tetlux-tables, sample_pre_integrated.
import package::lib::span::{Segment};
import package::lib::lookup::{lookup};
import package::lib::volume::{interpolate_volume, volume_slices};

// Pieces do not matter here: the table knows the function.
fn pieces_between(low: f32, high: f32, entry: u32) -> vec2<u32> {
    return vec2<u32>(0u);
}

// Coordinate of a thickness, as a ratio of the largest.
fn thickness_coordinate(ratio: f32) -> f32 {
    let intervals = f32(volume_slices() - 1u);
    let steps = ratio * exp2(intervals - 1.0);
    return (log2(max(steps, 1.0)) + min(steps, 1.0)) / intervals;
}

fn sample_pre_integrated(s_f: f32, s_b: f32, length: f32) -> vec4<f32> {
    return interpolate_volume(vec3<f32>(s_f, s_b, thickness_coordinate(length * lookup.length.x)));
}

fn shade(range: vec2<u32>, segment: Segment) -> vec4<f32> {
    return sample_pre_integrated(segment.front, segment.back, segment.length);
}
