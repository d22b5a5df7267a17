//! The linear closed form as Williams, Max and Stein 1998 published it, for comparison: it is not stable.
//!
//! ```text
//! a > b: psi = sqrt(pi)/r exp(p^2) (erf t - erf p),     r = sqrt(2 |a - b|), p = b/r, t = a/r
//! a < b: psi = sqrt(pi)/r exp(-p^2) (erfi p - erfi t)
//! a = b: psi = (1 - exp(-a)) / a
//! w_b = psi - zeta, w_f = 1 - psi
//! ```
//!
//! It is the value of [`crate::segment::weights`] in exact arithmetic. In floating point the difference of erf (erfi)
//! loses its digits wherever a and b are nearly equal or both large, exp(p^2) overflows while that difference becomes 0
//! (NaN), and psi - zeta and 1 - psi lose all digits in thin segments. Measured figures: the `accuracy` example.

use std::f64::consts::PI;

use errorfunctions::RealErrorFunctions;

use crate::segment::{Weights, clean, zeta};

#[cfg(test)]
mod tests;

/// The weights for a = tau_b D and b = tau_f D by the published form: may be anything, infinite or NaN included. NaN
/// and negative inputs count as 0.
pub fn linear_published(a: f64, b: f64) -> Weights {
    let (a, b) = (clean(a), clean(b));
    let zeta = zeta(a, b);
    let psi = psi_published(a, b);
    Weights { alpha: 1.0 - zeta, back: psi - zeta, front: 1.0 - psi }
}

fn psi_published(a: f64, b: f64) -> f64 {
    let r = (2.0 * (a - b).abs()).sqrt();
    let (p, t) = (b / r, a / r);
    if a > b {
        PI.sqrt() / r * (p * p).exp() * (RealErrorFunctions::erf(t) - RealErrorFunctions::erf(p))
    } else if a < b {
        PI.sqrt() / r * (-p * p).exp() * (erfi(p) - erfi(t))
    } else if a > 0.0 {
        (1.0 - (-a).exp()) / a
    } else {
        1.0
    }
}

/// erf(i x) / i = 2/sqrt(pi) int_0^x exp(y^2) dy.
fn erfi(x: f64) -> f64 {
    2.0 / PI.sqrt() * (x * x).exp() * x.dawson()
}
