// What an integral along a segment gives and what it took.
struct Integrated {
    // Premultiplied colour and alpha.
    color: vec4<f32>,
    // 1 where the colour has a closed form, 0 where nothing is seen.
    pieces: u32,
}
