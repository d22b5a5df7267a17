//! Meshes made by rule: hexahedral grids of any shape, split into tetrahedra.

mod cycles;
pub(crate) mod random;
mod vortices;
mod wing;

use glam::DVec3;

pub use cycles::{filled_ring, ring, three_cycle};
pub use vortices::Vortices;
pub use wing::{WING_FIELD, Wing, wing};

/// How a hexahedron becomes tetrahedra.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Split {
    /// Five: one in the middle, one at every other corner; mirrored in every other hexahedron of a grid.
    /// Conforming only where the hexahedra can be two-coloured: not across a periodic seam of odd count.
    Five,
    /// Six round the diagonal from the first to the last corner (Kuhn 1960): conforming on every structured grid.
    #[default]
    Six,
}

/// Six round the diagonal 0-6. Corners as VTK numbers them: bottom 0 1 2 3, top 4 5 6 7.
const SIX: [[usize; 4]; 6] = [[0, 1, 2, 6], [0, 5, 1, 6], [0, 2, 3, 6], [0, 3, 7, 6], [0, 4, 5, 6], [0, 7, 4, 6]];
const FIVE_EVEN: [[usize; 4]; 5] = [[0, 5, 2, 7], [1, 2, 0, 5], [3, 0, 2, 7], [4, 5, 0, 7], [6, 2, 5, 7]];
const FIVE_ODD: [[usize; 4]; 5] = [[1, 3, 4, 6], [0, 1, 3, 4], [2, 3, 1, 6], [5, 1, 4, 6], [7, 4, 3, 6]];

impl Split {
    /// The tetrahedra of the hexahedron at place `ijk` of a grid; `corners` in VTK's order. Positively oriented if
    /// the hexahedron is.
    pub fn hexahedron(self, corners: [u32; 8], ijk: [usize; 3]) -> impl Iterator<Item = [u32; 4]> {
        let cells: &[[usize; 4]] = match self {
            Split::Six => &SIX,
            Split::Five if (ijk[0] + ijk[1] + ijk[2]).is_multiple_of(2) => &FIVE_EVEN,
            Split::Five => &FIVE_ODD,
        };
        cells.iter().map(move |cell| cell.map(|i| corners[i]))
    }
}

/// Points and cells of a mesh that is not yet assembled.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Parts {
    /// World positions.
    pub points: Vec<DVec3>,
    /// Tetrahedra by point index.
    pub cells: Vec<[u32; 4]>,
}

impl Parts {
    /// A function of the position at every point: the values of a point field.
    pub fn sample(&self, f: impl FnMut(DVec3) -> f64) -> Vec<f64> {
        self.points.iter().copied().map(f).collect()
    }

    /// Adds another mesh beside this one; nothing is merged.
    pub fn append(&mut self, other: &Parts) {
        let offset = self.points.len() as u32;
        self.points.extend_from_slice(&other.points);
        self.cells.extend(other.cells.iter().map(|cell| cell.map(|v| v + offset)));
    }
}

/// A grid of `counts` hexahedra over the unit cube, each split into tetrahedra and moved by `place`.
///
/// `place` takes (i, j, k)/counts in [0, 1]^3 to a world position; i runs fastest.
pub fn grid(counts: [usize; 3], split: Split, place: impl Fn(DVec3) -> DVec3) -> Parts {
    let n = counts.map(|c| c + 1);
    let mut parts = Parts::default();
    for k in 0..n[2] {
        for j in 0..n[1] {
            for i in 0..n[0] {
                let unit = |index: usize, axis: usize| index as f64 / counts[axis].max(1) as f64;
                parts.points.push(place(DVec3::new(unit(i, 0), unit(j, 1), unit(k, 2))));
            }
        }
    }
    for_each_hexahedron(n, |ijk, corners| parts.cells.extend(split.hexahedron(corners, ijk)));
    parts
}

/// Calls `f` with the place and the corners, in VTK's order, of every hexahedron of a grid of `n` points, i fastest.
pub fn for_each_hexahedron(n: [usize; 3], mut f: impl FnMut([usize; 3], [u32; 8])) {
    let at = |i: usize, j: usize, k: usize| ((k * n[1] + j) * n[0] + i) as u32;
    for k in 0..n[2].saturating_sub(1) {
        for j in 0..n[1].saturating_sub(1) {
            for i in 0..n[0].saturating_sub(1) {
                let corner =
                    |dk| [at(i, j, k + dk), at(i + 1, j, k + dk), at(i + 1, j + 1, k + dk), at(i, j + 1, k + dk)];
                let ([a, b, c, d], [e, f0, g, h]) = (corner(0), corner(1));
                f([i, j, k], [a, b, c, d, e, f0, g, h]);
            }
        }
    }
}

/// An axis-aligned box of `counts` equal hexahedra between two corners.
pub fn cuboid(counts: [usize; 3], split: Split, corners: [DVec3; 2]) -> Parts {
    // A convex combination, so that the last point is the far corner itself.
    grid(counts, split, |u| corners[0] * (1.0 - u) + corners[1] * u)
}

/// The shell between two spheres about `center`: an O-grid, its seam and poles coincident points that
/// assembling merges. `counts` are hexahedra in longitude, latitude and radius.
pub fn sphere_shell(counts: [usize; 3], split: Split, center: DVec3, radii: [f64; 2]) -> Parts {
    grid(counts, split, |u| {
        // The seam and the poles are made exact, so that their points coincide bit for bit.
        let longitude = if u.x == 1.0 { 0.0 } else { u.x * std::f64::consts::TAU };
        let latitude = (u.y - 0.5) * std::f64::consts::PI;
        let ring = if u.y == 0.0 || u.y == 1.0 { 0.0 } else { latitude.cos() };
        let radius = radii[0] * (1.0 - u.z) + radii[1] * u.z;
        center + DVec3::new(ring * longitude.cos(), ring * longitude.sin(), latitude.sin()) * radius
    })
}

#[cfg(test)]
mod tests;
