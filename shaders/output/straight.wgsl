// For targets of 8 bits: colour that is not yet multiplied by alpha, so that its rounding does not drown thin cells.

fn stored(color: vec4<f32>, at: vec2<f32>, entry: u32) -> vec4<f32> {
    return vec4<f32>(color.rgb / max(color.a, 1e-30), color.a);
}
