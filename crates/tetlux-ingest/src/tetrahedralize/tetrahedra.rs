//! Tetrahedra as they are made, with the points that are added for them.

use glam::DVec3;
use tetlux_mesh::{Field, Location};

use crate::cell_type::{CellType, WEDGE};

/// Tetrahedra, the cell that each was made of, and points and their data.
pub(super) struct Tetrahedra {
    pub(super) points: Vec<DVec3>,
    pub(super) fields: Vec<Field>,
    pub(super) cells: Vec<[u32; 4]>,
    pub(super) origin: Vec<u32>,
    /// For each point the first that coincides with it; those beyond the end have none but themselves.
    first: Vec<u32>,
}

impl Tetrahedra {
    /// None yet; room for `capacity`.
    pub(super) fn new(points: Vec<DVec3>, fields: Vec<Field>, first: Vec<u32>, capacity: usize) -> Self {
        let (cells, origin) = (Vec::with_capacity(capacity), Vec::with_capacity(capacity));
        Tetrahedra { points, fields, cells, origin, first }
    }

    /// What decides how a face is cut: alike for points that coincide, different for all others.
    pub(super) fn rank(&self, point: u32) -> u32 {
        self.first.get(point as usize).copied().unwrap_or(point)
    }

    pub(super) fn push(&mut self, cell: [u32; 4], origin: usize) {
        self.cells.push(cell);
        self.origin.push(origin as u32);
    }

    /// Adds a part of a cell, unless two of its corners are one: of a collapsed cell that part is not there.
    pub(super) fn push_split(&mut self, cell: [u32; 4], origin: usize) {
        let ranks = cell.map(|v| self.rank(v));
        if (0..4).all(|i| (0..i).all(|j| ranks[i] != ranks[j])) {
            self.push(cell, origin);
        }
    }

    /// Adds a point at the weighted sum of others, with the weighted sum of their data.
    pub(super) fn add_point(&mut self, parts: &[(u32, f64)]) -> u32 {
        let added = self.points.len() as u32;
        let at = parts.iter().map(|&(v, weight)| self.points[v as usize] * weight).sum();
        self.points.push(at);
        for field in self.fields.iter_mut().filter(|field| field.location == Location::Point) {
            let n = field.components;
            for i in 0..n {
                let value = parts.iter().map(|&(v, weight)| field.values[v as usize * n + i] * weight).sum();
                field.values.push(value);
            }
        }
        added
    }

    /// Makes tetrahedra and turns all of them round if their volumes sum to less than nothing: for cells of which
    /// files do not agree what is inside out.
    pub(super) fn mend(&mut self, make: impl FnOnce(&mut Self)) {
        let start = self.cells.len();
        make(self);
        let volume = |cell: &[u32; 4]| {
            let [a, b, c, d] = cell.map(|v| self.points[v as usize]);
            (b - a).cross(c - a).dot(d - a)
        };
        if self.cells[start..].iter().map(volume).sum::<f64>() < 0.0 {
            self.cells[start..].iter_mut().for_each(|cell| cell.swap(2, 3));
        }
    }

    /// Makes the tetrahedra of a cell. VTK's documentation has the first triangle of a wedge face outwards, VTK's own
    /// interpolation and most writers inwards, so that wedges are turned as they need.
    pub(super) fn mend_wedge(&mut self, kind: &'static CellType, make: impl FnOnce(&mut Self)) {
        if kind.linear().number == WEDGE { self.mend(make) } else { make(self) }
    }
}
