// Classified at the vertices: luminance and extinction are linear in the cell.
//
// The twin in Rust is tetlux-optics, vertex_f32.
import package::lib::span::{Segment};
import package::axes::weights::{weights};

// Pieces do not matter here.
fn pieces_between(low: f32, high: f32, entry: u32) -> vec2<u32> {
    return vec2<u32>(0u);
}

fn shade(range: vec2<u32>, segment: Segment) -> vec4<f32> {
    let w = weights(segment.back.w * segment.length, segment.front.w * segment.length);
    return vec4<f32>(segment.front.rgb * w.z + segment.back.rgb * w.y, w.x);
}
