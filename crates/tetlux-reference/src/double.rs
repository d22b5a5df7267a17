//! Double-double arithmetic: about 31 digits, for determinants that nearly vanish.

use std::ops::{Add, Mul, Sub};

use glam::DVec3;

/// An unevaluated sum of two doubles, the second within half a unit in the last place of the first (Dekker 1971).
#[derive(Clone, Copy, Debug)]
struct Double(f64, f64);

impl Double {
    /// Exact difference of two doubles (Knuth's two-sum).
    fn difference(a: f64, b: f64) -> Self {
        let high = a - b;
        let shadow = high - a;
        Self(high, (a - (high - shadow)) - (b + shadow))
    }

    fn renormalized(high: f64, low: f64) -> Self {
        let sum = high + low;
        Self(sum, low - (sum - high))
    }
}

impl Add for Double {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        let sum = Self::difference(self.0, -other.0);
        Self::renormalized(sum.0, sum.1 + (self.1 + other.1))
    }
}

impl Sub for Double {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + Self(-other.0, -other.1)
    }
}

impl Mul for Double {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let product = self.0 * other.0;
        let error = self.0.mul_add(other.0, -product);
        Self::renormalized(product, error + (self.0 * other.1 + self.1 * other.0))
    }
}

/// det(b - a, c - d, a - d), with an error of some 1e-31 of the sum of the products' magnitudes.
pub(crate) fn determinant(a: DVec3, b: DVec3, c: DVec3, d: DVec3) -> f64 {
    let difference = |p: DVec3, q: DVec3| [0, 1, 2].map(|k| Double::difference(p[k], q[k]));
    let ([x, y, z], u, m) = (difference(b, a), difference(c, d), difference(a, d));
    let det = x * (u[1] * m[2] - u[2] * m[1]) + y * (u[2] * m[0] - u[0] * m[2]) + z * (u[0] * m[1] - u[1] * m[0]);
    det.0 + det.1
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_nearly_flat_determinant_keeps_its_digits() {
        // a = (0,0,h), b - a = (1,0,0), c - d = (0,1,0), a - d = (0,0,h): det = h, moved by (1,1,1) so that plain
        // differences round. h is a multiple of the spacing at 1, so that the positions are exact.
        let h = 2.0_f64.powi(-50);
        let one = DVec3::ONE;
        let (a, d) = (one + DVec3::new(0.0, 0.0, h), one);
        assert_eq!(determinant(a, a + DVec3::X, one + DVec3::Y, d), h);
        // det((1,1,t), (1,1+t,1), (1+t,1,1)) = 1(1+t-1) - 1(1-1-t) + t(1 - (1+t)^2) = 2t - 2t^2 - t^3.
        let t = 2.0_f64.powi(-30);
        let (d, zero) = (DVec3::ZERO, DVec3::new(1.0 + t, 1.0, 1.0));
        let found = determinant(zero, zero + DVec3::new(1.0, 1.0, t), DVec3::new(1.0, 1.0 + t, 1.0), d);
        // zero + (1, 1, t) is exact: 2 + t and 1 + t.
        assert_eq!(found, 2.0 * t - 2.0 * t * t - t * t * t);
    }
}
