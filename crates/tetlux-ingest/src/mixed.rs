//! What a file holds, before it is split into tetrahedra.

mod append;

use std::path::PathBuf;

use glam::DVec3;
use tetlux_mesh::procedural::for_each_hexahedron;
use tetlux_mesh::{Field, Location, MeshError};

use crate::cell_type::{self, CellType};
use crate::{IngestError, Place};

/// Points, cells of any type and fields, as a file gives them.
#[derive(Debug, Clone, Default)]
pub struct MixedMesh {
    /// The file it was read from, for messages.
    pub path: PathBuf,
    /// Positions in world space.
    pub points: Vec<DVec3>,
    /// The cells that are listed one by one.
    pub cells: MixedCells,
    /// The structured grids whose hexahedra are cells too.
    pub grids: Vec<StructuredGrid>,
    /// Point and cell data; those of cells for the listed ones first, then for each grid's hexahedra, i fastest,
    /// blanked ones too.
    pub fields: Vec<Field>,
    /// What the reader passed over or left out, a sentence each.
    pub notes: Vec<String>,
}

/// Cells of any type, as VTK lists them.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct MixedCells {
    /// VTK cell type of each cell (vtkCellType.h).
    pub types: Vec<u8>,
    /// Point indices of all cells, one cell after another. Of more points than a cell's type has the first count.
    pub connectivity: Vec<u32>,
    /// End of each cell's indices in `connectivity`.
    pub offsets: Vec<usize>,
    /// The faces of the polyhedra, one cell after another: the number of faces, then for each the number of its
    /// points and their indices in order round it. A polyhedron's points are in `connectivity` too, each once.
    pub face_stream: Vec<u32>,
    /// For each cell the place in `face_stream` where its faces begin, [`NO_FACES`](Self::NO_FACES) if it is no
    /// polyhedron. Empty where no cell is.
    pub face_offsets: Vec<usize>,
}

/// The hexahedra between the points of a block, i fastest.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct StructuredGrid {
    /// The block's first point in the mesh: the others follow it, i fastest.
    pub first_point: usize,
    /// Points along i, j and k.
    pub counts: [usize; 3],
    /// For each point of the block, whether it is blanked: a hexahedron with a blanked corner is no cell. `None`:
    /// all are cells.
    pub blanked: Option<Vec<bool>>,
}

impl MixedCells {
    /// In `face_offsets`: the cell is no polyhedron.
    pub const NO_FACES: usize = usize::MAX;

    /// Adds a cell that is no polyhedron.
    pub fn push(&mut self, number: u8, points: &[u32]) {
        self.types.push(number);
        self.connectivity.extend_from_slice(points);
        self.offsets.push(self.connectivity.len());
        if !self.face_offsets.is_empty() {
            self.face_offsets.push(Self::NO_FACES);
        }
    }

    /// Adds a polyhedron of its points, each once, and the points of its faces, in order round each.
    pub fn push_polyhedron(&mut self, points: &[u32], faces: &[&[u32]]) {
        self.face_offsets.resize(self.types.len(), Self::NO_FACES);
        self.face_offsets.push(self.face_stream.len());
        self.face_stream.push(faces.len() as u32);
        for face in faces {
            self.face_stream.push(face.len() as u32);
            self.face_stream.extend_from_slice(face);
        }
        self.types.push(cell_type::POLYHEDRON);
        self.connectivity.extend_from_slice(points);
        self.offsets.push(self.connectivity.len());
    }

    /// The faces of a polyhedron. `None` if the cell is none, or the stream ends before its faces do.
    pub fn faces(&self, cell: usize) -> Option<Vec<&[u32]>> {
        let stream = self.face_stream.get(*self.face_offsets.get(cell)?..)?;
        polyhedron(stream).map(|(faces, _)| faces)
    }

    /// Point indices of a cell. `None` if there is no such cell or the offsets are at fault.
    pub fn cell(&self, cell: usize) -> Option<&[u32]> {
        let start = match cell {
            0 => 0,
            _ => *self.offsets.get(cell - 1)?,
        };
        self.connectivity.get(start..*self.offsets.get(cell)?)
    }
}

/// The faces at the beginning of a stream, and what follows them.
fn polyhedron(stream: &[u32]) -> Option<(Vec<&[u32]>, &[u32])> {
    let (&count, mut rest) = stream.split_first()?;
    // A face takes one number at least, so no more are asked for than there can be.
    let mut faces = Vec::with_capacity((count as usize).min(rest.len()));
    for _ in 0..count {
        let (&length, after) = rest.split_first()?;
        let (face, after) = after.split_at_checked(length as usize)?;
        faces.push(face);
        rest = after;
    }
    Some((faces, rest))
}

impl StructuredGrid {
    /// Number of hexahedra, blanked ones too.
    pub fn hexahedra(&self) -> usize {
        self.counts.iter().map(|n| n.saturating_sub(1)).fold(1, usize::saturating_mul)
    }

    /// Number of points; `None` if it has none or too many to count.
    pub fn points(&self) -> Option<usize> {
        self.counts.iter().try_fold(1usize, |n, &c| n.checked_mul(c)).filter(|&n| n > 0)
    }

    /// Calls `f` for each hexahedron without a blanked corner: its number in the grid, its place, and its corners in
    /// the mesh, in VTK's order. The grid must fit the mesh.
    pub(crate) fn for_each_visible(&self, mut f: impl FnMut(usize, [usize; 3], [u32; 8])) {
        let mut number = 0;
        for_each_hexahedron(self.counts, |ijk, corners| {
            if self.blanked.as_ref().is_none_or(|blanked| corners.iter().all(|&c| !blanked[c as usize])) {
                f(number, ijk, corners.map(|c| self.first_point as u32 + c));
            }
            number += 1;
        });
    }

    fn fits(&self, points: usize) -> bool {
        let own = self.points();
        own.and_then(|n| n.checked_add(self.first_point)).is_some_and(|end| end <= points)
            && self.blanked.as_ref().is_none_or(|b| Some(b.len()) == own)
    }

    fn visible_hexahedra(&self, points: usize) -> usize {
        if self.blanked.is_none() {
            return self.hexahedra();
        }
        let mut visible = 0;
        if self.fits(points) {
            self.for_each_visible(|_, _, _| visible += 1);
        }
        visible
    }
}

impl MixedMesh {
    /// Number of listed cells and of hexahedra of grids, blanked ones too: of values in a cell field.
    pub(crate) fn cell_tuples(&self) -> usize {
        self.grids.iter().map(StructuredGrid::hexahedra).fold(self.cells.types.len(), usize::saturating_add)
    }

    /// The number of cells of each type, in the order of VTK's type numbers; blanked hexahedra are not counted.
    pub fn cell_counts(&self) -> Vec<(&'static str, usize)> {
        let mut counts = [0usize; 256];
        for &t in &self.cells.types {
            counts[t as usize] += 1;
        }
        let points = self.points.len();
        counts[cell_type::HEXAHEDRON as usize] +=
            self.grids.iter().map(|grid| grid.visible_hexahedra(points)).fold(0, usize::saturating_add);
        // Several numbers without a type of their own share one name.
        let mut named: Vec<(&'static str, usize)> = Vec::new();
        for (t, &count) in counts.iter().enumerate().filter(|&(_, &count)| count > 0) {
            let name = CellType::of(t as u8).map_or("cells of unknown type", |t| t.plural);
            match named.iter_mut().find(|(n, _)| *n == name) {
                Some((_, total)) => *total += count,
                None => named.push((name, count)),
            }
        }
        named
    }

    fn malformed(&self, place: Place, what: &str, found: String, remedy: &str) -> IngestError {
        let (what, remedy) = (what.into(), remedy.into());
        IngestError::Malformed { path: self.path.clone(), place, what, found, remedy }
    }

    /// Whether all parts fit together: finite points, indices in range, lengths that agree.
    pub(crate) fn check(&self) -> Result<(), IngestError> {
        let points = self.points.len();
        if u32::try_from(points).is_err() {
            let source = MeshError::TooLarge { what: "points", count: points, limit: u32::MAX as usize };
            return Err(IngestError::Mesh { path: self.path.clone(), source });
        }
        if let Some(point) = self.points.iter().position(|p| !p.is_finite()) {
            let at = self.points[point].to_array();
            return Err(IngestError::NonFinite { path: self.path.clone(), point, at });
        }
        if let Some(grid) = self.grids.iter().find(|grid| !grid.fits(points)) {
            let blanked = grid.blanked.as_ref().map_or(String::new(), |b| format!(" with {} blankings", b.len()));
            let found = format!("{:?} from point {} of {points}{blanked}", grid.counts, grid.first_point);
            let remedy = "a grid needs i x j x k points, one at least, and a blanking each if any";
            return Err(self.malformed(Place::File, "the grid's dimensions", found, remedy));
        }
        let MixedCells { types, connectivity, offsets, .. } = &self.cells;
        if types.len() != offsets.len() {
            let found = format!("{} types and {} offsets", types.len(), offsets.len());
            return Err(self.malformed(Place::File, "the cells' arrays", found, "each cell needs one of each"));
        }
        let mut start = 0;
        for (c, &end) in offsets.iter().enumerate() {
            if end < start || end > connectivity.len() {
                let found = format!("{end} after {start}, of {} indices", connectivity.len());
                let remedy = "offsets must not decrease nor pass the end of the connectivity";
                return Err(self.malformed(Place::Cell(c), "the cell's offset", found, remedy));
            }
            if let Some(&index) = connectivity[start..end].iter().find(|&&v| v as usize >= points) {
                let remedy = format!("indices must be below the number of points, {points}");
                return Err(self.malformed(Place::Cell(c), "a point index out of range", index.to_string(), &remedy));
            }
            let expected = CellType::of(types[c]).and_then(|t| t.points);
            if let Some(expected) = expected.filter(|&n| end - start < n) {
                let what = format!("the number of points of a cell of type {}", types[c]);
                let remedy = format!("it must have {expected}");
                return Err(self.malformed(Place::Cell(c), &what, (end - start).to_string(), &remedy));
            }
            start = end;
        }
        if start != connectivity.len() {
            let remedy = "the last offset must be the number of indices";
            return Err(self.malformed(
                Place::File,
                "indices that belong to no cell",
                (connectivity.len() - start).to_string(),
                remedy,
            ));
        }
        self.check_faces()?;
        self.check_fields()
    }

    /// Whether the face stream is that of the polyhedra, one after another, with indices in range.
    fn check_faces(&self) -> Result<(), IngestError> {
        let MixedCells { types, face_stream, face_offsets, .. } = &self.cells;
        let polyhedra = types.contains(&cell_type::POLYHEDRON);
        if face_offsets.len() != types.len() && (polyhedra || !face_offsets.is_empty()) {
            let found = format!("{} for {} cells", face_offsets.len(), types.len());
            return Err(self.malformed(
                Place::File,
                "the places of the polyhedra's faces",
                found,
                "each cell needs one",
            ));
        }
        let mut rest = face_stream.as_slice();
        for (c, &start) in face_offsets.iter().enumerate() {
            if types[c] != cell_type::POLYHEDRON {
                continue;
            }
            let next = face_stream.len() - rest.len();
            if start != next {
                let (found, remedy) =
                    (start.to_string(), format!("they must begin at {next}, where the last ones end"));
                return Err(self.malformed(Place::Cell(c), "the place of the polyhedron's faces", found, &remedy));
            }
            let Some((faces, after)) = polyhedron(rest) else {
                let found = format!("the end after {} numbers", face_stream.len());
                let remedy = "a polyhedron needs its number of faces, and for each that of its points, and these";
                return Err(self.malformed(Place::Cell(c), "the faces of the polyhedron", found, remedy));
            };
            if let Some(face) = faces.iter().find(|face| face.len() < 3) {
                let found = face.len().to_string();
                return Err(self.malformed(
                    Place::Cell(c),
                    "the points of a polyhedron's face",
                    found,
                    "it needs three",
                ));
            }
            if let Some(&index) = faces.iter().copied().flatten().find(|&&v| v as usize >= self.points.len()) {
                let remedy = format!("indices must be below the number of points, {}", self.points.len());
                return Err(self.malformed(
                    Place::Cell(c),
                    "a face's point index out of range",
                    index.to_string(),
                    &remedy,
                ));
            }
            rest = after;
        }
        if !rest.is_empty() {
            let found = format!("{} numbers", rest.len());
            return Err(self.malformed(
                Place::File,
                "faces that belong to no polyhedron",
                found,
                "write the file again",
            ));
        }
        Ok(())
    }

    fn check_fields(&self) -> Result<(), IngestError> {
        let cells = self.cell_tuples();
        for field in &self.fields {
            let tuples = if field.location == Location::Point { self.points.len() } else { cells };
            let expected = tuples.saturating_mul(field.components.max(1));
            if field.components == 0 || field.values.len() != expected {
                let source = MeshError::FieldLength {
                    name: field.name.clone(),
                    found: field.values.len(),
                    expected,
                    tuples,
                    location: field.location.plural(),
                    components: field.components,
                };
                return Err(IngestError::Mesh { path: self.path.clone(), source });
            }
        }
        Ok(())
    }
}
