// Alpha dithering for targets of 8 bits: Kraus, Qiao and Ebert 2004, section 4.2.

// An even distribution over [0, 1) of pixels and cells (the permuted congruential generator of O'Neill 2014, as a hash).
fn noise(at: vec2<u32>, entry: u32) -> f32 {
    var state = (at.x * 0x9e3779b9u + at.y) * 0x85ebca6bu + entry;
    state = state * 747796405u + 2891336453u;
    let word = ((state >> ((state >> 28u) + 4u)) ^ state) * 277803737u;
    return f32(((word >> 22u) ^ word) >> 8u) * (1.0 / 16777216.0);
}

// Alpha rounded up with the probability that makes its mean right.
fn dithered(alpha: f32, random: f32) -> f32 {
    let steps = 255.0 * clamp(alpha, 0.0, 1.0);
    return (floor(steps) + select(0.0, 1.0, fract(steps) > random)) / 255.0;
}

// The colour is not yet multiplied by alpha.
fn stored(color: vec4<f32>, at: vec2<f32>, entry: u32) -> vec4<f32> {
    let alpha = dithered(color.a, noise(vec2<u32>(at), entry));
    return vec4<f32>(color.rgb / max(color.a, 1e-30), alpha);
}
