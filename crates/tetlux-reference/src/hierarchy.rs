//! Bounding volumes over triangles: those that a line may meet.

use glam::DVec3;

use crate::line::Line;

/// Triangles a leaf holds at most.
const LEAF: usize = 4;
/// Boxes are this much larger than what they hold, which is of about unit size: far above any rounding of the slab
/// test, far below a cell.
const PADDING: f64 = 1.0 / (1u64 << 30) as f64;

struct Node {
    low: DVec3,
    high: DVec3,
    /// Triangles of a leaf; for an inner node the first child follows it and the second is `second`.
    first: usize,
    count: usize,
    second: usize,
}

/// A binary tree of boxes, split at the median of the triangles' centres.
pub(crate) struct Hierarchy<T> {
    nodes: Vec<Node>,
    triangles: Vec<T>,
}

impl<T: Copy> Hierarchy<T> {
    /// A tree of triangles with these corners.
    pub(crate) fn new(mut triangles: Vec<T>, corners: &impl Fn(&T) -> [DVec3; 3]) -> Self {
        let mut tree = Self { nodes: Vec::with_capacity(triangles.len()), triangles: Vec::new() };
        if !triangles.is_empty() {
            tree.build(&mut triangles, 0, corners);
        }
        tree.triangles = triangles;
        tree
    }

    fn build(&mut self, faces: &mut [T], first: usize, corners: &impl Fn(&T) -> [DVec3; 3]) {
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
        let key = |face: &T| corners(face).iter().map(|p| p[axis]).sum::<f64>();
        faces.select_nth_unstable_by(middle, |a, b| key(a).total_cmp(&key(b)));
        let (left, right) = faces.split_at_mut(middle);
        self.build(left, first, corners);
        self.nodes[place].second = self.nodes.len();
        self.build(right, first + middle, corners);
    }

    /// Calls `visit` with a superset of the triangles that the line crosses at a parameter up to `end`.
    pub(crate) fn candidates(&self, line: &Line, end: f64, mut visit: impl FnMut(T)) {
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
                self.triangles[node.first..node.first + node.count].iter().for_each(|&triangle| visit(triangle));
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
