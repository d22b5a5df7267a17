//! 1D transfer functions: luminance and opacity, each piecewise linear in the scalar, with its own nodes.

mod bounds;
#[cfg(test)]
mod tests;

/// Luminance at one scalar value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ColorNode {
    /// Scalar value.
    pub s: f64,
    /// Linear RGB luminance, each at least 0; values above 1 are allowed.
    pub rgb: [f64; 3],
}

/// Opacity at one scalar value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OpacityNode {
    /// Scalar value.
    pub s: f64,
    /// Extinction times the unit distance: at least 0, may exceed 1.
    pub opacity: f64,
}

/// A scalar interval on which luminance and opacity are both linear.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Piece {
    /// Scalar at the two ends, ascending.
    pub s: [f64; 2],
    /// Opacity at the two ends, as limits from inside the piece.
    pub opacity: [f64; 2],
    /// Linear RGB luminance at the two ends, as limits from inside the piece.
    pub luminance: [[f64; 3]; 2],
}

/// Which of the two node lists of a transfer function is meant.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NodeKind {
    /// The luminance nodes.
    Color,
    /// The opacity nodes.
    Opacity,
}

impl std::fmt::Display for NodeKind {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Color => "color",
            Self::Opacity => "opacity",
        })
    }
}

/// Why node lists make no transfer function. `index` counts from 0 within the list of `kind`.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum TransferFunctionError {
    /// A list without nodes.
    #[error("no {kind} nodes: give at least one")]
    Empty {
        /// The empty list.
        kind: NodeKind,
    },
    /// A position that is not finite, or beyond half of the f64 range, where a distance would overflow.
    #[error("{kind} node {index}: position {s} must be finite and within +-8.9e307")]
    Position {
        /// The list.
        kind: NodeKind,
        /// The node.
        index: usize,
        /// Its position.
        s: f64,
    },
    /// A position below its predecessor's.
    #[error("{kind} node {index}: position {s} is below the node before it ({previous}): sort the nodes")]
    Order {
        /// The list.
        kind: NodeKind,
        /// The node.
        index: usize,
        /// Its position.
        s: f64,
        /// The position of the node before it.
        previous: f64,
    },
    /// More than two nodes at one position.
    #[error("{kind} node {index}: a third node at position {s}: a step takes two, the limits from below and above")]
    Crowded {
        /// The list.
        kind: NodeKind,
        /// The third node.
        index: usize,
        /// The shared position.
        s: f64,
    },
    /// A luminance or opacity that is negative or not finite.
    #[error("{kind} node {index} (at {s}): value {value} must be finite and at least 0")]
    Value {
        /// The list.
        kind: NodeKind,
        /// The node.
        index: usize,
        /// Its position.
        s: f64,
        /// The offending luminance component or opacity.
        value: f64,
    },
}

/// Luminance and opacity over the scalar; constant outside the nodes.
///
/// Colour and opacity have independent nodes. Two nodes of one list at the same scalar make a step: the first is the
/// limit from below, the second the value at the step and above it.
#[derive(Clone, Debug, PartialEq)]
pub struct TransferFunction {
    color: Vec<ColorNode>,
    opacity: Vec<OpacityNode>,
}

impl TransferFunction {
    /// Takes node lists in non-decreasing order of `s`, each with at least one node and at most two at one `s`.
    ///
    /// # Errors
    ///
    /// Names the node and the value that break these rules, or are negative or not finite.
    pub fn new(color: Vec<ColorNode>, opacity: Vec<OpacityNode>) -> Result<Self, TransferFunctionError> {
        validate(NodeKind::Color, &color, |node| (node.s, node.rgb))?;
        validate(NodeKind::Opacity, &opacity, |node| (node.s, [node.opacity]))?;
        Ok(Self { color, opacity })
    }

    /// The luminance nodes, ascending.
    pub fn color_nodes(&self) -> &[ColorNode] {
        &self.color
    }

    /// The opacity nodes, ascending.
    pub fn opacity_nodes(&self) -> &[OpacityNode] {
        &self.opacity
    }

    /// All node positions, ascending, without duplicates; at least one. Between two of them both functions are linear.
    pub fn control_points(&self) -> Vec<f64> {
        let color = self.color.iter().map(|node| node.s);
        let mut points: Vec<f64> = color.chain(self.opacity.iter().map(|node| node.s)).collect();
        points.sort_by(f64::total_cmp);
        points.dedup();
        points
    }

    /// Linear RGB luminance at `s`; at a step the value from above. NaN takes the first node's.
    pub fn luminance(&self, s: f64) -> [f64; 3] {
        self.mix_luminance(Bracket::from_above(&self.color, |node| node.s, s))
    }

    /// The limit of the luminance from below `s`; differs from [`Self::luminance`] at a step only.
    pub fn luminance_below(&self, s: f64) -> [f64; 3] {
        self.mix_luminance(Bracket::from_below(&self.color, |node| node.s, s))
    }

    /// Opacity at `s`; at a step the value from above. NaN takes the first node's.
    pub fn opacity(&self, s: f64) -> f64 {
        self.mix_opacity(Bracket::from_above(&self.opacity, |node| node.s, s))
    }

    /// The limit of the opacity from below `s`; differs from [`Self::opacity`] at a step only.
    pub fn opacity_below(&self, s: f64) -> f64 {
        self.mix_opacity(Bracket::from_below(&self.opacity, |node| node.s, s))
    }

    /// The intervals between consecutive control points, ascending: one fewer than there are control points. Outside
    /// them the function is constant.
    pub fn pieces(&self) -> Vec<Piece> {
        let points = self.control_points();
        let between = |ends: &[f64]| Piece {
            s: [ends[0], ends[1]],
            opacity: [self.opacity(ends[0]), self.opacity_below(ends[1])],
            luminance: [self.luminance(ends[0]), self.luminance_below(ends[1])],
        };
        points.windows(2).map(between).collect()
    }

    /// The largest opacity over the closed `range`, given in either order, both values of a step at its ends included.
    /// A NaN end means the whole axis, so that culling by this bound stays safe.
    pub fn max_opacity(&self, range: [f64; 2]) -> f64 {
        let [low, high] = match range {
            [a, b] if a <= b => [a, b],
            [a, b] if b < a => [b, a],
            _ => [f64::NEG_INFINITY, f64::INFINITY],
        };
        let first = self.opacity.partition_point(|node| node.s < low);
        let end = self.opacity.partition_point(|node| node.s <= high);
        let inside = self.opacity[first..end].iter().map(|node| node.opacity);
        inside.fold(self.opacity(low).max(self.opacity(high)), f64::max)
    }

    /// The luminance, if it is the same wherever the opacity is above 0: then the order of segments along a ray does
    /// not matter. Black where the opacity is 0 everywhere.
    pub fn single_luminance(&self) -> Option<[f64; 3]> {
        let mut single = None;
        for piece in self.visible_pieces() {
            for rgb in piece.luminance {
                if *single.get_or_insert(rgb) != rgb {
                    return None;
                }
            }
        }
        Some(single.unwrap_or([0.0; 3]))
    }

    /// The pieces and the two constant ends, without those of zero opacity.
    pub(crate) fn visible_pieces(&self) -> impl Iterator<Item = Piece> {
        let constant =
            |s: f64, opacity: f64, rgb: [f64; 3]| Piece { s: [s; 2], opacity: [opacity; 2], luminance: [rgb; 2] };
        let (low, high) = (f64::NEG_INFINITY, f64::INFINITY);
        let ends = [low, high].map(|s| constant(s, self.opacity(s), self.luminance(s)));
        self.pieces().into_iter().chain(ends).filter(|piece| piece.opacity != [0.0; 2])
    }

    fn mix_luminance(&self, bracket: Bracket) -> [f64; 3] {
        let [from, to] = bracket.nodes.map(|index| self.color[index].rgb);
        std::array::from_fn(|channel| bracket.mix(from[channel], to[channel]))
    }

    fn mix_opacity(&self, bracket: Bracket) -> f64 {
        let [from, to] = bracket.nodes.map(|index| self.opacity[index].opacity);
        bracket.mix(from, to)
    }
}

/// The two nodes around a scalar and their weights.
struct Bracket {
    nodes: [usize; 2],
    weights: [f64; 2],
}

impl Bracket {
    fn from_above<N>(nodes: &[N], position: impl Fn(&N) -> f64, s: f64) -> Self {
        Self::new(nodes, &position, s, nodes.partition_point(|node| position(node) <= s))
    }

    fn from_below<N>(nodes: &[N], position: impl Fn(&N) -> f64, s: f64) -> Self {
        Self::new(nodes, &position, s, nodes.partition_point(|node| position(node) < s))
    }

    /// `next` is the first node on the far side of `s`; the list is not empty.
    fn new<N>(nodes: &[N], position: &impl Fn(&N) -> f64, s: f64, next: usize) -> Self {
        if next == 0 || next == nodes.len() {
            let end = next.saturating_sub(1);
            return Self { nodes: [end; 2], weights: [1.0, 0.0] };
        }
        let (from, to) = (position(&nodes[next - 1]), position(&nodes[next]));
        // Both weights by their own difference: a value near either end keeps its relative accuracy.
        Self { nodes: [next - 1, next], weights: [(to - s) / (to - from), (s - from) / (to - from)] }
    }

    fn mix(&self, from: f64, to: f64) -> f64 {
        // Equal values must stay equal to the last bit: a single luminance is recognised by comparison.
        if from == to { from } else { self.weights[0] * from + self.weights[1] * to }
    }
}

fn validate<N, const C: usize>(
    kind: NodeKind,
    nodes: &[N],
    parts: impl Fn(&N) -> (f64, [f64; C]),
) -> Result<(), TransferFunctionError> {
    if nodes.is_empty() {
        return Err(TransferFunctionError::Empty { kind });
    }
    let position = |index: usize| parts(&nodes[index]).0;
    for index in 0..nodes.len() {
        let (s, values) = parts(&nodes[index]);
        if !s.is_finite() || s.abs() > f64::MAX / 2.0 {
            return Err(TransferFunctionError::Position { kind, index, s });
        }
        if index >= 1 && s < position(index - 1) {
            return Err(TransferFunctionError::Order { kind, index, s, previous: position(index - 1) });
        }
        if index >= 2 && s == position(index - 2) {
            return Err(TransferFunctionError::Crowded { kind, index, s });
        }
        if let Some(&value) = values.iter().find(|value| !value.is_finite() || **value < 0.0) {
            return Err(TransferFunctionError::Value { kind, index, s, value });
        }
    }
    Ok(())
}
