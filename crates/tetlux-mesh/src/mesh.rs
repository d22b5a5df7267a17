//! The tetrahedral mesh.

use glam::{DVec3, Vec3};
use rayon::prelude::*;

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
        let around = |[low, high]: [Vec3; 2], p: &Vec3| [low.min(*p), high.max(*p)];
        self.points.iter().fold([Vec3::INFINITY, Vec3::NEG_INFINITY], around).map(|corner| corner.as_dvec3())
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
        (0..self.cells.len()).into_par_iter().map(|cell| self.scalar_range(scalar, cell)).collect()
    }

    /// Smallest and largest scalar of one cell; NaN in both where a value is missing.
    pub fn scalar_range(&self, scalar: &ScalarField, cell: usize) -> [f64; 2] {
        let values = match scalar.location {
            Location::Point => self.cells[cell].map(|v| scalar.values[v as usize]),
            Location::Cell => [scalar.values[cell]; 4],
        };
        if values.iter().all(|v| v.is_finite()) {
            [values.into_iter().fold(f64::INFINITY, f64::min), values.into_iter().fold(f64::NEG_INFINITY, f64::max)]
        } else {
            [f64::NAN; 2]
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::procedural::{Split, cuboid};

    /// Two cells, and what they carry.
    fn mesh(fields: Vec<Field>) -> TetMesh {
        let points = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z, DVec3::ONE];
        TetMesh::assemble(&points, &[[0, 1, 2, 3], [1, 2, 3, 4]], fields).unwrap()
    }

    #[test]
    fn scalars_are_found_by_name_and_component() {
        let wind = Field::point("wind", 2, vec![3.0, 4.0, 0.0, -2.0, f64::NAN, 1.0, 6.0, 8.0, 0.0, 0.0]);
        let mesh = mesh(vec![wind, Field::cell("rank", 1, vec![-7.0, 5.0])]);
        let speed = mesh.scalar("wind", Component::Magnitude).unwrap();
        assert_eq!((&speed.values[..2], speed.range, speed.missing), (&[5.0, 2.0][..], [0.0, 10.0], 1));
        assert_eq!(mesh.scalar("wind", Component::Index(1)).unwrap().range, [-2.0, 8.0]);
        let rank = mesh.scalar("rank", Component::Magnitude).unwrap();
        assert_eq!((rank.location, &rank.values[..]), (Location::Cell, &[-7.0, 5.0][..]));
    }

    #[test]
    fn scalars_that_are_not_there_are_named() {
        let mesh = mesh(vec![Field::point("void", 1, vec![f64::NAN; 5]), Field::cell("rank", 1, vec![0.0, 1.0])]);
        let refuse = |name, component| mesh.scalar(name, component).unwrap_err();
        assert!(matches!(refuse("void", Component::Magnitude), MeshError::NoData { count: 5, .. }));
        let message = refuse("void", Component::Magnitude).to_string();
        assert!(message.contains("\"void\" holds no finite value") && message.contains("\"rank\" (cells"), "{message}");
        assert!(matches!(
            refuse("rank", Component::Index(1)),
            MeshError::NoComponent { components: 1, component: 1, .. }
        ));
        let message = refuse("heat", Component::Magnitude).to_string();
        assert!(message.contains("\"heat\"") && message.contains("\"void\" (points, 1 component)"), "{message}");
    }

    #[test]
    fn ranges_of_cells_span_their_vertices() {
        let mesh = mesh(vec![
            Field::point("f", 1, vec![f64::NAN, 1.0, -2.0, 3.0, 0.5]),
            Field::cell("g", 1, vec![2.0, f64::INFINITY]),
        ]);
        let ranges = |name| mesh.scalar_ranges(&mesh.scalar(name, Component::Magnitude).unwrap());
        let f = ranges("f");
        assert!(f[0].iter().all(|v| v.is_nan()));
        assert_eq!(f[1], [-2.0, 3.0]);
        let g = ranges("g");
        assert_eq!(g[0], [2.0, 2.0]);
        assert!(g[1].iter().all(|v| v.is_nan()));
    }

    #[test]
    fn the_origin_is_the_middle_and_world_positions_are_those_given() {
        let corners = [DVec3::new(10.0, 20.0, 30.0), DVec3::new(12.0, 24.0, 31.0)];
        let parts = cuboid([1, 1, 1], Split::Six, corners);
        let mesh = TetMesh::assemble(&parts.points, &parts.cells, vec![]).unwrap();
        assert_eq!(mesh.origin(), DVec3::new(11.0, 22.0, 30.5));
        assert_eq!(mesh.bounds(), corners);
        assert_eq!(mesh.local_bounds(), [DVec3::new(-1.0, -2.0, -0.5), DVec3::new(1.0, 2.0, 0.5)]);
        assert_eq!(mesh.world(7), corners[1]);
    }
}
