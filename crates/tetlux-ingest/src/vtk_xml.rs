//! VTK XML: grids in one file, in pieces of their own files, and collections of them (VTK User's Guide, "VTK file
//! formats"; vtkXMLDataParser for the encodings; vtkXMLUnstructuredGridReader for polyhedra).

mod array;
mod base64;
mod collection;
mod compress;
mod document;
mod ghosts;
mod join;
mod lattice;
mod polyhedra;
mod tag;
mod unstructured;

use tetlux_mesh::{Field, Location};

use crate::source::{Files, Source};
use crate::{IngestError, MixedMesh, Place};
use array::floats;
use collection::{Contents, Reader};
use document::{DataArray, Document, Piece, Section};

const BYTE_ORDER_MARK: &[u8] = b"\xef\xbb\xbf";

/// Whether these bytes begin as an XML file of VTK's, or any XML, does.
pub(crate) fn recognizes(bytes: &[u8]) -> bool {
    let text = bytes.strip_prefix(BYTE_ORDER_MARK).unwrap_or(bytes).trim_ascii_start();
    text.starts_with(b"<?xml") || text.starts_with(b"<VTKFile") || text.starts_with(b"<!--")
}

/// Reads all pieces of a file, and of those it lists, into one mesh; of several time steps the one asked for, counted
/// from 0, or the last.
pub(crate) fn read(source: Source, time: Option<usize>, files: &mut Files) -> Result<MixedMesh, IngestError> {
    let path = source.path.clone();
    match Reader::new(&path, time, files).contents(source, 0)? {
        Contents::Parts(parts) => Ok(join::join(path, parts)),
        Contents::Flat(why) => Err(why),
    }
}

/// A piece's fields.
fn fields(
    source: &Source,
    document: &Document,
    piece: &Piece,
    points: u64,
    cells: u64,
) -> Result<Vec<Field>, IngestError> {
    let mut fields = Vec::new();
    for (i, array) in piece.arrays.iter().enumerate() {
        let (location, tuples) = match array.section {
            Section::PointData => (Location::Point, points),
            Section::CellData => (Location::Cell, cells),
            Section::Points | Section::Cells | Section::Coordinates => continue,
        };
        let name = array.name.clone().unwrap_or_else(|| format!("array {i}"));
        let values = floats(source, document, array, count(source, array, tuples)?)?;
        fields.push(Field { name, location, components: array.components, values });
    }
    Ok(fields)
}

/// The coordinates of the points that a piece lists.
fn listed_points(
    source: &Source,
    document: &Document,
    piece: &Piece,
    points: u64,
) -> Result<Vec<glam::DVec3>, IngestError> {
    let Some(array) = piece.arrays.iter().find(|a| a.section == Section::Points) else {
        return Err(missing(source, piece, "<Points> has no <DataArray>"));
    };
    if array.components != 3 {
        let place = Place::Byte(array.at);
        return Err(source.malformed(place, "components of the points", array.components, "points need three"));
    }
    let values = floats(source, document, array, count(source, array, points)?)?;
    Ok(values.as_chunks().0.iter().map(|&p: &[f64; 3]| p.into()).collect())
}

/// Number of values an array must have.
fn count(source: &Source, array: &DataArray, tuples: u64) -> Result<u64, IngestError> {
    tuples.checked_mul(array.components as u64).ok_or_else(|| {
        let remedy = format!("{tuples} tuples of them are too many");
        source.malformed(Place::Byte(array.at), "NumberOfComponents", array.components, remedy)
    })
}

fn missing(source: &Source, piece: &Piece, what: &str) -> IngestError {
    source.malformed(Place::Byte(piece.at), what, "nothing", "write the file again with all its arrays")
}
