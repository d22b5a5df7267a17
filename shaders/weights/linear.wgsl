// The linear closed form of Williams, Max and Stein 1998 as published, which is not stable.
import package::lib::published::{linear_published};

// (alpha, w_b, w_f) from the extinctions at the back and the front end times the length.
fn weights(a: f32, b: f32) -> vec3<f32> {
    return linear_published(a, b);
}
