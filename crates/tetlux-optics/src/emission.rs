//! The two conventions of emission, and the weights of the one in which it is not multiplied by the extinction.
//!
//! | convention | light from a segment of length D | one luminance throughout |
//! |---|---|---|
//! | emission-absorption | int L tau T ds = L_b w_b + L_f w_f | L alpha |
//! | emission density | int L T ds = L_b B + L_f F, B = D m_b, F = D m_f | L D psi |
//!
//! with m_b = int_0^1 u T du and m_f = int_0^1 (1-u) T du, u the normalised distance from the front; m_b + m_f = psi.
//! Song et al. 2009 tabulate F and B over both extinctions and D; they depend on a = tau_b D and b = tau_f D alone. In
//! the second convention empty space glows: it is meant for luminance that is zero where the extinction is.

use crate::quadrature::{bisect, gauss};
use crate::segment::{Weights, clean};

#[cfg(test)]
mod tests;

/// Optical depth that is integrated at once: twenty nodes are then exact to rounding.
const PART_DEPTH: f64 = 4.0;

/// Once the transmittance is this share of what has been summed, the rest is below its rounding.
const NEGLIGIBLE: f64 = 1e-18;

/// What the colour of a transfer function means.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum EmissionConvention {
    /// Luminance: emission per length is luminance times extinction. What transparent matter emits is nothing.
    #[default]
    EmissionAbsorption,
    /// Emission per unit of world length, whatever the extinction (Song et al. 2009).
    EmissionDensity,
}

/// Weights of emission that is not multiplied by the extinction, as a share of the segment's length: the light is
/// `D (L_b back + L_f front)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DensityWeights {
    /// m_b, the weight of the emission at the back end, in (0, 1/2].
    pub back: f64,
    /// m_f, the weight of the emission at the front end, in (0, 1/2].
    pub front: f64,
}

/// m_b and m_f for a = tau_b D and b = tau_f D. NaN and negative inputs count as 0.
///
/// Relative error below 1e-12: sums of positive terms, where the closed forms m_b = (alpha - b psi)/(a - b) and
/// m_f = (a psi - alpha)/(a - b) cancel.
pub fn density_weights(a: f64, b: f64) -> DensityWeights {
    let (a, b) = (clean(a), clean(b));
    let depth = |u0: f64, u1: f64| {
        let middle = 0.5 * (u0 + u1);
        (u1 - u0) * (b * (1.0 - middle) + a * middle)
    };
    let mut sum = DensityWeights { back: 0.0, front: 0.0 };
    bisect(0.0, 1.0, &|u0, u1| depth(u0, u1) <= PART_DEPTH, &mut |u0, u1| {
        let [back, front] = gauss(u0, u1, |u| {
            let transmittance = (-depth(u0, u)).exp();
            [u * transmittance, (1.0 - u) * transmittance]
        });
        let transmittance = (-depth(0.0, u0)).exp();
        sum.back += transmittance * back;
        sum.front += transmittance * front;
        (-depth(0.0, u1)).exp() > NEGLIGIBLE * sum.back
    });
    sum
}

/// Mean depth of the visible emission density, m_b / psi, for a = tau_b D and b = tau_f D: 0 at the front, 1/2 in
/// empty space. With psi it gives m_b = q_e psi and m_f = (1 - q_e) psi without cancellation.
pub fn q_e(a: f64, b: f64) -> f64 {
    let weights = density_weights(a, b);
    weights.back / (weights.back + weights.front)
}

/// The average model: mean luminance and mean extinction throughout, as the first projected tetrahedra had it.
///
/// alpha is exact; the weights are wrong by up to alpha/6 in thin segments and alpha/2 in thick ones.
pub fn weights_average(a: f64, b: f64) -> Weights {
    let alpha = -(-0.5 * (clean(a) + clean(b))).exp_m1();
    Weights { alpha, back: 0.5 * alpha, front: 0.5 * alpha }
}
