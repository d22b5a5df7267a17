//! Cells that are another piece's, and hidden ones: VTK's array `vtkGhostType` (vtkDataSetAttributes.h) marks them, and
//! its forerunner `vtkGhostLevels`.

use tetlux_mesh::{Field, Location};

use crate::cell_type::HEXAHEDRON;
use crate::{MixedCells, MixedMesh, StructuredGrid};

/// Of cells: another piece holds it too.
pub(super) const DUPLICATE: u8 = 1;
/// Of cells: finer ones are in its place.
const REFINED: u8 = 8;
/// Of cells: blanked.
pub(super) const HIDDEN: u8 = 32;
/// Of points: blanked.
pub(super) const HIDDEN_POINT: u8 = 2;

/// The marks of a mesh's cells and points, if it has any.
#[derive(Default)]
pub(super) struct Ghosts {
    pub(super) cells: Option<Vec<u8>>,
    pub(super) points: Option<Vec<u8>>,
}

impl Ghosts {
    /// Takes the marks out of the fields.
    pub(super) fn take(fields: &mut Vec<Field>) -> Ghosts {
        let mut ghosts = Ghosts::default();
        fields.retain(|field| {
            let level = field.name == "vtkGhostLevels";
            if !(level || field.name == "vtkGhostType") || field.components != 1 {
                return true;
            }
            let mark = |&v: &f64| if level { u8::from(v > 0.0) * DUPLICATE } else { v as u8 };
            let marks = || Some(field.values.iter().map(mark).collect());
            match field.location {
                Location::Cell => ghosts.cells = marks(),
                Location::Point if !level => ghosts.points = marks(),
                Location::Point => {}
            }
            false
        });
        ghosts
    }

    /// Leaves out what is marked, and counts it. A mesh with marks has listed cells, or else one grid.
    pub(super) fn apply(self, mesh: &mut MixedMesh, left: &mut LeftOut) {
        let left_out = |mark: u8| mark & (DUPLICATE | REFINED | HIDDEN) != 0;
        let marks = self.cells.filter(|marks| marks.iter().any(|&m| left_out(m)));
        let blanked = self.points.map(|marks| marks.iter().map(|m| m & HIDDEN_POINT != 0).collect::<Vec<bool>>());
        let blanked = blanked.filter(|blanked| blanked.contains(&true));
        if marks.is_none() && blanked.is_none() {
            return;
        }
        if let (Some(grid), None) = (mesh.grids.first_mut(), &marks) {
            let all = grid.hexahedra();
            grid.blanked = blanked;
            let visible = mesh.cell_counts().iter().map(|&(_, count)| count).sum();
            left.cornered += all.saturating_sub(visible);
            return;
        }
        if let Some(grid) = mesh.grids.pop() {
            mesh.cells = listed(&grid);
        }
        let cells = mesh.cells.types.len();
        let marks = marks.filter(|marks| marks.len() == cells).unwrap_or_else(|| vec![0; cells]);
        let mut keep = Vec::with_capacity(cells);
        for (c, &mark) in marks.iter().enumerate() {
            let corners = mesh.cells.cell(c).unwrap_or_default();
            let has_hidden = |b: &Vec<bool>| corners.iter().any(|&v| b.get(v as usize) == Some(&true));
            if mark & DUPLICATE != 0 {
                left.copies += 1;
            } else if left_out(mark) {
                left.hidden += 1;
            } else if blanked.as_ref().is_some_and(has_hidden) {
                left.cornered += 1;
            } else {
                keep.push(c);
            }
        }
        retain(mesh, &keep);
    }
}

/// Numbers of cells left out.
#[derive(Default)]
pub(super) struct LeftOut {
    copies: usize,
    hidden: usize,
    cornered: usize,
}

impl LeftOut {
    /// Notes what was left out.
    pub(super) fn note(self, mesh: &mut MixedMesh) {
        for (count, what) in [
            (self.copies, "ghost cells (vtkGhostType), which belong to other pieces"),
            (self.hidden, "hidden cells (vtkGhostType)"),
            (self.cornered, "cells with a hidden corner (vtkGhostType)"),
        ] {
            if count > 0 {
                mesh.note(format!("{what}: {count}, left out"));
            }
        }
    }
}

/// The hexahedra of a grid, one by one.
fn listed(grid: &StructuredGrid) -> MixedCells {
    let mut cells = MixedCells::default();
    grid.for_each_visible(|_, _, corners| cells.push(HEXAHEDRON, &corners));
    cells
}

/// Keeps these cells, and their data.
fn retain(mesh: &mut MixedMesh, keep: &[usize]) {
    let all = std::mem::take(&mut mesh.cells);
    for &c in keep {
        let points = all.cell(c).unwrap_or_default();
        match all.faces(c) {
            Some(faces) => mesh.cells.push_polyhedron(points, &faces),
            None => mesh.cells.push(all.types[c], points),
        }
    }
    for field in mesh.fields.iter_mut().filter(|field| field.location == Location::Cell) {
        let n = field.components;
        field.values = keep.iter().flat_map(|&c| &field.values[c * n..(c + 1) * n]).copied().collect();
    }
}
