//! Widgets in f32, function by function, as a shader has them: extinction, exact optical depth, and how fast the
//! extinction varies.
//!
//! Coordinates are normalised by the caller (a field's range to [0, 1]), lengths are in device units. Along a segment
//! each widget is a [`Track`]: a coordinate that is linear, and an extinction that is a fixed function of it. Measured
//! against f64: relative error of the optical depth below 2e-5 where it is above 1e-6, but for the rounding of places:
//! they are good to 1e-6 of the range, and a wave's phase to 1e-6 of its number of periods.

#[cfg(test)]
pub(crate) mod tests;

use crate::erf_f32::gaussian_mean;
use crate::segment_f32::clean;
use crate::widget::{BivariateFunction, Shape, WaveProfile};

/// No variation.
pub const UNIFORM: u32 = 0;
/// exp(-t^2).
pub const GAUSSIAN: u32 = 1;
/// Straight ramps.
pub const TRIANGLE: u32 = 2;
/// The absolute value of a sine.
pub const ABS_SINE: u32 = 3;
/// The square of a sine.
pub const SINE_SQUARED: u32 = 4;

/// Where a rectangle without an end has it.
const UNBOUNDED: f32 = 1e30;

/// Coordinates are limited to this value: their squares stay finite.
const FAR: f32 = 1e15;

/// A widget as a shader has it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C)]
pub struct Widget {
    /// Luminance and, last, extinction per device unit at the peak.
    pub color: [f32; 4],
    /// Lower ends of x and y, upper ends of x and y.
    pub support: [f32; 4],
    /// Gaussian: centre, then 1 / (sqrt 2 sigma). Wave: frequency, then phase at the origin, from 0 to 1, and 0.
    pub shape: [f32; 4],
    /// [`UNIFORM`] and so on, then padding.
    pub kind: [u32; 4],
}

/// The visible widgets of a function with the fields' ranges mapped to [0, 1] (a range of no width counts as 1), and
/// `extinction` per device unit of opacity 1.
pub fn widgets(function: &BivariateFunction, ranges: [[f64; 2]; 2], extinction: f64) -> Vec<Widget> {
    let scale = ranges.map(|[low, high]| if high > low { 1.0 / (high - low) } else { 1.0 });
    let origin = [0, 1].map(|axis| -ranges[axis][0] * scale[axis]);
    let single = |value: f64| value.clamp(-f64::from(UNBOUNDED), f64::from(UNBOUNDED)) as f32;
    let pack = |widget: &crate::widget::Widget| {
        let [r, g, b] = widget.color().map(single);
        let (kind, shape) = match *widget.shape() {
            Shape::Uniform => (UNIFORM, [0.0; 4]),
            Shape::Gaussian { center, sigma } => {
                let inverse = sigma.map(|s| (std::f64::consts::FRAC_1_SQRT_2 / s).min(1e12));
                (GAUSSIAN, [center[0], center[1], inverse[0], inverse[1]])
            }
            Shape::Wave { profile, frequency, offset } => {
                let kind = match profile {
                    WaveProfile::Triangle => TRIANGLE,
                    WaveProfile::AbsSine => ABS_SINE,
                    WaveProfile::SineSquared => SINE_SQUARED,
                };
                // All have period 1: a small phase keeps its digits.
                (kind, [frequency[0], frequency[1], offset - offset.floor(), 0.0])
            }
        };
        let support = widget
            .support()
            .map_or([-UNBOUNDED, -UNBOUNDED, UNBOUNDED, UNBOUNDED], |s| [s.s[0], s.g[0], s.s[1], s.g[1]].map(single));
        let peak = (widget.max_opacity() * extinction).min(1e15) as f32;
        Widget { color: [r, g, b, peak], support, shape: shape.map(single), kind: [kind, 0, 0, 0] }
    };
    let visible = function.widgets.iter().filter(|widget| widget.max_opacity() > 0.0);
    visible.map(|widget| pack(&widget.mapped(origin, scale))).collect()
}

/// A widget along a segment; u runs from 0 at the front to 1 at the back.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Track {
    /// [`UNIFORM`] and so on.
    pub kind: u32,
    /// Optical depth of the segment if the extinction were everywhere that of the coordinate's peak.
    pub scale: f32,
    /// The coordinate at u = 0 and how much it grows: t of a Gaussian, the phase of a wave.
    pub start: f32,
    /// See `start`.
    pub step: f32,
    /// Where it is seen, empty if the first is not below the second.
    pub from: f32,
    /// See `from`.
    pub to: f32,
}

/// The part of [0, 1] on which a scalar, linear from `front` to `back`, lies between `low` and `high`.
fn clip(front: f32, back: f32, low: f32, high: f32) -> [f32; 2] {
    let rise = back - front;
    if rise.abs() < 1e-20 {
        if low <= front && front <= high {
            return [0.0, 1.0];
        }
        return [1.0, 0.0];
    }
    let one = (low - front) / rise;
    let two = (high - front) / rise;
    [one.min(two).clamp(0.0, 1.0), one.max(two).clamp(0.0, 1.0)]
}

/// The part of [0, 1] on which a segment lies in a widget's rectangle.
pub fn inside(widget: &Widget, front: [f32; 2], back: [f32; 2]) -> [f32; 2] {
    let x = clip(front[0], back[0], widget.support[0], widget.support[2]);
    let y = clip(front[1], back[1], widget.support[1], widget.support[3]);
    [x[0].max(y[0]), x[1].min(y[1])]
}

/// A widget along the segment from `front` to `back` of a length in device units.
pub fn track(widget: &Widget, front: [f32; 2], back: [f32; 2], length: f32) -> Track {
    let [from, to] = inside(widget, front, back);
    let kind = widget.kind[0];
    let mut track = Track { kind, scale: clean(widget.color[3] * length), start: 0.0, step: 0.0, from, to };
    if kind == GAUSSIAN {
        return gaussian_track(widget, front, back, track);
    }
    if kind != UNIFORM {
        track.start = widget.shape[0] * front[0] + widget.shape[1] * front[1] + widget.shape[2];
        track.step = widget.shape[0] * (back[0] - front[0]) + widget.shape[1] * (back[1] - front[1]);
    }
    track
}

/// Of a Gaussian: t along the line, and its distance from the centre in the scale.
fn gaussian_track(widget: &Widget, front: [f32; 2], back: [f32; 2], whole: Track) -> Track {
    let mut track = whole;
    let center = [widget.shape[0], widget.shape[1]];
    let inverse = [widget.shape[2], widget.shape[3]];
    let x0 = ((front[0] - center[0]) * inverse[0]).clamp(-FAR, FAR);
    let y0 = ((front[1] - center[1]) * inverse[1]).clamp(-FAR, FAR);
    let dx = ((back[0] - front[0]) * inverse[0]).clamp(-FAR, FAR);
    let dy = ((back[1] - front[1]) * inverse[1]).clamp(-FAR, FAR);
    let length = (dx * dx + dy * dy).sqrt();
    if length < 1e-6 {
        track.scale *= (-(x0 * x0 + y0 * y0)).exp();
        return track;
    }
    let along = [dx / length, dy / length];
    // As a cross product: |x|^2 - t^2 would cancel. From the end that is nearer to the centre, where it is smaller.
    let x1 = x0 + dx;
    let y1 = y0 + dy;
    let mut across = along[0] * y0 - along[1] * x0;
    track.start = along[0] * x0 + along[1] * y0;
    if x1 * x1 + y1 * y1 < x0 * x0 + y0 * y0 {
        across = along[0] * y1 - along[1] * x1;
        track.start = along[0] * x1 + along[1] * y1 - length;
    }
    track.step = length;
    track.scale *= (-across * across).exp();
    // Beyond this the extinction is below 2e-9 a segment.
    let end = (track.scale.max(1e-30).ln() + 20.0).max(0.0).sqrt();
    track.from = track.from.max((-end - track.start) / length);
    track.to = track.to.min((end - track.start) / length);
    track
}

/// A wave's extinction at a phase, as a share of the peak's.
fn wave_share(kind: u32, phase: f32) -> f32 {
    let r = (phase - phase.round()).abs();
    if kind == TRIANGLE {
        return 2.0 * r;
    }
    let sine = (std::f32::consts::PI * r).sin();
    if kind == ABS_SINE {
        return sine;
    }
    sine * sine
}

/// 1 - sin(y)/y for |y| <= pi/2, without cancellation.
fn one_minus_sinc(y: f32) -> f32 {
    let z = y * y;
    z / 6.0 * (1.0 - z / 20.0 * (1.0 - z / 42.0 * (1.0 - z / 72.0 * (1.0 - z / 110.0))))
}

/// Mean of a wave between two distances, up to 1/2, from a zero, as a share of the peak.
fn ramp_mean(kind: u32, r0: f32, r1: f32) -> f32 {
    if kind == TRIANGLE {
        return r0 + r1;
    }
    let middle = std::f32::consts::FRAC_PI_2 * (r0 + r1);
    let half = std::f32::consts::FRAC_PI_2 * (r1 - r0);
    let sine = middle.sin();
    if kind == ABS_SINE {
        return sine * (1.0 - one_minus_sinc(half));
    }
    // sin^2(m) + cos(2m)/2 (1 - sinc) = sin^2(m) sinc + (1 - sinc)/2: a sum of positive terms.
    let lost = one_minus_sinc(2.0 * half);
    sine * sine * (1.0 - lost) + 0.5 * lost
}

/// Mean of a wave between two phases of one ramp, which begins at phase `half` / 2.
fn part_mean(kind: u32, half: f32, p0: f32, p1: f32) -> f32 {
    let rising = half - 2.0 * (half * 0.5).floor() < 0.5;
    if rising {
        return ramp_mean(kind, (p0 - 0.5 * half).clamp(0.0, 0.5), (p1 - 0.5 * half).clamp(0.0, 0.5));
    }
    ramp_mean(kind, (0.5 * half + 0.5 - p0).clamp(0.0, 0.5), (0.5 * half + 0.5 - p1).clamp(0.0, 0.5))
}

/// Mean of a wave from a phase to another not below it, as a share of the peak.
fn wave_mean(kind: u32, low: f32, high: f32) -> f32 {
    let first = (2.0 * low).floor();
    let last = (2.0 * high).floor();
    if first == last {
        return part_mean(kind, first, low, high);
    }
    let begin = 0.5 * (first + 1.0);
    let end = 0.5 * last;
    let sum = (begin - low) * part_mean(kind, first, low, begin)
        + (end - begin) * ramp_mean(kind, 0.0, 0.5)
        + (high - end) * part_mean(kind, last, end, high);
    sum / (high - low)
}

/// Extinction of a track at u times the segment's length; it ends at the track's ends without notice.
pub fn track_rate(track: &Track, u: f32) -> f32 {
    let p = track.start + track.step * u;
    if track.kind == UNIFORM {
        return track.scale;
    }
    if track.kind == GAUSSIAN {
        return track.scale * (-p * p).exp();
    }
    track.scale * wave_share(track.kind, p)
}

/// Optical depth of a track from u0 to u1 >= u0, exact for any number of peaks.
pub fn track_depth(track: &Track, u0: f32, u1: f32) -> f32 {
    let width = u1 - u0;
    if width <= 0.0 {
        return 0.0;
    }
    let p0 = track.start + track.step * u0;
    let p1 = track.start + track.step * u1;
    if track.kind == UNIFORM {
        return track.scale * width;
    }
    if track.kind == GAUSSIAN {
        return track.scale * width * gaussian_mean(p0, p1.max(p0));
    }
    track.scale * width * wave_mean(track.kind, p0.min(p1), p0.max(p1))
}

/// The next u, beyond the one given, at which a track's extinction has a kink; 2 if there is none.
pub fn next_kink(track: &Track, u: f32) -> f32 {
    if (track.kind != TRIANGLE && track.kind != ABS_SINE) || track.step.abs() < 1e-6 {
        return 2.0;
    }
    // A little further, so that the kink at u itself is not found again.
    let p = 2.0 * (track.start + track.step * (u + 1e-5));
    let half = if track.step > 0.0 { p.floor() + 1.0 } else { p.ceil() - 1.0 };
    (0.5 * half - track.start) / track.step
}

/// About how many kinks a track has where it is seen.
pub fn kinks(track: &Track) -> f32 {
    if track.kind != TRIANGLE && track.kind != ABS_SINE {
        return 0.0;
    }
    2.0 * (track.step * (track.to - track.from)).abs()
}

/// Bounds of the first and the second derivative of [`track_rate`] in u where the track is seen and has no kink.
pub fn track_slopes(track: &Track) -> [f32; 2] {
    let step = track.step.abs();
    let first = track.scale * step;
    let second = first * step;
    if track.kind == GAUSSIAN {
        let t0 = track.start + track.step * track.from;
        let t1 = track.start + track.step * track.to;
        let near = if t0 * t1 <= 0.0 { 0.0 } else { t0.abs().min(t1.abs()) };
        let far = t0.abs().max(t1.abs());
        return [first * gaussian_slope(near, far), second * gaussian_curvature(near, far)];
    }
    if track.kind == TRIANGLE {
        return [2.0 * first, 0.0];
    }
    if track.kind == ABS_SINE {
        return [std::f32::consts::PI * first, 9.869605 * second];
    }
    if track.kind == SINE_SQUARED {
        return [std::f32::consts::PI * first, 19.73921 * second];
    }
    [0.0, 0.0]
}

/// Largest 2 t exp(-t^2) for t from `near` to `far`: it peaks at sqrt(1/2).
fn gaussian_slope(near: f32, far: f32) -> f32 {
    let t = 0.70710677_f32.clamp(near, far.max(near));
    2.0 * t * (-t * t).exp()
}

/// Largest |4 t^2 - 2| exp(-t^2) for t from `near` to `far`: it falls from 2 to 0 at sqrt(1/2), then peaks at sqrt(3/2).
fn gaussian_curvature(near: f32, far: f32) -> f32 {
    let t = 1.2247449_f32.clamp(near, far.max(near));
    let at_near = (4.0 * near * near - 2.0).abs() * (-near * near).exp();
    at_near.max((4.0 * t * t - 2.0).abs() * (-t * t).exp())
}
