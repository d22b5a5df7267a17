// The mean depth q of the visible emission is looked up; opacity is computed. The twin in Rust is tetlux-tables,
// sample_weights.
import package::lib::segment::{clean, opacity};
import package::lib::plane::{interpolate_plane};

// q over (1 - (1 + x)^(-1/4), sqrt(rho)), for cleaned a, b.
fn sample_q(a: f32, b: f32) -> f32 {
    let x = 0.5 * (a + b);
    let rho = b / max(a + b, 1e-30);
    return interpolate_plane(vec2<f32>(1.0 - 1.0 / sqrt(sqrt(1.0 + x)), sqrt(rho))).x;
}

// (alpha, w_b, w_f) from the extinctions at the back and the front end times the length.
fn weights(a: f32, b: f32) -> vec3<f32> {
    let back = clean(a);
    let front = clean(b);
    let alpha = opacity(0.5 * (back + front));
    let q = sample_q(back, front);
    return vec3<f32>(alpha, alpha * q, alpha * (1.0 - q));
}
