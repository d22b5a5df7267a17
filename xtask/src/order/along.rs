//! What an order does to the colour along rays, and a picture of it.

use anyhow::Result;
use rayon::prelude::*;
use tetlux_image::Image;
use tetlux_mesh::{Location, NONE, TetMesh};
use tetlux_optics::segment::segment;
use tetlux_optics::transfer::{ColorNode, OpacityNode, TransferFunction};
use tetlux_order::Order;
use tetlux_order::verify::{Interval, Ray, Verification, Verifier};
use tetlux_scene::Scene;

/// Unit distance of the spiky function, as a share of the mesh's diagonal: its peaks act as isosurfaces.
pub(super) const SPIKY_UNIT_DISTANCE: f64 = 0.004;

/// Peaks of the spiky function.
const PEAKS: u32 = 8;

/// Narrow peaks over a scalar's range, neighbours in unlike colours.
pub(super) fn spiky([low, high]: [f64; 2]) -> Result<TransferFunction> {
    const COLORS: [[f64; 3]; 4] = [[1.0, 0.1, 0.1], [0.1, 0.9, 0.2], [0.15, 0.2, 1.0], [1.0, 0.9, 0.1]];
    // A constant field has a range all the same.
    let width = if high > low { high - low } else { 1.0 };
    let mut color = Vec::new();
    let mut opacity = Vec::new();
    for peak in 0..PEAKS {
        let at = |share: f64| low + width * (f64::from(peak) + share) / f64::from(PEAKS);
        color.push(ColorNode { s: at(0.5), rgb: COLORS[peak as usize % COLORS.len()] });
        for (share, height) in [(0.4, 0.0), (0.5, 1.0), (0.6, 0.0)] {
            opacity.push(OpacityNode { s: at(share), opacity: height });
        }
    }
    Ok(TransferFunction::new(color, opacity)?)
}

/// Colours along rays.
pub(super) struct Along<'a> {
    mesh: &'a TetMesh,
    scene: &'a Scene,
    transfer: &'a TransferFunction,
    verifier: &'a Verifier<'a>,
    /// Largest opacity in each cell: nothing where it is zero.
    opacity: Vec<f64>,
}

/// What the order does to the colours of some rays.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct ColorError {
    /// Largest difference of a channel.
    pub(super) max: f64,
    /// Rays that differ by more than the budget.
    pub(super) over: usize,
}

/// A cell's own colour and alpha along a ray.
struct Segment {
    cell: u32,
    color: [f64; 3],
    alpha: f64,
}

impl<'a> Along<'a> {
    pub(super) fn new(
        mesh: &'a TetMesh,
        scene: &'a Scene,
        transfer: &'a TransferFunction,
        verifier: &'a Verifier<'a>,
    ) -> Along<'a> {
        let opacity = mesh
            .scalar_ranges(&scene.scalar)
            .par_iter()
            .map(|&range| if range[0].is_nan() { 0.0 } else { transfer.max_opacity(range) })
            .collect();
        Along { mesh, scene, transfer, verifier, opacity }
    }

    /// The error of every order over the rays.
    pub(super) fn errors(&self, orders: &[&Order], rays: &[Ray]) -> Vec<ColorError> {
        let ranks: Vec<Vec<u32>> = orders.iter().map(|order| ranks(self.mesh, order)).collect();
        let budget = self.scene.method.max_error;
        rays.par_iter()
            .map(|ray| {
                let by_depth = self.segments(ray);
                let truth = composite(by_depth.iter());
                let mut ordered: Vec<&Segment> = by_depth.iter().collect();
                ranks
                    .iter()
                    .map(|rank| {
                        ordered.clear();
                        ordered.extend(by_depth.iter().filter(|s| rank[s.cell as usize] != NONE));
                        // Stable: groups stay sorted by depth.
                        ordered.sort_by_key(|s| rank[s.cell as usize]);
                        let pixel = composite(ordered.iter().copied());
                        let max = (0..4).map(|i| (pixel[i] - truth[i]).abs()).fold(0.0, f64::max);
                        ColorError { max, over: usize::from(max > budget) }
                    })
                    .collect()
            })
            .reduce(
                || vec![ColorError::default(); orders.len()],
                |a: Vec<ColorError>, b| {
                    let join =
                        |(a, b): (ColorError, ColorError)| ColorError { max: a.max.max(b.max), over: a.over + b.over };
                    a.into_iter().zip(b).map(join).collect()
                },
            )
    }

    /// The segments that are seen along a ray, by depth.
    fn segments(&self, ray: &Ray) -> Vec<Segment> {
        let length = ray.direction.length();
        let mut intervals = self.verifier.intervals(ray);
        intervals.retain(|interval| self.opacity[interval.cell as usize] > 0.0);
        let color = |interval: &Interval| {
            let [front, back] = [interval.entry, interval.exit].map(|t| self.scalar(ray, interval.cell, t));
            let span = (interval.exit - interval.entry) * length;
            let through = segment(self.transfer, self.scene.unit_distance, front, back, span);
            Segment { cell: interval.cell, color: through.color, alpha: through.alpha }
        };
        intervals.iter().map(color).collect()
    }

    /// The scalar at a point of a ray inside a cell.
    fn scalar(&self, ray: &Ray, cell: u32, t: f64) -> f64 {
        let scalar = &self.scene.scalar;
        if scalar.location == Location::Cell {
            return scalar.values[cell as usize];
        }
        let vertices = self.mesh.cells()[cell as usize];
        let p = vertices.map(|v| self.mesh.points()[v as usize].as_dvec3());
        let s = vertices.map(|v| scalar.values[v as usize]);
        let x = ray.origin - self.mesh.origin() + ray.direction * t - p[0];
        let [a, b, c] = [p[1] - p[0], p[2] - p[0], p[3] - p[0]];
        let volume = a.cross(b).dot(c);
        let shares = [b.cross(c).dot(x), c.cross(a).dot(x), a.cross(b).dot(x)].map(|d| (d / volume).clamp(0.0, 1.0));
        let sum = s[0] + (0..3).map(|i| shares[i] * (s[i + 1] - s[0])).sum::<f64>();
        // Rounding leaves no cell's own range.
        sum.clamp(s.into_iter().fold(f64::INFINITY, f64::min), s.into_iter().fold(f64::NEG_INFINITY, f64::max))
    }
}

/// For each cell its rank, the same for all of a group; [`NONE`] where it has none.
fn ranks(mesh: &TetMesh, order: &Order) -> Vec<u32> {
    let mut rank = vec![NONE; mesh.cells().len()];
    for (at, &cell) in order.cells.iter().enumerate() {
        rank[cell as usize] = at as u32;
    }
    for group in &order.groups {
        for &cell in &order.cells[group.start as usize..group.end as usize] {
            rank[cell as usize] = group.start;
        }
    }
    rank
}

/// Colour and alpha of segments, front to back.
fn composite<'s>(segments: impl Iterator<Item = &'s Segment>) -> [f64; 4] {
    let mut pixel = [0.0; 4];
    for s in segments {
        let left = 1.0 - pixel[3];
        for (channel, color) in s.color.iter().enumerate() {
            pixel[channel] += left * color;
        }
        pixel[3] += left * s.alpha;
    }
    pixel
}

/// The first cell that each ray meets.
pub(super) fn first_cells(verifier: &Verifier<'_>, rays: &[Ray]) -> Vec<Option<u32>> {
    rays.par_iter().map(|ray| verifier.intervals(ray).first().map(|interval| interval.cell)).collect()
}

/// The first cell of every pixel by its rank, from dark blue to light yellow; red where the order is wrong.
pub(super) fn picture(
    order: &Order,
    found: &Verification,
    first: &[Option<u32>],
    mesh: &TetMesh,
    size: [u32; 2],
) -> Result<Image> {
    let rank = ranks(mesh, order);
    let last = order.cells.len().max(1) as f32;
    let shade_of = |cell: u32| shade(rank[cell as usize] as f32 / last);
    let mut pixels: Vec<[f32; 4]> = first.iter().map(|cell| cell.map_or([0.0, 0.0, 0.0, 1.0], shade_of)).collect();
    for &ray in &found.inverted {
        pixels[ray] = [1.0, 0.02, 0.02, 1.0];
    }
    Ok(Image::from_pixels(size[0], size[1], pixels)?)
}

fn shade(share: f32) -> [f32; 4] {
    const STOPS: [[f32; 3]; 4] = [[0.01, 0.02, 0.12], [0.02, 0.2, 0.35], [0.15, 0.5, 0.3], [0.95, 0.9, 0.55]];
    let at = share.clamp(0.0, 1.0) * (STOPS.len() - 1) as f32;
    let low = (at as usize).min(STOPS.len() - 2);
    let mix = |i: usize| STOPS[low][i] + (STOPS[low + 1][i] - STOPS[low][i]) * (at - low as f32);
    [mix(0), mix(1), mix(2), 1.0]
}
