//! The cells of an unstructured grid.

use std::collections::HashSet;

use super::Reader;
use super::array::{Encoding, Kind, integers};
use crate::number::Number;
use crate::{IngestError, MixedCells, Place, cell_type};

/// Indices of all cells, as the file has them: a polyhedron's are its faces.
pub(super) struct Cells {
    indices: Vec<i64>,
    /// Start and end of each cell in `indices`.
    ranges: Vec<[usize; 2]>,
}

impl Cells {
    /// Reads what follows CELLS: each cell after its number of indices, or from version 5.0 on offsets and
    /// connectivity apart.
    pub(super) fn read(reader: &mut Reader) -> Result<Cells, IngestError> {
        let count: u64 = reader.words.number("the number of cells")?;
        let size: u64 = reader.words.number("the length of the list of cells")?;
        let word = reader.words.peek().unwrap_or_default();
        if word.eq_ignore_ascii_case(b"offsets") { apart(reader, count, size) } else { listed(reader, count, size) }
    }

    /// Joins indices and types.
    pub(super) fn assemble(self, reader: &Reader, types: Vec<i64>, points: usize) -> Result<MixedCells, IngestError> {
        let source = reader.words.source;
        if types.len() != self.ranges.len() {
            let (what, found) = (format!("the types of {} cells", self.ranges.len()), types.len());
            return Err(source.malformed(super::whole(), what, found, "CELLS and CELL_TYPES must have as many cells"));
        }
        let mut cells = MixedCells::default();
        let mut corners = Vec::new();
        for (c, (kind, [start, end])) in types.into_iter().zip(self.ranges).enumerate() {
            let place = Place::Cell(c);
            let Ok(kind) = u8::try_from(kind) else {
                let remedy = "cell types lie between 0 and 255";
                return Err(source.malformed(place, "the type of the cell", kind, remedy));
            };
            let indices = &self.indices[start..end];
            let point = |&index: &i64| {
                let inside = u32::try_from(index).ok().filter(|&v| (v as usize) < points);
                inside.ok_or_else(|| {
                    let remedy = format!("indices must lie between 0 and {}", points.saturating_sub(1));
                    source.malformed(place, "a point index out of range", index, remedy)
                })
            };
            corners.clear();
            if kind != cell_type::POLYHEDRON {
                for index in indices {
                    corners.push(point(index)?);
                }
                cells.push(kind, &corners);
                continue;
            }
            let Some(faces) = faces(indices) else {
                let remedy = "a polyhedron is the number of its faces, then for each that of its points and these";
                return Err(source.malformed(place, "the faces of a polyhedron", format!("{indices:?}"), remedy));
            };
            let faces: Vec<Vec<u32>> =
                faces.into_iter().map(|face| face.iter().map(point).collect()).collect::<Result<_, _>>()?;
            let mut seen = HashSet::new();
            corners.extend(faces.iter().flatten().filter(|&&v| seen.insert(v)));
            let faces: Vec<&[u32]> = faces.iter().map(Vec::as_slice).collect();
            cells.push_polyhedron(&corners, &faces);
        }
        Ok(cells)
    }
}

/// The faces of a polyhedron, if they take up all its indices and have three points or more each.
fn faces(indices: &[i64]) -> Option<Vec<&[i64]>> {
    let (&count, mut rest) = indices.split_first()?;
    let mut faces = Vec::new();
    while let Some((&length, after)) = rest.split_first() {
        let (face, after) = after.split_at_checked(usize::try_from(length).ok().filter(|&n| n >= 3)?)?;
        faces.push(face);
        rest = after;
    }
    (faces.len() as i64 == count).then_some(faces)
}

fn listed(reader: &mut Reader, count: u64, size: u64) -> Result<Cells, IngestError> {
    let indices = integers(&mut reader.words, reader.encoding, Kind::Of(Number::Int32), "the cells", size)?;
    // Each cell takes a number at least, its length.
    let mut ranges = Vec::with_capacity(count.min(size) as usize);
    let mut at = 0;
    while at < indices.len() {
        let end = usize::try_from(indices[at]).ok().and_then(|n| (at + 1).checked_add(n));
        let Some(end) = end.filter(|&end| end <= indices.len()) else {
            let what =
                format!("the number of points of a cell, {} indices before the end of CELLS", indices.len() - at);
            let remedy = "it must not pass the end";
            return Err(reader.words.source.malformed(Place::Cell(ranges.len()), what, indices[at], remedy));
        };
        ranges.push([at + 1, end]);
        at = end;
    }
    if ranges.len() as u64 != count {
        let what = format!("the cells in {size} numbers, {count} by their heading");
        return Err(reader.words.malformed(what, ranges.len(), "the heading of CELLS must fit what follows it"));
    }
    Ok(Cells { indices, ranges })
}

fn apart(reader: &mut Reader, count: u64, size: u64) -> Result<Cells, IngestError> {
    let offsets = part(reader, "offsets", count)?;
    let indices = part(reader, "connectivity", size)?;
    let mut ranges = Vec::with_capacity(offsets.len());
    for (c, pair) in offsets.windows(2).enumerate() {
        let ends = [usize::try_from(pair[0]), usize::try_from(pair[1])];
        let [Ok(start), Ok(end)] = ends else { return Err(bad_offset(reader, c, pair, size)) };
        if start > end || end > indices.len() || (c == 0 && start != 0) {
            return Err(bad_offset(reader, c, pair, size));
        }
        ranges.push([start, end]);
    }
    Ok(Cells { indices, ranges })
}

fn bad_offset(reader: &Reader, cell: usize, pair: &[i64], size: u64) -> IngestError {
    let found = format!("{} to {}", pair[0], pair[1]);
    let remedy = format!("offsets begin with 0, must not decrease, and {size} is the largest");
    reader.words.source.malformed(Place::Cell(cell), "the offsets of the cell", found, remedy)
}

fn part(reader: &mut Reader, name: &str, count: u64) -> Result<Vec<i64>, IngestError> {
    loop {
        match reader.keyword().as_deref() {
            Some("metadata") => super::attributes::skip_metadata(&mut reader.words),
            Some(keyword) if keyword == name => break,
            Some(other) => return Err(reader.unknown(other)),
            None => return Err(reader.words.cut(name)),
        }
    }
    let kind = Kind::read(&mut reader.words)?;
    integers(&mut reader.words, reader.encoding, kind, name, count)
}

/// Reads what follows CELL_TYPES.
pub(super) fn types(reader: &mut Reader) -> Result<Vec<i64>, IngestError> {
    let count = reader.words.number("the number of cell types")?;
    integers(&mut reader.words, reader.encoding, Kind::Of(Number::Int32), "the types of the cells", count)
}

impl Reader<'_> {
    /// Whether arrays are words.
    pub(super) fn is_ascii(&self) -> bool {
        self.encoding == Encoding::Ascii
    }
}
