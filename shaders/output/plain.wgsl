// What is composited, as it is: colour multiplied by alpha.

fn stored(color: vec4<f32>, at: vec2<f32>, entry: u32) -> vec4<f32> {
    return color;
}
