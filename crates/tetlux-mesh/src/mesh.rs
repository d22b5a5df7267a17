//! The tetrahedral mesh.

use glam::{DVec3, Vec3};

use crate::field::finite_range;
use crate::{Assembly, Component, Field, Location, MeshError, Report, ScalarField};

/// In [`TetMesh::neighbors`]: no cell across this face.
pub const NONE: u32 = u32::MAX;

/// Vertices of the face opposite each vertex, counter-clockwise seen from outside a positively oriented cell.
pub const FACES: [[usize; 3]; 4] = [[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]];

/// A tetrahedral mesh, assembled: points merged, cells oriented, faces matched.
///
/// Positions are single precision relative to [`origin`](Self::origin), the centre of the bounding box, so that a
/// mesh far from the origin loses nothing. They are what every renderer, and the reference, sees.
#[derive(Debug, Clone)]
pub struct TetMesh {
    pub(crate) origin: DVec3,
    pub(crate) points: Vec<Vec3>,
    pub(crate) cells: Vec<[u32; 4]>,
    pub(crate) neighbors: Vec<[u32; 4]>,
    pub(crate) fields: Vec<Field>,
    pub(crate) assembly: Assembly,
}

impl TetMesh {
    /// World position of the local origin: the centre of the bounding box.
    pub fn origin(&self) -> DVec3 {
        self.origin
    }

    /// Positions relative to [`origin`](Self::origin).
    pub fn points(&self) -> &[Vec3] {
        &self.points
    }

    /// Vertex indices of each cell, with (p1-p0) x (p2-p0) . (p3-p0) >= 0.
    pub fn cells(&self) -> &[[u32; 4]] {
        &self.cells
    }

    /// For each cell the cell across the face opposite each vertex, or [`NONE`].
    pub fn neighbors(&self) -> &[[u32; 4]] {
        &self.neighbors
    }

    /// Point and cell data.
    pub fn fields(&self) -> &[Field] {
        &self.fields
    }

    /// What assembling the mesh found and mended.
    pub fn assembly(&self) -> &Assembly {
        &self.assembly
    }

    /// World position of a point.
    pub fn world(&self, point: u32) -> DVec3 {
        self.origin + self.points[point as usize].as_dvec3()
    }

    /// Corners of the bounding box relative to [`origin`](Self::origin).
    pub fn local_bounds(&self) -> [DVec3; 2] {
        let mut bounds = [DVec3::INFINITY, DVec3::NEG_INFINITY];
        for p in &self.points {
            bounds = [bounds[0].min(p.as_dvec3()), bounds[1].max(p.as_dvec3())];
        }
        bounds
    }

    /// Corners of the bounding box in world space.
    pub fn bounds(&self) -> [DVec3; 2] {
        self.local_bounds().map(|corner| corner + self.origin)
    }

    /// Mean length of the cells' edges, an edge counted once a cell: ParaView's default unit distance.
    pub fn mean_edge_length(&self) -> f64 {
        let total: f64 = self.cells.iter().flat_map(|cell| self.edge_lengths(cell)).sum();
        total / (6 * self.cells.len().max(1)) as f64
    }

    pub(crate) fn edge_lengths(&self, cell: &[u32; 4]) -> [f64; 6] {
        let p = cell.map(|v| self.points[v as usize].as_dvec3());
        [(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)].map(|(i, j)| p[i].distance(p[j]))
    }

    /// One scalar a point or cell: a field by name, with a vector's magnitude or component.
    pub fn scalar(&self, name: &str, component: Component) -> Result<ScalarField, MeshError> {
        let field = self
            .fields
            .iter()
            .find(|f| f.name == name)
            .ok_or_else(|| MeshError::NoField { name: name.into(), available: self.field_list() })?;
        if let Component::Index(component) = component
            && component >= field.components
        {
            return Err(MeshError::NoComponent { name: name.into(), components: field.components, component });
        }
        let values: Vec<f64> = field.scalars(component).collect();
        let range = finite_range(values.iter().copied()).ok_or_else(|| MeshError::NoData {
            name: name.into(),
            count: values.len(),
            available: self.field_list(),
        })?;
        let missing = values.iter().filter(|v| !v.is_finite()).count();
        Ok(ScalarField { name: name.into(), location: field.location, values, range, missing })
    }

    /// Smallest and largest scalar of each cell; NaN in both where a value is missing.
    pub fn scalar_ranges(&self, scalar: &ScalarField) -> Vec<[f64; 2]> {
        let range = |values: [f64; 4]| {
            if values.iter().all(|v| v.is_finite()) {
                [values.into_iter().fold(f64::INFINITY, f64::min), values.into_iter().fold(f64::NEG_INFINITY, f64::max)]
            } else {
                [f64::NAN; 2]
            }
        };
        match scalar.location {
            Location::Point => self.cells.iter().map(|c| range(c.map(|v| scalar.values[v as usize]))).collect(),
            Location::Cell => scalar.values.iter().map(|&v| range([v; 4])).collect(),
        }
    }

    /// Counts and measures of the mesh, and what is wrong with it.
    pub fn validate(&self) -> Report {
        Report::of(self)
    }

    fn field_list(&self) -> String {
        let names: Vec<String> = self
            .fields
            .iter()
            .map(|f| {
                format!(
                    "\"{}\" ({}, {} component{})",
                    f.name,
                    f.location.plural(),
                    f.components,
                    if f.components == 1 { "" } else { "s" }
                )
            })
            .collect();
        if names.is_empty() { "no fields".into() } else { names.join(", ") }
    }
}
