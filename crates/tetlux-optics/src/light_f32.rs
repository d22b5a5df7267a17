//! [`crate::light`] in f32, function by function, as a shader has it.
//!
//! A ray's light and half-way vectors are the same all along it: [`crate::light::Light::vectors`], once a ray.

#[cfg(test)]
mod tests;

use crate::light::Light;

/// A light as a shader has it.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct LightUniform {
    /// Ambient, diffuse, specular, shininess.
    pub shares: [f32; 4],
    /// Unit vector to the light in the frame of the gradients; 0 if it is at the eye.
    pub direction: [f32; 3],
    /// Exponent of the silhouette.
    pub silhouette: f32,
}

impl LightUniform {
    /// The light with its direction turned into the frame of the gradients.
    pub fn new(light: &Light, turn: impl Fn([f64; 3]) -> [f64; 3]) -> Self {
        let [ambient, diffuse, specular] = light.shares();
        Self {
            shares: [ambient, diffuse, specular, light.shininess()].map(|x| x as f32),
            direction: light.direction().map_or([0.0; 3], |d| turn(d).map(|x| x as f32)),
            silhouette: light.silhouette() as f32,
        }
    }
}

pub(crate) fn dot(a: [f32; 3], b: [f32; 3]) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// The unit vector of a gradient; 0 of a gradient of no length.
pub fn normal(gradient: [f32; 3]) -> [f32; 3] {
    let size = gradient[0].abs() + gradient[1].abs() + gradient[2].abs();
    // NaN and 0 fail; what is left neither overflows nor vanishes when squared.
    if size > 1e-30 && size < 1e30 {
        let scaled = gradient.map(|x| x / size);
        let length = dot(scaled, scaled).sqrt();
        return scaled.map(|x| x / length);
    }
    [0.0; 3]
}

/// Unit vector half-way between two; 0 if they are opposite.
pub fn half_way(light: [f32; 3], view: [f32; 3]) -> [f32; 3] {
    normal([light[0] + view[0], light[1] + view[1], light[2] + view[2]])
}

/// x^p for x in [0, 1]; 1 for p = 0.
fn power(x: f32, p: f32) -> f32 {
    if p == 0.0 {
        return 1.0;
    }
    // The smallest normal number: its logarithm is finite.
    (p * x.max(1.1754944e-38).log2()).exp2()
}

/// The luminance of a point lit; `n` is the gradient's [`normal`], `toward` and `half` the ray's vectors.
pub fn lit(light: &LightUniform, luminance: [f32; 3], n: [f32; 3], toward: [f32; 3], half: [f32; 3]) -> [f32; 3] {
    let [ambient, diffuse, specular, shininess] = light.shares;
    if dot(n, n) == 0.0 {
        return luminance.map(|l| l * (ambient + diffuse));
    }
    let matte = ambient + diffuse * dot(n, toward).abs().min(1.0);
    let highlight = specular * power(dot(n, half).abs().min(1.0), shininess);
    luminance.map(|l| l * matte + highlight)
}

/// What a point's opacity is multiplied with; `view` is the unit vector to the eye.
pub fn silhouette_factor(light: &LightUniform, n: [f32; 3], view: [f32; 3]) -> f32 {
    if dot(n, n) == 0.0 || light.silhouette == 0.0 {
        return 1.0;
    }
    power((1.0 - dot(n, view).abs()).max(0.0), light.silhouette)
}
