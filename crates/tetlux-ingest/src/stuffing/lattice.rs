//! The body-centred cubic lattice: two cubic grids, each with its nodes in the middle of the other's cubes.

use glam::DVec3;

use super::crossings;
use crate::IngestError;
use crate::surface::Surface;

/// Nodes of both grids at most: some gigabytes of tetrahedra.
const MOST_NODES: u64 = 1 << 25;
/// Tests of a triangle against a lattice line at most.
const MOST_TESTS: u64 = 1 << 27;

/// From a node to half of its neighbours, in half cell sizes: along the axes the long edges, within a grid; along the
/// diagonals the short ones, from grid to grid. Other neighbours are in the opposite directions.
pub(super) const DIRECTIONS: [[i32; 3]; 7] =
    [[2, 0, 0], [0, 2, 0], [0, 0, 2], [1, 1, 1], [1, 1, -1], [1, -1, 1], [1, -1, -1]];

pub(super) fn is_long(direction: usize) -> bool {
    direction < 3
}

/// A box of the lattice. Coordinates of nodes are whole numbers of half cell sizes: all even in one grid, all odd in
/// the other.
pub(super) struct Lattice {
    /// Nodes of either grid along each axis.
    counts: [usize; 3],
    origin: DVec3,
    /// Half the cell size.
    half: f64,
}

impl Lattice {
    /// The lattice round a surface, with a cell to spare on each side.
    pub(super) fn round(surface: &Surface, cell_size: f64) -> Result<Lattice, IngestError> {
        let path = || surface.path.clone();
        if !(cell_size > 0.0 && cell_size.is_finite()) {
            return Err(IngestError::CellSize { path: path(), cell_size });
        }
        let [low, high] = surface.bounds();
        let extent = high - low;
        // In f64, which holds any count; saturated where it becomes whole.
        let cubes = |size: f64| extent.to_array().map(|e| (e / size).ceil() + 2.0);
        let nodes = |size: f64| cubes(size).iter().map(|n| n + 1.0).product::<f64>() * 2.0;
        let at = |size: f64| Lattice {
            counts: cubes(size).map(|n| n as usize + 1),
            origin: (low + high - DVec3::from_array(cubes(size)) * size) * 0.5,
            half: size * 0.5,
        };
        let fits = |size: f64| nodes(size) <= MOST_NODES as f64 && crossings::tests(surface, &at(size)) <= MOST_TESTS;
        if fits(cell_size) {
            return Ok(at(cell_size));
        }
        // Coarse enough for certain, then finer as long as it fits.
        let mut fitting = extent.max_element().max(cell_size);
        while fitting * 0.9 > cell_size && fits(fitting * 0.9) {
            fitting *= 0.9;
        }
        Err(IngestError::TooFine { path: path(), cell_size, nodes: nodes(cell_size), limit: MOST_NODES, fitting })
    }

    /// Number of nodes.
    pub(super) fn nodes(&self) -> usize {
        2 * self.counts.iter().product::<usize>()
    }

    /// The node at coordinates; `None` beyond the box.
    pub(super) fn node(&self, at: [i32; 3]) -> Option<usize> {
        let odd = at[0] & 1;
        let [i, j, k] = at.map(|x| usize::try_from((x - odd) >> 1).unwrap_or(usize::MAX));
        let [ni, nj, nk] = self.counts;
        (i < ni && j < nj && k < nk).then(|| ((k * nj + j) * ni + i) * 2 + odd as usize)
    }

    /// The coordinates of a node.
    pub(super) fn coordinates(&self, node: usize) -> [i32; 3] {
        let [ni, nj, _] = self.counts;
        let (place, odd) = (node / 2, (node % 2) as i32);
        [place % ni, place / ni % nj, place / ni / nj].map(|i| 2 * i as i32 + odd)
    }

    /// World position of a node.
    pub(super) fn position(&self, node: usize) -> DVec3 {
        let [x, y, z] = self.coordinates(node).map(f64::from);
        self.origin + DVec3::new(x, y, z) * self.half
    }

    /// A world position in the coordinates of nodes.
    pub(super) fn local(&self, p: DVec3) -> DVec3 {
        (p - self.origin) / self.half
    }

    /// Every other node of either grid, as on a chess board.
    pub(super) fn is_even(&self, node: usize) -> bool {
        self.coordinates(node).iter().map(|x| x >> 1).sum::<i32>() & 1 == 0
    }

    /// The edge between two neighbours.
    pub(super) fn edge_between(&self, a: usize, b: usize) -> u64 {
        let [from, to] = [a, b].map(|n| self.coordinates(n));
        let along = [0, 1, 2].map(|i| to[i] - from[i]);
        let against = along.map(|x| -x);
        match DIRECTIONS.iter().position(|&d| d == along) {
            Some(direction) => edge(a, direction),
            None => edge(b, DIRECTIONS.iter().position(|&d| d == against).unwrap_or(0)),
        }
    }

    /// Calls `f` with the nodes of every tetrahedron that can have one inside: the ends of a long edge of the even
    /// grid, then those of a long edge of the odd one beside it; all other edges are short. Positively oriented.
    pub(super) fn for_each_cell(&self, mut f: impl FnMut([usize; 4])) {
        for node in (0..self.nodes()).step_by(2) {
            let at = self.coordinates(node);
            for axis in 0..3 {
                let [u, v] = [(axis + 1) % 3, (axis + 2) % 3];
                let ring = [[1, 1], [-1, 1], [-1, -1], [1, -1]].map(|[du, dv]| {
                    let mut at = at;
                    at[axis] += 1;
                    at[u] += du;
                    at[v] += dv;
                    self.node(at)
                });
                // On the rim of the box, where nothing is inside, some are missing.
                if let (Some(end), [Some(a), Some(b), Some(c), Some(d)]) = (self.node(step(at, axis)), ring) {
                    [[a, b], [b, c], [c, d], [d, a]].into_iter().for_each(|[a, b]| f([node, end, a, b]));
                }
            }
        }
    }
}

/// The coordinates of a node's neighbour.
pub(super) fn step(at: [i32; 3], direction: usize) -> [i32; 3] {
    [0, 1, 2].map(|i| at[i] + DIRECTIONS[direction][i])
}

/// The edge from a node in a direction, as a number that orders edges by node.
pub(super) fn edge(node: usize, direction: usize) -> u64 {
    (node as u64) << 3 | direction as u64
}

/// The direction of an edge.
pub(super) fn direction(edge: u64) -> usize {
    (edge & 7) as usize
}
