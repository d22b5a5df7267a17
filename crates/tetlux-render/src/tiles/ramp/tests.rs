use fearless_simd::{Level, dispatch};
use tetlux_optics::segment::weights;
use tetlux_optics::transfer::{ColorNode, OpacityNode, TransferFunction};
use tetlux_optics::transfer_f32::{integrate, piece_at, pieces};

use super::*;

/// Error of the fits, half of 5.2e-6 of a share of at least 0.13 of alpha, and some roundings.
const RELATIVE: f64 = 2.5e-5;
const ABSOLUTE: f64 = 5e-6;

/// One segment in every lane.
fn one(level: Level, ramps: &[Ramp], model: Weights, [front, back, length]: [f32; 3]) -> [f32; 4] {
    dispatch!(level, simd => segment(simd, ramps, model, [front, back, length]))
}

#[inline(always)]
fn segment<S: Simd>(simd: S, ramps: &[Ramp], model: Weights, [front, back, length]: [f32; 3]) -> [f32; 4] {
    let splat = |x: f32| S::f32s::splat(simd, x);
    let mut pixels = [splat(0.0); 4];
    let (middle, rise) = (0.5 * (front + back), 0.5 * (back - front));
    if let [ramp] = ramps {
        add_segment(simd, ramp, model, splat(middle - ramp.ends[0]), splat(rise), splat(length), &mut pixels);
    } else {
        let part = Part { scalar: splat(middle), rise: splat(rise), length: splat(length) };
        add_cut_segment(simd, ramps, 0.0, model, &part, &mut pixels);
    }
    pixels.map(|p| p[S::f32s::LEN - 1])
}

/// Luminance 1 at scalar 0 and 0 at 1 in red, the reverse in green; extinctions at the ends.
fn ramp(low: f32, high: f32) -> Ramp {
    Ramp::new(&Piece { low: [1.0, 0.0, 1.0, low], high: [0.0, 1.0, 1.0, high], s: [0.0, 1.0, 1.0, 0.0] }, false)
}

#[test]
fn weights_at_every_depth() {
    for level in [Level::new(), Level::baseline()] {
        for exponent in -80..=150 {
            let depth = 10f64.powf(f64::from(exponent) * 0.1);
            for share in [0.0, 0.01, 0.3, 0.5, 0.8, 1.0] {
                let (b, f) = ((depth * share) as f32, (depth * (1.0 - share)) as f32);
                // From scalar 1 in front to 0 at the back.
                let [red, green, blue, alpha] = one(level, &[ramp(b, f)], Weights::Direct, [1.0, 0.0, 1.0]);
                let exact = weights(f64::from(b), f64::from(f));
                for (found, expected) in
                    [(red, exact.back), (green, exact.front), (blue, exact.alpha), (alpha, exact.alpha)]
                {
                    let error = (f64::from(found) - expected).abs();
                    let relative = depth > 3.0 || error <= RELATIVE * expected;
                    assert!(error <= ABSOLUTE && relative, "{b:e} {f:e}: {found:e}, not {expected:e}");
                }
            }
        }
    }
}

#[test]
fn average_weights_at_every_depth() {
    for exponent in -80..=150 {
        let depth = 10f64.powf(f64::from(exponent) * 0.1);
        let extinction = depth as f32;
        let [red, green, _, alpha] =
            one(Level::new(), &[ramp(0.0, 2.0 * extinction)], Weights::Average, [1.0, 0.0, 1.0]);
        let exact = -(-f64::from(extinction)).exp_m1();
        for (found, expected) in [(alpha, exact), (red, 0.5 * exact), (green, 0.5 * exact)] {
            assert!((f64::from(found) - expected).abs() <= 2e-6 * expected, "{depth:e}: {found:e}, not {expected:e}");
        }
    }
}

#[test]
fn cut_segments_are_those_of_the_twin() {
    let color = [(-1.0, [0.1, 0.2, 0.9]), (0.4, [0.9, 0.1, 0.3]), (0.4, [0.2, 1.0, 0.1]), (3.0, [1.0, 0.8, 0.0])];
    let opacity = [(-0.5, 0.3), (0.1, 0.0), (0.7, 0.0), (0.75, 4.0), (0.8, 0.0), (2.0, 0.5), (2.0, 1.5)];
    let transfer = TransferFunction::new(
        color.map(|(s, rgb)| ColorNode { s, rgb }).to_vec(),
        opacity.map(|(s, opacity)| OpacityNode { s, opacity }).to_vec(),
    );
    let pieces = pieces(&transfer.unwrap(), [-1.5, 3.5], 1.0);
    let ramps: Vec<Ramp> = pieces.iter().map(|piece| Ramp::new(piece, false)).collect();
    // Every tenth, and the steps' own places.
    let places: Vec<f32> = (0..=20).map(|i| i as f32 * 0.05).chain(pieces[1..].iter().map(|p| p.s[0])).collect();
    let mut met = 0;
    for &front in &places {
        for &back in &places {
            for length in [0.01, 1.0, 7.0, 100.0] {
                let range = [piece_at(&pieces, front.min(back)), piece_at(&pieces, front.max(back))];
                let twin = integrate(&pieces, range, Weights::Direct, front, back, length);
                let found = one(Level::new(), &ramps[range[0]..=range[1]], Weights::Direct, [front, back, length]);
                for i in 0..4 {
                    // Both are off by their weights and by cuts good to 1e-7 of the range, on slopes of up to 400.
                    assert!((found[i] - twin[i]).abs() <= 5e-5, "{front} {back} {length}: {found:?}, not {twin:?}");
                }
                met += usize::from(range[0] < range[1]);
            }
        }
    }
    assert!(met > 1000);
}

#[test]
fn any_depth_gives_finite_pixels() {
    for (low, high) in [(0.0, 1e15), (1e15, 0.0), (1e15, 1e15), (1e12, 1.0), (0.0, 0.0)] {
        for (front, back) in [(0.0, 1.0), (1.0, 0.0), (0.5, 0.5), (0.0, 0.0)] {
            for length in [0.0, 1e-30, 1e-12, 1.0, 4.0] {
                for model in [Weights::Direct, Weights::Average] {
                    let pixel = one(Level::new(), &[ramp(low, high)], model, [front, back, length]);
                    assert!(pixel.iter().all(|p| (0.0..=1.00001).contains(p)), "{low} {high} {length}: {pixel:?}");
                }
            }
        }
    }
}
