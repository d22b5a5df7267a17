//! The boundary as a surface of its own: what its outline is found from.

use glam::Vec3;
use tetlux_mesh::{NONE, TetMesh};

use super::Facts;

/// The faces of the boundary, by vertices of the boundary alone, and their edges.
#[derive(Debug, Clone, Default)]
pub(crate) struct Surface {
    /// For each vertex its point.
    pub(crate) points: Vec<u32>,
    /// And where that is: near in memory to those of the other vertices of its faces.
    pub(crate) positions: Vec<Vec3>,
    /// The vertices of each face of the boundary, counter-clockwise seen from outside; faces in their order.
    pub(crate) corners: Vec<[u32; 3]>,
    pub(crate) edges: Vec<Edge>,
}

/// Where two faces of the boundary meet.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Edge {
    /// Its vertices, as the first face runs; the second runs the other way.
    pub(crate) ends: [u32; 2],
    /// Counted from the boundary's first.
    pub(crate) faces: [u32; 2],
}

impl Surface {
    pub(super) fn new(mesh: &TetMesh, facts: &Facts) -> Surface {
        let mut places = vec![NONE; mesh.points().len()];
        let mut points = Vec::new();
        let mut place = |point: u32| {
            let place = &mut places[point as usize];
            if *place == NONE {
                *place = points.len() as u32;
                points.push(point);
            }
            *place
        };
        let faces = facts.interior..facts.owners.len();
        let corners: Vec<[u32; 3]> = faces.map(|face| facts.vertices(mesh, face).1.map(&mut place)).collect();
        let edges = edges(points.len(), &corners);
        let positions = points.iter().map(|&point| mesh.points()[point as usize]).collect();
        Surface { points, positions, corners, edges }
    }

    /// Where the vertices of a face are, counted from the boundary's first.
    pub(crate) fn corners(&self, face: usize) -> [Vec3; 3] {
        self.corners[face].map(|corner| self.positions[corner as usize])
    }
}

/// Pairs the edges of faces with those that run the other way between the same vertices. Cells have closed surfaces,
/// so that all find a partner; where more than two faces meet, whichever.
fn edges(vertices: usize, corners: &[[u32; 3]]) -> Vec<Edge> {
    let sides = || {
        corners.iter().enumerate().flat_map(|(face, &[a, b, c])| {
            [(a, b), (b, c), (c, a)]
                .map(|(a, b)| (a.min(b) as usize, Side { to: a.max(b), back: a > b, face: face as u32 }))
        })
    };
    let mut starts = vec![0; vertices + 2];
    for (from, _) in sides() {
        starts[from + 2] += 1;
    }
    for vertex in 0..vertices {
        starts[vertex + 2] += starts[vertex + 1];
    }
    let mut sorted = vec![Side::default(); 3 * corners.len()];
    for (from, side) in sides() {
        sorted[starts[from + 1]] = side;
        starts[from + 1] += 1;
    }
    let mut edges = Vec::with_capacity(sorted.len() / 2);
    for vertex in 0..vertices {
        let fan = &mut sorted[starts[vertex]..starts[vertex + 1]];
        fan.sort_unstable();
        for sheets in fan.chunk_by(|a, b| a.to == b.to) {
            let (there, back) = sheets.split_at(sheets.partition_point(|side| !side.back));
            edges.extend(
                there.iter().zip(back).map(|(s, t)| Edge { ends: [vertex as u32, s.to], faces: [s.face, t.face] }),
            );
        }
    }
    edges
}

/// An edge of one face, from its lower vertex.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default)]
struct Side {
    to: u32,
    /// The face runs from the higher to the lower.
    back: bool,
    face: u32,
}
