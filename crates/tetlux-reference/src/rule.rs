//! Gauss-Legendre rules, with the running integral at their nodes.

/// An N-point Gauss-Legendre rule on [0, 1]: exact for polynomials up to degree 2N - 1.
pub(crate) struct Rule<const N: usize> {
    /// Ascending, inside (0, 1).
    pub(crate) nodes: [f64; N],
    pub(crate) weights: [f64; N],
    /// `running[i][j]`: weight of the value at node j in the integral from 0 to node i of the polynomial through all
    /// values.
    pub(crate) running: [[f64; N]; N],
}

impl<const N: usize> Rule<N> {
    pub(crate) fn new() -> Self {
        let mut rule = Self { nodes: [0.0; N], weights: [0.0; N], running: [[0.0; N]; N] };
        // On [-1, 1]: zeros of the Legendre polynomial P_N by Newton's method from Tricomi's estimate.
        let zeros: [f64; N] = std::array::from_fn(|i| {
            let mut x = -((i as f64 + 0.75) / (N as f64 + 0.5) * std::f64::consts::PI).cos();
            for _ in 0..8 {
                let (value, slope) = with_slope(N, x);
                x -= value / slope;
            }
            x
        });
        let weights = zeros.map(|x| {
            let slope = with_slope(N, x).1;
            2.0 / ((1.0 - x * x) * slope * slope)
        });
        for i in 0..N {
            rule.nodes[i] = 0.5 * (1.0 + zeros[i]);
            rule.weights[i] = 0.5 * weights[i];
            for j in 0..N {
                // The interpolating polynomial in Legendre polynomials has, by discrete orthogonality, the
                // coefficients (k + 1/2) sum_j w_j P_k(x_j) f_j; the integral of P_k from -1 to x is
                // (P_(k+1) - P_(k-1))(x) / (2k + 1), with P_(-1) = -1.
                let sum: f64 = (0..N)
                    .map(|k| {
                        let before = if k == 0 { -1.0 } else { legendre(k - 1, zeros[i]) };
                        legendre(k, zeros[j]) * (legendre(k + 1, zeros[i]) - before)
                    })
                    .sum();
                // One half of (k + 1/2) / (2k + 1), one of the interval's length.
                rule.running[i][j] = 0.25 * weights[j] * sum;
            }
        }
        rule
    }
}

/// P_n(x) by the three-term recurrence.
fn legendre(n: usize, x: f64) -> f64 {
    let (mut before, mut value) = (0.0, 1.0);
    for k in 0..n {
        let k = k as f64;
        (before, value) = (value, ((2.0 * k + 1.0) * x * value - k * before) / (k + 1.0));
    }
    value
}

/// P_n and its derivative, for n >= 1 and abs(x) < 1.
fn with_slope(n: usize, x: f64) -> (f64, f64) {
    let value = legendre(n, x);
    (value, n as f64 * (x * value - legendre(n - 1, x)) / (x * x - 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rounding in sums of a dozen terms of unit size.
    const ROUNDING: f64 = 1e-15;

    fn is_exact_for_polynomials<const N: usize>() {
        let rule = Rule::<N>::new();
        assert!(rule.nodes.is_sorted() && rule.nodes[0] > 0.0 && rule.nodes[N - 1] < 1.0);
        for degree in 0..2 * N as i32 {
            let whole: f64 = (0..N).map(|i| rule.weights[i] * rule.nodes[i].powi(degree)).sum();
            let exact = 1.0 / f64::from(degree + 1);
            assert!((whole - exact).abs() < ROUNDING, "N {N}, degree {degree}: {whole} for {exact}");
        }
        for degree in 0..N as i32 {
            for i in 0..N {
                let part: f64 = (0..N).map(|j| rule.running[i][j] * rule.nodes[j].powi(degree)).sum();
                let exact = rule.nodes[i].powi(degree + 1) / f64::from(degree + 1);
                assert!((part - exact).abs() < ROUNDING, "N {N}, degree {degree}, node {i}: {part} for {exact}");
            }
        }
        // One degree more is beyond the rule: int x^(2N) differs by (N!)^4 / ((2N + 1) (2N)!^2), 1e-5 for N = 5.
        let beyond: f64 = (0..N).map(|i| rule.weights[i] * rule.nodes[i].powi(2 * N as i32)).sum();
        assert!((beyond - 1.0 / (2 * N + 1) as f64).abs() > 1e4 * ROUNDING);
    }

    #[test]
    fn rules_are_exact_for_polynomials() {
        is_exact_for_polynomials::<1>();
        is_exact_for_polynomials::<3>();
        is_exact_for_polynomials::<5>();
        is_exact_for_polynomials::<8>();
    }
}
