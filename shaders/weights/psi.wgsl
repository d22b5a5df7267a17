// Partial pre-integration as published: Moreland and Angel 2004. Psi is looked up; the weights are differences, which
// lose their digits in thin segments. The twin in Rust is tetlux-tables, sample_weights.
import package::lib::segment::{clean, opacity};
import package::lib::plane::{interpolate_plane};

// Mean transmittance to the front over (gamma(a), gamma(b)), gamma(x) = x / (1 + x), for cleaned a, b.
fn sample_psi(a: f32, b: f32) -> f32 {
    return interpolate_plane(vec2<f32>(1.0 - 1.0 / (1.0 + a), 1.0 - 1.0 / (1.0 + b))).x;
}

// (alpha, w_b, w_f) from the extinctions at the back and the front end times the length.
fn weights(a: f32, b: f32) -> vec3<f32> {
    let x = 0.5 * (clean(a) + clean(b));
    let psi = sample_psi(clean(a), clean(b));
    return vec3<f32>(opacity(x), psi - exp(-x), 1.0 - psi);
}
