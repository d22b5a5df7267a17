// Mean luminance and extinction: opacity exact, colour off by up to half of it (Shirley and Tuchman 1990).
import package::lib::segment::{weights_average};

// (alpha, w_b, w_f) from the extinctions at the back and the front end times the length.
fn weights(a: f32, b: f32) -> vec3<f32> {
    return weights_average(a, b);
}
