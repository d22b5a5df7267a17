//! Ray-segment integrals of the emission-absorption model in f64, relative error below 1e-12.
//!
//! On a segment of length D, luminance L and extinction tau are linear from the front (eye side, `f`) to the back
//! (`b`). With a = tau_b D, b = tau_f D, u the normalised distance from the front and
//! T(u) = exp(-(b u + (a - b) u^2 / 2)) the transmittance from u to the front:
//!
//! ```text
//! zeta = T(1) = exp(-X),  X = (a + b) / 2      transmittance;  alpha = 1 - zeta
//! psi  = int_0^1 T du                           mean transmittance to the front
//! w_b  = psi - zeta = int_0^1 u tau D T du      weight of the back luminance
//! w_f  = 1 - psi    = int_0^1 (1-u) tau D T du  weight of the front luminance
//! q    = w_b / alpha                            mean depth u of the visible emission, in (0, 2/3]
//! ```
//!
//! psi has closed forms in erfcx and Dawson's integral (Williams, Max and Stein 1998 with the scaling that neither
//! overflows nor cancels; tabulated by Moreland and Angel 2004). They lose all digits of the weights in thin segments,
//! where the integrals themselves, having positive integrands, lose none: thin segments use Gauss-Legendre quadrature.

use std::f64::consts::PI;

use errorfunctions::RealErrorFunctions;

use crate::emission::{EmissionConvention, density_weights};
use crate::quadrature::gauss;
use crate::transfer::TransferFunction;

#[cfg(test)]
mod tests;

/// Optical depth up to which the integrals are summed by quadrature. Twenty nodes are exact to rounding here, and
/// beyond it neither `psi - zeta` nor `1 - psi` cancels.
const QUADRATURE_DEPTH: f64 = 4.0;

/// Inputs are limited to this value: their squares stay finite, and every weight is at its limit long before.
pub(crate) const MAX_DEPTH: f64 = 1e150;

/// Below this the weights are their own first-order terms to the last bit, and quadrature would meet denormals.
const TINY_DEPTH: f64 = 1e-100;

/// What a segment adds: `I_0 (1 - alpha) + L_b back + L_f front`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Weights {
    /// Opacity of the segment, 1 - zeta, in [0, 1]; accurate also where zeta rounds to 1.
    pub alpha: f64,
    /// Weight w_b of the luminance at the back end.
    pub back: f64,
    /// Weight w_f of the luminance at the front end; `back + front` is alpha to rounding.
    pub front: f64,
}

/// The weights for a = tau_b D and b = tau_f D. NaN and negative inputs count as 0.
pub fn weights(a: f64, b: f64) -> Weights {
    let (a, b) = (clean(a), clean(b));
    let x = 0.5 * (a + b);
    let alpha = -(-x).exp_m1();
    if x < TINY_DEPTH {
        return Weights { alpha, back: a / 3.0 + b / 6.0, front: a / 6.0 + b / 3.0 };
    }
    if x <= QUADRATURE_DEPTH {
        let [back, front] = weights_by_quadrature(a, b);
        return Weights { alpha, back, front };
    }
    let psi = psi_closed_form(a, b, x);
    Weights { alpha, back: psi - (-x).exp(), front: 1.0 - psi }
}

/// Transmittance exp(-X) of the segment, for a = tau_b D and b = tau_f D.
pub fn zeta(a: f64, b: f64) -> f64 {
    (-0.5 * (clean(a) + clean(b))).exp()
}

/// Mean over the segment of the transmittance to its front end, for a = tau_b D and b = tau_f D; 1 in empty space.
pub fn psi(a: f64, b: f64) -> f64 {
    let (a, b) = (clean(a), clean(b));
    let x = 0.5 * (a + b);
    if x <= QUADRATURE_DEPTH { zeta(a, b) + weights(a, b).back } else { psi_closed_form(a, b, x) }
}

/// Mean depth of the visible emission, w_b / alpha, for a = tau_b D and b = tau_f D: 0 at the front, 1 at the back.
///
/// Towards empty space it tends to (2a + b) / (3(a + b)), which depends on the direction; at a = b = 0 it is 1/2, the
/// value for constant extinction.
pub fn q(a: f64, b: f64) -> f64 {
    let (a, b) = (clean(a), clean(b));
    if a + b == 0.0 {
        return 0.5;
    }
    if 0.5 * (a + b) < TINY_DEPTH {
        // Scaled up (a power of two, exact): denormal inputs keep what accuracy they have.
        let (a, b) = (a * 2.0_f64.powi(128), b * 2.0_f64.powi(128));
        return (2.0 * a + b) / (3.0 * (a + b));
    }
    let weights = weights(a, b);
    weights.back / weights.alpha
}

/// What a segment through a transfer function lets through and emits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SegmentResult {
    /// exp(-optical depth), in [0, 1].
    pub transmittance: f64,
    /// Opacity, 1 - transmittance; accurate also where the transmittance rounds to 1.
    pub alpha: f64,
    /// Emitted light that leaves the front end, linear RGB, without any background.
    pub color: [f64; 3],
}

/// The exact integral along a segment on which the scalar is linear from `s_front` to `s_back` over `length`.
///
/// Extinction is opacity / `unit_distance` per world length; `unit_distance` is above 0 and `length` at least 0, both
/// in world units. The segment is cut at the control points, between which [`weights`] holds, and the parts are
/// composed front to back; at a step the one-sided values count (partial pre-integration: Moreland and Angel 2004).
pub fn segment(tf: &TransferFunction, unit_distance: f64, s_front: f64, s_back: f64, length: f64) -> SegmentResult {
    segment_with(tf, unit_distance, s_front, s_back, length, EmissionConvention::EmissionAbsorption)
}

/// As [`segment`], in either convention of emission.
pub fn segment_with(
    tf: &TransferFunction,
    unit_distance: f64,
    s_front: f64,
    s_back: f64,
    length: f64,
    convention: EmissionConvention,
) -> SegmentResult {
    let mut stops = tf.control_points();
    stops.retain(|&s| s_front.min(s_back) < s && s < s_front.max(s_back));
    let ascending = s_front <= s_back;
    if !ascending {
        stops.reverse();
    }
    stops.push(s_back);

    let mut depth = 0.0_f64;
    let mut color = [0.0; 3];
    let mut front = s_front;
    for back in stops {
        // By the difference of scalars, not of two distances along the ray, which would cancel for a short part.
        let part = if s_front == s_back { length } else { length * ((back - front) / (s_back - s_front)) };
        let ((tau_f, light_f), (tau_b, light_b)) = if s_front == s_back {
            (above(tf, front), above(tf, back))
        } else if ascending {
            (above(tf, front), below(tf, back))
        } else {
            (below(tf, front), above(tf, back))
        };
        let scale = part / unit_distance;
        let (a, b) = (clean(tau_b * scale), clean(tau_f * scale));
        let [weight_b, weight_f] = match convention {
            EmissionConvention::EmissionAbsorption => {
                let weights = weights(a, b);
                [weights.back, weights.front]
            }
            EmissionConvention::EmissionDensity => {
                let weights = density_weights(a, b);
                [part * weights.back, part * weights.front]
            }
        };
        let transmittance = f64::exp(-depth);
        for channel in 0..3 {
            color[channel] += transmittance * (light_b[channel] * weight_b + light_f[channel] * weight_f);
        }
        depth += 0.5 * (a + b);
        front = back;
    }
    SegmentResult { transmittance: (-depth).exp(), alpha: -(-depth).exp_m1(), color }
}

fn above(tf: &TransferFunction, s: f64) -> (f64, [f64; 3]) {
    (tf.opacity(s), tf.luminance(s))
}

fn below(tf: &TransferFunction, s: f64) -> (f64, [f64; 3]) {
    (tf.opacity_below(s), tf.luminance_below(s))
}

/// NaN and negative values count as 0.
pub(crate) fn clean(depth: f64) -> f64 {
    if depth > 0.0 { depth.min(MAX_DEPTH) } else { 0.0 }
}

/// w_b and w_f as sums of positive terms.
fn weights_by_quadrature(a: f64, b: f64) -> [f64; 2] {
    gauss(0.0, 1.0, |u| {
        let v = 1.0 - u;
        // b + (a - b) u and b u + (a - b) u^2 / 2, each as a sum of positive terms.
        let extinction = b * v + a * u;
        let depth = u * (b * (1.0 - 0.5 * u) + a * (0.5 * u));
        let emission = extinction * (-depth).exp();
        [u * emission, v * emission]
    })
}

/// psi for x = (a + b) / 2 above [`QUADRATURE_DEPTH`]. The second term of each difference is then a small part of the
/// first, also where a is nearly b: both arguments are large and the functions tend to reciprocals.
fn psi_closed_form(a: f64, b: f64, x: f64) -> f64 {
    let zeta = (-x).exp();
    let r = (2.0 * (a - b).abs()).sqrt();
    if a > b {
        PI.sqrt() / r * ((b / r).erfcx() - zeta * (a / r).erfcx())
    } else if a < b {
        2.0 / r * ((b / r).dawson() - zeta * (a / r).dawson())
    } else {
        (1.0 - zeta) / a
    }
}
