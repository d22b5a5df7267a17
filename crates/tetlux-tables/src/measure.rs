//! The error of a table: its f32 lookups against f64 integrals, over a dense set of points chosen to be hard.

use std::f64::consts::PI;

use rayon::prelude::*;
use tetlux_optics::emission::density_weights;
use tetlux_optics::segment::{SegmentResult, psi, segment, weights};
use tetlux_optics::transfer::TransferFunction;
use tetlux_optics::widget_integral::{gaussian_bounded, sine_bounded};

use crate::lookup::{
    sample_color_ratio, sample_front_back, sample_gaussian, sample_pre_integrated, sample_sine, sample_triangle,
    sample_weights,
};
use crate::spec::{SpecError, TableKind, TransferSpec};
use crate::table::{MeasuredError, Table};
use crate::widget_tables::erf_difference;

/// Widget tables are for segments of at least this length, in the units of the profile's argument: their errors are
/// divided by it.
const WIDGET_LENGTH: f64 = 1.0;

/// Measures a table on the domain it is meant for.
///
/// Tables of q and psi: `w_b`, the error of the blended colour for luminances in [0, 1], for a and b from 0 and 1e-8 to
/// 1e6, with bands around a = b and b = sqrt a. F and B: the larger error over the largest length. Widgets: `w_b`, for
/// segments of at least `WIDGET_LENGTH`. Transfer functions: colour and alpha, for lengths over five decades.
///
/// # Errors
/// [`SpecError`] if the table's transfer function is none; a table that was built or read has one.
pub fn measure(table: &Table) -> Result<MeasuredError, SpecError> {
    match &table.spec().kind {
        TableKind::Psi | TableKind::Q { .. } => Ok(weights_error(table)),
        TableKind::QPair => Ok(pair_error(table)),
        TableKind::FrontBack { max_extinction, max_length } => {
            Ok(front_back_error(table, *max_extinction, *max_length))
        }
        TableKind::Gaussian { max_p, max_t } => Ok(gaussian_error(table, *max_p, *max_t, WIDGET_LENGTH)),
        TableKind::GaussianBounded { max_t } => Ok(gaussian_error(table, 316.0, *max_t, WIDGET_LENGTH)),
        TableKind::Sine { max_m } => Ok(sine_error(table, *max_m, WIDGET_LENGTH)),
        TableKind::SineBounded => Ok(sine_error(table, 316.0, WIDGET_LENGTH)),
        TableKind::Triangle { max_a } => Ok(triangle_error(table, *max_a)),
        TableKind::PreIntegrated { transfer, .. } => {
            transfer_error(transfer, "colour and alpha", |s_f, s_b, l, _| sample_pre_integrated(table, s_f, s_b, l))
        }
        TableKind::MeanExtinction { transfer } => transfer_error(transfer, "alpha", |s_f, s_b, l, exact| {
            let alpha = -(-table.interpolate([s_f, s_b, 0.0])[0] * l).exp_m1();
            [exact.color[0] as f32, exact.color[1] as f32, exact.color[2] as f32, alpha]
        }),
        TableKind::ColorRatio { transfer } => {
            transfer_error(transfer, "colour, alpha being exact", |s_f, s_b, _, exact| {
                let depth = -exact.transmittance.ln();
                let ratio = table.interpolate([s_f, s_b, table.axes()[2].coordinate(depth as f32)]);
                let alpha = exact.alpha as f32;
                [alpha * ratio[0], alpha * ratio[1], alpha * ratio[2], alpha]
            })
        }
    }
}

/// Measures colour and alpha from a [`TableKind::MeanExtinction`] and a [`TableKind::ColorRatio`] together.
///
/// # Errors
/// As [`measure`].
pub fn measure_color_ratio(mean: &Table, ratio: &Table) -> Result<MeasuredError, SpecError> {
    let (TableKind::MeanExtinction { transfer } | TableKind::ColorRatio { transfer }) = &ratio.spec().kind else {
        return measure(ratio);
    };
    transfer_error(transfer, "colour and alpha", |s_f, s_b, l, _| sample_color_ratio(mean, ratio, s_f, s_b, l))
}

/// Measures `w_b` from a widget's table over segments of at least `shortest` in the units of the profile's argument;
/// any other table as [`measure`] does.
///
/// # Errors
/// As [`measure`].
pub fn measure_widget(table: &Table, shortest: f64) -> Result<MeasuredError, SpecError> {
    match &table.spec().kind {
        TableKind::Gaussian { max_p, max_t } => Ok(gaussian_error(table, *max_p, *max_t, shortest)),
        TableKind::GaussianBounded { max_t } => Ok(gaussian_error(table, 316.0, *max_t, shortest)),
        TableKind::Sine { max_m } => Ok(sine_error(table, *max_m, shortest)),
        TableKind::SineBounded => Ok(sine_error(table, 316.0, shortest)),
        _ => measure(table),
    }
}

/// Largest and mean of the errors, summed in one order whatever the threads do.
fn summary(quantity: impl ToString, errors: &[f64]) -> MeasuredError {
    // A NaN is an infinite error; f64::max would pass it over.
    let max = errors.iter().fold(0.0, |max: f64, &e| if e.is_nan() { f64::INFINITY } else { max.max(e) });
    let mean = errors.iter().sum::<f64>() / errors.len().max(1) as f64;
    MeasuredError { quantity: quantity.to_string(), max, mean, points: errors.len() as u64 }
}

/// `count` values from `low` to `high`, equal ratios apart.
fn geometric(low: f64, high: f64, count: u32) -> impl Iterator<Item = f64> + Clone {
    (0..count).map(move |i| low * (high / low).powf(f64::from(i) / f64::from(count - 1)))
}

/// Pairs (a, b), f32 values, half of which are in bands where the integrals' formulas or tables are at their worst.
fn depth_pairs() -> Vec<[f32; 2]> {
    let axis: Vec<f64> = std::iter::once(0.0).chain(geometric(1e-8, 1e6, 320)).collect();
    let mut pairs: Vec<[f64; 2]> = axis.iter().flat_map(|&a| axis.iter().map(move |&b| [a, b])).collect();
    for a in geometric(1e-8, 1e6, 800) {
        for offset in geometric(1e-7, 0.3, 25) {
            pairs.extend([[a, a * (1.0 + offset)], [a, a * (1.0 - offset)]]);
        }
        // Psi turns from 1/b to sqrt(pi/(2a)) where b^2 is about a.
        pairs.extend(geometric(0.01, 100.0, 40).map(|factor| [a, factor * a.sqrt()]));
    }
    pairs.iter().map(|pair| pair.map(|v| v as f32)).collect()
}

fn weights_error(table: &Table) -> MeasuredError {
    let error = |&[a, b]: &[f32; 2]| {
        let exact = weights(f64::from(a), f64::from(b));
        (f64::from(sample_weights(table, a, b)[1]) - exact.back).abs()
    };
    summary("w_b", &depth_pairs().par_iter().map(error).collect::<Vec<_>>())
}

fn pair_error(table: &Table) -> MeasuredError {
    let error = |&[a, b]: &[f32; 2]| {
        let exact = weights(f64::from(a), f64::from(b));
        let blend = (f64::from(sample_weights(table, a, b)[1]) - exact.back).abs();
        let density = density_weights(f64::from(a), f64::from(b));
        let [f, b] = sample_front_back(table, b, a, 1.0).map(f64::from);
        blend.max((f - density.front).abs()).max((b - density.back).abs())
    };
    summary("w_b, F/D and B/D", &depth_pairs().par_iter().map(error).collect::<Vec<_>>())
}

fn front_back_error(table: &Table, max_extinction: f64, max_length: f64) -> MeasuredError {
    let axis = |max: f64| -> Vec<f32> {
        // Off the nodes of any size, and thin segments.
        let even = (0..36).map(|i| max * (f64::from(i) + 0.47) / 36.0);
        even.chain(geometric(1e-4 * max, max, 12)).map(|v| v as f32).collect()
    };
    let (extinctions, lengths) = (axis(max_extinction), axis(max_length));
    let triples: Vec<[f32; 3]> = extinctions
        .iter()
        .flat_map(|&f| extinctions.iter().map(move |&b| [f, b]))
        .flat_map(|[f, b]| lengths.iter().map(move |&d| [f, b, d]))
        .collect();
    let error = |&[f, b, d]: &[f32; 3]| {
        let length = f64::from(d);
        let exact = density_weights(f64::from(b) * length, f64::from(f) * length);
        let got = sample_front_back(table, f, b, d).map(f64::from);
        (got[0] - length * exact.front).abs().max((got[1] - length * exact.back).abs()) / max_length
    };
    summary("F/D_max and B/D_max", &triples.par_iter().map(error).collect::<Vec<_>>())
}

/// Triples of a strength, a beginning and an end: strengths from 1e-3 to `strongest`, lengths from `shortest` on.
fn widget_segments(strongest: f64, range: [f64; 2], shortest: f64) -> Vec<[f32; 3]> {
    let [low, high] = range;
    let starts = (0..43).map(move |i| low + (high - low) * f64::from(i) / 42.0);
    let lengths = geometric(shortest, high - low, 12);
    geometric(1e-3, strongest, 40)
        .flat_map(|p| starts.clone().map(move |start| [p, start]))
        .flat_map(|[p, start]| lengths.clone().map(move |length| [p, start, start + length]))
        .filter(|segment| segment[2] <= high)
        .map(|segment| segment.map(|v| v as f32))
        .collect()
}

fn gaussian_error(table: &Table, max_p: f64, max_t: f64, shortest: f64) -> MeasuredError {
    let error = |&[p32, from, to]: &[f32; 3]| {
        let [p, t0, t1] = [p32, from, to].map(f64::from);
        let zeta = (-p * erf_difference(t0, t1)).exp();
        let rest = (t1 - t0) * (-p * libm::erfc(t0)).exp();
        let exact = gaussian_bounded(p, t0) - zeta * gaussian_bounded(p, t1) + rest;
        (f64::from(sample_gaussian(table, p32, from, to)) - exact).abs() / (t1 - t0)
    };
    let segments = widget_segments(max_p.min(316.0), [-max_t, max_t], shortest);
    summary(format!("w_b, A D >= {shortest}"), &segments.par_iter().map(error).collect::<Vec<_>>())
}

fn sine_error(table: &Table, max_m: f64, shortest: f64) -> MeasuredError {
    let error = |&[m32, from, to]: &[f32; 3]| {
        let [m, t1, t2] = [m32, from, to].map(f64::from);
        let zeta = (-2.0 * m * (0.5 * (t1 + t2)).sin() * (0.5 * (t2 - t1)).sin()).exp();
        let exact = sine_bounded(m, t1) - zeta * sine_bounded(m, t2);
        (f64::from(sample_sine(table, m32, from, to)) - exact).abs() / (t2 - t1)
    };
    let segments = widget_segments(max_m.min(316.0), [0.0, PI], shortest);
    summary(format!("w_b, k D >= {shortest}"), &segments.par_iter().map(error).collect::<Vec<_>>())
}

fn triangle_error(table: &Table, max_a: f64) -> MeasuredError {
    // A tenth of a ramp.
    let shortest = 0.1;
    let error = |&[a32, from, to]: &[f32; 3]| {
        let [a, l0, l1] = [a32, from, to].map(f64::from);
        let length = l1 - l0;
        let exact = psi(a * (1.0 - l1) * length, a * (1.0 - l0) * length);
        (f64::from(sample_triangle(table, a32, from, to)) / length - exact).abs()
    };
    let segments = widget_segments(max_a, [0.0, 1.0], shortest);
    summary(format!("w_b, l >= {shortest}"), &segments.par_iter().map(error).collect::<Vec<_>>())
}

/// The largest error of colour and alpha over segments of every kind: between, on and near nodes, of no extent, thin
/// and thick. `sample` takes normalised scalars, a length and the exact result.
fn transfer_error(
    transfer: &TransferSpec,
    quantity: &str,
    sample: impl Fn(f32, f32, f32, &SegmentResult) -> [f32; 4] + Sync,
) -> Result<MeasuredError, SpecError> {
    let function = transfer.function()?;
    let [low, high] = transfer.range;
    let scalars = hard_scalars(&function, transfer.range);
    let lengths: Vec<f32> = geometric(1e-5 * transfer.max_length, transfer.max_length, 13).map(|l| l as f32).collect();
    let segments: Vec<[f32; 3]> = scalars
        .iter()
        .flat_map(|&f| scalars.iter().map(move |&b| [f, b]))
        .flat_map(|[f, b]| lengths.iter().map(move |&l| [f, b, l]))
        .collect();
    let error = |&[s_f, s_b, length]: &[f32; 3]| {
        let [front, back] = [s_f, s_b].map(|s| low + (high - low) * f64::from(s));
        let exact = segment(&function, transfer.unit_distance, front, back, f64::from(length));
        let got = sample(s_f, s_b, length, &exact).map(f64::from);
        let color = (0..3).map(|c| (got[c] - exact.color[c]).abs()).fold(0.0, f64::max);
        color.max((got[3] - exact.alpha).abs())
    };
    Ok(summary(quantity, &segments.par_iter().map(error).collect::<Vec<_>>()))
}

/// Normalised scalars between the nodes of tables, and close to the function's own nodes on either side.
fn hard_scalars(function: &TransferFunction, [low, high]: [f64; 2]) -> Vec<f32> {
    let even = (0..47).map(|i| (f64::from(i) + 0.37) / 47.0);
    let near = function.control_points().into_iter().flat_map(move |s| {
        let node = (s - low) / (high - low);
        [node - 1e-3, node + 1e-3]
    });
    even.chain(near).filter(|s| (0.0..=1.0).contains(s)).map(|s| s as f32).collect()
}

#[cfg(test)]
mod tests;
