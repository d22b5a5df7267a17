//! A segment lit by the gradient in f32, function by function, as a shader has it.
//!
//! # Error
//!
//! A ray's segments have opacities a_i and see through T_i of what is before them, and the sum of a_i T_i is the ray's
//! opacity, at most 1. A segment's light that errs by at most e a_i therefore lets the pixel err by at most e, however
//! many segments there are: each is given that share of its own opacity.
//!
//! Light is constant on pieces over which the normal turns by the same angle: it is that of the point at which even
//! extinction would absorb on average. With the slope V and the curvature W of the lit luminance over the normal's
//! angle, and a turn of t in n pieces, a piece errs by at most V t / n times its opacity, whatever is in it. Where
//! opacity and colour vary by no more than themselves over the segment, what varies evenly about that point cancels,
//! and V t / (12 n^2) + W t^2 / (24 n^2) is left; where they end within a piece, that piece alone (a_i / n of the opacity)
//! errs by V t / (2 n). [`turns_of`] takes n for V t / (4 n^2) + W t^2 / (16 n^2). Peaks that are narrower than a piece
//! are not covered by that, so that it is an estimate: by the tests no random segment, through widgets or through peaks of
//! a hundredth of it, takes more than half of what it may err by. [`crate::lit_linear_f32`] has a bound that is proved.

#[cfg(test)]
mod tests;

use crate::light::Light;
use crate::light_f32::{LightUniform, dot, half_way, lit, normal, silhouette_factor};
use crate::segment_f32::weights_direct;
use crate::widgets_f32::Integrated;

/// A segment's light is held on no more pieces than this.
const MOST_TURNS: f32 = 256.0;

/// What decides in how many pieces a segment's light is held.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Turning {
    /// Error of the light of a segment for an opacity of 1.
    pub error: f32,
    /// Bounds of the lit luminance's slope and curvature over the normal's angle.
    pub slope: f32,
    /// See `slope`.
    pub curvature: f32,
}

impl Turning {
    /// For luminances of at most `brightest` before they are lit.
    pub fn new(light: &Light, brightest: f64, error: f32) -> Self {
        let ([ambient, diffuse, specular], p) = (light.shares(), light.shininess());
        let k = light.silhouette();
        let lit = brightest * (ambient + diffuse) + specular;
        // cos^p is steepest where cos^2 = 1 - 1/p; (1 - |cos|)^k has the slope k at most, for k of 1 and more.
        let slope = brightest * diffuse + specular * (p / std::f64::consts::E).sqrt().min(p) + lit * k;
        let curvature = brightest * diffuse + specular * p + lit * k * (k + 1.0);
        Self { error, slope: slope as f32, curvature: curvature as f32 }
    }
}

/// In how many pieces the light of a segment is held over which the normal turns by an angle.
pub fn turns_of(turning: &Turning, angle: f32) -> f32 {
    let error = angle * (turning.slope / 4.0 + turning.curvature * angle / 16.0);
    (error / turning.error).sqrt().ceil().clamp(1.0, MOST_TURNS)
}

/// Where in a piece of even extinction light is absorbed on average: at 1/2 if it is thin, near the front if thick.
fn absorbed_at(alpha: f32) -> f32 {
    let depth = -(1.0 - alpha.min(0.999_999)).ln();
    let [alpha, back, _] = weights_direct(depth, depth);
    if alpha > 1e-6 { back / alpha } else { 0.5 }
}

/// The angle between two gradients; 0 if one of them is none, as nothing turns then.
fn angle_between(a: [f32; 3], b: [f32; 3]) -> f32 {
    let [p, q] = [normal(a), normal(b)];
    if dot(p, p) == 0.0 || dot(q, q) == 0.0 {
        return 0.0;
    }
    let across = [p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]];
    dot(across, across).sqrt().atan2(dot(p, q))
}

/// Premultiplied colour and alpha of a segment with the gradients at its front and its back end, and the pieces that it
/// took. `eye` is the unit vector to the eye in the gradients' frame; `classified` gives the part of the segment between
/// two shares of it, unlit, its extinction times a factor.
pub fn integrate_lit(
    light: &LightUniform,
    turning: &Turning,
    gradients: [[f32; 3]; 2],
    eye: [f32; 3],
    classified: impl Fn(f32, f32, f32) -> Integrated,
) -> Integrated {
    let [front, back] = gradients;
    let toward = if light.direction == [0.0; 3] { eye } else { light.direction };
    let half = half_way(toward, eye);
    let normal_at = |u: f32| normal([0, 1, 2].map(|i| front[i] + (back[i] - front[i]) * u));
    let factor_at = |u: f32| silhouette_factor(light, normal_at(u), eye);
    let angle = angle_between(front, back);
    let count = turns_of(turning, angle);
    if count > 1.0 {
        let whole = classified(0.0, 1.0, 1.0);
        if whole.color[3] <= 0.0 {
            // Nothing is seen: there is nothing to light.
            return whole;
        }
    }
    let [near, far] = [front, back].map(|g| dot(g, g).sqrt());
    let mut result = Integrated::default();
    let mut begin = 0.0_f32;
    for k in 1..=count as u32 {
        // Where the normal has turned by k / count of the angle.
        let turned = angle * (k as f32 / count);
        let (ahead, behind) = (near * turned.sin(), far * (angle - turned).max(0.0).sin());
        let mut end = 1.0;
        if (k as f32) < count {
            end = (ahead / (ahead + behind).max(1e-37)).clamp(begin, 1.0);
        }
        let mut factor = 1.0;
        if light.silhouette != 0.0 {
            factor = (factor_at(begin) + 4.0 * factor_at(0.5 * (begin + end)) + factor_at(end)) / 6.0;
        }
        let part = classified(begin, end, factor);
        let alpha = part.color[3];
        if alpha > 0.0 {
            let at = begin + (end - begin) * absorbed_at(alpha);
            let [r, g, b, _] = part.color.map(|c| c / alpha);
            let luminance = lit(light, [r, g, b], normal_at(at), toward, half);
            let seen = (1.0 - result.color[3]) * alpha;
            for channel in 0..3 {
                result.color[channel] += seen * luminance[channel];
            }
            result.color[3] += seen;
        }
        result.pieces += part.pieces;
        begin = end;
    }
    result
}
