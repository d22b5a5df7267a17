//! From polygons to triangles.

use glam::{DVec2, DVec3};

/// Corners up to which ears are looked for, in quadratic time or worse; larger polygons are cut as if convex.
const MOST_CORNERS: usize = 400;

/// Cuts a polygon into triangles that face its way: at its ears (Meisters 1975), seen along its mean normal. Where
/// there is none, as in one that crosses itself, from one corner: the triangles still close the gap.
pub(super) fn triangles(points: &[DVec3], polygon: &[u32], into: &mut Vec<[u32; 3]>) {
    if let &[a, b, c] = polygon {
        return into.push([a, b, c]);
    }
    let flat = flatten(points, polygon);
    let mut rest: Vec<usize> = (0..polygon.len()).collect();
    while rest.len() > 3 && polygon.len() <= MOST_CORNERS {
        let Some(ear) = (0..rest.len()).find(|&i| is_ear(&flat, &rest, i)) else { break };
        into.push(neighbors(&rest, ear).map(|i| polygon[i]));
        rest.remove(ear);
    }
    into.extend((1..rest.len() - 1).map(|i| [rest[0], rest[i], rest[i + 1]].map(|i| polygon[i])));
}

/// The corners in the plane across the mean normal, counter-clockwise.
fn flatten(points: &[DVec3], polygon: &[u32]) -> Vec<DVec2> {
    let at = |i: usize| points[polygon[i % polygon.len()] as usize] - points[polygon[0] as usize];
    let normal: DVec3 = (0..polygon.len()).map(|i| at(i).cross(at(i + 1))).sum();
    let normal = normal.try_normalize().unwrap_or(DVec3::Z);
    let (u, v) = normal.any_orthonormal_pair();
    (0..polygon.len()).map(|i| DVec2::new(at(i).dot(u), at(i).dot(v))).collect()
}

/// The corner before one, that one, and the one after.
fn neighbors(rest: &[usize], i: usize) -> [usize; 3] {
    [rest[(i + rest.len() - 1) % rest.len()], rest[i], rest[(i + 1) % rest.len()]]
}

/// Whether the triangle at a corner lies inside and holds no other corner.
fn is_ear(flat: &[DVec2], rest: &[usize], i: usize) -> bool {
    let corners = neighbors(rest, i);
    let [a, b, c] = corners.map(|i| flat[i]);
    let left = |a: DVec2, b: DVec2, p: DVec2| (b - a).perp_dot(p - a);
    let inside = |p: DVec2| left(a, b, p) >= 0.0 && left(b, c, p) >= 0.0 && left(c, a, p) >= 0.0;
    // A corner at the same place as one of the three is no obstacle: polygons with holes run along a slit twice.
    let others = rest.iter().filter(|&i| !corners.contains(i)).map(|&i| flat[i]);
    left(a, b, c) > 0.0 && others.filter(|&p| p != a && p != b && p != c).all(|p| !inside(p))
}
