//! Tables of a 1D transfer function over the scalars at the two ends of a segment and its length.
//!
//! Scalars run from 0 to 1 over the range of the specification. Single texels are integrated in the shader's f32
//! arithmetic (relative error 6.3e-6 of each piece's weights), which is far below what interpolation costs.

use rayon::prelude::*;
use tetlux_optics::transfer::TransferFunction;
use tetlux_optics::transfer_f32::{Piece, Weights, integrate, piece_at, pieces};

use crate::axis::Axis;
use crate::integral_tables::values;
use crate::spec::{Construction, SpecError, TransferSpec};

#[cfg(test)]
mod tests;

/// Optical depth of the slice that holds the limit of no depth: the colour is off by this share at most.
const THIN: f32 = 1e-6;

/// Position of node `index` of `nodes`, scalars normalised.
fn scalar(index: usize, nodes: usize) -> f32 {
    (index as f64 / (nodes - 1) as f64) as f32
}

/// A transfer function ready to be integrated in f32.
struct Integrator {
    pieces: Vec<Piece>,
}

impl Integrator {
    fn new(transfer: &TransferSpec) -> Result<Self, SpecError> {
        Ok(Self { pieces: pieces(&transfer.function()?, transfer.range, 1.0 / transfer.unit_distance) })
    }

    /// Premultiplied colour and alpha.
    fn segment(&self, s_f: f32, s_b: f32, length: f32) -> [f32; 4] {
        let range = [s_f.min(s_b), s_f.max(s_b)].map(|s| piece_at(&self.pieces, s));
        integrate(&self.pieces, range, Weights::Direct, s_f, s_b, length)
    }
}

/// Premultiplied colour and alpha over (`s_f`, `s_b`, l).
pub(crate) fn pre_integrated(
    axes: &[Axis],
    transfer: &TransferSpec,
    construction: Construction,
) -> Result<Vec<f32>, SpecError> {
    let integrator = Integrator::new(transfer)?;
    let [nx, ny, nz] = [0, 1, 2].map(|axis: usize| axes[axis].nodes as usize);
    let lengths = values(&axes[2]);
    if construction == Construction::Exact {
        let slices = lengths.iter().map(|&l| exact_slice(&integrator, [nx, ny], l as f32));
        return Ok(slices.flatten().flatten().collect());
    }
    let logarithmic = matches!(axes[2].map, crate::AxisMap::Logarithm { .. });
    let mut texels: Vec<[f32; 4]> = Vec::with_capacity(nx * ny * nz);
    texels.resize(nx * ny, [0.0; 4]);
    let first = exact_slice(&integrator, [nx, ny], lengths[1] as f32);
    texels.extend_from_slice(&first);
    for k in 2..nz {
        let last = &texels[(k - 1) * nx * ny..];
        // The front part is one first slice of k, or half of the segment where slices double.
        let next = if logarithmic { compose(last, last, nx, 0.5) } else { compose(&first, last, nx, 1.0 / k as f32) };
        texels.extend_from_slice(&next);
    }
    Ok(texels.into_iter().flatten().collect())
}

fn exact_slice(integrator: &Integrator, [nx, ny]: [usize; 2], length: f32) -> Vec<[f32; 4]> {
    let texel = |index: usize| integrator.segment(scalar(index % nx, nx), scalar(index / nx, ny), length);
    (0..nx * ny).into_par_iter().with_min_len(nx).map(texel).collect()
}

/// The slice of segments whose front `share` is taken from `front` and whose rest from `back`, n x n texels each:
/// C = `C_front` + (1 - `alpha_front`) `C_back`, the scalar in between interpolated linearly.
fn compose(front: &[[f32; 4]], back: &[[f32; 4]], n: usize, share: f32) -> Vec<[f32; 4]> {
    let mut slice = vec![[0.0; 4]; n * n];
    slice.par_chunks_mut(n).enumerate().for_each(|(j, row)| {
        for (i, texel) in row.iter_mut().enumerate() {
            let middle = i as f32 + (j as f32 - i as f32) * share;
            let low = (middle as usize).min(n - 2);
            let t = middle - low as f32;
            let (f0, f1) = (front[low * n + i], front[(low + 1) * n + i]);
            let (b0, b1) = (back[j * n + low], back[j * n + low + 1]);
            let f: [f32; 4] = std::array::from_fn(|c| f0[c] + (f1[c] - f0[c]) * t);
            let through = 1.0 - f[3];
            *texel = std::array::from_fn(|c| f[c] + through * (b0[c] + (b1[c] - b0[c]) * t));
        }
    });
    slice
}

/// The integral of the extinction from the range's lower end: its differences give mean extinctions without a table
/// of two axes.
struct RunningExtinction {
    /// Normalised scalars at which it changes its quadratic, ascending, 0 and 1 among them.
    stops: Vec<f64>,
    /// Extinction above and below each stop.
    extinction: Vec<[f64; 2]>,
    /// Integral up to each stop.
    integral: Vec<f64>,
}

impl RunningExtinction {
    fn new(function: &TransferFunction, transfer: &TransferSpec) -> Self {
        let [low, high] = transfer.range;
        let mut scalars = function.control_points();
        scalars.retain(|s| (low..=high).contains(s));
        scalars.extend([low, high]);
        scalars.sort_by(f64::total_cmp);
        scalars.dedup();
        let scale = 1.0 / transfer.unit_distance;
        let at = |&s: &f64| [function.opacity(s) * scale, function.opacity_below(s) * scale];
        let extinction: Vec<[f64; 2]> = scalars.iter().map(at).collect();
        let stops: Vec<f64> = scalars.iter().map(|s| (s - low) / (high - low)).collect();
        let mut integral = vec![0.0];
        for i in 1..stops.len() {
            let mean = 0.5 * (extinction[i - 1][0] + extinction[i][1]);
            integral.push(integral[i - 1] + mean * (stops[i] - stops[i - 1]));
        }
        Self { stops, extinction, integral }
    }

    /// Extinction from above and integral up to s, in [0, 1].
    fn at(&self, s: f64) -> [f64; 2] {
        let i = self.stops.partition_point(|&stop| stop <= s).clamp(1, self.stops.len() - 1) - 1;
        let along = s - self.stops[i];
        let slope = (self.extinction[i + 1][1] - self.extinction[i][0]) / (self.stops[i + 1] - self.stops[i]);
        let extinction = self.extinction[i][0] + slope * along;
        [extinction, self.integral[i] + 0.5 * along * (self.extinction[i][0] + extinction)]
    }

    /// Mean extinction between two normalised scalars.
    fn mean(&self, s_f: f64, s_b: f64) -> f64 {
        let ([tau, front], [_, back]) = (self.at(s_f), self.at(s_b));
        if s_f == s_b { tau } else { ((back - front) / (s_b - s_f)).max(0.0) }
    }
}

/// Mean extinction over (`s_f`, `s_b`).
pub(crate) fn mean_extinction(axes: &[Axis], transfer: &TransferSpec) -> Result<Vec<f32>, SpecError> {
    let running = RunningExtinction::new(&transfer.function()?, transfer);
    let [nx, ny] = [0, 1].map(|axis: usize| axes[axis].nodes as usize);
    let mean = |index: usize| running.mean(f64::from(scalar(index % nx, nx)), f64::from(scalar(index / nx, ny)));
    Ok((0..nx * ny).into_par_iter().map(|index| mean(index).min(f64::from(f32::MAX)) as f32).collect())
}

/// Colour / alpha over (`s_f`, `s_b`, 1-(1+mu l)^(-1/4)).
///
/// Where there is no extinction between the scalars the ratio has no limit; the mean of the ends' luminances is
/// stored, and what it is multiplied with is 0.
pub(crate) fn color_ratio(axes: &[Axis], transfer: &TransferSpec) -> Result<Vec<f32>, SpecError> {
    let function = transfer.function()?;
    let integrator = Integrator::new(transfer)?;
    let running = RunningExtinction::new(&function, transfer);
    let [nx, ny, nz] = [0, 1, 2].map(|axis: usize| axes[axis].nodes as usize);
    let depths: Vec<f32> = values(&axes[2]).into_iter().map(|x| (x as f32).max(THIN)).collect();
    let luminance: Vec<[f32; 3]> = (0..nx.max(ny))
        .flat_map(|i| [(i, nx), (i, ny)])
        .map(|(i, n)| {
            let [low, high] = transfer.range;
            let s = low + (high - low) * f64::from(scalar(i.min(n - 1), n));
            function.luminance(s).map(|c| c.min(f64::from(f32::MAX)) as f32)
        })
        .collect();
    let texel = |index: usize| -> [f32; 3] {
        let (i, j, k) = (index % nx, index / nx % ny, index / (nx * ny));
        let (s_f, s_b) = (scalar(i, nx), scalar(j, ny));
        let mean = running.mean(f64::from(s_f), f64::from(s_b));
        let length = (f64::from(depths[k]) / mean) as f32;
        if mean > 0.0 && length.is_finite() {
            let [r, g, b, alpha] = integrator.segment(s_f, s_b, length);
            if alpha > 0.0 {
                return [r / alpha, g / alpha, b / alpha];
            }
        }
        let (front, back) = (luminance[2 * i], luminance[2 * j + 1]);
        std::array::from_fn(|c| 0.5 * (front[c] + back[c]))
    };
    Ok((0..nx * ny * nz)
        .into_par_iter()
        .with_min_len(nx)
        .map(texel)
        .collect::<Vec<_>>()
        .into_iter()
        .flatten()
        .collect())
}
