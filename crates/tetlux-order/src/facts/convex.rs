//! Whether a mesh fills a convex body, and that once.

use std::f64::consts::TAU;

use glam::DVec3;
use tetlux_mesh::TetMesh;

use super::Facts;
use crate::exact::{Viewpoint, plane_sign};

/// A direction that no mesh of rule or reason is aligned with.
const GENERIC: DVec3 = DVec3::new(0.348_771_096_2, -0.620_194_772_1, 0.702_641_348_9);

/// Certifies that the boundary is a closed surface, nowhere concave, that turns about the mesh once.
///
/// A closed surface without a concave edge has the same number of sheets in every direction of its normals (it is
/// immersed but for vertices, where sheets may wind several times); counting them at the summits in one direction
/// tells a single convex body from several, or from one wound about itself. Cells of positive volume then fill it
/// once.
pub(super) fn is_convex(mesh: &TetMesh, facts: &Facts) -> bool {
    if facts.known.folded_faces > 0 || facts.known.non_manifold_faces > 0 {
        return false;
    }
    let faces: Vec<[u32; 3]> = (facts.interior..facts.owners.len()).map(|face| facts.vertices(mesh, face).1).collect();
    has_no_concave_edge(mesh, &faces) && sheets(mesh, &faces) == Some(1)
}

/// Every edge of the surface joins two faces, neither of which has the other's third vertex before it.
fn has_no_concave_edge(mesh: &TetMesh, faces: &[[u32; 3]]) -> bool {
    let mut edges: Vec<([u32; 2], u32, u32)> = Vec::with_capacity(3 * faces.len());
    for (face, &[a, b, c]) in faces.iter().enumerate() {
        for (a, b, opposite) in [(a, b, c), (b, c, a), (c, a, b)] {
            edges.push(([a.min(b), a.max(b)], opposite, face as u32));
        }
    }
    edges.sort_unstable();
    let at = |v: u32| mesh.points()[v as usize];
    let normal = |face: u32| {
        let [a, b, c] = faces[face as usize].map(|v| at(v).as_dvec3());
        (b - a).cross(c - a)
    };
    edges.chunk_by(|a, b| a.0 == b.0).all(|pair| match *pair {
        [(_, _, first), (_, apex, second)] => {
            let [a, b, c] = faces[first as usize].map(at);
            match plane_sign(a, b, c, &Viewpoint::new(at(apex).as_dvec3(), true)).value {
                -1 => true,
                // In one plane: side by side, not one upon the other.
                0 => normal(first).dot(normal(second)) > 0.0,
                _ => false,
            }
        }
        _ => false,
    })
}

/// How often the surface turns about the summits in one direction; `None` where rounding leaves it open.
fn sheets(mesh: &TetMesh, faces: &[[u32; 3]]) -> Option<u32> {
    let at = |v: u32| mesh.points()[v as usize].as_dvec3();
    let height = |v: u32| (GENERIC.dot(at(v)), v);
    // Vertices of the surface that no neighbour on it overtops.
    let mut is_summit = vec![false; mesh.points().len()];
    faces.iter().flatten().for_each(|&v| is_summit[v as usize] = true);
    for &[a, b, c] in faces {
        for (a, b) in [(a, b), (b, c), (c, a)] {
            let lower = if height(a) < height(b) { a } else { b };
            is_summit[lower as usize] = false;
        }
    }
    // Each summit with the two other corners of a face round it.
    let mut corners: Vec<[u32; 3]> = faces
        .iter()
        .flat_map(|&[a, b, c]| [[a, b, c], [b, c, a], [c, a, b]])
        .filter(|corner| is_summit[corner[0] as usize])
        .collect();
    corners.sort_unstable();
    let mut turned = 0.0;
    for round in corners.chunk_by(|a, b| a[0] == b[0]) {
        let edge = |summit: u32, v: u32| (at(v) - at(summit)).normalize_or_zero();
        // Within the cone that the faces make, which need not hold what is straight below the summit.
        let axis = round.iter().map(|&[s, b, c]| edge(s, b) + edge(s, c)).sum::<DVec3>().normalize_or_zero();
        if axis == DVec3::ZERO {
            return None;
        }
        let across = axis.any_orthonormal_vector();
        let along = across.cross(axis);
        for &[s, b, c] in round {
            let [b, c] = [b, c].map(|v| [edge(s, v).dot(across), edge(s, v).dot(along)]);
            turned += (b[0] * c[1] - b[1] * c[0]).atan2(b[0] * c[0] + b[1] * c[1]);
        }
    }
    let sheets = turned / TAU;
    // A whole number but for rounding.
    ((sheets - sheets.round()).abs() < 1e-3 && sheets > 0.0).then(|| sheets.round() as u32)
}
