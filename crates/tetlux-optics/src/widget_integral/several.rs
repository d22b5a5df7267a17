//! Several widgets at once: exact optical depth, colour by sub-segments.

use super::{RaySegment, clip, optical_depth};
use crate::emission::EmissionConvention;
use crate::segment::{SegmentResult, clean, psi, weights};
use crate::widget::BivariateFunction;

/// The integral along a segment on which both scalars are linear; inputs as in [`optical_depth`].
///
/// Extinctions add, so transmittance and alpha are exact. The colour has no closed form: the segment is cut where it
/// enters or leaves a support, and the parts into about `pieces` equal sub-segments in all (0 counts as 1). In each the
/// optical depth is exact, the luminance linear between the extinction-weighted colours at its ends, and so is the
/// extinction but for its scale. The colour's error falls with the square of the number of pieces; with emission and
/// absorption there is none where all widgets have one colour. As an emission density (Song et al. 2009) a widget's
/// colour is emitted all over its support.
pub fn bivariate_segment(
    function: &BivariateFunction,
    unit_distance: f64,
    ray: &RaySegment,
    pieces: usize,
    convention: EmissionConvention,
) -> SegmentResult {
    let mut depth = 0.0_f64;
    let mut color = [0.0; 3];
    let cuts = if ray.is_finite() { cuts(function, ray) } else { Vec::new() };
    for ends in cuts.windows(2) {
        let width = ends[1] - ends[0];
        let count = ((pieces.max(1) as f64) * width).ceil().max(1.0) as usize;
        for index in 0..count {
            let [from, to] = [index, index + 1].map(|i| match i {
                i if i == count => ends[1],
                i => ends[0] + width * (i as f64 / count as f64),
            });
            let part = RaySegment { front: ray.at(from), back: ray.at(to), length: ray.length * (to - from) };
            let piece = integrate(function, unit_distance, &part, convention);
            let transmittance = (-depth).exp();
            for channel in 0..3 {
                color[channel] += transmittance * piece.color[channel];
            }
            depth += piece.depth;
        }
    }
    let depth = function.widgets.iter().map(|widget| optical_depth(widget, unit_distance, ray)).sum::<f64>();
    SegmentResult { transmittance: (-depth).exp(), alpha: -(-depth).exp_m1(), color }
}

/// Normalised distances at which extinction may jump, both ends included, ascending.
fn cuts(function: &BivariateFunction, ray: &RaySegment) -> Vec<f64> {
    let supports = function.widgets.iter().filter_map(|widget| widget.support());
    let mut cuts: Vec<f64> =
        supports.filter_map(|rectangle| clip(rectangle, ray)).flatten().chain([0.0, 1.0]).collect();
    cuts.sort_by(f64::total_cmp);
    cuts.dedup();
    cuts
}

struct Part {
    depth: f64,
    color: [f64; 3],
}

/// A part on which no widget begins or ends.
fn integrate(
    function: &BivariateFunction,
    unit_distance: f64,
    ray: &RaySegment,
    convention: EmissionConvention,
) -> Part {
    let middle = ray.at(0.5);
    // Summed over the widgets that are here: optical depth, extinction at the ends, each with the colours it weights.
    let (mut depth, mut depth_color) = (0.0, [0.0; 3]);
    let (mut ends, mut end_colors) = ([0.0; 2], [[0.0; 3]; 2]);
    let mut density = [0.0; 3];
    for widget in function.widgets.iter().filter(|widget| widget.contains(middle)) {
        let widget_everywhere = widget.unbounded();
        let own = optical_depth(&widget_everywhere, unit_distance, ray);
        depth += own;
        let at_ends = [ray.front, ray.back].map(|point| widget_everywhere.opacity(point));
        for channel in 0..3 {
            let color = widget.color()[channel];
            depth_color[channel] += own * color;
            density[channel] += color;
            for end in 0..2 {
                end_colors[end][channel] += at_ends[end] * color;
            }
        }
        for end in 0..2 {
            ends[end] += at_ends[end];
        }
    }
    let depth = clean(depth);
    // Extinctions at the ends, scaled so that their mean gives the exact depth; alike where neither end has any.
    let total = ends[0] + ends[1];
    let [b, a] = ends.map(|end| if total > 0.0 { 2.0 * depth * (end / total) } else { depth });
    if convention == EmissionConvention::EmissionDensity {
        let seen = ray.length * psi(a, b);
        return Part { depth, color: density.map(|emission| emission * seen) };
    }
    let weights = weights(a, b);
    let color = std::array::from_fn(|channel| {
        let [front, back] = [0, 1].map(|end| {
            if ends[end] > 0.0 {
                end_colors[end][channel] / ends[end]
            } else if depth > 0.0 {
                depth_color[channel] / depth
            } else {
                0.0
            }
        });
        front * weights.front + back * weights.back
    });
    Part { depth, color }
}
