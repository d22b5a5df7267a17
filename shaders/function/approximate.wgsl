// The approximate mode as published: equal pieces, classified at their ends, and the table of F and B (Song et al. 2009,
// section 5). Emission density. The twin in Rust is tetlux-tables, published.
import package::lib::segment::{opacity};
import package::lib::integrated::{Integrated};
import package::lib::look::{look};
import package::lib::volume::{interpolate_volume};
import package::axes::sample::{classify};

// The table's largest extinction, with the length that is 1 in it.
const MAX_EXTINCTION = 10.0;

// (F, B) for the extinctions at the two ends and the length, in the table's unit.
fn sample_front_back(alpha_f: f32, alpha_b: f32, length: f32) -> vec2<f32> {
    return interpolate_volume(vec3<f32>(alpha_f / MAX_EXTINCTION, alpha_b / MAX_EXTINCTION, length)).xy;
}

fn approximate(front: vec2<f32>, back: vec2<f32>, length: f32) -> vec4<f32> {
    let unit = look.unit;
    let part = length / f32(look.pieces);
    var result = vec4<f32>(0.0);
    var near = classify(front);
    for (var k = 1u; k <= look.pieces; k++) {
        let far = classify(front + (back - front) * (f32(k) / f32(look.pieces)));
        let w = sample_front_back(near.w * unit, far.w * unit, part / unit);
        let left = 1.0 - result.w;
        let light = left * unit * look.emission;
        let alpha = opacity(0.5 * (near.w + far.w) * part);
        result += vec4<f32>(light * (near.rgb * w.x + far.rgb * w.y), left * alpha);
        near = far;
    }
    return result;
}

// A segment with both scalars at its ends, of a length in device units.
fn classified(front: vec2<f32>, back: vec2<f32>, length: f32) -> Integrated {
    return Integrated(approximate(front, back, length), look.pieces);
}
