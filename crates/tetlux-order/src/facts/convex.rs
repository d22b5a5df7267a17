//! Whether a mesh fills a convex body, and that once.

use std::f64::consts::TAU;

use glam::DVec3;
use tetlux_mesh::TetMesh;

use super::Facts;
use super::surface::{Edge, Surface};
use crate::exact::{Viewpoint, plane_sign};

/// Certifies that the boundary is a closed surface without a concave edge, of the topology of a sphere, that winds about
/// none of its vertices more than once.
///
/// Such a surface bounds a convex body: without a concave edge, it turns to every direction equally often, which is
/// once if its Euler characteristic is 2 and no vertex is a branch point (Riemann and Hurwitz). Cells of positive
/// volume then fill the body once.
pub(super) fn is_convex(mesh: &TetMesh, facts: &Facts) -> bool {
    if facts.known.folded_faces > 0 || facts.known.non_manifold_faces > 0 {
        return false;
    }
    let surface = facts.surface(mesh);
    has_no_concave_edge(mesh, surface) && is_simple_sphere(mesh, surface)
}

/// Every edge of the surface joins two faces, neither of which has the other's third vertex before it.
fn has_no_concave_edge(mesh: &TetMesh, surface: &Surface) -> bool {
    let Surface { points, corners: faces, edges, .. } = surface;
    let at = |v: u32| mesh.points()[points[v as usize] as usize];
    let normal = |face: u32| {
        let [a, b, c] = faces[face as usize].map(|v| at(v).as_dvec3());
        (b - a).cross(c - a)
    };
    let bends_back = |edge: &Edge| {
        let [first, second] = edge.faces;
        let Some(apex) = faces[second as usize].into_iter().find(|v| !edge.ends.contains(v)) else { return false };
        let [a, b, c] = faces[first as usize].map(at);
        match plane_sign(a, b, c, &Viewpoint::new(at(apex).as_dvec3(), true)).value {
            -1 => true,
            // In one plane: side by side, not one upon the other.
            0 => normal(first).dot(normal(second)) > 0.0,
            _ => false,
        }
    };
    let joins_two = 2 * edges.len() == 3 * faces.len() && edges.windows(2).all(|pair| pair[0].ends != pair[1].ends);
    joins_two && edges.iter().all(bends_back)
}

/// Euler's characteristic is 2, and every vertex has its faces round it once.
fn is_simple_sphere(mesh: &TetMesh, surface: &Surface) -> bool {
    let Surface { points, corners: faces, .. } = surface;
    let at = |v: u32| mesh.points()[points[v as usize] as usize].as_dvec3();
    let normal = |&[a, b, c]: &[u32; 3]| (at(b) - at(a)).cross(at(c) - at(a)).normalize_or_zero();
    let turns = |face: &[u32; 3]| [0, 1, 2].map(|i| [face[i], face[(i + 1) % 3], face[(i + 2) % 3]]);

    let mut vertices = vec![Vertex::NEW; points.len()];
    for face in faces {
        let normal = normal(face);
        for [v, b, c] in turns(face) {
            let vertex = &mut vertices[v as usize];
            vertex.normal += normal;
            vertex.edges += (at(b) - at(v)).normalize_or_zero() + (at(c) - at(v)).normalize_or_zero();
        }
    }
    for face in faces {
        let normal = normal(face);
        for &v in face {
            let vertex = &mut vertices[v as usize];
            vertex.blunt &= normal.dot(vertex.normal) > CERTAIN;
            vertex.sharp &= normal.dot(vertex.edges) < -CERTAIN;
        }
    }
    for face in faces {
        for [v, b, c] in turns(face) {
            let vertex = &mut vertices[v as usize];
            let inward = if vertex.blunt { -vertex.normal } else { vertex.edges }.normalize_or_zero();
            let (p, q) = (at(b) - at(v), at(c) - at(v));
            // The angle between two edges as seen along the axis.
            let (p, q) = (p - inward * inward.dot(p), q - inward * inward.dot(q));
            vertex.turned += inward.dot(q.cross(p)).atan2(p.dot(q));
        }
    }
    // Whole turns, but for roundings.
    let simple = |v: &Vertex| (v.blunt || v.sharp) && (v.turned / TAU - 1.0).abs() < 1e-3;
    vertices.iter().all(simple) && 2 * vertices.len() == faces.len() + 4
}

/// Far above the roundings of a few unit vectors.
const CERTAIN: f64 = 1e-9;

/// What the faces round a vertex of the surface are like.
#[derive(Debug, Clone)]
struct Vertex {
    /// Sum of the faces' normals: its opposite points inwards if all of them turn the same way, `blunt`.
    normal: DVec3,
    /// Sum of the directions of the edges: it points inwards if it is behind all faces, `sharp`.
    edges: DVec3,
    blunt: bool,
    sharp: bool,
    /// The angle round the axis that points inwards that the faces cover.
    turned: f64,
}

impl Vertex {
    const NEW: Vertex = Vertex { normal: DVec3::ZERO, edges: DVec3::ZERO, blunt: true, sharp: true, turned: 0.0 };
}
