//! Waves: a segment is a row of ramps between the zeros and the peaks, at the multiples of half a period.
//!
//! On a ramp the distance r from the zero is linear, from r0 to r1 in [0, 1/2], and differences of phases to multiples
//! of a half are exact. Whole periods are composed by doubling, so their number costs nothing.

use std::f64::consts::PI;

use super::RaySegment;
use crate::segment::clean;
use crate::span::Span;
use crate::widget::{WaveProfile, phase, wave_share, zero_distance};

/// Optical depth; `scale` is the one that the segment would have at the peak throughout.
pub(super) fn depth(profile: WaveProfile, frequency: [f64; 2], offset: f64, ray: &RaySegment, scale: f64) -> f64 {
    let [front, back] = [ray.front, ray.back].map(|point| phase(frequency, offset, point));
    ramps(front, back, &|width, r0, r1| Span::dark(width, width * scale * mean(profile, r0, r1))).depth
}

/// All integrals, for a segment of the given share of the whole.
pub(super) fn span(
    profile: WaveProfile,
    frequency: [f64; 2],
    offset: f64,
    ray: &RaySegment,
    scale: f64,
    width: f64,
) -> Span {
    let [front, back] = [ray.front, ray.back].map(|point| phase(frequency, offset, point));
    ramps(front, back, &|share, r0, r1| ramp(profile, share * width, share * scale, r0, r1))
}

/// V(M, t) = int_t^pi exp(-M (cos t - cos y)) dy, the integral over the rest of a lobe of the sine, as seen from t.
///
/// On a segment from t1 to t2 in [0, pi] with extinction a_max sin(k l + const), M = a_max / k and transmittance zeta:
/// k D psi = V(t1) - zeta V(t2). V is at most pi and V(0) = pi exp(-M) I_0(M); relative error below 1e-12. `m` is at
/// least 0 and `t` in [0, pi]: both are clamped, NaN counts as 0.
pub fn sine_bounded(m: f64, t: f64) -> f64 {
    let t = if t > 0.0 { t.min(PI) } else { 0.0 };
    let m = clean(m);
    // Optical depth int M sin y dy over the rest if it were at the peak throughout: M (pi - t).
    let rest = PI - t;
    let part = |length: f64, r0: f64, r1: f64| ramp(WaveProfile::AbsSine, length, m * length, r0, r1);
    if t < 0.5 * PI {
        part(0.5 * PI - t, t / PI, 0.5).then(part(0.5 * PI, 0.5, 0.0)).visible
    } else {
        part(rest, rest / PI, 0.0).visible
    }
}

/// Composes `piece(share of the segment, r0, r1)` over all ramps from phase `front` to phase `back`.
fn ramps(front: f64, back: f64, piece: &impl Fn(f64, f64, f64) -> Span) -> Span {
    if front == back {
        let r = zero_distance(front);
        return piece(1.0, r, r);
    }
    // Every profile is even.
    let (from, to) = if front < back { (front, back) } else { (-front, -back) };
    let total = to - from;
    if !total.is_finite() {
        return Span::empty(1.0);
    }
    // Ramp i runs over the phases i/2 .. (i + 1)/2; it rises if i is even.
    let (first, last) = ((2.0 * from).floor(), (2.0 * to).ceil() - 1.0);
    let rises = |i: f64| i.rem_euclid(2.0) == 0.0;
    let part = |i: f64, p: f64, q: f64, share: f64| {
        let [r0, r1] = [p, q].map(|phase| if rises(i) { phase - 0.5 * i } else { 0.5 * (i + 1.0) - phase });
        // Phases beyond 2^52 have no fraction.
        piece(share, r0.clamp(0.0, 0.5), r1.clamp(0.0, 0.5))
    };
    if first >= last {
        return part(first, from, to, 1.0);
    }
    let half = |i: f64| if rises(i) { piece(0.5 / total, 0.0, 0.5) } else { piece(0.5 / total, 0.5, 0.0) };
    let (first_end, last_start) = (0.5 * (first + 1.0), 0.5 * last);
    let mut sum = part(first, from, first_end, (first_end - from) / total);
    let between = (last - first - 1.0) as u64;
    if between >= 2 {
        sum = sum.then(half(first + 1.0).then(half(first + 2.0)).repeated(between / 2));
    }
    if between % 2 == 1 {
        sum = sum.then(half(last - 1.0));
    }
    sum.then(part(last, last_start, to, (to - last_start) / total))
}

/// A ramp of a given share of the segment; `scale` is its optical depth at the peak throughout.
fn ramp(profile: WaveProfile, width: f64, scale: f64, r0: f64, r1: f64) -> Span {
    if profile == WaveProfile::Triangle || r0 == r1 {
        return Span::linear(width, scale * wave_share(profile, r1), scale * wave_share(profile, r0));
    }
    let r = |x: f64| r0 * (1.0 - x) + r1 * x;
    Span::by_quadrature(
        width,
        |x| scale * wave_share(profile, r(x)),
        |x0, x1| (x1 - x0) * scale * mean(profile, r(x0), r(x1)),
        |_, _| true,
    )
}

/// Mean over r from r0 to r1, both in [0, 1/2], as a share of the peak.
fn mean(profile: WaveProfile, r0: f64, r1: f64) -> f64 {
    let (middle, half) = (PI * 0.5 * (r0 + r1), PI * 0.5 * (r1 - r0));
    match profile {
        WaveProfile::Triangle => r0 + r1,
        // (cos(pi r0) - cos(pi r1)) / (pi (r1 - r0)).
        WaveProfile::AbsSine => middle.sin() * (1.0 - one_minus_sinc(half)),
        // 1/2 - (sin(2 pi r1) - sin(2 pi r0)) / (4 pi (r1 - r0)).
        WaveProfile::SineSquared => middle.sin().powi(2) + 0.5 * (2.0 * middle).cos() * one_minus_sinc(2.0 * half),
    }
}

/// 1 - sin(y)/y for |y| <= pi/2, without cancellation: y^2/6 (1 - y^2/20 (1 - y^2/42 (...))).
fn one_minus_sinc(y: f64) -> f64 {
    let square = y * y;
    // Ten factors: the next is below rounding at pi/2.
    let mut series = 1.0;
    for k in (2..=11).rev() {
        let k = f64::from(k);
        series = 1.0 - series * square / (2.0 * k * (2.0 * k + 1.0));
    }
    series * square / 6.0
}
