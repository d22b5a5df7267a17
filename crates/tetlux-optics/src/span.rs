//! Integrals over a part of a ray segment, and their composition.

#[cfg(test)]
mod tests;

use crate::quadrature::{bisect, gauss};
use crate::segment::{clean, psi, weights};

/// Optical depth up to which a part with smooth extinction is integrated at once: twenty nodes are then exact to
/// rounding.
const PART_DEPTH: f64 = 2.0;

/// Once the transmittance is this share of what has been summed, the rest is below its rounding.
const NEGLIGIBLE: f64 = 1e-18;

/// What a part of a segment does to light. `w` is the distance from the part's front end in units of the whole
/// segment, tau the extinction per such unit, T the transmittance to the part's front end. Every integrand is
/// positive, hence every sum in [`Span::then`] keeps its relative accuracy.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Span {
    /// Length as a share of the segment.
    pub(crate) width: f64,
    /// Optical depth.
    pub(crate) depth: f64,
    /// Opacity, 1 - exp(-depth).
    pub(crate) alpha: f64,
    /// int T dw.
    pub(crate) visible: f64,
    /// int w tau T dw.
    pub(crate) back: f64,
    /// int (width - w) tau T dw.
    pub(crate) front: f64,
}

impl Span {
    /// Nothing that absorbs.
    pub(crate) fn empty(width: f64) -> Self {
        Self { width, depth: 0.0, alpha: 0.0, visible: width, back: 0.0, front: 0.0 }
    }

    /// Only the optical depth counts: what is seen of this part is negligible, or not asked for.
    pub(crate) fn dark(width: f64, depth: f64) -> Self {
        Self { width, depth, alpha: -(-depth).exp_m1(), visible: 0.0, back: 0.0, front: 0.0 }
    }

    /// Linear extinction; `a` and `b` are the optical depths that the part would have with its back and its front
    /// extinction throughout.
    pub(crate) fn linear(width: f64, a: f64, b: f64) -> Self {
        let (a, b) = (clean(a), clean(b));
        let weights = weights(a, b);
        Self {
            width,
            depth: 0.5 * (a + b),
            alpha: weights.alpha,
            visible: width * psi(a, b),
            back: width * weights.back,
            front: width * weights.front,
        }
    }

    /// Extinction smooth in x, which runs from 0 at the part's front to 1 at its back: `rate(x)` is the optical depth
    /// per unit of x, `depth(x0, x1)` its integral, and `smooth(x0, x1)` says whether the rate is close to a
    /// polynomial there.
    pub(crate) fn by_quadrature(
        width: f64,
        rate: impl Fn(f64) -> f64,
        depth: impl Fn(f64, f64) -> f64,
        smooth: impl Fn(f64, f64) -> bool,
    ) -> Self {
        let mut sum = Self::empty(0.0);
        let fits = |x0: f64, x1: f64| smooth(x0, x1) && depth(x0, x1) <= PART_DEPTH;
        let mut end = 0.0;
        bisect(0.0, 1.0, &fits, &mut |x0, x1| {
            let share = x1 - x0;
            let [visible, back, front] = gauss(0.0, 1.0, |v| {
                let x = x0 + v * share;
                let transmittance = (-depth(x0, x)).exp();
                let emission = share * rate(x) * transmittance;
                [transmittance, v * emission, (1.0 - v) * emission]
            });
            let part = width * share;
            sum = sum.then(Self {
                visible: part * visible,
                back: part * back,
                front: part * front,
                ..Self::dark(part, depth(x0, x1))
            });
            end = x1;
            (-sum.depth).exp() > NEGLIGIBLE * sum.back
        });
        if end < 1.0 {
            sum = sum.then(Self::dark(width * (1.0 - end), depth(end, 1.0)));
        }
        let depth = depth(0.0, 1.0);
        Self { width, depth, alpha: -(-depth).exp_m1(), ..sum }
    }

    /// This part with another right behind it.
    pub(crate) fn then(self, behind: Self) -> Self {
        let transmittance = (-self.depth).exp();
        Self {
            width: self.width + behind.width,
            depth: self.depth + behind.depth,
            alpha: self.alpha + transmittance * behind.alpha,
            visible: self.visible + transmittance * behind.visible,
            back: self.back + transmittance * (self.width * behind.alpha + behind.back),
            front: self.front + self.alpha * behind.width + transmittance * behind.front,
        }
    }

    /// This part `count` times in a row, by doubling: the closed geometric sums without their cancellation.
    pub(crate) fn repeated(self, mut count: u64) -> Self {
        let (mut sum, mut power) = (Self::empty(0.0), self);
        while count > 0 {
            if count & 1 == 1 {
                sum = sum.then(power);
            }
            power = power.then(power);
            count >>= 1;
        }
        sum
    }
}
