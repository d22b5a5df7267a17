//! What a transfer function does at most, and one with fewer nodes that does nearly the same.

use super::{ColorNode, TransferFunction};

impl TransferFunction {
    /// The closed intervals, ascending and apart, on which the opacity is nowhere above `threshold`: a range has
    /// [`max_opacity`](Self::max_opacity) of at most the threshold if it lies in one of them, and only then (but for
    /// the rounding of where a ramp passes a threshold above 0). Made once, it is asked for every cell.
    pub fn dark_intervals(&self, threshold: f64) -> Vec<[f64; 2]> {
        let dark = |opacity: f64| opacity <= threshold;
        let mut intervals = Vec::new();
        let mut start = dark(self.opacity[0].opacity).then_some(f64::NEG_INFINITY);
        for pair in self.opacity.windows(2) {
            let [a, b] = [pair[0], pair[1]];
            let step = a.s == b.s;
            let at = |from: f64, to: f64, share: f64| from + (to - from) * share.clamp(0.0, 1.0);
            match (dark(a.opacity), dark(b.opacity)) {
                (true, false) => {
                    // Both values of a step count at its place.
                    let end = if step {
                        a.s.next_down()
                    } else {
                        at(a.s, b.s, (threshold - a.opacity) / (b.opacity - a.opacity))
                    };
                    intervals.extend(start.filter(|&start| start <= end).map(|start| [start, end]));
                    start = None;
                }
                (false, true) => {
                    start = Some(if step {
                        b.s.next_up()
                    } else {
                        at(b.s, a.s, (threshold - b.opacity) / (a.opacity - b.opacity))
                    });
                }
                _ => {}
            }
        }
        intervals.extend(start.map(|start| [start, f64::INFINITY]));
        intervals
    }

    /// The largest difference of a component of the luminance between any two places of opacity above 0.
    pub fn luminance_spread(&self) -> f64 {
        let mut bounds = [[f64::INFINITY, f64::NEG_INFINITY]; 3];
        for rgb in self.visible_pieces().flat_map(|piece| piece.luminance) {
            for channel in 0..3 {
                let [low, high] = bounds[channel];
                bounds[channel] = [low.min(rgb[channel]), high.max(rgb[channel])];
            }
        }
        bounds.into_iter().map(|[low, high]| high - low).fold(0.0, f64::max)
    }

    /// The same opacity, and a luminance with fewer nodes that is nowhere off by more than `tolerance` in any
    /// component. A picture's colours are weighted means of luminances, with weights that add up to its alpha: no
    /// pixel changes by more than the tolerance. Steps stay.
    pub fn with_fewer_colors(&self, tolerance: f64) -> TransferFunction {
        let nodes = &self.color;
        let mut color = vec![nodes[0]];
        let mut from = 0;
        while from + 1 < nodes.len() {
            from = self.farthest(from, tolerance);
            color.push(nodes[from]);
        }
        TransferFunction { color, opacity: self.opacity.clone() }
    }

    /// The last colour node to which a straight line from node `from` passes all nodes between within a tolerance.
    fn farthest(&self, from: usize, tolerance: f64) -> usize {
        let nodes = &self.color;
        let origin = nodes[from];
        let slopes = |node: &ColorNode, off: f64| -> [f64; 3] {
            std::array::from_fn(|i| (node.rgb[i] + off - origin.rgb[i]) / (node.s - origin.s))
        };
        // Of lines that pass all nodes so far, the least and the largest slopes.
        let mut cone = [[f64::NEG_INFINITY; 3], [f64::INFINITY; 3]];
        let mut reached = from + 1;
        if nodes[reached].s == origin.s {
            return reached;
        }
        for next in from + 1..nodes.len() {
            if nodes[next].s == nodes[next - 1].s {
                break;
            }
            let slope = slopes(&nodes[next], 0.0);
            if (0..3).all(|i| cone[0][i] <= slope[i] && slope[i] <= cone[1][i]) {
                reached = next;
            }
            let (low, high) = (slopes(&nodes[next], -tolerance), slopes(&nodes[next], tolerance));
            cone = [std::array::from_fn(|i| cone[0][i].max(low[i])), std::array::from_fn(|i| cone[1][i].min(high[i]))];
            if (0..3).any(|i| cone[0][i] > cone[1][i]) {
                break;
            }
        }
        reached
    }
}

#[cfg(test)]
mod tests {
    use super::super::OpacityNode;
    use super::*;
    use crate::accuracy::Random;

    fn transfer(color: &[[f64; 2]], opacity: &[[f64; 2]]) -> TransferFunction {
        TransferFunction::new(
            color.iter().map(|&[s, v]| ColorNode { s, rgb: [v, 0.5 * v, 1.0 - v] }).collect(),
            opacity.iter().map(|&[s, opacity]| OpacityNode { s, opacity }).collect(),
        )
        .unwrap()
    }

    /// Nodes at multiples of 1/8, some of them steps, some dark.
    fn random(random: &mut Random) -> TransferFunction {
        let mut nodes = Vec::new();
        for k in 0..12 {
            for _ in 0..1 + usize::from(random.unit() < 0.3) {
                let height = (4.0 * random.unit()).floor() / 4.0;
                nodes.push([f64::from(k) / 8.0, height]);
            }
        }
        transfer(&[[0.0, 0.5]], &nodes)
    }

    #[test]
    fn a_range_is_dark_where_its_largest_opacity_is() {
        let mut numbers = Random::new(5);
        let mut dark = 0;
        for _ in 0..200 {
            let function = random(&mut numbers);
            for threshold in [0.0, 0.25, 0.6] {
                let intervals = function.dark_intervals(threshold);
                assert!(intervals.windows(2).all(|w| w[0][1] < w[1][0]), "{intervals:?}");
                for _ in 0..50 {
                    // Ends on nodes, where steps are, and between them.
                    let mut place =
                        || (numbers.unit() * 16.0 - 2.0).floor() / 8.0 + if numbers.unit() < 0.5 { 0.0 } else { 0.03 };
                    let (a, b) = (place(), place());
                    let range = [a.min(b), a.max(b)];
                    let inside = intervals.iter().any(|i| i[0] <= range[0] && range[1] <= i[1]);
                    assert_eq!(inside, function.max_opacity(range) <= threshold, "{range:?} of {function:?}");
                    dark += usize::from(inside);
                }
            }
        }
        assert!(dark > 1000, "{dark}");
    }

    #[test]
    fn spread_is_of_what_is_seen() {
        let ramp = [[0.0, 0.0], [1.0, 1.0], [2.0, 0.25]];
        assert_eq!(transfer(&ramp, &[[0.0, 1.0]]).luminance_spread(), 1.0);
        // From 1 on nothing is seen; at 1/2 red is 1/2, and blue falls as red rises.
        let fading = transfer(&[[0.0, 0.0], [0.5, 0.5], [1.0, 1.0]], &[[0.0, 1.0], [0.5, 0.0], [2.0, 0.0]]);
        assert_eq!(fading.luminance_spread(), 0.5);
        assert_eq!(transfer(&ramp, &[[0.0, 0.0]]).luminance_spread(), 0.0);
    }

    #[test]
    fn fewer_colors_stay_within_the_tolerance() {
        // A parabola: chords of width w are off by w^2 / 4 at most, so that about 1 / (2 sqrt(tolerance)) are needed.
        let nodes: Vec<[f64; 2]> = (0..=256).map(|k| f64::from(k) / 256.0).map(|s| [s, s * s]).collect();
        let function = transfer(&nodes, &[[0.0, 1.0], [1.0, 0.0]]);
        for tolerance in [1e-2, 1e-3, 1e-4] {
            let simple = function.with_fewer_colors(tolerance);
            let count = simple.color_nodes().len() as f64;
            assert!((0.8..2.5).contains(&(count * 2.0 * f64::sqrt(tolerance))), "{count} nodes for {tolerance}");
            for k in 0..=1000 {
                let s = f64::from(k) / 1000.0;
                let [a, b] = [&function, &simple].map(|f| f.luminance(s));
                // Roundings of the cone come on top.
                assert!((0..3).all(|i| (a[i] - b[i]).abs() <= tolerance + 1e-12), "{a:?} and {b:?} at {s}");
            }
            assert_eq!(simple.opacity_nodes(), function.opacity_nodes());
        }
        let exact = transfer(&[[0.0, 0.0], [0.25, 0.25], [1.0, 1.0]], &[[0.0, 1.0]]).with_fewer_colors(0.0);
        assert_eq!(exact.color_nodes().len(), 2, "nodes on a line are not needed");
    }

    #[test]
    fn steps_of_color_stay() {
        let stairs = transfer(&[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [2.0, 1.0], [2.0, 0.0], [3.0, 0.0]], &[[0.0, 1.0]]);
        assert_eq!(stairs.with_fewer_colors(0.1), stairs);
    }
}
