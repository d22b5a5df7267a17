// Light by the gradient as normal, two-sided, and silhouettes. Twins of the same names in Rust: tetlux-optics, light_f32.
import package::lib::look::{look};

// The unit vector of a gradient; 0 of a gradient of no length.
fn normal(gradient: vec3<f32>) -> vec3<f32> {
    let size = abs(gradient.x) + abs(gradient.y) + abs(gradient.z);
    // NaN and 0 fail; what is left neither overflows nor vanishes when squared.
    if size > 1e-30 && size < 1e30 {
        let scaled = gradient / size;
        return scaled / sqrt(dot(scaled, scaled));
    }
    return vec3<f32>(0.0);
}

// Unit vector half-way between two; 0 if they are opposite.
fn half_way(toward: vec3<f32>, eye: vec3<f32>) -> vec3<f32> {
    return normal(toward + eye);
}

// x^p for x in [0, 1]; 1 for p = 0.
fn power(x: f32, p: f32) -> f32 {
    if p == 0.0 {
        return 1.0;
    }
    // The smallest normal number: its logarithm is finite.
    return exp2(p * log2(max(x, 1.1754944e-38)));
}

// The luminance of a point lit; n is the gradient's normal, `toward` and `half` the ray's vectors.
fn lit(luminance: vec3<f32>, n: vec3<f32>, toward: vec3<f32>, half: vec3<f32>) -> vec3<f32> {
    let s = look.shares;
    if dot(n, n) == 0.0 {
        return luminance * (s.x + s.y);
    }
    let matte = s.x + s.y * min(abs(dot(n, toward)), 1.0);
    let highlight = s.z * power(min(abs(dot(n, half)), 1.0), s.w);
    return luminance * matte + highlight;
}

// What a point's opacity is multiplied with; `eye` is the unit vector to the eye.
fn silhouette_factor(n: vec3<f32>, eye: vec3<f32>) -> f32 {
    if dot(n, n) == 0.0 || look.silhouette == 0.0 {
        return 1.0;
    }
    return power(max(1.0 - abs(dot(n, eye)), 0.0), look.silhouette);
}
