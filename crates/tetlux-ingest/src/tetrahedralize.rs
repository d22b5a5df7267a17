//! From cells of any type to tetrahedra.

use glam::DVec3;
use tetlux_mesh::procedural::{Split, for_each_hexahedron};
use tetlux_mesh::{Field, Location, TetMesh};

use crate::cell_type::{CellType, TETRAHEDRON};
use crate::{IngestError, MixedMesh, Place};

/// Tetrahedra, and the cell that each was made of.
#[derive(Default)]
struct Tetrahedra {
    cells: Vec<[u32; 4]>,
    origin: Vec<u32>,
}

impl Tetrahedra {
    fn push(&mut self, cell: [u32; 4], origin: usize) {
        self.cells.push(cell);
        self.origin.push(origin as u32);
    }
}

impl MixedMesh {
    /// Splits every cell into tetrahedra and assembles them; each takes its cell's data.
    ///
    /// The hexahedra of a structured grid are split by `split`, those with a blanked corner left out. Of listed cells
    /// tetrahedra stay, and hexahedra, voxels, wedges and pyramids are split from their corner of smallest index, so
    /// that two cells cut the quadrilateral between them along the same diagonal (Dompierre, Labbé, Vallet and
    /// Camarero 1999); coincident points count as one there. Cells without volume (triangles and the like) are left
    /// out. Fails at the first cell of another type, and where [`TetMesh::assemble`] does.
    pub fn tetrahedralize(mut self, split: Split) -> Result<TetMesh, IngestError> {
        self.check()?;
        let tetrahedra = match &self.grid {
            Some(grid) => {
                let mut made = Tetrahedra::default();
                let mut hexahedron = 0;
                for_each_hexahedron(grid.counts, |ijk, corners| {
                    if grid.visible(&corners) {
                        split.hexahedron(corners, ijk).for_each(|cell| made.push(cell, hexahedron));
                    }
                    hexahedron += 1;
                });
                made
            }
            None => self.split_listed()?,
        };
        let fields = std::mem::take(&mut self.fields)
            .into_iter()
            .map(|field| match field.location {
                Location::Point => field,
                Location::Cell => spread(field, &tetrahedra.origin),
            })
            .collect();
        drop(tetrahedra.origin);
        TetMesh::assemble(&self.points, &tetrahedra.cells, fields)
            .map_err(|source| IngestError::Mesh { path: self.path, source })
    }

    fn split_listed(&self) -> Result<Tetrahedra, IngestError> {
        let mut made = Tetrahedra::default();
        let mut first = Vec::new();
        for (c, &number) in self.cells.types.iter().enumerate() {
            let corners = self.cells.cell(c).unwrap_or_default();
            if let (TETRAHEDRON, Some(&tetrahedron)) = (number, corners.first_chunk()) {
                made.push(tetrahedron, c);
                continue;
            }
            match CellType::of(number) {
                Some(kind) if kind.dimension < 3 => {}
                Some(kind) if !kind.faces.is_empty() => {
                    if first.is_empty() {
                        first = first_coincident(&self.points);
                    }
                    pull(kind, corners, &first, |cell| made.push(cell, c));
                }
                kind => {
                    return Err(IngestError::Unsupported {
                        path: self.path.clone(),
                        place: Place::Cell(c),
                        what: "a cell of type",
                        found: format!("{number} ({})", kind.map_or("unknown", |k| k.name)),
                        remedy: "make linear tetrahedra, hexahedra, voxels, wedges or pyramids of it (in ParaView: \
                                 Tetrahedralize)"
                            .into(),
                    });
                }
            }
        }
        Ok(made)
    }
}

/// Cell data of the tetrahedra: each takes its cell's.
fn spread(field: Field, origin: &[u32]) -> Field {
    let n = field.components;
    let values = origin.iter().flat_map(|&c| &field.values[c as usize * n..(c as usize + 1) * n]).copied().collect();
    Field { values, ..field }
}

/// For each point the first that coincides with it, after rounding to single precision about the bounding box's
/// centre: the points that assembling will make one.
fn first_coincident(points: &[DVec3]) -> Vec<u32> {
    let (low, high) =
        points.iter().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), &p| (low.min(p), high.max(p)));
    let center = low * 0.5 + high * 0.5;
    // Adding zero turns -0 into +0, so that equal points are equal bit for bit.
    let bits = |i: u32| ((points[i as usize] - center).as_vec3() + glam::Vec3::ZERO).to_array().map(f32::to_bits);
    let mut sorted: Vec<u32> = (0..points.len() as u32).collect();
    sorted.sort_unstable_by_key(|&i| (bits(i), i));
    let mut first = vec![0; points.len()];
    for group in sorted.chunk_by(|&a, &b| bits(a) == bits(b)) {
        group.iter().for_each(|&i| first[i as usize] = group[0]);
    }
    first
}

/// Splits a convex cell into the tetrahedra between its smallest corner and the triangles of the faces away from it,
/// each face itself cut from its smallest corner. How a face is cut then depends on its own corners alone.
fn pull(kind: &CellType, corners: &[u32], first: &[u32], mut emit: impl FnMut([u32; 4])) {
    let rank = |i: usize| first[corners[i] as usize];
    let Some(apex) = (0..kind.points.unwrap_or(0)).min_by_key(|&i| rank(i)) else { return };
    for face in kind.faces {
        if face.iter().any(|&i| rank(i) == rank(apex)) {
            continue;
        }
        let n = face.len();
        let start = (0..n).min_by_key(|&i| rank(face[i])).unwrap_or(0);
        for i in 1..n - 1 {
            let triangle = [start, start + i, start + i + 1].map(|i| corners[face[i % n]]);
            // Faces are listed counter-clockwise seen from outside, so the apex comes first for a positive volume.
            emit([corners[apex], triangle[0], triangle[1], triangle[2]]);
        }
    }
}

#[cfg(test)]
mod tests;
