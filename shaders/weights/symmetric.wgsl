// Linear luminance and extinction, without table or division: relative error 1e-5.
import package::lib::symmetric::{weights_symmetric};

// (alpha, w_b, w_f) from the extinctions at the back and the front end times the length.
fn weights(a: f32, b: f32) -> vec3<f32> {
    return weights_symmetric(a, b);
}
