//! Gaussians: along a ray exp(-C - t^2) with t linear, C the square of the scaled distance of the ray from the centre.

use std::f64::consts::PI;

use errorfunctions::RealErrorFunctions as Functions;

use super::RaySegment;
use crate::quadrature::{bisect, gauss};
use crate::segment::clean;
use crate::span::Span;
use crate::widget::gaussian_coordinates;

/// Beyond this exp(-t^2) is 0 in f64.
const END: f64 = 28.0;

/// Up to this length in t means are summed as a series, beyond it they are differences of erf.
const SERIES: f64 = 1.0;

/// Whether exp(-t^2), and what is made of it, is close to a polynomial from t0 to t1.
fn is_smooth(t0: f64, t1: f64) -> bool {
    (t1 - t0) * t0.abs().max(t1.abs()).max(7.0) <= 7.0
}

/// A segment in the scaled coordinates of a Gaussian.
pub(super) struct Line {
    /// Optical depth of the segment if the extinction were everywhere that of t = 0.
    scale: f64,
    /// t at the front and the back, ascending. Equal for constant extinction, which `scale` then holds.
    t: [f64; 2],
}

impl Line {
    /// `scale` is the optical depth that the segment would have at the Gaussian's centre throughout.
    pub(super) fn new(center: [f64; 2], sigma: [f64; 2], ray: &RaySegment, scale: f64) -> Self {
        let [front, back] = [ray.front, ray.back].map(|point| gaussian_coordinates(center, sigma, point));
        let step: [f64; 2] =
            std::array::from_fn(|axis| (ray.back[axis] - ray.front[axis]) / (std::f64::consts::SQRT_2 * sigma[axis]));
        let length = step[0].hypot(step[1]);
        if length == 0.0 {
            let square = front[0] * front[0] + front[1] * front[1];
            return Self { scale: scale * (-square).exp(), t: [0.0; 2] };
        }
        let direction = step.map(|component| component / length);
        let along = |x: [f64; 2]| direction[0] * x[0] + direction[1] * x[1];
        // As a cross product: |x|^2 - t^2 would cancel. From the end that is nearer to the centre, where it is smaller.
        let near = if front[0].hypot(front[1]) <= back[0].hypot(back[1]) { front } else { back };
        let across = direction[0] * near[1] - direction[1] * near[0];
        let (t0, t1) = (along(front), along(back));
        let line = Self { scale: scale * (-across * across).exp(), t: [t0, t1] };
        // Not ordered: the step is below the rounding of t. Not finite: nothing is near.
        if t0 < t1 && t1 - t0 < f64::INFINITY {
            line
        } else {
            let share = if t0.is_finite() { (-t0 * t0).exp() } else { 0.0 };
            Self { scale: line.scale * share, t: [0.0; 2] }
        }
    }

    /// Optical depth: P (erf t1 - erf t0), P = a_max exp(-C) sqrt(pi) / (2 A), without P, which is infinite at A = 0.
    pub(super) fn depth(&self) -> f64 {
        self.scale * mean(self.t[0], self.t[1])
    }

    /// All integrals, for a segment of the given share of the whole.
    pub(super) fn span(&self, width: f64) -> Span {
        let [t0, t1] = self.t;
        let length = t1 - t0;
        let [low, high] = [t0.clamp(-END, END), t1.clamp(-END, END)];
        if length == 0.0 {
            return Span::linear(width, self.scale, self.scale);
        }
        if low == high {
            return Span::empty(width);
        }
        let share = (high - low) / length;
        let t = |x: f64| low * (1.0 - x) + high * x;
        let scale = self.scale * share;
        let bell = Span::by_quadrature(
            width * share,
            |x| scale * (-t(x) * t(x)).exp(),
            |x0, x1| (x1 - x0) * scale * mean(t(x0), t(x1)),
            |x0, x1| is_smooth(t(x0), t(x1)),
        );
        let [before, behind] = [(low - t0) / length, (t1 - high) / length].map(|share| Span::empty(width * share));
        before.then(bell).then(behind)
    }
}

/// Mean of exp(-t^2) from t0 to t1 >= t0.
fn mean(t0: f64, t1: f64) -> f64 {
    if t1 - t0 <= SERIES {
        let (middle, half) = (0.5 * (t0 + t1), 0.5 * (t1 - t0));
        return (-middle * middle).exp() * mean_ratio(middle, half);
    }
    0.5 * PI.sqrt() * erf_difference(t0, t1) / (t1 - t0)
}

/// Mean of exp(-(t + y)^2) / exp(-t^2) over y from -h to h: the sum of H_2k(t) h^2k / (2k+1)!, H the Hermite
/// polynomials. For h <= 1/2 nothing in it cancels: for small t the first term leads, for large t all are positive.
fn mean_ratio(t: f64, h: f64) -> f64 {
    // H_n(t) h^n / n! of two consecutive n.
    let (mut even, mut odd) = (1.0_f64, 2.0 * t * h);
    let mut sum = 1.0;
    let mut n = 1.0;
    // Far enough for 2 t h = 28; most need ten terms.
    for _ in 0..60 {
        even = (2.0 * t * h * odd - 2.0 * h * h * even) / (n + 1.0);
        odd = (2.0 * t * h * even - 2.0 * h * h * odd) / (n + 2.0);
        n += 2.0;
        sum += even / n;
        if even.abs() + odd.abs() < 1e-17 * sum {
            break;
        }
    }
    sum
}

/// erf t1 - erf t0 for t1 > t0, not nearly equal.
fn erf_difference(t0: f64, t1: f64) -> f64 {
    if t0 >= 0.0 {
        Functions::erfc(t0) - Functions::erfc(t1)
    } else if t1 <= 0.0 {
        Functions::erfc(-t1) - Functions::erfc(-t0)
    } else {
        Functions::erf(t1) - Functions::erf(t0)
    }
}

/// U(P, t) = int_t^inf (exp(-P (erf y - erf t)) - exp(-P erfc t)) dy: what is seen from t, less what shines through.
///
/// On a segment from t0 to t1 = t0 + A D of a line on which the optical depth is P (erf t - erf t0), zeta its
/// transmittance: A D psi = U(t0) - zeta U(t1) + (t1 - t0) exp(-P erfc t0). At least 0; 0 above t = 28 in f64, and
/// U(-28) + (-28 - t)(1 - exp(-2P)) below -28. Relative error below 1e-12. P is at least 0; NaN gives 0.
pub fn gaussian_bounded(p: f64, t: f64) -> f64 {
    let p = clean(p);
    if p == 0.0 || t.is_nan() || t >= END {
        return 0.0;
    }
    let low = t.max(-END);
    let depth = |y0: f64, y1: f64| p * (y1 - y0) * mean(y0, y1) * (2.0 / PI.sqrt());
    let mut sum = (low - t) * -(-2.0 * p).exp_m1();
    bisect(low, END, &|y0, y1| is_smooth(y0, y1) && depth(y0, y1) <= 2.0, &mut |y0, y1| {
        let rest = |y: f64| -(-p * Functions::erfc(y)).exp_m1();
        let [part] = gauss(y0, y1, |y| [(-depth(y0, y)).exp() * rest(y)]);
        sum += (-depth(low, y0)).exp() * part;
        // The integrand only falls: what remains is below END times its value here.
        (-depth(low, y1)).exp() * rest(y1) > 1e-19 * sum
    });
    sum
}
