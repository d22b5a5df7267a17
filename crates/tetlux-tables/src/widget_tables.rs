//! Tables of the bivariate widgets' profiles: each as published, and its bounded form.
//!
//! The bounded forms fill a row from its far end: with T the transmittance from a node to the next,
//! V(t) = `int_t^t' T(y) dy` + T(t') V(t'), every term positive.

use rayon::prelude::*;

use crate::axis::Axis;
use crate::graded::{panel, transmittance_integral};
use crate::integral_tables::values;

const TWO_OVER_SQRT_PI: f64 = std::f64::consts::FRAC_2_SQRT_PI;

/// `int_0^t exp(-P erf y) dy` over (P, t).
pub(crate) fn gaussian(axes: &[Axis]) -> Vec<f32> {
    let columns = columns(axes, |p, ts| {
        // Summed outwards from 0 on either side: no cancellation.
        let mut column = vec![0.0; ts.len()];
        let step = |from: f64, to: f64| smooth(from, to, p, |y| (-p * libm::erf(y)).exp());
        let first = ts.partition_point(|&t| t < 0.0);
        for (from, i) in (first..ts.len()).map(|i| (if i == first { 0.0 } else { ts[i - 1] }, i)) {
            column[i] = if i == first { 0.0 } else { column[i - 1] } + step(from, ts[i]);
        }
        for i in (0..first).rev() {
            let (from, value) = if i + 1 == first { (0.0, 0.0) } else { (ts[i + 1], column[i + 1]) };
            column[i] = value - step(ts[i], from);
        }
        column
    });
    transpose(&columns)
}

/// U(P, t) = `int_t^inf [exp(-P (erf y - erf t)) - exp(-P erfc t)] dy` over (P, t).
pub(crate) fn gaussian_bounded(axes: &[Axis]) -> Vec<f32> {
    let columns = columns(axes, |p, ts| {
        let depth = |t: f64, y: f64| (p * erf_difference(t, y)).max(0.0);
        let rate = |t: f64, y: f64| {
            let nearest = if t < 0.0 && y > 0.0 { 0.0 } else { t.abs().min(y.abs()) };
            p * TWO_OVER_SQRT_PI * (-nearest * nearest).exp() + 0.5
        };
        let rest = |t: f64| (-p * libm::erfc(t)).exp();
        let part = |t: f64, to: f64| {
            let visible = transmittance_integral(to - t, rate(t, to), |y| depth(t, t + y));
            (visible - (to - t) * rest(t)).max(0.0)
        };
        let mut column = vec![0.0; ts.len()];
        for i in (0..ts.len()).rev() {
            // erfc(8) is 1e-29: nothing is left beyond.
            column[i] = match ts.get(i + 1) {
                Some(&next) => part(ts[i], next) + (-depth(ts[i], next)).exp() * column[i + 1],
                None => beyond(p, ts[i]),
            };
        }
        column
    });
    transpose(&columns)
}

/// U(P, t) for the last node: to first order in P erfc(y) where that is small, else by panels.
fn beyond(p: f64, t: f64) -> f64 {
    let full = |y: f64| (p * libm::erfc(y)).exp_m1() * (-p * libm::erfc(t)).exp();
    if p * libm::erfc(t) < 1.0 {
        return (0..32).map(|i| panel(t + f64::from(i) * 0.25, t + f64::from(i + 1) * 0.25, full)).sum();
    }
    let rate = p * TWO_OVER_SQRT_PI * (-t * t).exp();
    let length = 8.0_f64.max(t) - t;
    let visible = transmittance_integral(length, rate.max(0.5), |y| (p * erf_difference(t, t + y)).max(0.0));
    (visible - length * (-p * libm::erfc(t)).exp()).max(0.0)
}

/// erf(to) - erf(from) without cancellation where both are near 1 or near -1.
pub(crate) fn erf_difference(from: f64, to: f64) -> f64 {
    if from > 0.5 && to > 0.5 {
        libm::erfc(from) - libm::erfc(to)
    } else if from < -0.5 && to < -0.5 {
        libm::erfc(-to) - libm::erfc(-from)
    } else {
        libm::erf(to) - libm::erf(from)
    }
}

/// `int_0^x exp(M cos y) dy` over (x, M).
pub(crate) fn sine(axes: &[Axis]) -> Vec<f32> {
    rows(axes, |m, xs| {
        let mut sum = 0.0;
        let mut from = 0.0;
        let mut next = |x: f64| {
            sum += smooth(from, x, m, |y| (m * y.cos()).exp());
            from = x;
            sum
        };
        xs.iter().map(|&x| next(x)).collect()
    })
}

/// V(M, t) = `int_t^pi exp(-M (cos t - cos y)) dy` over (M, t).
pub(crate) fn sine_bounded(axes: &[Axis]) -> Vec<f32> {
    let columns = columns(axes, |m, ts| {
        let depth = |t: f64, y: f64| 2.0 * m * (0.5 * (t + y)).sin() * (0.5 * (y - t)).sin();
        let mut column = vec![0.0; ts.len()];
        for i in (0..ts.len() - 1).rev() {
            let (t, next) = (ts[i], ts[i + 1]);
            // The depth is at most M sin(t) y + M y^2/2.
            let rate = m * t.sin() + m.sqrt() + 0.5;
            let part = transmittance_integral(next - t, rate, |y| depth(t, t + y));
            column[i] = part + (-depth(t, next)).exp() * column[i + 1];
        }
        column
    });
    transpose(&columns)
}

/// `int_0^l exp(-A (y - y^2/2)) dy` over (l, A).
pub(crate) fn triangle(axes: &[Axis]) -> Vec<f32> {
    rows(axes, |a, ls| {
        let mut sum = 0.0;
        let mut from = 0.0;
        let mut next = |l: f64| {
            sum += smooth(from, l, a, |y| (-a * (y - 0.5 * y * y)).exp());
            from = l;
            sum
        };
        ls.iter().map(|&l| next(l)).collect()
    })
}

/// `int_from^to f` for an f whose logarithm changes by at most `rate` a unit: panels over which it changes by 2.
fn smooth(from: f64, to: f64, rate: f64, f: impl Fn(f64) -> f64) -> f64 {
    // At most 80 pi / 2 panels for the largest rate that a specification may ask for.
    let panels = ((to - from).abs() * (rate + 1.0) / 2.0).ceil().clamp(1.0, 1e4);
    let width = (to - from) / panels;
    (0..panels as u32).map(f64::from).map(|i| panel(from + i * width, from + (i + 1.0) * width, &f)).sum()
}

/// Runs along the first axis for each value of the second.
fn rows(axes: &[Axis], row: impl Fn(f64, &[f64]) -> Vec<f64> + Sync) -> Vec<f32> {
    let xs = values(&axes[0]);
    values(&axes[1]).par_iter().flat_map_iter(|&y| row(y, &xs)).map(|v| v as f32).collect()
}

/// Runs along the second axis for each value of the first.
fn columns(axes: &[Axis], column: impl Fn(f64, &[f64]) -> Vec<f64> + Sync) -> Vec<Vec<f64>> {
    let ys = values(&axes[1]);
    values(&axes[0]).par_iter().map(|&x| column(x, &ys)).collect()
}

fn transpose(columns: &[Vec<f64>]) -> Vec<f32> {
    let height = columns.first().map_or(0, Vec::len);
    (0..height).flat_map(|j| columns.iter().map(move |column| column[j] as f32)).collect()
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use tetlux_optics::widget_integral as exact;

    use super::*;
    use crate::spec::{TableKind, TableSpec};
    use crate::{Precision, Table};

    fn table(kind: TableKind) -> Table {
        Table::build(&TableSpec { id: "w".to_owned(), kind, size: [41, 33, 1], precision: Precision::F32 }).unwrap()
    }

    fn at(table: &Table, i: usize, j: usize) -> f64 {
        f64::from(table.texel(i, j, 0)[0])
    }

    /// f32 texels: half an ulp; the quadrature's own error is far below.
    const TOLERANCE: f64 = 2e-7;

    /// Modified Bessel function I_0 times exp(-x), by its integral's trapezoidal rule, which converges geometrically.
    fn scaled_bessel(x: f64) -> f64 {
        let n = 800;
        (0..n).map(|i| (x * ((2.0 * PI * f64::from(i) / f64::from(n)).cos() - 1.0)).exp()).sum::<f64>() / f64::from(n)
    }

    #[test]
    fn a_whole_lobe_of_a_sine_is_a_bessel_function() {
        let table = table(TableKind::SineBounded);
        for i in 0..36 {
            let m = table.axes()[0].value(i as u32);
            let exact = PI * scaled_bessel(m);
            assert!((at(&table, i, 0) / exact - 1.0).abs() < TOLERANCE, "M = {m}: {} for {exact}", at(&table, i, 0));
        }
        for j in 0..33 {
            let t = table.axes()[1].value(j as u32);
            assert!((at(&table, 0, j) - (PI - t)).abs() < 4.0 * TOLERANCE, "M = 0 at t = {t}");
            assert!(at(&table, 40, j) < 1e-6, "an infinite M lets nothing through");
        }
    }

    #[test]
    fn the_published_sine_table_is_the_same_integral() {
        let table = table(TableKind::Sine { max_m: 10.0 });
        for j in 0..33 {
            let m = table.axes()[1].value(j as u32);
            let exact = PI * scaled_bessel(m) * m.exp();
            assert!((at(&table, 40, j) / exact - 1.0).abs() < TOLERANCE, "M = {m}");
            assert_eq!(at(&table, 0, j), 0.0);
        }
    }

    #[test]
    fn a_thin_gaussian_is_its_first_order_term() {
        let size = [4096, 17, 1];
        let spec = TableSpec {
            id: "w".to_owned(),
            kind: TableKind::GaussianBounded { max_t: 4.0 },
            size,
            precision: Precision::F32,
        };
        let table = Table::build(&spec).unwrap();
        let p = table.axes()[0].value(1);
        for j in 0..17 {
            let t = table.axes()[1].value(j as u32);
            assert_eq!(at(&table, 0, j), 0.0, "P = 0");
            // Of exp(-P (erf y - erf t)) - exp(-P erfc t) = P erfc y + O(P^2 erfc^2): int erfc = ierfc(t).
            let ierfc = (-t * t).exp() / PI.sqrt() - t * libm::erfc(t);
            let second_order = 2.0 * p * p * (10.0 + ierfc);
            let error = (at(&table, 1, j) - p * ierfc).abs();
            // Near t = 4 the difference above has cancelled to the last bits of its terms.
            assert!(error < second_order + 1e-12, "t = {t}: {} for {}", at(&table, 1, j), p * ierfc);
        }
    }

    #[test]
    fn bounded_forms_are_the_pointwise_integrals() {
        let (gaussian, sine) = (table(TableKind::GaussianBounded { max_t: 4.0 }), table(TableKind::SineBounded));
        for i in [1, 5, 20, 33, 38] {
            let p = gaussian.axes()[0].value(i as u32);
            for j in 0..33 {
                let (t, y) = (gaussian.axes()[1].value(j as u32), sine.axes()[1].value(j as u32));
                let u = exact::gaussian_bounded(p, t);
                // Where U is far below the visible length of 8 it is a difference that has cancelled.
                assert!(
                    (at(&gaussian, i, j) - u).abs() < TOLERANCE * u + 1e-9,
                    "U({p}, {t}): {} for {u}",
                    at(&gaussian, i, j)
                );
                let v = exact::sine_bounded(p, y);
                assert!((at(&sine, i, j) - v).abs() < TOLERANCE * v + 1e-9, "V({p}, {y}): {} for {v}", at(&sine, i, j));
            }
        }
    }

    #[test]
    fn both_gaussian_tables_hold_the_same_integral() {
        let (published, bounded) =
            (table(TableKind::Gaussian { max_p: 10.0, max_t: 4.0 }), table(TableKind::GaussianBounded { max_t: 4.0 }));
        // P of the bounded table's node 10 of 40 is (3/4)^-4 - 1 = 175/81; a published axis that has it as a node.
        let p = bounded.axes()[0].value(10);
        let spec = TableSpec { kind: TableKind::Gaussian { max_p: p, max_t: 4.0 }, ..published.spec().clone() };
        let published = Table::build(&spec).unwrap();
        for (j0, j1) in [(0, 32), (10, 20), (16, 32), (3, 4), (20, 30)] {
            let [t0, t1] = [j0, j1].map(|j| bounded.axes()[1].value(j as u32));
            let by_published = (p * libm::erf(t0)).exp() * (at(&published, 40, j1) - at(&published, 40, j0));
            let zeta = (-p * erf_difference(t0, t1)).exp();
            let rest = (t1 - t0) * (-p * libm::erfc(t0)).exp();
            let by_bounded = at(&bounded, 10, j0) - zeta * at(&bounded, 10, j1) + rest;
            // The published values reach e^P = 9 times the interval; their f32 rounding shows.
            assert!((by_published - by_bounded).abs() < 1e-5, "{t0} to {t1}: {by_published} and {by_bounded}");
        }
    }

    #[test]
    fn a_falling_ramp_is_dawsons_integral() {
        let table = table(TableKind::Triangle { max_a: 10.0 });
        for j in 0..33 {
            let a = table.axes()[1].value(j as u32);
            for i in [1, 20, 40] {
                let l = table.axes()[0].value(i as u32);
                let exact = l * tetlux_optics::segment::psi(a * (1.0 - l) * l, a * l);
                assert!((at(&table, i, j) / exact - 1.0).abs() < TOLERANCE, "l = {l}, A = {a}");
            }
        }
    }
}
