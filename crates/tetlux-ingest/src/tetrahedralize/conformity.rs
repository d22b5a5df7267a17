//! Where cells meet that cannot fit together.

use tetlux_mesh::coincident;

use super::quadratic::PYRAMID_WITH_BASE_POINT;
use crate::MixedMesh;
use crate::cell_type::{
    BIQUADRATIC_WEDGE, CellType, HEXAHEDRON, POLYHEDRON, QUADRATIC_PYRAMID, TRIQUADRATIC_HEXAHEDRON,
};

/// A triangle or quadrilateral: its corners in ascending order, then `u32::MAX`.
type Face = [u32; 4];

/// Number of faces between a linear and a quadratic cell, or between quadratic ones of which only one has a point in
/// the middle of the face: one side is cut where the other is not.
pub(crate) fn faces_that_differ(mesh: &MixedMesh) -> usize {
    let kinds = || mesh.cells.types.iter().enumerate().filter_map(|(c, &t)| Some((c, CellType::of(t)?)));
    let solid = |kind: &CellType| kind.dimension == 3;
    let mut quadratic = kinds().filter(|(_, kind)| is_quadratic(kind)).peekable();
    // The usual case, all cells linear or all quadratic without points in faces, is settled without a look at any face.
    let mixed = !mesh.grids.is_empty() || kinds().any(|(_, kind)| solid(kind) && !is_quadratic(kind));
    if quadratic.peek().is_none() || !mixed && kinds().all(|(c, kind)| !has_face_points(kind, points(mesh, c).len())) {
        return 0;
    }
    let Ok(first) = coincident(&mesh.points) else { return 0 };
    let mut faces: Vec<(Face, bool)> = Vec::new();
    for (c, kind) in quadratic {
        let points = points(mesh, c);
        for face in kind.linear().faces {
            let middle = face.len() == 4 && has_face_points(kind, points.len());
            faces.extend(corners(face.iter().map(|&i| first[points[i] as usize])).map(|corners| (corners, middle)));
        }
    }
    faces.sort_unstable();
    let mut differ = 0;
    let mut open: Vec<Face> = Vec::new();
    for group in faces.chunk_by(|a, b| a.0 == b.0) {
        if group.len() == 1 {
            open.push(group[0].0);
        }
        differ += usize::from(group.iter().any(|face| face.1 != group[0].1));
    }
    let mut visit = |face: Option<Face>| differ += usize::from(face.is_some_and(|f| open.binary_search(&f).is_ok()));
    for (c, kind) in kinds() {
        if kind.number == POLYHEDRON {
            for face in mesh.cells.faces(c).unwrap_or_default() {
                visit(corners(face.iter().map(|&v| first[v as usize])));
            }
        } else if !is_quadratic(kind) {
            for face in kind.faces {
                visit(corners(face.iter().map(|&i| first[points(mesh, c)[i] as usize])));
            }
        }
    }
    for grid in &mesh.grids {
        grid.for_each_visible(|_, _, hexahedron| {
            for face in CellType::of(HEXAHEDRON).map_or(&[][..], |kind| kind.faces) {
                visit(corners(face.iter().map(|&i| first[hexahedron[i] as usize])));
            }
        });
    }
    differ
}

/// Whether a cell has points on its edges beside its corners.
pub(crate) fn is_quadratic(kind: &'static CellType) -> bool {
    kind.linear().number != kind.number
}

/// Whether a cell of so many points has one in the middle of each quadrilateral face, too.
fn has_face_points(kind: &CellType, points: usize) -> bool {
    match kind.number {
        TRIQUADRATIC_HEXAHEDRON | BIQUADRATIC_WEDGE => true,
        QUADRATIC_PYRAMID => points >= PYRAMID_WITH_BASE_POINT,
        _ => false,
    }
}

fn points(mesh: &MixedMesh, cell: usize) -> &[u32] {
    mesh.cells.cell(cell).unwrap_or_default()
}

/// The face of these corners, repeated ones counted once; `None` if it has too many or too few.
fn corners(all: impl Iterator<Item = u32>) -> Option<Face> {
    let (mut face, mut count) = ([u32::MAX; 4], 0);
    for v in all {
        if !face[..count].contains(&v) {
            *face.get_mut(count)? = v;
            count += 1;
        }
    }
    face.sort_unstable();
    (count >= 3).then_some(face)
}
