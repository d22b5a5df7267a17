use super::*;
use crate::accuracy::Random;
use crate::segment::weights;

/// f32 weights, and cuts that are off by 1e-7 of the range on slopes of up to 80.
const TOLERANCE: f64 = 1e-4;

fn lively() -> TransferFunction {
    let color = [(-1.0, [0.1, 0.2, 0.9]), (0.4, [0.9, 0.1, 0.3]), (0.4, [0.2, 1.0, 0.1]), (3.0, [1.0, 0.8, 0.0])];
    let opacity = [(-0.5, 0.3), (0.1, 0.0), (0.7, 0.0), (0.75, 4.0), (0.8, 0.0), (2.0, 0.5), (2.0, 1.5)];
    TransferFunction::new(
        color.map(|(s, rgb)| ColorNode { s, rgb }).to_vec(),
        opacity.map(|(s, opacity)| OpacityNode { s, opacity }).to_vec(),
    )
    .unwrap()
}

/// The same in f64, cut at the nodes of both.
fn exact(transfer: &TransferFunction, front: [f64; 2], back: [f64; 2], length: f64) -> [f64; 4] {
    let at = |axis: usize, u: f64| front[axis] + (back[axis] - front[axis]) * u;
    let cut = |axis: usize, s: f64| (s - front[axis]) / (back[axis] - front[axis]);
    let color = transfer.color_nodes().iter().map(|n| cut(0, n.s));
    let opacity = transfer.opacity_nodes().iter().map(|n| cut(1, n.s));
    let mut cuts: Vec<f64> = color.chain(opacity).filter(|u| 0.0 < *u && *u < 1.0).chain([0.0, 1.0]).collect();
    cuts.sort_by(f64::total_cmp);
    let mut result = [0.0; 4];
    for ends in cuts.windows(2).filter(|ends| ends[1] - ends[0] > 1e-12) {
        // Both functions are linear here: their ends follow from two points inside.
        let inner = [0.25, 0.75].map(|v| ends[0] + (ends[1] - ends[0]) * v);
        let [a, b] = inner.map(|u| (transfer.luminance(at(0, u)), transfer.opacity(at(1, u))));
        let part = (ends[1] - ends[0]) * length;
        let extend = |p: f64, q: f64| [1.5 * p - 0.5 * q, 1.5 * q - 0.5 * p];
        let [tau_f, tau_b] = extend(a.1, b.1).map(|tau| tau.max(0.0) * part);
        let w = weights(tau_b, tau_f);
        let through = 1.0 - result[3];
        for channel in 0..3 {
            let [f, b] = extend(a.0[channel], b.0[channel]);
            result[channel] += through * (f * w.front + b * w.back);
        }
        result[3] += through * w.alpha;
    }
    result
}

#[test]
fn agrees_with_f64() {
    let transfer = lively();
    let ranges = [[-1.5, 3.5], [-1.0, 2.5]];
    let [color, opacity] = axes(&transfer, ranges, 1.0);
    let mut random = Random::new(9);
    let mut worst = 0.0_f64;
    for _ in 0..5000 {
        let mut between = |[low, high]: [f64; 2]| f64::from((low + (high - low) * random.unit()) as f32);
        let ends = [[between(ranges[0]), between(ranges[1])], [between(ranges[0]), between(ranges[1])]];
        let length = 4.0 * random.unit();
        let place = |p: [f64; 2]| [0, 1].map(|k| ((p[k] - ranges[k][0]) / (ranges[k][1] - ranges[k][0])) as f32);
        let got = integrate(&color, &opacity, place(ends[0]), place(ends[1]), length as f32);
        let exact = exact(&transfer, ends[0], ends[1], length);
        for k in 0..4 {
            worst = worst.max((f64::from(got[k]) - exact[k]).abs());
        }
    }
    println!("largest error {worst:.1e}");
    assert!(worst < TOLERANCE, "{worst:e}");
}

#[test]
fn a_scalar_that_stands_still_is_no_trouble() {
    let transfer = lively();
    let [color, opacity] = axes(&transfer, [[0.0, 4.0], [0.0, 1.0]], 1.0);
    // Luminance at 0.4, a tenth of its range, from above, opacity 4 at 0.75, over half a unit.
    let got = integrate(&color, &opacity, [0.1, 0.75], [0.1, 0.75], 0.5);
    let alpha = 1.0 - (-2.0_f64).exp();
    assert!((f64::from(got[3]) - alpha).abs() < 1e-5);
    assert!((f64::from(got[1]) - alpha).abs() < 1e-5, "{got:?}");
    // The colour runs on alone, over a step: half of it red 0.1 and so on, mean by alpha.
    let got = integrate(&color, &opacity, [0.1, 0.75], [0.75, 0.75], 1e-3);
    let alpha = 1.0 - (-4e-3_f64).exp();
    assert!((f64::from(got[3]) - alpha).abs() < 1e-6);
    // Red from 0.2 to 1.0: in a thin segment the mean.
    assert!((f64::from(got[0]) - 0.6 * alpha).abs() < 1e-5);
}
