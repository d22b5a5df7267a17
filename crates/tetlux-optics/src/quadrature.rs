//! Quadrature of smooth integrands that are nowhere negative, so that a relative error is kept.

#[cfg(test)]
mod tests;

/// Positive halves of the 20 Gauss-Legendre nodes on [-1, 1], and their weights.
const NODES: [[f64; 2]; 10] = [
    [0.9931285991850949, 0.017614007139152118],
    [0.9639719272779138, 0.04060142980038694],
    [0.912234428251326, 0.06267204833410907],
    [0.8391169718222188, 0.08327674157670475],
    [0.7463319064601508, 0.10193011981724044],
    [0.636053680726515, 0.11819453196151841],
    [0.5108670019508271, 0.13168863844917664],
    [0.37370608871541955, 0.14209610931838204],
    [0.22778585114164507, 0.14917298647260374],
    [0.07652652113349734, 0.15275338713072584],
];

/// The integrals of `N` functions over [from, to], by 20 nodes: exact for polynomials up to degree 39.
pub(crate) fn gauss<const N: usize>(from: f64, to: f64, functions: impl Fn(f64) -> [f64; N]) -> [f64; N] {
    let length = to - from;
    let mut sums = [0.0; N];
    for [node, weight] in NODES {
        for v in [0.5 - 0.5 * node, 0.5 + 0.5 * node] {
            for (sum, value) in sums.iter_mut().zip(functions(from + v * length)) {
                *sum += 0.5 * weight * length * value;
            }
        }
    }
    sums
}

/// Halves [from, to] until every part `fits` (or has no inner number), and visits the parts in ascending order for as
/// long as `visit` says true.
pub(crate) fn bisect(
    from: f64,
    to: f64,
    fits: &impl Fn(f64, f64) -> bool,
    visit: &mut impl FnMut(f64, f64) -> bool,
) -> bool {
    let middle = from + 0.5 * (to - from);
    if fits(from, to) || !(from < middle && middle < to) {
        return visit(from, to);
    }
    bisect(from, middle, fits, visit) && bisect(middle, to, fits, visit)
}
