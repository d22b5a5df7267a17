//! What a file holds, before it is split into tetrahedra.

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
    /// The cells that are listed one by one; none where `grid` gives them.
    pub cells: MixedCells,
    /// The structured grid whose hexahedra are the cells, if the file holds one.
    pub grid: Option<StructuredGrid>,
    /// Point and cell data.
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
}

/// The hexahedra between the points of a block, i fastest.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct StructuredGrid {
    /// Points along i, j and k.
    pub counts: [usize; 3],
    /// For each point, whether it is blanked: a hexahedron with a blanked corner is no cell. `None`: all are cells.
    pub blanked: Option<Vec<bool>>,
}

impl MixedCells {
    /// Point indices of a cell. `None` if there is no such cell or the offsets are at fault.
    pub fn cell(&self, cell: usize) -> Option<&[u32]> {
        let start = match cell {
            0 => 0,
            _ => *self.offsets.get(cell - 1)?,
        };
        self.connectivity.get(start..*self.offsets.get(cell)?)
    }
}

impl StructuredGrid {
    /// Number of hexahedra, blanked ones too.
    pub fn hexahedra(&self) -> usize {
        self.counts.iter().map(|n| n.saturating_sub(1)).fold(1, usize::saturating_mul)
    }

    /// Whether a hexahedron has no blanked corner.
    pub(crate) fn visible(&self, corners: &[u32; 8]) -> bool {
        self.blanked.as_ref().is_none_or(|blanked| corners.iter().all(|&c| !blanked[c as usize]))
    }
}

impl MixedMesh {
    /// The number of cells of each type, in the order of VTK's type numbers; blanked hexahedra are not counted.
    pub fn cell_counts(&self) -> Vec<(&'static str, usize)> {
        let mut counts = [0usize; 256];
        for &t in &self.cells.types {
            counts[t as usize] += 1;
        }
        counts[cell_type::HEXAHEDRON as usize] += self.visible_hexahedra();
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

    fn visible_hexahedra(&self) -> usize {
        let Some(grid) = &self.grid else { return 0 };
        let Some(blanked) = &grid.blanked else { return grid.hexahedra() };
        let mut visible = 0;
        if grid.counts.iter().try_fold(1usize, |n, &c| n.checked_mul(c)) == Some(blanked.len()) {
            for_each_hexahedron(grid.counts, |_, corners| visible += usize::from(grid.visible(&corners)));
        }
        visible
    }

    /// Whether all parts fit together: finite points, indices in range, lengths that agree.
    pub(crate) fn check(&self) -> Result<(), IngestError> {
        let points = self.points.len();
        let malformed = |place, what: &str, found: String, remedy: &str| IngestError::Malformed {
            path: self.path.clone(),
            place,
            what: what.into(),
            found,
            remedy: remedy.into(),
        };
        if u32::try_from(points).is_err() {
            let source = MeshError::TooLarge { what: "points", count: points, limit: u32::MAX as usize };
            return Err(IngestError::Mesh { path: self.path.clone(), source });
        }
        if let Some(point) = self.points.iter().position(|p| !p.is_finite()) {
            let at = self.points[point].to_array();
            return Err(IngestError::NonFinite { path: self.path.clone(), point, at });
        }
        if let Some(grid) = &self.grid {
            let expected = grid.counts.iter().try_fold(1usize, |n, &c| n.checked_mul(c));
            let fits = expected == Some(points) && grid.blanked.as_ref().is_none_or(|b| b.len() == points);
            if !fits || !self.cells.types.is_empty() {
                let found = format!("{:?} for {points} points", grid.counts);
                let remedy = "a grid needs i x j x k points and no listed cells";
                return Err(malformed(Place::File, "the grid's dimensions", found, remedy));
            }
        }
        let MixedCells { types, connectivity, offsets } = &self.cells;
        if types.len() != offsets.len() {
            let found = format!("{} types and {} offsets", types.len(), offsets.len());
            return Err(malformed(Place::File, "the cells' arrays", found, "each cell needs one of each"));
        }
        let mut start = 0;
        for (c, &end) in offsets.iter().enumerate() {
            if end < start || end > connectivity.len() {
                let found = format!("{end} after {start}, of {} indices", connectivity.len());
                let remedy = "offsets must not decrease nor pass the end of the connectivity";
                return Err(malformed(Place::Cell(c), "the cell's offset", found, remedy));
            }
            if let Some(&index) = connectivity[start..end].iter().find(|&&v| v as usize >= points) {
                let remedy = format!("indices must be below the number of points, {points}");
                return Err(malformed(Place::Cell(c), "a point index out of range", index.to_string(), &remedy));
            }
            let expected = CellType::of(types[c]).and_then(|t| t.points);
            if let Some(expected) = expected.filter(|&n| end - start < n) {
                let what = format!("the number of points of a cell of type {}", types[c]);
                let remedy = format!("it must have {expected}");
                return Err(malformed(Place::Cell(c), &what, (end - start).to_string(), &remedy));
            }
            start = end;
        }
        if start != connectivity.len() {
            let remedy = "the last offset must be the number of indices";
            return Err(malformed(
                Place::File,
                "indices that belong to no cell",
                (connectivity.len() - start).to_string(),
                remedy,
            ));
        }
        self.check_fields()
    }

    fn check_fields(&self) -> Result<(), IngestError> {
        let cells = self.grid.as_ref().map_or(self.cells.types.len(), StructuredGrid::hexahedra);
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
