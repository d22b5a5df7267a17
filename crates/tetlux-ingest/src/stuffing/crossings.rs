//! Where the lines of the lattice cross a surface.
//!
//! All edges of a direction lie on parallel lines. Seen along them triangles are plane, and lines are points: whether
//! a point is in a triangle is decided by exact predicates, with points on an edge moved aside by less than any
//! distance (Edelsbrunner and Mücke 1990), alike for both triangles at the edge. So a line leaves a closed surface as
//! often as it enters, whatever the rounding.

use glam::DVec3;
use rayon::prelude::*;

use super::lattice::{self, DIRECTIONS, Lattice, is_long};
use crate::surface::Surface;

/// A crossing of an edge of the lattice.
pub(super) struct Crossing {
    /// [`lattice::edge`].
    pub(super) edge: u64,
    /// Where on it, from 0 to 1.
    pub(super) at: f64,
    /// What the winding number changes by, along the edge: -1 out of a surface that faces outwards, 1 into it.
    pub(super) step: i8,
}

/// A point as seen along a direction: two coordinates across, in which lines have whole ones, and one along.
#[derive(Clone, Copy)]
struct Seen {
    across: [f64; 2],
    along: f64,
}

/// A point seen along a direction, from coordinates of the lattice.
fn see(direction: usize, p: DVec3) -> Seen {
    if is_long(direction) {
        return Seen { across: [p[(direction + 1) % 3], p[(direction + 2) % 3]], along: p[direction] };
    }
    let [_, s, t] = DIRECTIONS[direction].map(f64::from);
    Seen { across: [s * p.y - p.x, t * p.z - p.x], along: p.x }
}

/// Whether what turns counter-clockwise as seen faces along the direction, or against it.
fn handedness(direction: usize) -> i8 {
    if is_long(direction) { 1 } else { (DIRECTIONS[direction][1] * DIRECTIONS[direction][2]) as i8 }
}

/// The whole numbers from the least to the greatest of three coordinates.
fn span(values: [f64; 3]) -> [i32; 2] {
    // Coordinates lie within the lattice, or, for counting, are cut off at the ends of the type.
    let [a, b, c] = values;
    [a.min(b).min(c).ceil() as i32, a.max(b).max(c).floor() as i32]
}

/// How many lines of the lattice are to be tested against triangles.
pub(super) fn tests(surface: &Surface, lattice: &Lattice) -> u64 {
    let of_triangle = |triangle: &[u32; 3]| {
        let corners = triangle.map(|v| lattice.local(surface.points[v as usize]));
        let count = |direction: usize| {
            let seen = corners.map(|p| see(direction, p));
            let [u, v] = [0, 1].map(|i| {
                let [low, high] = span(seen.map(|s| s.across[i]));
                (i64::from(high) - i64::from(low) + 1).max(0) as u64
            });
            u.saturating_mul(v) / if is_long(direction) { 2 } else { 4 }
        };
        (0..DIRECTIONS.len()).map(count).sum::<u64>()
    };
    surface.triangles.iter().map(of_triangle).fold(0, u64::saturating_add)
}

/// All crossings of the lattice's edges, by edge and place.
pub(super) fn find(surface: &Surface, lattice: &Lattice) -> Vec<Crossing> {
    let points: Vec<DVec3> = surface.points.iter().map(|&p| lattice.local(p)).collect();
    let of_direction = |direction: usize| {
        let seen: Vec<Seen> = points.iter().map(|&p| see(direction, p)).collect();
        let mut crossings = Vec::new();
        for triangle in &surface.triangles {
            of_triangle(direction, triangle.map(|v| seen[v as usize]), lattice, &mut crossings);
        }
        crossings
    };
    let mut crossings: Vec<Crossing> = (0..DIRECTIONS.len()).into_par_iter().flat_map_iter(of_direction).collect();
    crossings.par_sort_unstable_by(|a, b| a.edge.cmp(&b.edge).then(a.at.total_cmp(&b.at)));
    crossings
}

fn of_triangle(direction: usize, corners: [Seen; 3], lattice: &Lattice, into: &mut Vec<Crossing>) {
    let long = is_long(direction);
    let [[u0, u1], [v0, v1]] = [0, 1].map(|i| span(corners.map(|c| c.across[i])));
    for u in (u0..=u1).filter(|u| long || u & 1 == 0) {
        // Along an axis each grid has lines of its own, of coordinates alike even or odd.
        let parity = u & 1;
        for v in (v0 + ((v0 ^ parity) & 1)..=v1).step_by(2) {
            let Some((along, sign)) = crossing(&corners, [f64::from(u), f64::from(v)]) else { continue };
            let floor = along.floor() as i32;
            let (from, length) = if long { (floor - ((floor ^ parity) & 1), 2.0) } else { (floor, 1.0) };
            let mut at = [from; 3];
            if long {
                at[(direction + 1) % 3] = u;
                at[(direction + 2) % 3] = v;
            } else {
                let [_, s, t] = DIRECTIONS[direction];
                at = [from, s * (u + from), t * (v + from)];
            }
            if let Some(node) = lattice.node(at) {
                let at = ((along - f64::from(from)) / length).clamp(0.0, 1.0);
                into.push(Crossing { edge: lattice::edge(node, direction), at, step: -sign * handedness(direction) });
            }
        }
    }
}

/// Where the line at a place goes through a triangle, and whether that turns counter-clockwise (1) or not (-1).
fn crossing(corners: &[Seen; 3], at: [f64; 2]) -> Option<(f64, i8)> {
    let [a, b, c] = corners;
    let ((wa, sa), (wb, sb), (wc, sc)) = (side(b, c, at), side(c, a, at), side(a, b, at));
    if sa == 0 || sa != sb || sb != sc {
        return None;
    }
    let sum = wa + wb + wc;
    let along = if sum > 0.0 {
        (wa * a.along + wb * b.along + wc * c.along) / sum
    } else {
        (a.along + b.along + c.along) / 3.0
    };
    Some((along, sa))
}

/// How far a point is beside an edge, times its length, and on which side: 1 on the left. On the edge itself the
/// side of (e, e^2) from the point for any e small enough; 0 only if the edge has no length.
fn side(from: &Seen, to: &Seen, at: [f64; 2]) -> (f64, i8) {
    let coordinates = |[x, y]: [f64; 2]| robust::Coord { x, y };
    let area = robust::orient2d(coordinates(from.across), coordinates(to.across), coordinates(at));
    let sign = |x: f64| i8::from(x > 0.0) - i8::from(x < 0.0);
    let [du, dv] = [0, 1].map(|i| to.across[i] - from.across[i]);
    let side = [area, -dv, du].map(sign).into_iter().find(|&s| s != 0).unwrap_or(0);
    (area.abs(), side)
}

/// The winding number of each node: by how much it changes from the rim, where it is 0, along the first axis.
pub(super) fn windings(lattice: &Lattice, crossings: &[Crossing]) -> Vec<i32> {
    let mut windings = vec![0; lattice.nodes()];
    for crossing in crossings.iter().filter(|c| lattice::direction(c.edge) == 0) {
        // Of the edge's further end, two places on: nodes of the two grids alternate.
        if let Some(winding) = windings.get_mut((crossing.edge >> 3) as usize + 2) {
            *winding += i32::from(crossing.step);
        }
    }
    // At the end of each line the sum is 0 again, so that one sum can run through all of them.
    for node in 2..windings.len() {
        windings[node] += windings[node - 2];
    }
    windings
}
