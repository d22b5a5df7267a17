//! The faces of polyhedra, in the two layouts VTK has had.
//!
//! Until version 2.2 of the format: `faces` holds for each polyhedron the number of its faces and for each face the
//! number of its points and these; `faceoffsets` holds where each cell's end, -1 for cells of other types. From
//! version 2.3 on (VTK 9.4): `face_connectivity` and `face_offsets` list the points of all faces and where each face
//! ends, `polyhedron_to_faces` and `polyhedron_offsets` the faces of all cells and where each cell's end.

use super::array::integers;
use super::document::{DataArray, Document, Piece, Section};
use super::missing;
use super::unstructured::{point, range};
use crate::cell_type::POLYHEDRON;
use crate::source::Source;
use crate::{IngestError, MixedCells, Place};

/// Adds their faces to the polyhedra of a piece, if there are any.
pub(super) fn read(
    source: &Source,
    document: &Document,
    piece: &Piece,
    first_cell: usize,
    cells: &mut MixedCells,
) -> Result<(), IngestError> {
    if !cells.types.contains(&POLYHEDRON) {
        return Ok(());
    }
    let faces = Faces { source, document, piece, first_cell };
    match piece.array(Section::Cells, "faces") {
        Some(stream) => faces.stream(stream, cells),
        None if piece.array(Section::Cells, "polyhedron_to_faces").is_some() => faces.listed(cells),
        None => Err(missing(source, piece, "<Cells> has polyhedra, but no array \"faces\" or \"polyhedron_to_faces\"")),
    }
}

struct Faces<'a> {
    source: &'a Source,
    document: &'a Document<'a>,
    piece: &'a Piece<'a>,
    first_cell: usize,
}

impl Faces<'_> {
    /// The layout until version 2.2.
    fn stream(&self, faces: &DataArray, cells: &mut MixedCells) -> Result<(), IngestError> {
        let ends = integers(self.source, self.document, self.array("faceoffsets")?, Some(self.piece.cells))?;
        let stream = integers(self.source, self.document, faces, None)?;
        let mut start = 0;
        for (c, &kind) in cells.types.iter().enumerate() {
            if kind != POLYHEDRON {
                cells.face_offsets.push(MixedCells::NO_FACES);
                continue;
            }
            let own = usize::try_from(ends[c]).ok().and_then(|end| stream.get(start..end));
            let own = own.ok_or_else(|| {
                let remedy =
                    format!("it must lie between {start}, the last, and {}, the length of \"faces\"", stream.len());
                self.malformed(c, "the polyhedron's number in \"faceoffsets\"", ends[c], &remedy)
            })?;
            cells.face_offsets.push(cells.face_stream.len());
            self.copy(c, own, &mut cells.face_stream)?;
            start += own.len();
        }
        Ok(())
    }

    /// Copies one polyhedron's faces from the file's stream.
    fn copy(&self, c: usize, own: &[i64], to: &mut Vec<u32>) -> Result<(), IngestError> {
        let cut = || {
            let remedy = "it must be the number of faces, and for each that of its points, and these";
            self.malformed(c, "the polyhedron's part of \"faces\"", format!("{} numbers", own.len()), remedy)
        };
        let number = |rest: &[i64]| rest.first().and_then(|&n| u32::try_from(n).ok()).ok_or_else(cut);
        let count = number(own)?;
        to.push(count);
        let mut rest = &own[1..];
        for _ in 0..count {
            let length = number(rest)?;
            let (face, after) = rest[1..].split_at_checked(length as usize).ok_or_else(cut)?;
            to.push(length);
            self.points(c, face, to)?;
            rest = after;
        }
        if rest.is_empty() { Ok(()) } else { Err(cut()) }
    }

    /// The layout from version 2.3 on.
    fn listed(&self, cells: &mut MixedCells) -> Result<(), IngestError> {
        let all = |name, expected| integers(self.source, self.document, self.array(name)?, expected);
        let face_ends = all("face_offsets", None)?;
        let points = all("face_connectivity", None)?;
        let cell_ends = all("polyhedron_offsets", Some(self.piece.cells))?;
        let ids = all("polyhedron_to_faces", None)?;
        // Two cells share a face at most, so the stream cannot be longer.
        let most = cells.types.len() + ids.len() + 2 * points.len();
        for (c, &kind) in cells.types.iter().enumerate() {
            if kind != POLYHEDRON {
                cells.face_offsets.push(MixedCells::NO_FACES);
                continue;
            }
            let own = between(&ids, &cell_ends, c).ok_or_else(|| {
                let remedy = "it must not decrease, nor pass the length of \"polyhedron_to_faces\"";
                self.malformed(c, "the polyhedron's number in \"polyhedron_offsets\"", cell_ends[c], remedy)
            })?;
            let stream = &mut cells.face_stream;
            cells.face_offsets.push(stream.len());
            // Not more than there are indices in memory; a count beyond 32 bits makes a stream that fails its check.
            stream.push(u32::try_from(own.len()).unwrap_or(u32::MAX));
            for &id in own {
                let face = usize::try_from(id).ok().filter(|&f| f < face_ends.len());
                let face = face.and_then(|f| between(&points, &face_ends, f)).ok_or_else(|| {
                    let remedy =
                        format!("it must be one of the {} of \"face_offsets\", within bounds", face_ends.len());
                    self.malformed(c, "a face of the polyhedron", id, &remedy)
                })?;
                if stream.len() + 1 + face.len() > most {
                    let remedy = "two cells share a face at most: write the file again";
                    return Err(self.malformed(c, "faces that more than two polyhedra have, among them", id, remedy));
                }
                stream.push(u32::try_from(face.len()).unwrap_or(u32::MAX));
                self.points(c, face, stream)?;
            }
        }
        Ok(())
    }

    /// Copies a face's points.
    fn points(&self, c: usize, face: &[i64], to: &mut Vec<u32>) -> Result<(), IngestError> {
        for &index in face {
            let index = point(index, self.piece)
                .ok_or_else(|| self.malformed(c, "a point index of a face out of range", index, &range(self.piece)))?;
            to.push(index);
        }
        Ok(())
    }

    fn array(&self, name: &str) -> Result<&DataArray<'_>, IngestError> {
        let found = self.piece.array(Section::Cells, name);
        found
            .ok_or_else(|| missing(self.source, self.piece, &format!("<Cells> has polyhedra, but no array \"{name}\"")))
    }

    fn malformed(&self, c: usize, what: &str, found: impl ToString, remedy: &str) -> IngestError {
        self.source.malformed(Place::Cell(self.first_cell + c), what, found, remedy)
    }
}

/// The values of the n-th of several lists, of which `ends` tells where each ends.
fn between<'a>(values: &'a [i64], ends: &[i64], n: usize) -> Option<&'a [i64]> {
    let start = match n {
        0 => 0,
        _ => usize::try_from(*ends.get(n - 1)?).ok()?,
    };
    values.get(start..usize::try_from(*ends.get(n)?).ok()?)
}
