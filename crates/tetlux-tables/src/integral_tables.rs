//! Tables of the segment integrals for linear extinction: psi, q, (q, `q_e`), and F and B.

use std::f64::consts::PI;

use rayon::prelude::*;
use tetlux_optics::segment;

use crate::axis::Axis;
use crate::graded::weighted_integral;
use crate::spec::Design;

/// Rows of `channels` values each, computed in parallel: `value(x, y)` at the nodes of two axes.
pub(crate) fn plane<const C: usize>(axes: &[Axis], value: impl Fn(f64, f64) -> [f64; C] + Sync) -> Vec<f32> {
    let xs = values(&axes[0]);
    values(&axes[1])
        .par_iter()
        .flat_map_iter(|&y| xs.iter().flat_map(move |&x| [(x, y)]).flat_map(|(x, y)| value(x, y)))
        .map(|v| v as f32)
        .collect()
}

/// The parameter at every node.
pub(crate) fn values(axis: &Axis) -> Vec<f64> {
    (0..axis.nodes).map(|index| axis.value(index)).collect()
}

pub(crate) fn psi(axes: &[Axis]) -> Vec<f32> {
    plane(axes, |a, b| [segment::psi(a, b)])
}

/// Towards X = 0, q depends on the direction: q = (2a + b)/(3(a + b)) = (2 - rho)/3.
fn q_at(x: f64, rho: f64) -> f64 {
    if x == 0.0 { (2.0 - rho) / 3.0 } else { segment::q(2.0 * x * (1.0 - rho), 2.0 * x * rho) }
}

/// `int_0^1 u T du`: the weight of the back end where emission is not multiplied by extinction. The closed form
/// (alpha - b psi)/(a - b) cancels; a sum of positive terms does not.
pub(crate) fn m_b(a: f64, b: f64) -> f64 {
    let d = a - b;
    let depth = |u: f64| u * (b * (1.0 - 0.5 * u) + a * (0.5 * u));
    weighted_integral(1.0, b + d.max(0.0).sqrt(), depth, |u| u)
}

/// What design R multiplies q by, from a = 2X(1 - rho) and b = 2X rho: about 2/psi where it is thick, 4 where thin.
pub(crate) fn r_scale(a: f64, b: f64) -> f64 {
    b + (b * b + 8.0 / PI * a + 16.0).sqrt()
}

pub(crate) fn q(axes: &[Axis], design: Design) -> Vec<f32> {
    plane(axes, |x, rho| {
        let q = q_at(x, rho);
        [if design == Design::Q { q } else { q * r_scale(2.0 * x * (1.0 - rho), 2.0 * x * rho) }]
    })
}

pub(crate) fn q_pair(axes: &[Axis]) -> Vec<f32> {
    plane(axes, |x, rho| {
        let (a, b) = (2.0 * x * (1.0 - rho), 2.0 * x * rho);
        [q_at(x, rho), m_b(a, b) / segment::psi(a, b)]
    })
}

pub(crate) fn front_back(axes: &[Axis]) -> Vec<f32> {
    let slices = values(&axes[2]).into_par_iter().flat_map_iter(|d| {
        let at = move |alpha_f: f64, alpha_b: f64| {
            let (a, b) = (alpha_b * d, alpha_f * d);
            // T falls along the segment, so m_b is at most half of psi: the difference keeps its digits.
            let back = m_b(a, b);
            [d * (segment::psi(a, b) - back), d * back]
        };
        plane(axes, at)
    });
    slices.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_moment_is_the_pointwise_integral() {
        let depths = [0.0, 1e-9, 1e-3, 0.5, 3.0, 200.0, 1e6, 1e12];
        for (a, b) in depths.iter().flat_map(|&a| depths.map(|b| (a, b))) {
            let exact = tetlux_optics::emission::density_weights(a, b).back;
            assert!((m_b(a, b) / exact - 1.0).abs() < 1e-8, "({a}, {b}): {} for {exact}", m_b(a, b));
        }
    }

    #[test]
    fn thin_and_thick_limits_of_q() {
        assert_eq!(q_at(0.0, 0.0), 2.0 / 3.0);
        assert_eq!(q_at(0.0, 1.0), 1.0 / 3.0);
        assert!(q_at(1e13, 0.5) < 1e-12);
        // The stored quantity of design R tends to 4 q where thin.
        assert_eq!(r_scale(0.0, 0.0), 4.0);
    }
}
