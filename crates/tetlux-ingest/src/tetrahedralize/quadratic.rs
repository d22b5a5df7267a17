//! Quadratic cells, cut at the points in the middle of their edges (and faces).
//!
//! A triangle with three mid-edge points becomes four triangles, a quadrilateral with four becomes four at its corners
//! and two between the mid-edge points, one with a fifth in its middle four quadrilaterals. What is inside follows.

use std::sync::LazyLock;

use tetlux_mesh::procedural::for_each_hexahedron;

use super::{Tetrahedra, fan, pull};
use crate::cell_type::{
    BIQUADRATIC_WEDGE, CellType, HEXAHEDRON, PYRAMID, QUADRATIC_HEXAHEDRON, QUADRATIC_PYRAMID, QUADRATIC_TETRAHEDRON,
    QUADRATIC_WEDGE, TRIQUADRATIC_HEXAHEDRON, WEDGE,
};

/// Points of a [`QUADRATIC_PYRAMID`] that has one in the middle of its base.
pub(crate) const PYRAMID_WITH_BASE_POINT: usize = 14;

/// Splits a quadratic cell; false if it is none of those known.
pub(super) fn split(kind: &'static CellType, points: &[u32], origin: usize, made: &mut Tetrahedra) -> bool {
    match kind.number {
        QUADRATIC_TETRAHEDRON => tetrahedron(points, origin, made),
        QUADRATIC_HEXAHEDRON => PATTERNS[0].split(points, origin, made),
        QUADRATIC_WEDGE => made.mend(|made| PATTERNS[1].split(points, origin, made)),
        QUADRATIC_PYRAMID if points.len() < PYRAMID_WITH_BASE_POINT => PATTERNS[2].split(points, origin, made),
        QUADRATIC_PYRAMID => pyramid_with_base_point(points, origin, made),
        TRIQUADRATIC_HEXAHEDRON => hexahedron_of_27(points, origin, made),
        BIQUADRATIC_WEDGE => made.mend(|made| wedge_of_18(points, origin, made)),
        _ => return false,
    }
    true
}

/// Edges of the linear cells, in the order of the mid-edge points of the quadratic ones (VTK User's Guide, "VTK file
/// formats", and vtkQuadraticTetra.h and its like).
const HEXAHEDRON_EDGES: &[[usize; 2]] =
    &[[0, 1], [1, 2], [2, 3], [3, 0], [4, 5], [5, 6], [6, 7], [7, 4], [0, 4], [1, 5], [2, 6], [3, 7]];
const WEDGE_EDGES: &[[usize; 2]] = &[[0, 1], [1, 2], [2, 0], [3, 4], [4, 5], [5, 3], [0, 3], [1, 4], [2, 5]];
const PYRAMID_EDGES: &[[usize; 2]] = &[[0, 1], [1, 2], [2, 3], [3, 0], [0, 4], [1, 4], [2, 4], [3, 4]];

/// Pairs of opposite corners of the octahedron between a tetrahedron's mid-edge points, and the four round each pair.
const OCTAHEDRON: [([usize; 2], [usize; 4]); 3] =
    [([4, 9], [6, 7, 8, 5]), ([5, 7], [8, 9, 6, 4]), ([6, 8], [4, 5, 9, 7])];

/// Four tetrahedra at the corners, and four round the shortest diagonal of the octahedron between them.
fn tetrahedron(points: &[u32], origin: usize, made: &mut Tetrahedra) {
    for corner in [[0, 4, 6, 7], [4, 1, 5, 8], [6, 5, 2, 9], [7, 8, 9, 3]] {
        made.push_split(corner.map(|i| points[i]), origin);
    }
    let length = |[a, b]: [usize; 2]| {
        let [a, b] = [a, b].map(|i| made.points[points[i] as usize]);
        a.distance_squared(b)
    };
    let shortest = OCTAHEDRON.iter().min_by(|a, b| length(a.0).total_cmp(&length(b.0)));
    let &([a, b], ring) = shortest.unwrap_or(&OCTAHEDRON[0]);
    for i in 0..4 {
        made.push_split([a, b, ring[i], ring[(i + 1) % 4]].map(|i| points[i]), origin);
    }
}

/// How a cell with mid-edge points alone is split: caps are cut off at its corners, and what is left, a polyhedron of
/// the mid-edge points, is split from a point added in its middle.
struct Pattern {
    edges: &'static [[usize; 2]],
    /// Number of corners, and so of the first mid-edge point.
    corners: usize,
    /// Each corner, and the mid-edge points round it, counter-clockwise seen from it.
    caps: Vec<(usize, Vec<usize>)>,
    /// What is left, face by face, counter-clockwise seen from outside.
    faces: Vec<Vec<usize>>,
    /// The cell's interpolation in its middle: the weight of each point.
    weights: Vec<f64>,
}

static PATTERNS: LazyLock<[Pattern; 3]> = LazyLock::new(|| {
    // The serendipity functions in the middle of a hexahedron and of a wedge (Zienkiewicz and Taylor, The Finite
    // Element Method, volume 1); for a pyramid the mean of its mid-edge points.
    let hexahedron = [vec![-0.25; 8], vec![0.25; 12]].concat();
    let wedge = [vec![-2.0 / 9.0; 6], vec![2.0 / 9.0; 6], vec![1.0 / 3.0; 3]].concat();
    let pyramid = [vec![0.0; 5], vec![0.125; 8]].concat();
    [
        Pattern::new(HEXAHEDRON, HEXAHEDRON_EDGES, hexahedron),
        Pattern::new(WEDGE, WEDGE_EDGES, wedge),
        Pattern::new(PYRAMID, PYRAMID_EDGES, pyramid),
    ]
});

impl Pattern {
    fn new(linear: u8, edges: &'static [[usize; 2]], weights: Vec<f64>) -> Pattern {
        let corners = weights.len() - edges.len();
        let middle =
            |a: usize, b: usize| corners + edges.iter().position(|e| *e == [a, b] || *e == [b, a]).unwrap_or_default();
        let (mut faces, mut round) = (Vec::new(), vec![Vec::new(); corners]);
        for face in CellType::of(linear).map_or(&[][..], |kind| kind.faces) {
            let n = face.len();
            let middles: Vec<usize> = (0..n).map(|i| middle(face[i], face[(i + 1) % n])).collect();
            for i in 0..n {
                // Round a corner, seen from it, faces follow one another from their edge out to their edge in.
                round[face[i]].push((middles[i], middles[(i + n - 1) % n]));
            }
            faces.push(middles);
        }
        let mut caps = Vec::new();
        for (corner, steps) in round.into_iter().enumerate() {
            let mut cap = vec![steps[0].0];
            while cap.len() < steps.len() {
                let last = cap[cap.len() - 1];
                cap.extend(steps.iter().find(|step| step.0 == last).map(|step| step.1));
            }
            faces.push(cap.clone());
            caps.push((corner, cap));
        }
        Pattern { edges, corners, caps, faces, weights }
    }

    fn split(&self, points: &[u32], origin: usize, made: &mut Tetrahedra) {
        // Of a quadrilateral with a collapsed edge the triangle's three mid-edge points are left together.
        let key = |made: &Tetrahedra, i: usize| {
            let rank = made.rank(points[i]);
            let collapsed = self.edges[i - self.corners].iter().any(|&end| made.rank(points[end]) == rank);
            (collapsed, rank)
        };
        for (corner, cap) in &self.caps {
            fan(
                cap.len(),
                |made, i| key(made, cap[i]),
                made,
                |made, [i, j, k]| {
                    made.push_split([*corner, cap[i], cap[k], cap[j]].map(|i| points[i]), origin);
                },
            );
        }
        let parts: Vec<(u32, f64)> = points.iter().copied().zip(self.weights.iter().copied()).collect();
        let center = made.add_point(&parts);
        for face in &self.faces {
            fan(
                face.len(),
                |made, i| key(made, face[i]),
                made,
                |made, [i, j, k]| {
                    let [a, b, c] = [i, j, k].map(|i| points[face[i]]);
                    made.push_split([center, a, b, c], origin);
                },
            );
        }
    }
}

/// Six pyramids and, between those at the sides, four tetrahedra.
fn pyramid_with_base_point(points: &[u32], origin: usize, made: &mut Tetrahedra) {
    const PYRAMIDS: [[usize; 5]; 6] = [
        [0, 5, 13, 8, 9],
        [5, 1, 6, 13, 10],
        [13, 6, 2, 7, 11],
        [8, 13, 7, 3, 12],
        [9, 10, 11, 12, 4],
        [9, 12, 11, 10, 13],
    ];
    let Some(kind) = CellType::of(PYRAMID) else { return };
    for pyramid in PYRAMIDS {
        pull(kind, &pyramid.map(|i| points[i]), origin, made);
    }
    for tetrahedron in [[13, 5, 10, 9], [13, 6, 11, 10], [13, 7, 12, 11], [13, 8, 9, 12]] {
        made.push_split(tetrahedron.map(|i| points[i]), origin);
    }
}

/// Eight hexahedra.
fn hexahedron_of_27(points: &[u32], origin: usize, made: &mut Tetrahedra) {
    /// Points of the cell (vtkTriQuadraticHexahedron.h) in the order of a grid of 3 x 3 x 3.
    const GRID: [usize; 27] =
        [0, 8, 1, 11, 24, 9, 3, 10, 2, 16, 22, 17, 20, 26, 21, 19, 23, 18, 4, 12, 5, 15, 25, 13, 7, 14, 6];
    let Some(kind) = CellType::of(HEXAHEDRON) else { return };
    for_each_hexahedron([3; 3], |_, corners| pull(kind, &corners.map(|i| points[GRID[i as usize]]), origin, made));
}

/// Eight wedges, four on four.
fn wedge_of_18(points: &[u32], origin: usize, made: &mut Tetrahedra) {
    /// Points of the cell (vtkBiQuadraticQuadraticWedge.h) in three layers, each of three corners and three points
    /// between these.
    const LAYERS: [[usize; 6]; 3] = [[0, 1, 2, 6, 7, 8], [12, 13, 14, 15, 16, 17], [3, 4, 5, 9, 10, 11]];
    const TRIANGLES: [[usize; 3]; 4] = [[0, 3, 5], [3, 1, 4], [5, 4, 2], [3, 4, 5]];
    let Some(kind) = CellType::of(WEDGE) else { return };
    for layers in LAYERS.windows(2) {
        for [a, b, c] in TRIANGLES {
            let corners = [layers[0][a], layers[0][b], layers[0][c], layers[1][a], layers[1][b], layers[1][c]];
            pull(kind, &corners.map(|i| points[i]), origin, made);
        }
    }
}

#[cfg(test)]
mod tests;
