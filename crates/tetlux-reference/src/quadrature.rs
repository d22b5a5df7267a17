//! Adaptive quadrature of the emission-absorption integral along the segments of a ray.

use glam::DVec3;
use tetlux_optics::NoData;

use crate::definition::{Definition, Inside, Sight};
use crate::rule::Rule;
use crate::walk::Segment;

/// A panel with more optical depth is halved without asking the rules: what lies behind its front would be hidden
/// from all their nodes.
const MOST_DEPTH: f64 = 2.0;
/// A panel is halved at most so often: 2^-60 of a segment, where only rounding is left.
const MOST_HALVINGS: u32 = 60;
/// Two results that differ by this share of their size agree: rounding allows no more.
const ROUNDING: f64 = 8.0 * f64::EPSILON;
/// What is hidden behind the ray's opacity is left out once it is below this share of the tolerance.
const HIDDEN: f64 = 1e-3;

/// What has been gathered along a ray, front to back.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Gathered {
    pub(crate) color: [f64; 3],
    pub(crate) optical_depth: f64,
    /// Points at which the transfer function was asked.
    pub(crate) evaluations: usize,
}

/// A segment between two neighbouring cuts.
struct Layer {
    segment: Segment,
    inside: Inside,
}

/// The integral over a panel as one rule sees it, light weighted by the transmittance from the panel's front.
#[derive(Clone, Copy)]
struct Estimate {
    color: [f64; 3],
    depth: f64,
    /// By how much the extinctions differ that it saw.
    spread: f64,
}

/// Buffers that a thread uses again and again.
#[derive(Default)]
pub(crate) struct Workspace {
    ends: Vec<f64>,
    active: Vec<Segment>,
    cuts: Vec<f64>,
    shares: Vec<f64>,
    layers: Vec<Layer>,
}

/// The integrator of one classification.
///
/// Cuts where it is not smooth (control points, edges and kinks of widgets) leave panels on which the functions are smooth; it assumes no more. On a panel the
/// optical depth at the nodes is the integral of the polynomial through the extinctions. Gauss-Legendre rules of 3
/// and 5, then 5 and 8 points are compared; where they differ by more than the panel's share of the tolerance,
/// which is its share of the ray's length in the mesh, it is halved.
pub(crate) struct Integrator<'a> {
    definition: Definition<'a>,
    /// The brightest luminance, at least 1: what an error of the transmittance may cost.
    brightest: f64,
    tolerance: f64,
    rules: (Rule<3>, Rule<5>, Rule<8>),
}

/// One ray's scales, and how it sees.
#[derive(Clone, Copy)]
struct Scales {
    sight: Sight,
    /// Extinction per parameter, of opacity 1.
    extinction: f64,
    /// Error allowed per parameter.
    error: f64,
}

impl<'a> Integrator<'a> {
    pub(crate) fn new(definition: Definition<'a>, tolerance: f64) -> Self {
        let brightest = definition.brightest();
        Self { definition, brightest, tolerance, rules: (Rule::new(), Rule::new(), Rule::new()) }
    }

    /// The same with cells without data seen.
    pub(crate) fn with_no_data(mut self, no_data: NoData) -> Self {
        self.definition.no_data = no_data;
        Self::new(self.definition, self.tolerance)
    }

    /// How a ray of this direction sees.
    pub(crate) fn sight(&self, direction: DVec3) -> Sight {
        self.definition.sight(direction)
    }

    /// Integrates over segments in ascending order of their starts. `extinction` is that of opacity 1, per parameter.
    /// Where segments overlap, extinctions and emissions add.
    pub(crate) fn integrate(
        &self,
        segments: &[Segment],
        extinction: f64,
        sight: Sight,
        work: &mut Workspace,
    ) -> Gathered {
        let length: f64 = segments.iter().map(|s| s.t[1] - s.t[0]).sum();
        let scales = Scales { sight, extinction, error: self.tolerance / length };
        let mut gathered = Gathered::default();
        if segments.is_sorted_by(|a, b| a.t[1] <= b.t[0]) {
            for segment in segments {
                self.stretch(segment.t, std::slice::from_ref(segment), scales, work, &mut gathered);
            }
            return gathered;
        }
        let mut ends = std::mem::take(&mut work.ends);
        let mut active = std::mem::take(&mut work.active);
        ends.clear();
        ends.extend(segments.iter().flat_map(|s| s.t));
        ends.sort_unstable_by(f64::total_cmp);
        ends.dedup();
        active.clear();
        let mut waiting = segments.iter().peekable();
        for end in ends.windows(2) {
            active.retain(|s| s.t[1] > end[0]);
            while let Some(segment) = waiting.next_if(|s| s.t[0] <= end[0]) {
                active.push(*segment);
            }
            self.stretch([end[0], end[1]], &active, scales, work, &mut gathered);
        }
        (work.ends, work.active) = (ends, active);
        gathered
    }

    /// Integrates over an interval that every one of `segments` covers.
    fn stretch(
        &self,
        [from, to]: [f64; 2],
        segments: &[Segment],
        scales: Scales,
        work: &mut Workspace,
        sum: &mut Gathered,
    ) {
        if segments.is_empty() || self.hidden(sum) {
            return;
        }
        let Workspace { cuts, shares, layers, .. } = work;
        cuts.clear();
        cuts.push(from);
        for segment in segments {
            shares.clear();
            self.definition.cuts(segment, &scales.sight, shares);
            let place = |share: f64| segment.t[0] + (segment.t[1] - segment.t[0]) * share;
            cuts.extend(shares.iter().map(|&share| place(share)).filter(|&t| from < t && t < to));
        }
        cuts.push(to);
        if cuts.len() > 2 {
            cuts.sort_unstable_by(f64::total_cmp);
        }
        for i in 1..cuts.len() {
            let panel = [cuts[i - 1], cuts[i]];
            if panel[0] < panel[1] {
                let middle = 0.5 * (panel[0] + panel[1]);
                layers.clear();
                layers.extend(segments.iter().map(|&segment| {
                    let inside = self.definition.inside(&segment.at(middle));
                    Layer { segment, inside }
                }));
                self.panel(layers, panel, scales, 0, sum);
            }
        }
    }

    fn panel(&self, layers: &[Layer], [a, b]: [f64; 2], scales: Scales, halvings: u32, sum: &mut Gathered) {
        if self.hidden(sum) {
            return;
        }
        let best = self.estimate(&self.rules.1, layers, [a, b], scales, sum);
        if best.depth == 0.0 {
            return;
        }
        let transmittance = (-sum.optical_depth).exp();
        let allowed = scales.error * (b - a);
        let place = place_rounding(layers, b);
        let mut accepted = None;
        if best.depth <= MOST_DEPTH || halvings == MOST_HALVINGS {
            let rough = self.estimate(&self.rules.0, layers, [a, b], scales, sum);
            if halvings == MOST_HALVINGS || self.agree(&rough, &best, transmittance, allowed, place) {
                accepted = Some(best);
            } else {
                let finer = self.estimate(&self.rules.2, layers, [a, b], scales, sum);
                accepted = self.agree(&best, &finer, transmittance, allowed, place).then_some(finer);
            }
        }
        match accepted {
            Some(Estimate { color, depth, .. }) => {
                for channel in 0..3 {
                    sum.color[channel] += transmittance * color[channel];
                }
                sum.optical_depth += depth;
            }
            None => {
                let middle = 0.5 * (a + b);
                self.panel(layers, [a, middle], scales, halvings + 1, sum);
                self.panel(layers, [middle, b], scales, halvings + 1, sum);
            }
        }
    }

    /// Whether two estimates differ by no more than is allowed, or than rounding explains: of the results, and, where the
    /// extinction is steep, of places by `place`.
    fn agree(&self, rough: &Estimate, fine: &Estimate, transmittance: f64, allowed: f64, place: f64) -> bool {
        let depth_error = self.brightest * (fine.depth - rough.depth).abs();
        let light = fine.color.iter().fold(0.0, |m: f64, &c| m.max(c));
        let light_error = (0..3).map(|c| (fine.color[c] - rough.color[c]).abs()).fold(0.0, f64::max);
        let rounding = ROUNDING * (light + self.brightest * fine.depth) + self.brightest * fine.spread * place;
        transmittance * (light_error + depth_error) <= allowed.max(transmittance * rounding)
    }

    fn estimate<const N: usize>(
        &self,
        rule: &Rule<N>,
        layers: &[Layer],
        [a, b]: [f64; 2],
        scales: Scales,
        sum: &mut Gathered,
    ) -> Estimate {
        sum.evaluations += N;
        let mut extinctions = [0.0; N];
        let mut emissions = [[0.0; 3]; N];
        for i in 0..N {
            let t = a + (b - a) * rule.nodes[i];
            for layer in layers {
                let here = self.definition.look_up(&layer.inside, &layer.segment.at(t), &scales.sight);
                extinctions[i] += here.opacity * scales.extinction;
                for channel in 0..3 {
                    emissions[i][channel] += here.emission[channel] * scales.extinction;
                }
            }
        }
        let mut estimate = Estimate { color: [0.0; 3], depth: 0.0, spread: 0.0 };
        if extinctions == [0.0; N] {
            return estimate;
        }
        let [least, most] = extinctions.iter().fold([f64::INFINITY, 0.0], |[l, m]: [f64; 2], &e| [l.min(e), m.max(e)]);
        estimate.spread = most - least;
        for i in 0..N {
            let before: f64 = (0..N).map(|j| rule.running[i][j] * extinctions[j]).sum();
            let weight = rule.weights[i] * (b - a);
            estimate.depth += weight * extinctions[i];
            let seen = weight * (-(b - a) * before).exp();
            for channel in 0..3 {
                estimate.color[channel] += seen * emissions[i][channel];
            }
        }
        estimate
    }

    /// Whether nothing that is still to come can be seen.
    fn hidden(&self, sum: &Gathered) -> bool {
        sum.optical_depth > 1.0 && (-sum.optical_depth).exp() * self.brightest < HIDDEN * self.tolerance
    }
}

/// By how much rounding moves a place on a line: that of its parameter `t`, and that of scalars over how fast they change.
fn place_rounding(layers: &[Layer], t: f64) -> f64 {
    let of_scalars = layers.iter().flat_map(|Layer { segment, .. }| {
        let [front, back] = segment.values;
        let length = segment.t[1] - segment.t[0];
        [0, 1].map(|axis| {
            // Halves, so that the difference of two large scalars does not overflow.
            let change = (0.5 * back[axis] - 0.5 * front[axis]).abs();
            let size = 0.5 * front[axis].abs().max(back[axis].abs());
            if change > 0.0 { length * (size / change) } else { 0.0 }
        })
    });
    ROUNDING * of_scalars.fold(t.abs(), f64::max)
}

#[cfg(test)]
mod tests;
