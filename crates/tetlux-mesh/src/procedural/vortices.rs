//! Vorticity over a delta wing, in closed form.

use std::f64::consts::{PI, TAU};

use glam::{DVec2, DVec3};

use super::random::SplitMix64;
use super::wing::{half_thickness, half_width};

/// The vorticity magnitude of a pair of leading-edge vortices, scaled to about 1 in the cores before they break down.
///
/// A picture of the flow, not a solution of it. Lengths in the cross plane are in half widths of the wing, so that the
/// flow over it is conical (Legendre 1952). On each side it adds
/// - a core with the Gaussian profile of Lamb, Oseen and Burgers,
/// - the shear layer that leaves the leading edge and rolls up into the core: a Gaussian about a logarithmic spiral,
/// - a secondary vortex between core and leading edge,
/// - breakdown near the trailing edge (Lambourne and Bryer 1961): the core widens, hollows out and winds into a helix
///   against the flow's rotation, further upstream on one side than on the other,
///
/// and to both the boundary layer, the wake's sheet and a modulation by random waves that grows after breakdown.
#[derive(Debug, Clone)]
pub struct Vortices {
    waves: Vec<Wave>,
    sides: [Side; 2],
}

/// One wave of the modulation.
#[derive(Debug, Clone, Copy)]
struct Wave {
    number: DVec3,
    phase: f64,
}

/// What differs between the two vortices.
#[derive(Debug, Clone, Copy)]
struct Side {
    breakdown: f64,
    phase: f64,
}

/// The vortex axis over the wing, in half widths.
const AXIS: DVec2 = DVec2::new(0.68, 0.29);
/// The leading edge seen from there.
const EDGE: DVec2 = DVec2::new(1.0 - AXIS.x, -AXIS.y);
/// Radians of the spiral over which its radius falls by e: a factor 1.9 each turn.
const WINDING: f64 = 9.8;
const CORE_RADIUS: f64 = 0.095;
const SHEET_THICKNESS: f64 = 0.032;
/// Wave length of the helix, and length over which it grows, in root chords.
const HELIX_PITCH: f64 = 0.25;
const HELIX_GROWTH: f64 = 0.22;

impl Vortices {
    /// The flow of a seed.
    pub fn new(seed: u64) -> Self {
        // Another stream than that of the mesh.
        let mut random = SplitMix64::new(seed ^ 0x766f_7274_6963_6573);
        let waves = (0..16)
            .map(|_| {
                let direction = DVec3::from([(); 3].map(|()| random.signed())).normalize_or(DVec3::X);
                Wave { number: direction * (15.0 + 30.0 * random.unit()), phase: TAU * random.unit() }
            })
            .collect();
        let mut side =
            |breakdown: f64| Side { breakdown: breakdown + 0.04 * random.signed(), phase: TAU * random.unit() };
        let sides = [side(0.66), side(0.80)];
        Vortices { waves, sides }
    }

    /// At a position in the frame of [`wing`](super::wing()): x along the root chord from the apex, z up.
    pub fn vorticity(&self, p: DVec3) -> f64 {
        let wave: f64 = self.waves.iter().map(|w| (w.number.dot(p) + w.phase).sin()).sum::<f64>() / 4.0;
        let vortices: f64 = self
            .sides
            .iter()
            .zip([1.0, -1.0])
            .map(|(side, sign)| side.vortex(DVec3::new(p.x, sign * p.y, p.z), wave))
            .sum();
        // Dissipation downstream; nothing before the apex.
        let life = step(0.0, 0.05, p.x) * (1.0 - step(1.3, 1.85, p.x));
        vortices * life + layers(p)
    }
}

impl Side {
    /// The vortex at positive y.
    fn vortex(&self, p: DVec3, wave: f64) -> f64 {
        let s = half_width(p.x);
        let wake = (p.x - 1.0).max(0.0);
        let since = (p.x - self.breakdown).max(0.0);
        let broken = 1.0 - (-since / HELIX_GROWTH).exp();

        // Behind the wing the pair draws together and sinks a little.
        let axis = AXIS + DVec2::new(-0.10, -0.02) * wake;
        let angle = self.phase - TAU * since / HELIX_PITCH;
        let helix = DVec2::from_angle(angle) * (0.17 * broken * (-0.4 * wake).exp());
        let place = DVec2::new(p.y, p.z) / s;

        let from_core = place - axis - helix;
        let r = from_core.length();
        let radius = CORE_RADIUS * (1.0 + 0.55 * broken);
        let hollow = 1.0 - 0.45 * broken * gauss(r / (0.45 * radius));
        let core = (1.0 - 0.25 * broken) * gauss(r / radius) * hollow;

        let from_axis = place - axis - 0.5 * helix;
        let sheet = (0.44 - 0.12 * broken) * spiral(from_axis, p.x, broken);
        let over = 1.0 - step(0.95, 1.15, p.x);
        let secondary = 0.3 * over * gauss(place.distance(DVec2::new(0.87, 0.085)) / 0.05);
        (core + sheet + secondary) * (1.0 + (0.04 + 0.24 * broken) * wave).max(0.0)
    }
}

/// The rolled-up shear layer at a place seen from the axis: 1 on the sheet.
fn spiral(from_axis: DVec2, x: f64, broken: f64) -> f64 {
    let r = from_axis.length().max(1e-9);
    let outer = EDGE.length();
    let turned = WINDING * (outer / r).ln();
    let angle = from_axis.to_angle() - EDGE.to_angle() - turned;
    let off = angle - TAU * (angle / TAU).round();
    // The sheet crosses circles at an angle whose tangent is 1 / WINDING.
    let distance = off * r / (1.0 + WINDING * WINDING).sqrt();
    let thickness = SHEET_THICKNESS * (1.0 + 0.8 * broken);
    // It ends at the leading edge and fades into the core; on the way it ripples (Gad-el-Hak and Blackwelder 1985).
    let ends = (1.0 - step(outer, 1.12 * outer, r)) * step(0.05, 0.14, r);
    let ripple = 1.0 + 0.3 * (3.0 * turned + TAU * 9.0 * (x + 0.1).max(0.1).ln()).sin();
    gauss(distance / thickness) * ends * ripple
}

/// Boundary layer of the wing and the sheet that leaves the trailing edge.
fn layers(p: DVec3) -> f64 {
    let (s, h) = (half_width(p.x), half_thickness(p.x));
    let outside = DVec3::new((-p.x).max(p.x - 1.0), p.y.abs() - s, p.z.abs() - h).max(DVec3::ZERO);
    let boundary = 0.16 * (-outside.length() / (0.07 * s)).exp();
    let wake = (p.x - 1.0).max(0.0);
    let across = 0.5 * PI * (p.y / (0.9 * s)).clamp(-1.0, 1.0);
    let sheet = 0.14 * (-wake / 0.3).exp() * gauss((p.z / s + 0.12 * wake) / 0.05) * across.cos();
    boundary + if wake > 0.0 { sheet * step(0.0, 0.05, wake) } else { 0.0 }
}

fn gauss(x: f64) -> f64 {
    (-x * x).exp()
}

/// 0 up to `from`, 1 from `to`, smooth between.
fn step(from: f64, to: f64, x: f64) -> f64 {
    let t = ((x - from) / (to - from)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The axis of a vortex over the wing, before it breaks down: that is behind x = 0.62 for every seed.
    fn axis(x: f64, sign: f64) -> DVec3 {
        let s = half_width(x);
        DVec3::new(x, sign * AXIS.x * s, AXIS.y * s)
    }

    #[test]
    fn cores_are_bright_and_the_air_far_away_is_not() {
        for seed in 0..8 {
            let flow = Vortices::new(seed);
            for x in [0.1, 0.3, 0.45, 0.6] {
                for sign in [1.0, -1.0] {
                    let core = flow.vorticity(axis(x, sign));
                    // One, less and more by the modulation of 4 per cent times at most four.
                    assert!((0.8..1.2).contains(&core), "{core} at {x}");
                }
                assert!(flow.vorticity(DVec3::new(x, 0.0, 0.5)) < 0.01);
            }
            assert!(flow.vorticity(DVec3::new(-0.15, 0.0, 0.0)) < 0.01);
        }
    }

    #[test]
    fn the_shear_layer_leaves_the_leading_edge() {
        assert!(spiral(EDGE, 0.5, 0.0) > 0.65, "1 less the ripple");
        assert!(spiral(EDGE * 1.3, 0.5, 0.0) < 1e-6);
        // Half a turn on it has come closer by exp(-pi / WINDING); there it is, and half a spacing further in it is not.
        let opposite = -EDGE * (-PI / WINDING).exp();
        assert!(spiral(opposite, 0.5, 0.0) > 0.65);
        assert!(spiral(opposite * (-PI / WINDING).exp(), 0.5, 0.0) < 0.05);
    }

    #[test]
    fn values_are_finite_everywhere() {
        let flow = Vortices::new(1);
        let mut random = SplitMix64::new(2);
        for _ in 0..10_000 {
            let p = DVec3::from([(); 3].map(|()| 3.0 * random.signed()));
            let value = flow.vorticity(p);
            assert!((0.0..3.0).contains(&value), "{value} at {p}");
        }
        for p in [DVec3::ZERO, axis(0.5, 1.0), DVec3::new(0.0, 1e-300, 0.0)] {
            assert!(flow.vorticity(p).is_finite());
        }
    }
}
