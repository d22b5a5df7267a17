//! The approximate mode as it was published, in f32: N equal pieces, classified at their ends (Song et al. 2009, section 5).
//!
//! Between the ends of a piece of length h colour and opacity are taken to be linear. With emission density, the paper's
//! convention, the piece's light is c_f F + c_b B, F = h m_f and B = h m_b; with emission-absorption c_f w_f + c_b w_b.
//! Nothing bounds the error: what lies between two samples is not seen.

#[cfg(test)]
mod tests;

use crate::emission::EmissionConvention;
use crate::segment_f32::{clean, weights_direct};
use crate::widget_f32::{Widget, track, track_rate};

/// Positive nodes of the rule of 12 nodes of Gauss and Legendre on [-1, 1], and their weights.
const NODES: [[f32; 2]; 6] = [
    [0.12523341, 0.24914705],
    [0.3678315, 0.23349254],
    [0.58731794, 0.20316742],
    [0.76990265, 0.16007833],
    [0.9041173, 0.10693932],
    [0.98156065, 0.047175337],
];

/// (m_b, m_f): mean over a piece of u T and (1 - u) T, T the transmittance from the distance u to the front, for
/// a = tau_b h and b = tau_f h. Absolute error below 1e-5.
pub fn density_weights(a: f32, b: f32) -> [f32; 2] {
    let back = clean(a).min(1e6);
    let front = clean(b).min(1e6);
    // Nodes crowd towards the front where it is dense.
    let crowd = 0.24 * (front + back.sqrt());
    let mut m_b = 0.0;
    let mut m_f = 0.0;
    for k in 0..12 {
        let [node, weight] = NODES[k / 2];
        let v = if k % 2 == 0 { 0.5 - 0.5 * node } else { 0.5 + 0.5 * node };
        let stretch = 1.0 + crowd * (1.0 - v);
        let u = v / stretch;
        let depth = u * (front * (1.0 - 0.5 * u) + back * (0.5 * u));
        let seen = 0.5 * weight * (1.0 + crowd) / (stretch * stretch) * (-depth).exp();
        m_b += u * seen;
        m_f += (1.0 - u) * seen;
    }
    [m_b, m_f]
}

/// Colour and alpha of a segment of a length in device units, from `count` equal pieces. `classify` gives colour and, last,
/// extinction per device unit at normalised scalars.
pub fn integrate(
    classify: impl Fn([f32; 2]) -> [f32; 4],
    front: [f32; 2],
    back: [f32; 2],
    length: f32,
    count: u32,
    convention: EmissionConvention,
) -> [f32; 4] {
    let pieces = count.max(1);
    let part = length / pieces as f32;
    let mut result = [0.0; 4];
    let mut near = classify(front);
    for k in 1..=pieces {
        let u = k as f32 / pieces as f32;
        let far = classify([front[0] + (back[0] - front[0]) * u, front[1] + (back[1] - front[1]) * u]);
        let [alpha, mut w_b, mut w_f] = weights_direct(far[3] * part, near[3] * part);
        if convention == EmissionConvention::EmissionDensity {
            let [m_b, m_f] = density_weights(far[3] * part, near[3] * part);
            w_b = part * m_b;
            w_f = part * m_f;
        }
        for channel in 0..3 {
            result[channel] += (1.0 - result[3]) * (near[channel] * w_f + far[channel] * w_b);
        }
        result[3] += (1.0 - result[3]) * alpha;
        near = far;
    }
    result
}

/// Colour and extinction of widgets at a point, for [`integrate`]: of several the extinction-weighted mean colour.
pub fn classify_widgets(widgets: &[Widget], point: [f32; 2]) -> [f32; 4] {
    let mut sum = [0.0; 4];
    for widget in widgets {
        let track = track(widget, point, point, 1.0);
        if track.from < track.to {
            let rate = track_rate(&track, 0.0);
            for channel in 0..3 {
                sum[channel] += widget.color[channel] * rate;
            }
            sum[3] += rate;
        }
    }
    if sum[3] > 0.0 {
        for channel in 0..3 {
            sum[channel] /= sum[3];
        }
    }
    sum
}
