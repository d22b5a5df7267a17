//! The linear closed form of Williams, Max and Stein 1998 in f32: the twin of `shaders/lib/published.wgsl`.
//!
//! For comparison only, see [`crate::published`]: off by any amount for thin, dense and nearly constant segments. As no
//! shader may make an infinity or a NaN, exponents are limited and the weights clamped to [0, 1] here, which turns what
//! would not be finite into wrong finite weights.

use crate::segment_f32::{clean, dawson, erfcx, opacity};

#[cfg(test)]
mod tests;

/// Largest exponent of a power: the product with the largest factor here stays finite.
const MAX_EXPONENT: f32 = 60.0;

/// The published form's factors sqrt(pi) and 2/sqrt(pi).
const ROOT_PI: f32 = 1.7724539;
const TWO_OVER_ROOT_PI: f32 = std::f32::consts::FRAC_2_SQRT_PI;

/// erf(x) for x >= 0.
fn erf_published(x: f32) -> f32 {
    1.0 - (-x * x).exp() * erfcx(x)
}

/// erf(i x) / i for x >= 0, not beyond the limit of exponents.
fn erfi_published(x: f32) -> f32 {
    TWO_OVER_ROOT_PI * (x * x).min(MAX_EXPONENT).exp() * dawson(x)
}

/// Mean transmittance to the front by the published form, for cleaned a, b.
pub fn psi_published(a: f32, b: f32) -> f32 {
    if a == b {
        return opacity(a) / a.max(1e-30);
    }
    let r = (2.0 * (a - b).abs()).max(1e-30).sqrt();
    let p = b / r;
    let t = a / r;
    if a > b {
        return ROOT_PI / r * (p * p).min(MAX_EXPONENT).exp() * (erf_published(t) - erf_published(p));
    }
    ROOT_PI / r * (-p * p).exp() * (erfi_published(p) - erfi_published(t))
}

/// (alpha, w_b, w_f) by the published form, each in [0, 1] but otherwise with any error, for any a, b.
pub fn linear_published(a: f32, b: f32) -> [f32; 3] {
    let back = clean(a);
    let front = clean(b);
    let zeta = (-0.5 * (back + front)).exp();
    let psi = psi_published(back, front);
    [1.0 - zeta, (psi - zeta).clamp(0.0, 1.0), (1.0 - psi).clamp(0.0, 1.0)]
}
