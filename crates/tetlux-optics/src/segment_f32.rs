//! The shader's ray-segment integrals in f32, function by function: the twin of `shaders/lib/segment.wgsl`.
//!
//! Symbols as in [`crate::segment`]. Measured against it over nine sets of 20 000 f32 inputs from 1e-8 to 1e6: relative
//! error of alpha, `w_b` and `w_f` at most 6.3e-6, absolute error at most 1.4e-6. No step makes an infinity or a NaN,
//! whatever the inputs.

#[cfg(test)]
mod tests;

/// Polynomial fit of the mean depth for x <= 3: `Q_SMALL[i][j]` multiplies (2x/3 - 1)^i (2 rho - 1)^j. Relative error
/// 2.3e-6.
const Q_SMALL: [[f32; 6]; 7] = [
    [0.37945005, -0.16073368, 0.023733398, -0.0025222052, 2.0773936e-4, -1.1764681e-5],
    [-0.11209796, 0.011266346, 0.021324925, -0.004741566, 6.084157e-4, -5.6071112e-5],
    [0.011816426, 0.0044946843, -0.0033548484, -0.0017996931, 5.5326393e-4, -8.442922e-5],
    [0.0026015933, -0.0010154207, -7.063597e-4, 4.9658044e-4, 9.513845e-5, -3.308228e-5],
    [-8.318558e-4, -1.0990144e-4, 2.473769e-4, 4.6949866e-5, -4.71872e-5, 2.4654864e-6],
    [-3.404152e-5, 6.24129e-5, 1.3945086e-8, -2.7435968e-5, 9.228248e-6, -4.2233014e-6],
    [3.402083e-5, -4.7048798e-6, -5.87998e-6, 2.013514e-6, -2.5483773e-6, 1.4655121e-6],
];

/// erfcx(x) = t P(t) / Q(t), t = 1 / (1 + x / 1.5), coefficients ascending. Relative error 1.2e-7.
const ERFCX_P: [f32; 5] = [0.37612644, 0.23035075, 0.6645468, 0.46277294, 0.33668923];
const ERFCX_Q: [f32; 5] = [1.0, -0.38754705, 1.3757992, -0.16759986, 0.24983415];

/// Daw(x) = x z P(z) / Q(z), z = 1 / (1 + x^2 / 5), coefficients ascending. Relative error 4.2e-6.
const DAWSON_P: [f32; 7] = [0.10000042, -0.23751499, 0.39265388, -0.11536399, 0.52579886, -1.0893826, 2.0929441];
const DAWSON_Q: [f32; 6] = [1.0, -3.474178, 6.4801655, -4.8540235, 1.9897939, 0.52737063];

/// Square root of pi.
const SQRT_PI: f32 = 1.7724539;

/// Inputs are limited to this value: squares stay finite, and every weight is at its limit long before.
const MAX_DEPTH: f32 = 1e15;

/// NaN and negative values count as 0: a comparison with NaN is false, or an optimiser's minimum picks the number.
pub(crate) fn clean(depth: f32) -> f32 {
    if depth > 0.0 {
        return depth.min(MAX_DEPTH);
    }
    0.0
}

pub(crate) fn horner4(c: [f32; 5], x: f32) -> f32 {
    c[0] + x * (c[1] + x * (c[2] + x * (c[3] + x * c[4])))
}

pub(crate) fn horner5(c: [f32; 6], x: f32) -> f32 {
    c[0] + x * (c[1] + x * (c[2] + x * (c[3] + x * (c[4] + x * c[5]))))
}

pub(crate) fn horner6(c: [f32; 7], x: f32) -> f32 {
    c[0] + x * (c[1] + x * (c[2] + x * (c[3] + x * (c[4] + x * (c[5] + x * c[6])))))
}

/// exp(x^2) erfc(x) for x >= 0.
pub(crate) fn erfcx(x: f32) -> f32 {
    let t = 1.0 / (1.0 + x / 1.5);
    t * horner4(ERFCX_P, t) / horner4(ERFCX_Q, t)
}

/// Dawson's integral exp(-x^2) int_0^x exp(y^2) dy for x >= 0.
pub(crate) fn dawson(x: f32) -> f32 {
    let z = 1.0 / (1.0 + x * x / 5.0);
    x * z * horner6(DAWSON_P, z) / horner5(DAWSON_Q, z)
}

/// Opacity 1 - exp(-x) of optical depth x >= 0. The series keeps its digits where exp(-x) rounds to 1.
pub fn opacity(x: f32) -> f32 {
    if x >= 0.25 {
        return 1.0 - (-x).exp();
    }
    x * (1.0 - x / 2.0 * (1.0 - x / 3.0 * (1.0 - x / 4.0 * (1.0 - x / 5.0 * (1.0 - x / 6.0)))))
}

/// Mean depth of the visible emission for x <= 3, by the polynomial.
fn mean_depth_thin(x: f32, rho: f32) -> f32 {
    let t = x * (2.0 / 3.0) - 1.0;
    let s = 2.0 * rho - 1.0;
    let mut q = horner5(Q_SMALL[6], s);
    q = q * t + horner5(Q_SMALL[5], s);
    q = q * t + horner5(Q_SMALL[4], s);
    q = q * t + horner5(Q_SMALL[3], s);
    q = q * t + horner5(Q_SMALL[2], s);
    q = q * t + horner5(Q_SMALL[1], s);
    q * t + horner5(Q_SMALL[0], s)
}

/// Mean depth of the visible emission for x > 3, by the closed forms of the mean transmittance psi.
fn mean_depth_thick(x: f32, a: f32, b: f32) -> f32 {
    let zeta = (-x).exp();
    // Nearly constant extinction: the difference is held away from 0, which changes psi by less than its fit error.
    let r = (2.0 * (a - b).abs().max(1e-7 * b * b)).sqrt();
    let psi = if a >= b {
        SQRT_PI / r * (erfcx(b / r) - zeta * erfcx(a / r))
    } else {
        2.0 / r * (dawson(b / r) - zeta * dawson(a / r))
    };
    (psi - zeta) / (1.0 - zeta)
}

/// Mean depth q of the visible emission, 0 at the front and 1 at the back, for cleaned a, b.
pub fn mean_depth(x: f32, rho: f32, a: f32, b: f32) -> f32 {
    if x <= 3.0 {
        return mean_depth_thin(x, rho);
    }
    mean_depth_thick(x, a, b)
}

/// (alpha, w_b, w_f): opacity and the weights of the back and front luminance, for any a, b.
pub fn weights_direct(a: f32, b: f32) -> [f32; 3] {
    let back = clean(a);
    let front = clean(b);
    let x = 0.5 * (back + front);
    let rho = front / (back + front).max(1e-30);
    let alpha = opacity(x);
    let q = mean_depth(x, rho, back, front);
    [alpha, alpha * q, alpha * (1.0 - q)]
}

/// The share of a segment between the depths `ends`, front and back, that lies before a depth.
pub fn share_before(limit: f32, ends: [f32; 2]) -> f32 {
    let [front, back] = ends;
    if limit >= back {
        return 1.0;
    }
    ((limit - front) / (back - front).max(1e-30)).clamp(0.0, 1.0)
}

/// As weights_direct, with the mean luminance throughout: a model, wrong by up to half of alpha in thick segments.
pub fn weights_average(a: f32, b: f32) -> [f32; 3] {
    let alpha = opacity(0.5 * (clean(a) + clean(b)));
    [alpha, 0.5 * alpha, 0.5 * alpha]
}
