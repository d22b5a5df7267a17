//! Bounding volumes over the boundary faces: where a line may enter the mesh.

use glam::DVec3;
use tetlux_mesh::FACES;

use crate::line::Line;
use crate::walk::Space;

/// Faces a leaf holds at most.
const LEAF: usize = 4;
/// Boxes are this much larger than what they hold, in units of the mesh's half-width: far above any rounding of the
/// slab test, far below a cell.
const PADDING: f64 = 1.0 / (1u64 << 30) as f64;

/// A boundary face: four times its cell, plus its number in it. Assembling a mesh keeps this within 32 bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct BoundaryFace(u32);

impl BoundaryFace {
    pub(crate) fn cell(self) -> u32 {
        self.0 / 4
    }

    /// Vertices, counter-clockwise from outside.
    pub(crate) fn vertices(self, cells: &[[u32; 4]]) -> [u32; 3] {
        FACES[self.0 as usize % 4].map(|i| cells[self.cell() as usize][i])
    }
}

struct Node {
    low: DVec3,
    high: DVec3,
    /// Faces of a leaf; for an inner node the first child follows it and the second is `second`.
    first: usize,
    count: usize,
    second: usize,
}

/// A binary tree of boxes, split at the median of the faces' centres.
pub(crate) struct Hierarchy {
    nodes: Vec<Node>,
    faces: Vec<BoundaryFace>,
}

impl Hierarchy {
    pub(crate) fn new(space: &Space) -> Self {
        let cells = space.mesh.cells();
        let around = space.mesh.neighbors();
        let mut faces: Vec<BoundaryFace> = (0..around.len())
            .flat_map(|c| (0..4).filter(move |&f| around[c][f] == tetlux_mesh::NONE).map(move |f| (c, f)))
            .map(|(c, f)| BoundaryFace((4 * c + f) as u32))
            .collect();
        let mut tree = Self { nodes: Vec::with_capacity(faces.len()), faces: Vec::new() };
        if !faces.is_empty() {
            let corners = |face: &BoundaryFace| face.vertices(cells).map(|v| space.position(v));
            tree.build(&mut faces, 0, &corners);
        }
        tree.faces = faces;
        tree
    }

    fn build(&mut self, faces: &mut [BoundaryFace], first: usize, corners: &impl Fn(&BoundaryFace) -> [DVec3; 3]) {
        let mut bounds = [DVec3::INFINITY, DVec3::NEG_INFINITY];
        let mut centers = bounds;
        for face in &*faces {
            let v = corners(face);
            bounds = v.iter().fold(bounds, |b, &p| [b[0].min(p), b[1].max(p)]);
            let center = v[0] + v[1] + v[2];
            centers = [centers[0].min(center), centers[1].max(center)];
        }
        let place = self.nodes.len();
        let [low, high] = [bounds[0] - PADDING, bounds[1] + PADDING];
        self.nodes.push(Node { low, high, first, count: faces.len(), second: 0 });
        if faces.len() <= LEAF {
            return;
        }
        let extent = centers[1] - centers[0];
        let axis = extent.max_position();
        let middle = faces.len() / 2;
        let key = |face: &BoundaryFace| corners(face).iter().map(|p| p[axis]).sum::<f64>();
        faces.select_nth_unstable_by(middle, |a, b| key(a).total_cmp(&key(b)));
        let (left, right) = faces.split_at_mut(middle);
        self.build(left, first, corners);
        self.nodes[place].second = self.nodes.len();
        self.build(right, first + middle, corners);
    }

    /// Calls `visit` with a superset of the faces that the line crosses at a parameter up to `end`.
    pub(crate) fn candidates(&self, line: &Line, end: f64, mut visit: impl FnMut(BoundaryFace)) {
        let (origin, direction) = (line.origin(), line.direction());
        let mut next = 0;
        // Median splits of 32-bit counts go at most 32 deep.
        let mut stack = [0; 40];
        let mut waiting = 0;
        while let Some(node) = self.nodes.get(next) {
            let hit = meets(node, origin, direction, end);
            if hit && node.second != 0 {
                stack[waiting] = node.second;
                waiting += 1;
                next += 1;
                continue;
            }
            if hit {
                self.faces[node.first..node.first + node.count].iter().for_each(|&face| visit(face));
            }
            if waiting == 0 {
                return;
            }
            waiting -= 1;
            next = stack[waiting];
        }
    }
}

/// Whether the line meets the box at a parameter up to `end`.
fn meets(node: &Node, origin: DVec3, direction: DVec3, end: f64) -> bool {
    let (mut enter, mut leave) = (f64::NEG_INFINITY, end + PADDING);
    for k in 0..3 {
        if direction[k] == 0.0 {
            if origin[k] < node.low[k] || origin[k] > node.high[k] {
                return false;
            }
        } else {
            let inverse = 1.0 / direction[k];
            let (a, b) = ((node.low[k] - origin[k]) * inverse, (node.high[k] - origin[k]) * inverse);
            enter = enter.max(a.min(b));
            leave = leave.min(a.max(b));
        }
    }
    enter <= leave
}
