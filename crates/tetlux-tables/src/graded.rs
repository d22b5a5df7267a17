//! Integrals of a transmittance that may fall within a small part of its interval.

/// Nodes on [0, 1] and weights of 8-point Gauss-Legendre quadrature.
const GAUSS: [[f64; 2]; 8] = [
    [0.019_855_071_751_231_88, 0.050_614_268_145_188_13],
    [0.101_666_761_293_186_63, 0.111_190_517_226_687_24],
    [0.237_233_795_041_835_5, 0.156_853_322_938_943_64],
    [0.408_282_678_752_175_1, 0.181_341_891_689_181],
    [0.591_717_321_247_825, 0.181_341_891_689_181],
    [0.762_766_204_958_164_5, 0.156_853_322_938_943_64],
    [0.898_333_238_706_813_4, 0.111_190_517_226_687_24],
    [0.980_144_928_248_768_1, 0.050_614_268_145_188_13],
];

/// Depth past which nothing is added: e^-45 is 3e-20.
const OPAQUE: f64 = 45.0;

/// `int_0^length exp(-depth(y)) dy` for a depth that rises from 0 by at most `rate` a unit at first.
///
/// Panels double, from a quarter of 1/rate: each is small against what the transmittance has left to fall, so that the
/// relative error is about 1e-9, below what f32 texels can hold.
pub(crate) fn transmittance_integral(length: f64, rate: f64, depth: impl Fn(f64) -> f64) -> f64 {
    weighted_integral(length, rate, depth, |_| 1.0)
}

/// The same of `weight(y) exp(-depth(y))`, for a weight that is a polynomial of low degree.
pub(crate) fn weighted_integral(
    length: f64,
    rate: f64,
    depth: impl Fn(f64) -> f64,
    weight: impl Fn(f64) -> f64,
) -> f64 {
    let mut from = 0.0;
    let mut width = (0.25 / rate).min(length);
    let mut sum = 0.0;
    while from < length {
        // Whatever the scales are, the loop ends.
        let to = if width > 1e-18 * length { (from + width).min(length) } else { length };
        sum += panel(from, to, |y| weight(y) * (-depth(y)).exp());
        if depth(to) > OPAQUE {
            break;
        }
        width *= 2.0;
        from = to;
    }
    sum
}

/// `int_from^to f dy` of a smooth function, by one panel.
pub(crate) fn panel(from: f64, to: f64, f: impl Fn(f64) -> f64) -> f64 {
    (to - from) * GAUSS.iter().map(|&[node, weight]| weight * f(from + (to - from) * node)).sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exponentials_of_every_steepness() {
        for k in [1e-6_f64, 0.1, 1.0, 30.0, 1e4, 1e12] {
            let exact = -(-k).exp_m1() / k;
            let got = transmittance_integral(1.0, k, |y| k * y);
            assert!((got / exact - 1.0).abs() < 1e-9, "{k}: {got} for {exact}");
        }
    }

    #[test]
    fn half_a_gaussian() {
        // The depth starts flat: its rate is that of its square root's scale.
        let got = transmittance_integral(40.0, 1.0, |y| y * y);
        assert!((got - std::f64::consts::PI.sqrt() / 2.0).abs() < 1e-9, "{got}");
    }
}
