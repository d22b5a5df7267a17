//! What a shader does with each table, in f32.
//!
//! Every function takes the table that its description names, and gives NaN for a table of another kind.

use std::f32::consts::{FRAC_2_SQRT_PI, PI};

use tetlux_optics::erf_f32::erf;
use tetlux_optics::segment_f32::opacity;

use crate::spec::{Design, TableKind};
use crate::table::Table;

/// a and b are limited to this value: their sum stays finite, and every function is at its limit.
const MAX_DEPTH: f32 = 1e15;

/// NaN and negative values count as 0.
fn clean(depth: f32) -> f32 {
    if depth > 0.0 { depth.min(MAX_DEPTH) } else { 0.0 }
}

/// X = (a + b)/2 and rho = b/(a + b).
fn depth_and_share(a: f32, b: f32) -> [f32; 2] {
    [0.5 * (a + b), b / (a + b).max(1e-30)]
}

fn at(table: &Table, parameters: [f32; 3]) -> [f32; 4] {
    let mut coordinates = [0.0; 3];
    for (axis, (coordinate, parameter)) in table.axes().iter().zip(coordinates.iter_mut().zip(parameters)) {
        *coordinate = axis.coordinate(parameter);
    }
    table.interpolate(coordinates)
}

/// psi for a = `tau_b` D and b = `tau_f` D from a [`TableKind::Psi`].
pub fn sample_psi(table: &Table, a: f32, b: f32) -> f32 {
    match table.spec().kind {
        TableKind::Psi => at(table, [clean(a), clean(b), 0.0])[0],
        _ => f32::NAN,
    }
}

/// q for a = `tau_b` D and b = `tau_f` D from a [`TableKind::Q`] of any design or a [`TableKind::QPair`].
pub fn sample_q(table: &Table, a: f32, b: f32) -> f32 {
    let (a, b) = (clean(a), clean(b));
    let [x, rho] = depth_and_share(a, b);
    let value = at(table, [x, rho, 0.0])[0];
    match table.spec().kind {
        TableKind::Q { design: Design::Q } | TableKind::QPair => value,
        TableKind::Q { design: Design::R | Design::R4 } => value / (b + (b * b + 8.0 / PI * a + 16.0).sqrt()),
        _ => f32::NAN,
    }
}

/// (alpha, `w_b`, `w_f`) from a table of q ([`sample_q`]) or of psi. With q the three are consistent and positive;
/// from psi the weights are differences, which lose their digits in thin segments.
pub fn sample_weights(table: &Table, a: f32, b: f32) -> [f32; 3] {
    let x = 0.5 * (clean(a) + clean(b));
    let alpha = opacity(x);
    if table.spec().kind == TableKind::Psi {
        let psi = sample_psi(table, a, b);
        return [alpha, psi - (-x).exp(), 1.0 - psi];
    }
    let q = sample_q(table, a, b);
    [alpha, alpha * q, alpha * (1.0 - q)]
}

/// (F, B) for the extinctions at the two ends and the length D: from a [`TableKind::FrontBack`], or from a
/// [`TableKind::QPair`] by psi = zeta + alpha q, F = D (1 - `q_e`) psi and B = D `q_e` psi.
pub fn sample_front_back(table: &Table, alpha_f: f32, alpha_b: f32, length: f32) -> [f32; 2] {
    match table.spec().kind {
        TableKind::FrontBack { .. } => {
            let [front, back, ..] = at(table, [alpha_f, alpha_b, length]);
            [front, back]
        }
        TableKind::QPair => {
            let [x, rho] = depth_and_share(clean(alpha_b * length), clean(alpha_f * length));
            let [q, q_e, ..] = at(table, [x, rho, 0.0]);
            let psi = (-x).exp() + opacity(x) * q;
            [length * (1.0 - q_e) * psi, length * q_e * psi]
        }
        _ => [f32::NAN; 2],
    }
}

/// `int_t0^t1 exp(-P (erf y - erf t0)) dy`: the transmittance to the front end of a Gaussian widget, integrated, from
/// a [`TableKind::Gaussian`] or a [`TableKind::GaussianBounded`]. `t0 <= t1` is the front.
pub fn sample_gaussian(table: &Table, p: f32, t0: f32, t1: f32) -> f32 {
    match table.spec().kind {
        TableKind::Gaussian { .. } => {
            let integral = |t: f32| at(table, [p, t, 0.0])[0];
            (p * erf(t0)).exp() * (integral(t1) - integral(t0))
        }
        TableKind::GaussianBounded { max_t } => {
            let bounded = |t: f32| {
                // In front of the table T is 1 until the widget begins; the table ends where nothing is left.
                let before = (-(max_t as f32) - t).max(0.0);
                at(table, [p, t, 0.0])[0] + before * (1.0 - (-2.0 * p).exp())
            };
            let rest = (t1 - t0) * (-p * libm::erfcf(t0)).exp();
            bounded(t0) - gaussian_transmittance(p, t0, t1) * bounded(t1) + rest
        }
        _ => f32::NAN,
    }
}

/// exp(-P (erf t1 - erf t0)).
fn gaussian_transmittance(p: f32, t0: f32, t1: f32) -> f32 {
    let difference = if t1 - t0 < 0.1 {
        // The middle and 3-point Gauss-Legendre: the difference of two erf loses its digits.
        let (middle, reach) = (0.5 * (t0 + t1), 0.5 * (t1 - t0) * 0.774_596_7);
        let gauss = |t: f32| (-t * t).exp();
        let mean = (5.0 * gauss(middle - reach) + 8.0 * gauss(middle) + 5.0 * gauss(middle + reach)) / 18.0;
        FRAC_2_SQRT_PI * (t1 - t0) * mean
    } else if t0 > 0.5 {
        libm::erfcf(t0) - libm::erfcf(t1)
    } else if t1 < -0.5 {
        libm::erfcf(-t1) - libm::erfcf(-t0)
    } else {
        libm::erff(t1) - libm::erff(t0)
    };
    (-p * difference).exp()
}

/// `int_t1^t2 exp(-M (cos t1 - cos y)) dy`, `0 <= t1 <= t2 <= pi`: the same for one lobe of a sine, from a
/// [`TableKind::Sine`] or a [`TableKind::SineBounded`].
pub fn sample_sine(table: &Table, m: f32, t1: f32, t2: f32) -> f32 {
    match table.spec().kind {
        TableKind::Sine { .. } => {
            let integral = |t: f32| at(table, [t, m, 0.0])[0];
            (-m * t1.cos()).exp() * (integral(t2) - integral(t1))
        }
        TableKind::SineBounded => {
            let zeta = (-2.0 * m * (0.5 * (t1 + t2)).sin() * (0.5 * (t2 - t1)).sin()).exp();
            at(table, [m, t1, 0.0])[0] - zeta * at(table, [m, t2, 0.0])[0]
        }
        _ => f32::NAN,
    }
}

/// `int_l0^l1` of the transmittance to l0 along a ramp that falls as A (1 - l), `0 <= l0 <= l1 <= 1`, from a
/// [`TableKind::Triangle`]. A rising ramp needs no table.
pub fn sample_triangle(table: &Table, a_max: f32, l0: f32, l1: f32) -> f32 {
    match table.spec().kind {
        TableKind::Triangle { .. } => {
            let integral = |l: f32| at(table, [l, a_max, 0.0])[0];
            (a_max * (l0 - 0.5 * l0 * l0)).exp() * (integral(l1) - integral(l0))
        }
        _ => f32::NAN,
    }
}

/// Premultiplied colour and alpha from a [`TableKind::PreIntegrated`]; scalars from 0 to 1 over the table's range, the
/// length in world units.
pub fn sample_pre_integrated(table: &Table, s_f: f32, s_b: f32, length: f32) -> [f32; 4] {
    match (&table.spec().kind, table.axes()) {
        (TableKind::PreIntegrated { .. }, [_, _, thickness]) => {
            table.interpolate([s_f, s_b, thickness.coordinate(length)])
        }
        _ => [f32::NAN; 4],
    }
}

/// The same from a [`TableKind::MeanExtinction`] and a [`TableKind::ColorRatio`] of one transfer function.
pub fn sample_color_ratio(mean: &Table, ratio: &Table, s_f: f32, s_b: f32, length: f32) -> [f32; 4] {
    match (&mean.spec().kind, &ratio.spec().kind, ratio.axes()) {
        (TableKind::MeanExtinction { .. }, TableKind::ColorRatio { .. }, [_, _, depth]) => {
            let x = clean(mean.interpolate([s_f, s_b, 0.0])[0] * length);
            let alpha = opacity(x);
            let [r, g, b, _] = ratio.interpolate([s_f, s_b, depth.coordinate(x)]);
            [alpha * r, alpha * g, alpha * b, alpha]
        }
        _ => [f32::NAN; 4],
    }
}
