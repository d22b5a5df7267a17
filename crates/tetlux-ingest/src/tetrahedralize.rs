//! From cells of any type to tetrahedra.

mod conformity;
mod grids;
mod polyhedron;
mod quadratic;
mod tetrahedra;

use tetlux_mesh::procedural::Split;
use tetlux_mesh::{Field, Location, TetMesh, coincident};

pub(crate) use conformity::{faces_that_differ, is_quadratic};
pub(crate) use quadratic::PYRAMID_WITH_BASE_POINT;

use crate::cell_type::{CellType, POLYHEDRON, TETRAHEDRON};
use crate::{IngestError, MixedMesh, Place};
use tetrahedra::Tetrahedra;

impl MixedMesh {
    /// Splits every cell into tetrahedra and assembles them; each takes its cell's data.
    ///
    /// Two cells cut the face between them alike, since how it is cut depends on its own points alone: from its corner
    /// of smallest index, coincident points counting as one (Dompierre, Labbé, Vallet and Camarero 1999).
    ///
    /// - Tetrahedra stay. Hexahedra, voxels, wedges, pyramids and prisms are split from their corner of smallest index.
    /// - Polyhedra get a point in the middle (the mean of their corners, with the mean of their data), from which
    ///   tetrahedra go to the triangles of their faces.
    /// - Quadratic cells are cut at their mid-edge points, and at those in the middle of faces and cells where they
    ///   have them. Those with more than four faces and none in the middle get one there, placed and valued by the
    ///   cell's own interpolation. A linear cell beside a quadratic one does not fit it, nor does one with a point in
    ///   the middle of the face between them beside one without.
    /// - The hexahedra of structured grids are split by `split`, those with a blanked corner left out. Where five
    ///   tetrahedra each would not conform across blocks, or there are listed cells too, they become six; of a single
    ///   grid that closes on itself `split` alone decides.
    ///
    /// Cells whose corners coincide are split as what they have become; cells without volume (triangles and the like)
    /// are left out. Fails at the first cell of another type, and where [`TetMesh::assemble`] does.
    pub fn tetrahedralize(mut self, split: Split) -> Result<TetMesh, IngestError> {
        self.check()?;
        let path = std::mem::take(&mut self.path);
        let points = std::mem::take(&mut self.points);
        let fields = std::mem::take(&mut self.fields);
        let failed = |source| IngestError::Mesh { path: path.clone(), source };

        let count = self.cells.types.len();
        let tetrahedra = self.cells.types.iter().filter(|&&t| t == TETRAHEDRON).count();
        let solid =
            self.cells.types.iter().filter(|&&t| CellType::of(t).is_some_and(|kind| kind.dimension == 3)).count();
        // Only tetrahedra have no face that could be cut one way or another.
        let first = if solid > tetrahedra || !self.grids.is_empty() {
            coincident(&points).map_err(failed)?
        } else {
            Vec::new()
        };
        let mut made = Tetrahedra::new(points, fields, first, tetrahedra);
        for (c, &number) in self.cells.types.iter().enumerate() {
            if !self.split_cell(c, number, &mut made) {
                return Err(IngestError::Unsupported {
                    path,
                    place: Place::Cell(c),
                    what: "a cell of type",
                    found: format!("{number} ({})", CellType::of(number).map_or("unknown", |kind| kind.name)),
                    remedy: "make linear or quadratic tetrahedra, hexahedra, wedges or pyramids of it (in ParaView: \
                             Tetrahedralize)"
                        .into(),
                });
            }
        }
        let split = if solid > 0 { Split::Six } else { split };
        grids::split(&self.grids, split, count, &mut made);
        drop(self);

        let Tetrahedra { points, fields, cells, origin, .. } = made;
        let fields = fields.into_iter().map(|field| match field.location {
            Location::Point => field,
            Location::Cell => spread(field, &origin),
        });
        let fields = fields.collect();
        drop(origin);
        TetMesh::assemble(&points, &cells, fields).map_err(failed)
    }

    /// Splits a listed cell; false if there is no way to.
    fn split_cell(&self, c: usize, number: u8, made: &mut Tetrahedra) -> bool {
        let points = self.cells.cell(c).unwrap_or_default();
        match (number, points.first_chunk()) {
            (TETRAHEDRON, Some(&cell)) => made.push(cell, c),
            (POLYHEDRON, _) => polyhedron::split(&self.cells.faces(c).unwrap_or_default(), c, made),
            _ => match CellType::of(number) {
                Some(kind) if kind.dimension < 3 => {}
                Some(kind) if !kind.faces.is_empty() => made.mend_wedge(kind, |made| pull(kind, points, c, made)),
                Some(kind) => return quadratic::split(kind, points, c, made),
                None => return false,
            },
        }
        true
    }
}

/// Cell data of the tetrahedra: each takes its cell's.
fn spread(field: Field, origin: &[u32]) -> Field {
    let n = field.components;
    let values = origin.iter().flat_map(|&c| &field.values[c as usize * n..(c as usize + 1) * n]).copied().collect();
    Field { values, ..field }
}

/// Splits a convex cell into the tetrahedra between its smallest corner and the triangles of the faces away from it,
/// each face itself cut from its smallest corner. How a face is cut then depends on its own corners alone.
fn pull(kind: &CellType, corners: &[u32], origin: usize, made: &mut Tetrahedra) {
    let Some(apex) = (0..kind.points.unwrap_or(0)).min_by_key(|&i| made.rank(corners[i])) else { return };
    for face in kind.faces {
        if face.iter().any(|&i| made.rank(corners[i]) == made.rank(corners[apex])) {
            continue;
        }
        // Faces are listed counter-clockwise seen from outside, so the apex comes first for a positive volume.
        let key = |made: &Tetrahedra, i: usize| made.rank(corners[face[i]]);
        fan(face.len(), key, made, |made, [i, j, k]| {
            made.push_split([apex, face[i], face[j], face[k]].map(|corner| corners[corner]), origin);
        });
    }
}

/// The triangles of a polygon of `n` corners, all from the one with the smallest key.
fn fan<K: Ord>(
    n: usize,
    key: impl Fn(&Tetrahedra, usize) -> K,
    made: &mut Tetrahedra,
    mut emit: impl FnMut(&mut Tetrahedra, [usize; 3]),
) {
    let start = (0..n).min_by_key(|&i| key(made, i)).unwrap_or(0);
    for i in 1..n.saturating_sub(1) {
        emit(made, [start, start + i, start + i + 1].map(|i| i % n));
    }
}

#[cfg(test)]
mod tests;
