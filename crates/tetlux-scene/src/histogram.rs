//! How much of a mesh lies where in the plane of its two scalars: what widgets are placed by.

use rayon::prelude::*;
use tetlux_image::{Image, ImageError};
use tetlux_mesh::{Location, ScalarField, TetMesh};
use tetlux_optics::Classification;

use crate::SceneError;

mod plot;

#[cfg(test)]
mod tests;

/// Most bins along an axis.
pub const MAX_BINS: usize = 4096;

/// Sampling of a cell stops at this many points along an edge.
const FINEST: usize = 16;

/// Bins by which rounding may put a value past the end of its own range.
const ROUNDING: f64 = 1e-6;

/// Brightness of the least volume that is drawn, as a power of ten below the largest.
const DECADES: f64 = 8.0;

/// Volumes over a grid of bins.
#[derive(Debug, Clone, PartialEq)]
pub struct Histogram {
    /// World volume in every bin, row by row, the row of the lowest second scalar first.
    pub volumes: Vec<f64>,
    /// Bins along each axis.
    pub bins: [usize; 2],
    /// What the bins span along each axis.
    pub range: [[f64; 2]; 2],
    /// Volume of the cells without data.
    pub without_data: f64,
    /// Volume whose values lie outside the range.
    pub outside: f64,
}

impl Histogram {
    /// The volume-weighted histogram of a mesh over two of its scalars, each over the range given, else its own.
    ///
    /// A cell is sampled at the points of a regular lattice inside, each with an equal share of its volume, twice as
    /// many along an edge as the cell spans bins, 4 to 16: so a cell in one bin is exact, one that spans many is good to
    /// some percent a bin, and the sum of all bins is the mesh's volume but for rounding. The same for any number of
    /// threads.
    ///
    /// # Errors
    ///
    /// A number of bins of 0 or above [`MAX_BINS`], a scalar that is not this mesh's.
    pub fn new(
        mesh: &TetMesh,
        scalars: [&ScalarField; 2],
        given: [Option<[f64; 2]>; 2],
        bins: [usize; 2],
    ) -> Result<Histogram, SceneError> {
        if bins.iter().any(|n| !(1..=MAX_BINS).contains(n)) {
            return Err(SceneError::Method(format!("{bins:?} bins: each axis takes 1 to {MAX_BINS}")));
        }
        for scalar in scalars {
            let expected = match scalar.location {
                Location::Point => mesh.points().len(),
                Location::Cell => mesh.cells().len(),
            };
            if scalar.values.len() != expected {
                return Err(SceneError::Method(format!("the field \"{}\" belongs to another mesh", scalar.name)));
            }
        }
        if let Some([low, high]) =
            given.into_iter().flatten().find(|[low, high]| low >= high || !(high - low).is_finite())
        {
            return Err(SceneError::Method(format!("the range {low} to {high} must ascend and be finite")));
        }
        let range = [0, 1].map(|axis| {
            let [low, high] = scalars[axis].range;
            given[axis].unwrap_or(if low < high { [low, high] } else { [low - 0.5, low + 0.5] })
        });
        let lattices: Vec<Vec<[f64; 4]>> = (0..=FINEST).map(lattice).collect();
        // Chunks of fixed size, summed in their order: threads change nothing.
        let size = mesh.cells().len().div_ceil(32).max(1);
        let parts: Vec<(Vec<f64>, [f64; 2])> = mesh
            .cells()
            .par_chunks(size)
            .enumerate()
            .map(|(chunk, cells)| {
                let (mut volumes, mut missing, mut outside) = (vec![0.0; bins[0] * bins[1]], 0.0, 0.0);
                for (k, cell) in cells.iter().enumerate() {
                    let volume = volume_of(mesh, cell);
                    let values = scalars.map(|scalar| match scalar.location {
                        Location::Point => cell.map(|v| scalar.values[v as usize]),
                        Location::Cell => [scalar.values[chunk * size + k]; 4],
                    });
                    if values.as_flattened().iter().any(|v| !v.is_finite()) {
                        missing += volume;
                        continue;
                    }
                    // In units of bins.
                    let places = [0, 1].map(|axis| {
                        let [low, high] = range[axis];
                        values[axis].map(|v| (v - low) / (high - low) * bins[axis] as f64)
                    });
                    let span = places.map(|p| {
                        p.iter().copied().fold(f64::NEG_INFINITY, f64::max)
                            - p.iter().copied().fold(f64::INFINITY, f64::min)
                    });
                    let points = &lattices[(2 * span[0].max(span[1]).ceil() as usize + 2).clamp(4, FINEST)];
                    let share = volume / points.len() as f64;
                    for weights in points {
                        let at = [0, 1].map(|axis| (0..4).map(|v| weights[v] * places[axis][v]).sum::<f64>());
                        if (0..2).any(|axis| at[axis] < -ROUNDING || at[axis] > bins[axis] as f64 + ROUNDING) {
                            outside += share;
                            continue;
                        }
                        let [i, j] = [0, 1].map(|axis| (at[axis].max(0.0) as usize).min(bins[axis] - 1));
                        volumes[j * bins[0] + i] += share;
                    }
                }
                (volumes, [missing, outside])
            })
            .collect();
        let mut histogram =
            Histogram { volumes: vec![0.0; bins[0] * bins[1]], bins, range, without_data: 0.0, outside: 0.0 };
        for (volumes, [missing, outside]) in parts {
            for (sum, volume) in histogram.volumes.iter_mut().zip(volumes) {
                *sum += volume;
            }
            histogram.without_data += missing;
            histogram.outside += outside;
        }
        Ok(histogram)
    }

    /// Brightness of a bin on a logarithmic scale: 1 for the largest volume, 0 for 1e-8 of it or less.
    pub fn level(&self, column: usize, row: usize) -> f64 {
        let largest = self.volumes.iter().copied().fold(0.0, f64::max);
        let volume = self.volumes[row * self.bins[0] + column];
        if volume > 0.0 { (1.0 + (volume / largest).log10() / DECADES).max(0.0) } else { 0.0 }
    }

    /// Values of the two scalars in the middle of a bin.
    pub fn center(&self, column: usize, row: usize) -> [f64; 2] {
        let at = |axis: usize, k: usize| {
            let [low, high] = self.range[axis];
            low + (high - low) * (k as f64 + 0.5) / self.bins[axis] as f64
        };
        [at(0, column), at(1, row)]
    }

    /// A pixel a bin, the second scalar upwards: the histogram in grey, over it the classification in its colours.
    ///
    /// # Errors
    ///
    /// [`ImageError`] if there is no memory for the picture.
    pub fn picture(&self, classification: &Classification) -> Result<Image, ImageError> {
        let [width, height] = self.bins;
        let centers = (0..width * height).map(|k| self.center(k % width, k / width));
        let most = centers.map(|c| classification.opacity(c)).fold(0.0, f64::max);
        let largest = self.volumes.iter().copied().fold(0.0, f64::max);
        let mut pixels = Vec::with_capacity(width * height);
        for row in (0..height).rev() {
            for column in 0..width {
                let volume = self.volumes[row * width + column];
                let level = if volume > 0.0 { (1.0 + (volume / largest).log10() / DECADES).max(0.0) } else { 0.0 };
                let grey = 0.004 + 0.7 * level * level;
                let center = self.center(column, row);
                // Faint ones are seen too.
                let share = if most > 0.0 { 0.75 * (classification.opacity(center) / most).sqrt() } else { 0.0 };
                let color = classification.luminance(center);
                let mix = |c: usize| (grey * (1.0 - share) + color[c].min(1.0) * share * (0.2 + 0.8 * level)) as f32;
                pixels.push([mix(0), mix(1), mix(2), 1.0]);
            }
        }
        Image::from_pixels(width as u32, height as u32, pixels)
    }
}

/// The middles of the upright ones among the n^3 like tetrahedra of a tetrahedron cut n times, in its barycentric
/// coordinates: a lattice that lies evenly about its middle.
fn lattice(n: usize) -> Vec<[f64; 4]> {
    let n = n.max(1);
    let mut points = Vec::new();
    for i in 0..n {
        for j in 0..n - i {
            for k in 0..n - i - j {
                let l = n - 1 - i - j - k;
                points.push([i, j, k, l].map(|index| (index as f64 + 0.25) / n as f64));
            }
        }
    }
    points
}

fn volume_of(mesh: &TetMesh, cell: &[u32; 4]) -> f64 {
    let p = cell.map(|v| mesh.points()[v as usize].as_dvec3());
    (p[1] - p[0]).cross(p[2] - p[0]).dot(p[3] - p[0]).abs() / 6.0
}
