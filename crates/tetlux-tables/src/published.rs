//! Segments through two fields as Song et al. 2009 published them, in f32, function by function, as a shader has them.
//!
//! A widget's colour is an emission density: light per unit distance wherever the widget is, whatever its opacity
//! ([`tetlux_optics::EmissionConvention::EmissionDensity`]). What is not opaque glows all the same, and the reference,
//! which has emission-absorption, shows another picture. Each widget is limited to a rectangle, a Gaussian to 3 sigma
//! ([`tetlux_optics::BivariateFunction::as_published`]).
//!
//! [`analytic`] (section 4) has one widget at a time and one peak along a segment. Uniform: a closed form. Gaussian:
//! `exp(P erf t0) (table(P, t1) - table(P, t0)) / A`. Triangle: a rising ramp by the difference of two erf, a falling one
//! by its table. Sine: its table. The tables end at P, M and A of 10; beyond, where the profile hardly changes along a
//! segment that is not opaque, it counts as even, as the paper has it where nothing changes at all. The optical depth is
//! exact. Parts behind the second peak are left out.
//!
//! [`approximate`] (section 5) has equal pieces, classified at their ends, and the table of F and B.

#[cfg(test)]
mod tests;

use std::f32::consts::PI;

use tetlux_optics::published_f32::psi_published;
use tetlux_optics::segment_f32::opacity;
use tetlux_optics::widget_f32::{
    GAUSSIAN, TRIANGLE, Track, UNIFORM, Widget, inside, next_kink, track, track_depth, track_rate,
};

use crate::lookup::{sample_front_back, sample_gaussian, sample_sine, sample_triangle};
use crate::spec::TableKind;
use crate::table::Table;

/// A segment up to its second peak has four parts between kinks at most; f32 may add slivers.
const MOST_PARTS: u32 = 6;

/// The tables of [`analytic`]: those named `gaussian`, `sine` and `triangle`.
#[derive(Clone, Copy, Debug)]
pub struct WidgetTables<'a> {
    /// A [`TableKind::Gaussian`].
    pub gaussian: &'a Table,
    /// A [`TableKind::Sine`].
    pub sine: &'a Table,
    /// A [`TableKind::Triangle`].
    pub triangle: &'a Table,
}

/// Where the second axis of strengths ends, or the first.
fn largest(table: &Table) -> f32 {
    match table.spec().kind {
        TableKind::Gaussian { max_p: max, .. }
        | TableKind::Sine { max_m: max }
        | TableKind::Triangle { max_a: max } => max as f32,
        _ => 0.0,
    }
}

/// Mean transmittance to the front of even extinction.
fn even(depth: f32) -> f32 {
    if depth < 1e-6 {
        return 1.0;
    }
    opacity(depth) / depth
}

/// Mean transmittance from the part [u, end] of a track to its front, on which it has no kink; `depth` is its own.
fn visible(tables: &WidgetTables, track: &Track, u: f32, end: f32, depth: f32) -> f32 {
    let p0 = track.start + track.step * u;
    let p1 = track.start + track.step * end;
    let step = track.step.abs();
    let travel = (p1 - p0).abs();
    if track.kind == UNIFORM || travel < 1e-6 || depth <= 0.0 {
        return even(depth);
    }
    if track.kind == GAUSSIAN {
        let p = 0.88622695 * track.scale / step;
        if p > largest(tables.gaussian) {
            return even(depth);
        }
        return sample_gaussian(tables.gaussian, p, p0, p1) / travel;
    }
    // The lobe, by the middle: an end may lie on its rim.
    let lobe = (0.5 * (p0 + p1)).floor();
    let [q0, q1] = [(p0 - lobe).clamp(0.0, 1.0), (p1 - lobe).clamp(0.0, 1.0)];
    // From the front, phases ascend: a lobe is the same from either side.
    let [q0, q1] = if track.step < 0.0 { [1.0 - q0, 1.0 - q1] } else { [q0, q1] };
    if track.kind == TRIANGLE {
        let strength = 0.5 * track.scale / step;
        if strength > largest(tables.triangle) {
            return even(depth);
        }
        if q0 + q1 < 1.0 {
            return psi_published(track_rate(track, end) * (end - u), track_rate(track, u) * (end - u));
        }
        return sample_triangle(tables.triangle, strength, 2.0 * q0 - 1.0, 2.0 * q1 - 1.0) / (2.0 * travel);
    }
    let strength = track.scale / (PI * step);
    if strength > largest(tables.sine) {
        return even(depth);
    }
    sample_sine(tables.sine, strength, PI * q0, PI * q1) / (PI * travel)
}

/// Where a track comes to its second peak beyond u; 2 if it has none.
fn second_peak(track: &Track, u: f32) -> f32 {
    if track.kind == UNIFORM || track.kind == GAUSSIAN || track.step.abs() < 1e-6 {
        return 2.0;
    }
    let p = track.start + track.step * u;
    if track.step > 0.0 {
        return ((p - 0.5).floor() + 2.5 - track.start) / track.step;
    }
    ((p - 0.5).ceil() - 1.5 - track.start) / track.step
}

/// Of one widget alone along a segment: the transmittance to the front integrated over it, as a share of the segment, and
/// the optical depth.
fn alone(tables: &WidgetTables, widget: &Widget, front: [f32; 2], back: [f32; 2], length: f32) -> [f32; 2] {
    let [from, to] = inside(widget, front, back);
    let track = track(widget, front, back, length);
    let last = second_peak(&track, from).min(to);
    let mut share = 0.0_f32;
    let mut depth = 0.0_f32;
    let mut u = from;
    for _ in 0..MOST_PARTS {
        if u >= last {
            break;
        }
        let end = next_kink(&track, u).max(u + 1e-6).min(last);
        let own = track_depth(&track, u, end);
        // Where the published forms cancel they give anything.
        share += (-depth).exp() * (end - u) * visible(tables, &track, u, end, own).clamp(0.0, 1.0);
        depth += own;
        u = end;
    }
    [share, depth]
}

/// Colour and alpha of a segment by the analytic integrals; `length` is in device units, `emission` is unit distances per
/// device unit. Widgets are met one after the other, each as if it were alone.
pub fn analytic(
    tables: &WidgetTables,
    widgets: &[Widget],
    front: [f32; 2],
    back: [f32; 2],
    length: f32,
    emission: f32,
) -> [f32; 4] {
    let mut result = [0.0; 4];
    let mut last = -1.0;
    let mut after = 0;
    for _ in 0..widgets.len() {
        // The next widget that the segment enters; of several that it enters at one place in their order.
        let mut next = 0;
        let mut entry = 2.0;
        for i in 0..widgets.len() {
            let [from, to] = inside(&widgets[i], front, back);
            if from < to && from < entry && (from > last || (from == last && i >= after)) {
                next = i;
                entry = from;
            }
        }
        if entry > 1.0 {
            break;
        }
        let [share, depth] = alone(tables, &widgets[next], front, back, length);
        let light = (1.0 - result[3]) * share * length * emission;
        for channel in 0..3 {
            result[channel] += light * widgets[next].color[channel];
        }
        result[3] += (1.0 - result[3]) * opacity(depth);
        last = entry;
        after = next + 1;
    }
    result
}

/// Colour and alpha of a segment in `count` equal pieces, each of which is as if colour and extinction were linear between
/// its ends, where `classify` gives them. `table` is one of F and B; `unit` is the length in device units that is 1 in it,
/// no piece being longer; the others as of [`analytic`].
pub fn approximate(
    table: &Table,
    classify: impl Fn([f32; 2]) -> [f32; 4],
    front: [f32; 2],
    back: [f32; 2],
    length: f32,
    emission: f32,
    count: u32,
    unit: f32,
) -> [f32; 4] {
    let part = length / count as f32;
    let mut result = [0.0; 4];
    let mut near = classify(front);
    for k in 1..=count {
        let u = k as f32 / count as f32;
        let far = classify([front[0] + (back[0] - front[0]) * u, front[1] + (back[1] - front[1]) * u]);
        let [w_f, w_b] = sample_front_back(table, near[3] * unit, far[3] * unit, part / unit);
        let light = (1.0 - result[3]) * unit * emission;
        for channel in 0..3 {
            result[channel] += light * (near[channel] * w_f + far[channel] * w_b);
        }
        result[3] += (1.0 - result[3]) * opacity(0.5 * (near[3] + far[3]) * part);
        near = far;
    }
    result
}
