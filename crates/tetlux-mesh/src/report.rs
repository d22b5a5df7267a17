//! What is known of a mesh, and what is wrong with it.

use rayon::prelude::*;

use crate::{Assembly, FACES, NONE, TetMesh};

/// Counts and measures of a mesh: see [`TetMesh::validate`].
#[derive(Debug, Clone, PartialEq)]
pub struct Report {
    /// What assembling the mesh found and mended.
    pub assembly: Assembly,
    /// Points after merging.
    pub points: usize,
    /// Points that no cell uses.
    pub points_unused: usize,
    /// Cells after dropping those with repeated vertices.
    pub cells: usize,
    /// Corners of the bounding box in world space.
    pub bounds: [[f64; 3]; 2],
    /// Shortest and longest edge of a cell, in world units.
    pub edge_lengths: [f64; 2],
    /// Mean edge length, in world units: the default unit distance.
    pub mean_edge_length: f64,
    /// Sum of the cells' volumes, in cubic world units.
    pub volume: f64,
    /// Faces with a cell on one side only.
    pub boundary_faces: usize,
    /// Sets of cells connected through faces.
    pub components: usize,
    /// Quadrilaterals of the boundary that are split along one diagonal on one side and along the other on the
    /// other side: there the cells do not conform, and overlap or leave gaps unless the quadrilateral is plane.
    /// A hole of the shape of one tetrahedron has the same triangles, and counts too.
    pub quads_split_both_ways: usize,
}

impl Report {
    pub(crate) fn of(mesh: &TetMesh) -> Report {
        let mut used = vec![false; mesh.points.len()];
        let mut edge_lengths = [f64::INFINITY, 0.0f64];
        let mut volume = 0.0;
        for cell in &mesh.cells {
            cell.iter().for_each(|&v| used[v as usize] = true);
            for length in mesh.edge_lengths(cell) {
                edge_lengths = [edge_lengths[0].min(length), edge_lengths[1].max(length)];
            }
            let p = cell.map(|v| mesh.points[v as usize].as_dvec3());
            volume += (p[1] - p[0]).cross(p[2] - p[0]).dot(p[3] - p[0]);
        }
        let boundary = boundary_faces(mesh);
        Report {
            assembly: mesh.assembly,
            points: mesh.points.len(),
            points_unused: used.iter().filter(|&&u| !u).count(),
            cells: mesh.cells.len(),
            bounds: mesh.bounds().map(|corner| corner.to_array()),
            edge_lengths,
            mean_edge_length: mesh.mean_edge_length(),
            volume: volume / 6.0,
            boundary_faces: boundary.len(),
            components: mesh.components(),
            quads_split_both_ways: quads_split_both_ways(&boundary),
        }
    }

    /// All that a mesh is checked for, with the number of places found: none where there is nothing wrong.
    pub fn checks(&self) -> [Check; 9] {
        let a = &self.assembly;
        [
            ("merged points", a.points_merged, "coincident points were merged"),
            ("differing data", a.merged_data_differ, "merged points carry data that differ from those kept"),
            ("unused points", self.points_unused, "points are used by no cell"),
            ("repeated vertices", a.cells_repeated, "cells with repeated vertices were dropped"),
            ("inverted cells", a.cells_inverted, "inverted cells were turned round"),
            ("flat cells", a.cells_flat, "cells have zero volume: kept in the adjacency, without optical depth"),
            (
                "non-manifold faces",
                a.faces_non_manifold,
                "faces are shared by three or more cells: cells overlap there",
            ),
            ("folded faces", a.faces_folded, "faces have both their cells on one side: cells overlap there"),
            (
                "split both ways",
                self.quads_split_both_ways,
                "quadrilaterals are split along both diagonals: cells do not conform there",
            ),
        ]
        .map(|(name, count, meaning)| Check { name, count, meaning })
    }

    /// What a user should know before trusting a picture of this mesh, a sentence each; empty if nothing is wrong.
    pub fn faults(&self) -> Vec<String> {
        let found = self.checks().into_iter().filter(|check| check.count > 0);
        found.map(|check| format!("{} {}", check.count, check.meaning)).collect()
    }
}

/// Something that a mesh is checked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Check {
    /// What is looked for, in short.
    pub name: &'static str,
    /// How often it was found.
    pub count: usize,
    /// What it means, as the rest of a sentence that begins with the count.
    pub meaning: &'static str,
}

impl TetMesh {
    /// Sets of cells connected through faces.
    pub fn components(&self) -> usize {
        components(&self.neighbors)
    }

    /// Quadrilaterals of the boundary split along both diagonals: see [`Report::quads_split_both_ways`].
    pub fn quads_split_both_ways(&self) -> usize {
        quads_split_both_ways(&boundary_faces(self))
    }
}

/// Vertices and cell of each face with a cell on one side only.
fn boundary_faces(mesh: &TetMesh) -> Vec<([u32; 3], u32)> {
    let mut faces = Vec::new();
    for (c, (cell, around)) in mesh.cells.iter().zip(&mesh.neighbors).enumerate() {
        for f in (0..4).filter(|&f| around[f] == NONE) {
            faces.push((FACES[f].map(|i| cell[i]), c as u32));
        }
    }
    faces
}

/// Joins neighbours into trees whose root is the first cell, halving paths on the way: in order of index, so that little
/// jumps in memory.
fn components(neighbors: &[[u32; 4]]) -> usize {
    let mut parents: Vec<u32> = (0..neighbors.len() as u32).collect();
    let root = |parents: &mut [u32], mut cell: u32| {
        while parents[cell as usize] != cell {
            let above = parents[parents[cell as usize] as usize];
            parents[cell as usize] = above;
            cell = above;
        }
        cell
    };
    let mut count = neighbors.len();
    for (cell, around) in neighbors.iter().enumerate() {
        let mut own = root(&mut parents, cell as u32);
        for &neighbor in around.iter().filter(|&&n| (n as usize) < cell) {
            let other = root(&mut parents, neighbor);
            if own != other {
                parents[own.max(other) as usize] = own.min(other);
                own = own.min(other);
                count -= 1;
            }
        }
    }
    count
}

/// Sets of four boundary vertices covered by triangle pairs along both diagonals.
fn quads_split_both_ways(boundary: &[([u32; 3], u32)]) -> usize {
    // Triangles that share an edge come together: (edge, the third vertex, the cell).
    let mut wings: Vec<([u32; 2], u32, u32)> = boundary
        .iter()
        .flat_map(|&([a, b, c], cell)| [(a, b, c, cell), (b, c, a, cell), (c, a, b, cell)])
        .map(|(a, b, opposite, cell)| ([a.min(b), a.max(b)], opposite, cell))
        .collect();
    wings.par_sort_unstable();
    let mut quads: Vec<([u32; 4], [u32; 2])> = Vec::with_capacity(wings.len() / 2);
    for fan in wings.chunk_by(|a, b| a.0 == b.0) {
        // Two triangles, more only where sheets of the boundary touch along the edge. Two faces of one cell are no
        // quadrilateral: that cell's own four vertices would show every edge as a diagonal.
        for (i, &(edge, p, cell)) in fan.iter().enumerate().take(MOST_SHEETS) {
            for &(_, q, other) in fan[i + 1..].iter().take(MOST_SHEETS) {
                if q != p && other != cell {
                    let mut quad = [edge[0], edge[1], p, q];
                    quad.sort_unstable();
                    quads.push((quad, edge));
                }
            }
        }
    }
    quads.par_sort_unstable();
    let crossed = |diagonals: &[([u32; 4], [u32; 2])]| {
        diagonals.iter().any(|(_, d)| diagonals.iter().any(|(_, e)| !d.contains(&e[0]) && !d.contains(&e[1])))
    };
    quads.chunk_by(|a, b| a.0 == b.0).filter(|diagonals| crossed(diagonals)).count()
}

/// Boundary triangles looked at round one edge: bounds the work on an edge shared by a great many cells.
const MOST_SHEETS: usize = 64;

#[cfg(test)]
mod tests;
