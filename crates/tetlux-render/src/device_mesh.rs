//! The mesh as devices have it: scaled, single precision, vertices in ascending order.

use glam::{DVec3, Vec3};
use rayon::prelude::*;
use tetlux_mesh::{Location, ScalarField, TetMesh};
use tetlux_optics::no_data_f32::NO_DATA;
use tetlux_optics::transfer_f32::normalise;

/// In the first of a cell's [`ascending`] vertices: in that order they are negatively oriented.
pub(crate) const NEGATIVE: u32 = 1 << 31;

/// In the place of a cell's scalar: those of its points.
const OF_POINTS: f32 = -1.0;

/// Where the scalars of cells are.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) enum Data {
    /// All at the points.
    Point,
    /// All in the cells.
    Cell,
    /// At the points, but for cells without data.
    Mixed,
}

impl Data {
    /// Where those of a scalar are; cells that miss values of the scalars `without` are seen.
    pub(crate) fn of(scalar: &ScalarField, without: &[&ScalarField]) -> Data {
        match (scalar.location, without.is_empty()) {
            (Location::Point, true) => Data::Point,
            (Location::Point, false) => Data::Mixed,
            (Location::Cell, _) => Data::Cell,
        }
    }
}

/// A mesh's points and one of its scalars, in device units. Its cells devices take as [`ascending`] gives them.
#[derive(Debug, Clone)]
pub(crate) struct DeviceMesh {
    /// Device units per world unit: a power of two, so that scaling is exact.
    pub(crate) scale: f64,
    /// Positions relative to the mesh's origin, and the normalised scalar (0 for cell data).
    pub(crate) points: Vec<[f32; 4]>,
    /// The normalised scalar of each cell, or [`NO_DATA`], or [`OF_POINTS`]; empty if all have those of their points.
    pub(crate) cell_scalars: Vec<f32>,
    pub(crate) data: Data,
    /// Bounding box in device units.
    pub(crate) bounds: [DVec3; 2],
}

impl DeviceMesh {
    /// Scalars are mapped from the field's range to [0, 1]; missing ones become 0: the plan leaves their cells out, or they
    /// are seen as [`NO_DATA`] where one of the scalars `without` misses a value.
    pub(crate) fn new(mesh: &TetMesh, scalar: &ScalarField, without: &[&ScalarField]) -> DeviceMesh {
        let bounds = mesh.local_bounds();
        let scale = unit_scale((bounds[1] - bounds[0]).max_element());
        let data = Data::of(scalar, without);
        let at_points = data != Data::Cell;
        let point = |(i, p): (usize, &Vec3)| {
            let [x, y, z] = (p.as_dvec3() * scale).as_vec3().to_array();
            [x, y, z, if at_points { normalised(scalar, scalar.values[i]) as f32 } else { 0.0 }]
        };
        let points = mesh.points().par_iter().enumerate().map(point).collect();
        let cell_scalar = |cell: usize| match at_points {
            _ if without.iter().any(|scalar| is_missing(mesh, scalar, cell)) => NO_DATA,
            true => OF_POINTS,
            false => normalised(scalar, scalar.values[cell]) as f32,
        };
        let own = if data == Data::Point { 0 } else { mesh.cells().len() };
        let cell_scalars = (0..own).into_par_iter().map(cell_scalar).collect();
        DeviceMesh { scale, points, cell_scalars, data, bounds: bounds.map(|corner| corner * scale) }
    }

    /// The scalar that a cell has throughout; `None` if it has those of its points.
    pub(crate) fn own_scalar(&self, cell: u32) -> Option<f32> {
        self.cell_scalars.get(cell as usize).copied().filter(|&s| s != OF_POINTS)
    }
}

/// Whether a cell has no finite value of a scalar.
fn is_missing(mesh: &TetMesh, scalar: &ScalarField, cell: usize) -> bool {
    match scalar.location {
        Location::Point => mesh.cells()[cell].iter().any(|&v| !scalar.values[v as usize].is_finite()),
        Location::Cell => !scalar.values[cell].is_finite(),
    }
}

/// A value of a field mapped from its range to [0, 1]; 0 if it is missing.
pub(crate) fn normalised(scalar: &ScalarField, s: f64) -> f64 {
    if s.is_finite() { normalise(scalar.range, s).clamp(0.0, 1.0) } else { 0.0 }
}

/// The power of two that brings a width into [1, 2).
fn unit_scale(width: f64) -> f64 {
    if width > 0.0 { (-width.log2().floor()).exp2() } else { 1.0 }
}

/// The vertices of a positively oriented cell in ascending order, marked if that takes an odd permutation.
pub(crate) fn ascending(mut cell: [u32; 4]) -> [u32; 4] {
    let mut odd = false;
    for (i, j) in [(0, 1), (2, 3), (0, 2), (1, 3), (1, 2)] {
        if cell[i] > cell[j] {
            cell.swap(i, j);
            odd = !odd;
        }
    }
    // Assembled meshes have fewer than 2^30 points.
    cell[0] |= if odd { NEGATIVE } else { 0 };
    cell
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_permutation_is_sorted_with_its_parity() {
        for code in 0..256usize {
            let cell: [usize; 4] = std::array::from_fn(|i| (code >> (2 * i)) & 3);
            let inversions =
                (0..4).flat_map(|i| (0..i).map(move |j| (j, i))).filter(|&(j, i)| cell[j] > cell[i]).count();
            if (0..4).all(|v| cell.contains(&v)) {
                let sorted = ascending(cell.map(|v| v as u32 + 7));
                assert_eq!(sorted.map(|v| v & !NEGATIVE), [7, 8, 9, 10]);
                assert_eq!(sorted[0] & NEGATIVE != 0, inversions % 2 == 1, "{cell:?}");
            }
        }
    }

    #[test]
    fn scales_are_powers_of_two() {
        for width in [1e-12, 0.3, 1.0, 1.5, 1e12] {
            let scaled = width * unit_scale(width);
            assert!((1.0..2.0).contains(&scaled), "{width} becomes {scaled}");
            assert_eq!(unit_scale(width).log2().fract(), 0.0);
        }
    }
}
