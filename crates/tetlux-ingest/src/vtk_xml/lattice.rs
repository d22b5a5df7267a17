//! Structured, rectilinear and image grids: pieces of a lattice, i fastest.

use glam::{DMat3, DVec3};
use tetlux_mesh::Location;

use super::array::floats;
use super::document::{Document, Kind, Piece, Section};
use super::{fields, listed_points, missing};
use crate::source::Source;
use crate::{IngestError, MixedMesh, Place, StructuredGrid};

/// A lattice of which no array tells that it is so large has no more points: else a few bytes could fill any memory.
const MOST_UNTOLD: u64 = 1 << 16;

/// The points of a lattice from one index to another, both included.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Extent {
    low: [i32; 3],
    high: [i32; 3],
}

/// Where the points of a lattice are.
#[derive(Debug, Clone, Copy)]
pub(super) struct Lattice {
    pub(super) whole: Option<Extent>,
    /// Place of the point of index 0, 0, 0, of images.
    pub(super) origin: [f64; 3],
    /// Distance of points along i, j and k, of images.
    pub(super) spacing: [f64; 3],
    /// The matrix whose columns are the directions of i, j and k, row by row, of images.
    pub(super) direction: [f64; 9],
}

impl Default for Lattice {
    fn default() -> Self {
        let direction = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];
        Lattice { whole: None, origin: [0.0; 3], spacing: [1.0; 3], direction }
    }
}

impl Extent {
    /// From first and last index of i, j and k.
    pub(super) fn new([i0, i1, j0, j1, k0, k1]: [i32; 6]) -> Extent {
        Extent { low: [i0, j0, k0], high: [i1, j1, k1] }
    }

    /// Points along each axis.
    pub(super) fn counts(&self) -> [u64; 3] {
        [0, 1, 2].map(|axis| (i64::from(self.high[axis]) - i64::from(self.low[axis]) + 1).max(0) as u64)
    }

    /// Number of points, if it can be counted.
    pub(super) fn points(&self) -> Option<u64> {
        let [ni, nj, nk] = self.counts();
        ni.checked_mul(nj)?.checked_mul(nk)
    }

    /// Number of cells, of whatever dimension: along an axis of one point there is one.
    pub(super) fn cells(&self) -> Option<u64> {
        let counts = self.counts();
        let [ni, nj, nk] = counts.map(|n| n.saturating_sub(1).max(1));
        if counts.contains(&0) { Some(0) } else { ni.checked_mul(nj)?.checked_mul(nk) }
    }

    /// The smallest that holds both.
    pub(super) fn with(&self, other: &Extent) -> Extent {
        let [low, high] = [self.low, self.high];
        Extent {
            low: [0, 1, 2].map(|axis| low[axis].min(other.low[axis])),
            high: [0, 1, 2].map(|axis| high[axis].max(other.high[axis])),
        }
    }

    /// Where in this extent each row of points along i of another within it begins, and in the other: calls `f` with
    /// both and the row's length. `less` is 1 for cells, which are one fewer along each axis than points.
    pub(super) fn for_each_row(&self, inner: &Extent, less: u64, mut f: impl FnMut(usize, usize, usize)) {
        let [wide, own] = [self, inner].map(|e| e.counts().map(|n| n.saturating_sub(less) as usize));
        let first = [0, 1, 2].map(|axis| (i64::from(inner.low[axis]) - i64::from(self.low[axis])) as usize);
        for k in 0..own[2] {
            for j in 0..own[1] {
                let to = ((first[2] + k) * wide[1] + first[1] + j) * wide[0] + first[0];
                f(to, (k * own[1] + j) * own[0], own[0]);
            }
        }
    }
}

/// Reads a piece, and its extent if it has volume.
pub(super) fn read(
    source: &Source,
    document: &Document,
    piece: &Piece,
) -> Result<(MixedMesh, Option<Extent>), IngestError> {
    let Some(extent) = piece.extent.or(document.lattice.whole) else {
        return Err(missing(source, piece, "the piece has no Extent"));
    };
    let mut mesh = MixedMesh { path: source.path.clone(), ..MixedMesh::default() };
    let sizes = extent.points().filter(|&n| n <= u64::from(u32::MAX)).zip(extent.cells());
    let Some((points, cells)) = sizes else {
        let found = format!("{:?} points", extent.counts());
        let remedy = "32 bits must name every point: split the data set";
        return Err(source.malformed(Place::Byte(piece.at), "the extent of the piece", found, remedy));
    };
    if points == 0 {
        return Ok((mesh, None));
    }
    mesh.fields = fields(source, document, piece, points, cells)?;
    if document.kind != Kind::Structured && mesh.fields.is_empty() && points > MOST_UNTOLD {
        let what = format!("a piece of {points} points, but no array with a value for each");
        return Err(source.malformed(Place::Byte(piece.at), what, "none", "write the file with point or cell data"));
    }
    mesh.points = match document.kind {
        Kind::Structured => listed_points(source, document, piece, points)?,
        Kind::Rectilinear => {
            let [x, y, z] = axes(source, document, piece, &extent)?;
            positions(source, piece, &extent, |[i, j, k]| DVec3::new(x[i], y[j], z[k]))?
        }
        _ => {
            let Lattice { origin, spacing, direction, .. } = document.lattice;
            let turn = DMat3::from_cols_array(&direction).transpose();
            positions(source, piece, &extent, |ijk| {
                let index = [0, 1, 2].map(|axis| f64::from(extent.low[axis]) + ijk[axis] as f64);
                DVec3::from(origin) + turn * (DVec3::from(spacing) * DVec3::from(index))
            })?
        }
    };
    let counts = extent.counts().map(|n| n as usize);
    if counts.contains(&1) {
        let [ni, nj, nk] = counts;
        mesh.notes.push(format!("a grid of {ni} x {nj} x {nk} points has no volume: its cells are left out"));
        mesh.fields.retain(|field| field.location == Location::Point);
        return Ok((mesh, None));
    }
    mesh.grids.push(StructuredGrid { first_point: 0, counts, blanked: None });
    Ok((mesh, Some(extent)))
}

/// The coordinates along x, y and z.
fn axes(source: &Source, document: &Document, piece: &Piece, extent: &Extent) -> Result<[Vec<f64>; 3], IngestError> {
    let mut arrays = piece.arrays.iter().filter(|a| a.section == Section::Coordinates);
    let mut axis = |n: u64| match arrays.next() {
        Some(array) if array.components == 1 => floats(source, document, array, n),
        Some(array) => {
            let place = Place::Byte(array.at);
            Err(source.malformed(place, "components of the coordinates", array.components, "an axis needs one"))
        }
        None => Err(missing(source, piece, "<Coordinates> lacks an array: x, y and z need one each")),
    };
    let [ni, nj, nk] = extent.counts();
    Ok([axis(ni)?, axis(nj)?, axis(nk)?])
}

fn positions(
    source: &Source,
    piece: &Piece,
    extent: &Extent,
    place: impl Fn([usize; 3]) -> DVec3,
) -> Result<Vec<DVec3>, IngestError> {
    let [ni, nj, nk] = extent.counts().map(|n| n as usize);
    let mut points = Vec::new();
    if points.try_reserve_exact(ni * nj * nk).is_err() {
        let found = format!("{ni} x {nj} x {nk} points");
        let remedy = "free memory, or split the data set";
        return Err(source.malformed(Place::Byte(piece.at), "no memory for the piece", found, remedy));
    }
    for k in 0..nk {
        for j in 0..nj {
            points.extend((0..ni).map(|i| place([i, j, k])));
        }
    }
    Ok(points)
}
