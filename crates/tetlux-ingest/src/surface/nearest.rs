//! How far a point is from a surface.

use glam::DVec3;

use super::Surface;

/// Triangles of a leaf at most.
const LEAF: usize = 4;

/// A tree of boxes round the triangles of a surface, halved at the median.
pub(crate) struct Nearest {
    /// Corners of the triangles, in the order of the leaves.
    triangles: Vec<[DVec3; 3]>,
    /// The root first, then for each node its first half right after it.
    nodes: Vec<Node>,
}

struct Node {
    bounds: [DVec3; 2],
    /// Of a leaf its triangles.
    triangles: std::ops::Range<usize>,
    /// Where the second half is; 0 for a leaf.
    second: usize,
}

impl Nearest {
    pub(crate) fn new(surface: &Surface) -> Self {
        let mut triangles: Vec<[DVec3; 3]> =
            surface.triangles.iter().map(|t| t.map(|v| surface.points[v as usize])).collect();
        let mut nodes = Vec::with_capacity(triangles.len());
        let count = triangles.len();
        build(&mut triangles, 0..count, &mut nodes);
        Nearest { triangles, nodes }
    }

    /// The distance from a point to the nearest triangle.
    pub(crate) fn distance(&self, p: DVec3) -> f64 {
        let mut best = f64::INFINITY;
        // Halving at the median keeps the depth below the bits of an index.
        let mut stack = vec![(0, 0.0)];
        while let Some((n, ahead)) = stack.pop() {
            if ahead >= best {
                continue;
            }
            let node = &self.nodes[n];
            if node.second == 0 {
                let near = self.triangles[node.triangles.clone()].iter().map(|t| closest(t, p).distance_squared(p));
                best = near.fold(best, f64::min);
                continue;
            }
            let mut halves = [n + 1, node.second].map(|h| (h, to_box(&self.nodes[h].bounds, p)));
            if halves[0].1 < halves[1].1 {
                halves.reverse();
            }
            stack.extend(halves);
        }
        best.sqrt()
    }
}

fn build(triangles: &mut [[DVec3; 3]], range: std::ops::Range<usize>, nodes: &mut Vec<Node>) {
    let own = &mut triangles[range.clone()];
    let empty = [DVec3::INFINITY, DVec3::NEG_INFINITY];
    let bounds = own.iter().flatten().fold(empty, |[low, high], &p| [low.min(p), high.max(p)]);
    let place = nodes.len();
    nodes.push(Node { bounds, triangles: range.clone(), second: 0 });
    if own.len() <= LEAF {
        return;
    }
    let size = bounds[1] - bounds[0];
    let axis = (0..3).max_by(|&a, &b| size[a].total_cmp(&size[b])).unwrap_or(0);
    let middle = |t: &[DVec3; 3]| t[0][axis] + t[1][axis] + t[2][axis];
    let half = own.len() / 2;
    own.select_nth_unstable_by(half, |a, b| middle(a).total_cmp(&middle(b)));
    build(triangles, range.start..range.start + half, nodes);
    nodes[place].second = nodes.len();
    build(triangles, range.start + half..range.end, nodes);
}

/// Squared distance to a box.
fn to_box([low, high]: &[DVec3; 2], p: DVec3) -> f64 {
    p.clamp(*low, *high).distance_squared(p)
}

/// The point of a triangle nearest to another (Ericson, Real-Time Collision Detection, 5.1.5); of one without area
/// that on its edges.
fn closest(&[a, b, c]: &[DVec3; 3], p: DVec3) -> DVec3 {
    let normal = (b - a).cross(c - a);
    let inside = |from: DVec3, to: DVec3| normal.dot((to - from).cross(p - from)) > 0.0;
    if inside(a, b) && inside(b, c) && inside(c, a) {
        return p - normal * (normal.dot(p - a) / normal.length_squared());
    }
    let on = |from: DVec3, to: DVec3| {
        let along = to - from;
        from + along * (along.dot(p - from) / along.length_squared()).clamp(0.0, 1.0)
    };
    let [x, y, z] = [on(a, b), on(b, c), on(c, a)];
    let nearer = |x: DVec3, y: DVec3| if x.distance_squared(p) <= y.distance_squared(p) { x } else { y };
    nearer(x, nearer(y, z))
}

#[cfg(test)]
mod tests;
