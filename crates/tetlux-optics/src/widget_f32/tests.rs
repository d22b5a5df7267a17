use super::*;
use crate::accuracy::Random;
use crate::widget::Rectangle;
use crate::widget_integral::{RaySegment, optical_depth};

/// A widget of any kind, and a segment through the unit square.
pub(crate) fn random_widget(random: &mut Random) -> crate::widget::Widget {
    let mut between = |low: f64, high: f64| low + (high - low) * random.unit();
    let shape = match between(0.0, 5.0) as usize {
        0 => Shape::Uniform,
        1 => Shape::Gaussian {
            center: [between(0.0, 1.0), between(0.0, 1.0)],
            sigma: [10.0_f64.powf(between(-1.7, 0.0)), 10.0_f64.powf(between(-1.7, 0.0))],
        },
        kind => {
            let profile = [WaveProfile::Triangle, WaveProfile::AbsSine, WaveProfile::SineSquared][kind - 2];
            Shape::Wave { profile, frequency: [between(-4.0, 4.0), between(-4.0, 4.0)], offset: between(-9.0, 9.0) }
        }
    };
    let support = (between(0.0, 1.0) < 0.5).then(|| {
        let [x, y] = [between(0.0, 0.5), between(0.0, 0.5)];
        Rectangle { s: [x, x + between(0.1, 0.5)], g: [y, y + between(0.1, 0.5)] }
    });
    let opacity = 10.0_f64.powf(between(-1.0, 1.0));
    let color = [between(0.0, 1.0), between(0.0, 1.0), between(0.0, 1.0)];
    crate::widget::Widget::new(shape, support, opacity, color).unwrap()
}

pub(crate) fn random_segment(random: &mut Random) -> ([f32; 2], [f32; 2]) {
    let front = [random.unit() as f32, random.unit() as f32];
    // Mesh cells span anything from nothing to all of the range.
    let reach = random.decades(-4.0, 0.0);
    let toward = |from: f32, to: f64| from + reach * (to as f32 - from);
    (front, [toward(front[0], random.unit()), toward(front[1], random.unit())])
}

pub(crate) fn exact_segment(front: [f32; 2], back: [f32; 2], length: f32) -> RaySegment {
    RaySegment { front: front.map(f64::from), back: back.map(f64::from), length: f64::from(length) }
}

#[test]
fn optical_depth_is_exact_in_single_precision() {
    let mut random = Random::new(3);
    let mut worst = 0.0_f64;
    let unit = [[0.0, 1.0]; 2];
    for _ in 0..20_000 {
        let widget = random_widget(&mut random);
        let device = widgets(&BivariateFunction { widgets: vec![widget] }, unit, 1.0)[0];
        let (front, back) = random_segment(&mut random);
        let track = track(&device, front, back, 1.0);
        let depth = f64::from(track_depth(&track, track.from, track.to));
        let exact = optical_depth(&widget, 1.0, &exact_segment(front, back, 1.0));
        // Places are rounded by 1e-7 of the range: that moves rims of rectangles along the segment and phases. A steep
        // Gaussian, sigma 0.02, has a relative slope of up to 7 / 0.02 where it is 1e-9 of its peak.
        let travel = f64::from((back[0] - front[0]).abs().max((back[1] - front[1]).abs()));
        let moved = widget.max_opacity() * (2e-6 + 1e-7 / travel.max(1e-3));
        worst = worst.max((depth - exact).abs() / (moved + 2e-5 * exact));
        assert!((depth - exact).abs() < moved + 2e-5 * exact, "{widget:?} {front:?} {back:?}: {depth} {exact}");
    }
    println!("largest share of the tolerance: {worst:.2}");
}

#[test]
fn slopes_bound_what_is_met() {
    let mut random = Random::new(11);
    for _ in 0..3000 {
        let widget = random_widget(&mut random);
        let device = widgets(&BivariateFunction { widgets: vec![widget] }, [[0.0, 1.0]; 2], 1.0)[0];
        let (front, back) = random_segment(&mut random);
        let track = track(&device, front, back, 1.0);
        let [slope, curvature] = track_slopes(&track);
        let h = 1e-2;
        let mut u = track.from;
        while u + 2.0 * h < track.to {
            let [a, b, c] = [u, u + h, u + 2.0 * h].map(|u| track_rate(&track, u));
            // Differences are means of derivatives; rounding of rates up to 10 in differences over 1e-2 and 1e-4.
            assert!((b - a).abs() <= h * slope * 1.001 + 1e-4 * (1.0 + track.scale));
            if next_kink(&track, u) > u + 2.0 * h {
                assert!(
                    (c - 2.0 * b + a).abs() <= h * h * curvature * 1.001 + 2e-5 * (1.0 + track.scale),
                    "{track:?} {u}"
                );
            }
            u += h;
        }
    }
}

#[test]
fn kinks_are_found_one_after_the_other() {
    for step in [3.0, -3.0] {
        let track = Track { kind: TRIANGLE, scale: 1.0, start: 0.2, step, from: 0.0, to: 1.0 };
        let mut found = Vec::new();
        let mut u = next_kink(&track, 0.0);
        while u < 1.0 {
            found.push(u);
            u = next_kink(&track, u);
        }
        // Phases 0.5, 1, .. 3 on the way up from 0.2 to 3.2; 0, -0.5, .. -2.5 on the way down to -2.8.
        let first = if step > 0.0 { 0.1 } else { 0.2 / 3.0 };
        let expected: Vec<f32> = (0..6).map(|k| first + k as f32 / 6.0).collect();
        assert_eq!(found.len(), 6);
        assert!(found.iter().zip(&expected).all(|(a, b)| (a - b).abs() < 1e-5), "{found:?}");
    }
    let smooth = Track { kind: SINE_SQUARED, scale: 1.0, start: 0.2, step: 3.0, from: 0.0, to: 1.0 };
    assert_eq!(next_kink(&smooth, 0.0), 2.0);
}

#[test]
fn nothing_infinite_comes_of_extremes() {
    let widget = |shape| crate::widget::Widget::new(shape, None, 1e300, [1e300; 3]).unwrap();
    let shapes = [
        Shape::Uniform,
        Shape::Gaussian { center: [1e300, 0.0], sigma: [1e-300, 1e300] },
        Shape::Gaussian { center: [0.5, 0.5], sigma: [1e-300, 1e-300] },
        Shape::Wave { profile: WaveProfile::AbsSine, frequency: [1e9, 0.0], offset: 1e300 },
        Shape::Wave { profile: WaveProfile::SineSquared, frequency: [1e-300, 1e-9], offset: 0.5 },
    ];
    for shape in shapes {
        let device = widgets(&BivariateFunction { widgets: vec![widget(shape)] }, [[0.0, 1.0]; 2], 1e300)[0];
        for (front, back) in [([0.0; 2], [1.0; 2]), ([0.5; 2], [0.5; 2]), ([1.0, 0.0], [0.5, 0.5])] {
            for length in [0.0, 1e-30, 1.0, 1e30] {
                let track = track(&device, front, back, length);
                let depth = track_depth(&track, track.from, track.to);
                assert!(depth.is_finite() && depth >= 0.0, "{shape:?} {track:?}");
                assert!(track_slopes(&track).iter().all(|slope| *slope >= 0.0), "{shape:?} {track:?}");
            }
        }
    }
}
