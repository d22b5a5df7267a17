//! Segments of what is classified at the vertices, in f32: the twin of `shaders/shading/vertex.wgsl`.

use crate::segment_f32::{weights_average, weights_direct};
use crate::transfer_f32::Weights;

/// Premultiplied colour and alpha of a segment with luminance and, last, extinction per device unit at its front and back
/// end, linear in between, of a length in device units.
pub fn shade(model: Weights, front: [f32; 4], back: [f32; 4], length: f32) -> [f32; 4] {
    let (back_depth, front_depth) = (back[3] * length, front[3] * length);
    let [alpha, w_back, w_front] = match model {
        Weights::Direct => weights_direct(back_depth, front_depth),
        Weights::Average => weights_average(back_depth, front_depth),
    };
    let channel = |i: usize| front[i] * w_front + back[i] * w_back;
    [channel(0), channel(1), channel(2), alpha]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::segment::segment;
    use crate::transfer::{ColorNode, OpacityNode, TransferFunction};

    /// Relative error of the weights.
    const TOLERANCE: f64 = 2e-5;

    #[test]
    fn agrees_with_f64() {
        for (front, back) in [(0.0, 3.0), (3.0, 0.0), (1.0, 1.0), (0.2, 40.0), (1e-6, 0.0), (0.0, 0.0)] {
            for length in [0.0, 1e-4, 0.5, 2.0, 30.0] {
                let ends = [(0.0, front, [0.1, 0.9, 0.4]), (1.0, back, [1.0, 0.2, 0.4])];
                let linear = TransferFunction::new(
                    ends.map(|(s, _, rgb)| ColorNode { s, rgb }).to_vec(),
                    ends.map(|(s, opacity, _)| OpacityNode { s, opacity }).to_vec(),
                );
                let exact = segment(&linear.unwrap(), 1.0, 0.0, 1.0, length);
                let [front, back] = ends.map(|(_, opacity, [r, g, b])| [r, g, b, opacity].map(|x| x as f32));
                let found = shade(Weights::Direct, front, back, length as f32);
                let [r, g, b] = exact.color;
                for (found, exact) in found.into_iter().zip([r, g, b, exact.alpha]) {
                    assert!(
                        (f64::from(found) - exact).abs() <= TOLERANCE * exact,
                        "{front:?} {back:?} {length}: {found}, {exact}"
                    );
                }
            }
        }
    }
}
