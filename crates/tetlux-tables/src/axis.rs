//! The axes of a table: how a parameter is laid along its nodes.

use serde::{Deserialize, Serialize};

/// Stands for an infinite parameter at the last node of an unbounded axis; every tabulated function is at its limit.
pub const INFINITE: f64 = 1e13;

/// How a parameter x maps to the coordinate g in [0, 1].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", tag = "map")]
pub enum AxisMap {
    /// g = (x - min) / (max - min), clamped.
    Linear {
        /// x at g = 0.
        min: f64,
        /// x at g = 1.
        max: f64,
    },
    /// g = x / (1 + x) for x in [0, inf): gamma of Moreland and Angel 2004.
    Ratio,
    /// g = 1 - (1 + x)^(-1/4) for x in [0, inf).
    Quarter,
    /// g = 1 - (1 + x)^(-1/3) for x in [0, inf).
    Third,
    /// g = sqrt x for x in [0, 1].
    Root,
    /// Linear up to 2^-(n-2) max, then one node for each doubling up to max, n being the number of nodes: Kraus, Qiao
    /// and Ebert 2004, equation 1, whose texture coordinate is ((n - 1) g + 1/2) / n.
    Logarithm {
        /// x at g = 1.
        max: f64,
    },
}

/// One axis: its parameter, the number of nodes and their places. Nodes lie at g = i / (n - 1), both ends included.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Axis {
    /// The parameter, in the symbols of the table's description.
    pub name: String,
    /// Number of nodes, at least 2.
    pub nodes: u32,
    /// Where they lie.
    #[serde(flatten)]
    pub map: AxisMap,
}

impl Axis {
    pub(crate) fn new(name: &str, nodes: u32, map: AxisMap) -> Self {
        Self { name: name.to_owned(), nodes, map }
    }

    /// The parameter at node `index`; [`INFINITE`] at the last node of an unbounded axis.
    pub fn value(&self, index: u32) -> f64 {
        let g = f64::from(index) / f64::from(self.nodes - 1);
        let last = index + 1 >= self.nodes;
        match self.map {
            AxisMap::Linear { max, .. } | AxisMap::Logarithm { max } if last => max,
            AxisMap::Ratio | AxisMap::Quarter | AxisMap::Third if last => INFINITE,
            AxisMap::Linear { min, max } => min + (max - min) * g,
            AxisMap::Ratio => g / (1.0 - g),
            AxisMap::Quarter => (1.0 - g).powi(-4) - 1.0,
            AxisMap::Third => (1.0 - g).powi(-3) - 1.0,
            AxisMap::Root => g * g,
            AxisMap::Logarithm { .. } if index == 0 => 0.0,
            AxisMap::Logarithm { max } => max * (f64::from(index) - f64::from(self.nodes - 1)).exp2(),
        }
    }

    /// The coordinate g in [0, 1] of parameter `x`, in f32 as a shader computes it. NaN counts as 0.
    pub fn coordinate(&self, x: f32) -> f32 {
        let positive = x.max(0.0);
        let g = match self.map {
            AxisMap::Linear { min, max } => (x - min as f32) / (max - min) as f32,
            // As 1 - 1/(1 + x): finite for every x.
            AxisMap::Ratio => 1.0 - 1.0 / (1.0 + positive),
            AxisMap::Quarter => 1.0 - 1.0 / (1.0 + positive).sqrt().sqrt(),
            AxisMap::Third => 1.0 - 1.0 / (1.0 + positive).cbrt(),
            AxisMap::Root => positive.sqrt(),
            AxisMap::Logarithm { max } => {
                let intervals = (self.nodes - 1) as f32;
                let steps = positive / max as f32 * (intervals - 1.0).exp2();
                (steps.max(1.0).log2() + steps.min(1.0)) / intervals
            }
        };
        unit(g)
    }
}

/// The nearest value in [0, 1]; 0 for NaN.
pub(crate) fn unit(g: f32) -> f32 {
    if g > 0.0 { g.min(1.0) } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MAPS: [AxisMap; 6] = [
        AxisMap::Linear { min: -4.0, max: 4.0 },
        AxisMap::Ratio,
        AxisMap::Quarter,
        AxisMap::Third,
        AxisMap::Root,
        AxisMap::Logarithm { max: 3.0 },
    ];

    #[test]
    fn a_node_has_its_own_coordinate() {
        // A few ulp of the largest intermediate value, 1.
        let tolerance = 1e-6;
        for map in MAPS {
            let axis = Axis::new("x", 12, map);
            for i in 0..11 {
                let g = axis.coordinate(axis.value(i) as f32);
                assert!((g - i as f32 / 11.0).abs() < tolerance, "{map:?}: node {i} at {g}");
            }
            // (1 + 1e13)^(-1/4) is 6e-4.
            assert!(axis.coordinate(axis.value(11) as f32) > 1.0 - 6e-4, "{map:?}");
        }
    }

    #[test]
    fn coordinates_stay_in_the_unit_interval() {
        for map in MAPS {
            let axis = Axis::new("x", 5, map);
            for x in [f32::NAN, f32::NEG_INFINITY, -1.0, 0.0, f32::MIN_POSITIVE, 1e30, f32::MAX, f32::INFINITY] {
                let g = axis.coordinate(x);
                assert!((0.0..=1.0).contains(&g), "{map:?} at {x}: {g}");
            }
        }
    }

    #[test]
    fn the_logarithmic_axis_doubles() {
        let axis = Axis::new("l", 8, AxisMap::Logarithm { max: 1.0 });
        let values: Vec<f64> = (0..8).map(|i| axis.value(i)).collect();
        // Kraus, Qiao and Ebert 2004, figure 6: for n_r = 8 the linear part ends at l_max / 64.
        assert_eq!(values, [0.0, 1.0 / 64.0, 1.0 / 32.0, 1.0 / 16.0, 0.125, 0.25, 0.5, 1.0]);
    }
}
