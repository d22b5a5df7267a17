//! The pieces of unstructured grids: points and cells of any type.

use super::array::{integers, label};
use super::document::{Document, Piece, Section};
use super::{fields, listed_points, missing, polyhedra};
use crate::source::Source;
use crate::{IngestError, MixedCells, MixedMesh, Place};

/// Reads a piece; its first cell has the number `first_cell` in messages.
pub(super) fn read(
    source: &Source,
    document: &Document,
    piece: &Piece,
    first_cell: usize,
) -> Result<MixedMesh, IngestError> {
    if piece.points > u64::from(u32::MAX) {
        let remedy = "32 bits must name every point: split the data set";
        return Err(source.malformed(Place::Byte(piece.at), "the number of points", piece.points, remedy));
    }
    Ok(MixedMesh {
        path: source.path.clone(),
        points: listed_points(source, document, piece, piece.points)?,
        cells: cells(source, document, piece, first_cell)?,
        fields: fields(source, document, piece, piece.points, piece.cells)?,
        ..MixedMesh::default()
    })
}

fn cells(source: &Source, document: &Document, piece: &Piece, first_cell: usize) -> Result<MixedCells, IngestError> {
    let mut cells = MixedCells::default();
    if piece.cells == 0 {
        return Ok(cells);
    }
    let array = |name: &str| {
        let found = piece.array(Section::Cells, name);
        found.ok_or_else(|| missing(source, piece, &format!("<Cells> has no array \"{name}\"")))
    };
    let (types, offsets, connectivity) = (array("types")?, array("offsets")?, array("connectivity")?);

    for (c, t) in integers(source, document, types, Some(piece.cells))?.into_iter().enumerate() {
        let remedy = "cell types lie between 0 and 255";
        let t = u8::try_from(t)
            .map_err(|_| source.malformed(Place::Cell(first_cell + c), "the type of the cell", t, remedy))?;
        cells.types.push(t);
    }
    let mut last = 0;
    for (c, end) in integers(source, document, offsets, Some(piece.cells))?.into_iter().enumerate() {
        let place = Place::Cell(first_cell + c);
        let remedy = format!("offsets must not decrease (the last was {last})");
        let offset = usize::try_from(end).ok().filter(|&end| end >= last);
        last = offset.ok_or_else(|| source.malformed(place, "the offset of the cell", end, remedy))?;
        cells.offsets.push(last);
    }
    let indices = integers(source, document, connectivity, Some(last as u64))?;
    cells.connectivity.reserve_exact(indices.len());
    for (i, index) in indices.into_iter().enumerate() {
        let Some(index) = point(index, piece) else {
            let cell = cells.offsets.partition_point(|&end| end <= i);
            let what = format!("a point index of {} out of range", label(connectivity));
            let place = Place::Cell(first_cell + cell);
            return Err(source.malformed(place, what, index, range(piece)));
        };
        cells.connectivity.push(index);
    }
    polyhedra::read(source, document, piece, first_cell, &mut cells)?;
    Ok(cells)
}

/// An index as a point of the piece, if it is one.
pub(super) fn point(index: i64, piece: &Piece) -> Option<u32> {
    u32::try_from(index).ok().filter(|&v| u64::from(v) < piece.points)
}

/// What indices of points are allowed.
pub(super) fn range(piece: &Piece) -> String {
    format!("indices must lie between 0 and {}", piece.points.saturating_sub(1))
}
