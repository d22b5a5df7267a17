//! VTK XML unstructured grids (VTK User's Guide, "VTK file formats"; vtkXMLDataParser for the encodings).

mod array;
mod base64;
mod document;

use glam::DVec3;
use tetlux_mesh::{Field, Location};

use crate::source::Source;
use crate::{IngestError, MixedCells, MixedMesh, Place};
use array::{floats, integers};
use document::{DataArray, Document, Piece, Section};

const BYTE_ORDER_MARK: &[u8] = b"\xef\xbb\xbf";

/// Whether these bytes begin as an XML file of VTK's, or any XML, does.
pub(crate) fn recognizes(bytes: &[u8]) -> bool {
    let text = bytes.strip_prefix(BYTE_ORDER_MARK).unwrap_or(bytes).trim_ascii_start();
    text.starts_with(b"<?xml") || text.starts_with(b"<VTKFile") || text.starts_with(b"<!--")
}

/// Reads all pieces of a file into one mesh.
pub(crate) fn read(mut source: Source) -> Result<MixedMesh, IngestError> {
    if source.bytes.starts_with(BYTE_ORDER_MARK) {
        source.bytes.drain(..BYTE_ORDER_MARK.len());
    }
    let document = Document::parse(&source)?;
    let mut mesh = MixedMesh { path: source.path.clone(), ..MixedMesh::default() };
    let pieces = document.pieces.iter().filter(|piece| piece.points > 0 || piece.cells > 0);
    for (p, piece) in pieces.enumerate() {
        let offset = mesh.points.len();
        if offset as u64 + piece.points > u64::from(u32::MAX) {
            let remedy = "32 bits must name every point: split the data set";
            return Err(source.malformed(Place::Byte(piece.at), "the number of points", piece.points, remedy));
        }
        read_points(&mut mesh, &source, &document, piece)?;
        read_cells(&mut mesh, &source, &document, piece, offset as u32)?;
        read_fields(&mut mesh, &source, &document, piece, p == 0)?;
    }
    Ok(mesh)
}

fn read_points(mesh: &mut MixedMesh, source: &Source, document: &Document, piece: &Piece) -> Result<(), IngestError> {
    let Some(array) = piece.arrays.iter().find(|a| a.section == Section::Points) else {
        return Err(missing(source, piece, "<Points> has no <DataArray>"));
    };
    if array.components != 3 {
        let place = Place::Byte(array.at);
        return Err(source.malformed(place, "components of the points", array.components, "points need three"));
    }
    let values = floats(source, document, array, count(source, array, piece.points)?)?;
    mesh.points.extend(values.as_chunks().0.iter().map(|&p: &[f64; 3]| DVec3::from(p)));
    Ok(())
}

fn read_cells(
    mesh: &mut MixedMesh,
    source: &Source,
    document: &Document,
    piece: &Piece,
    first_point: u32,
) -> Result<(), IngestError> {
    if piece.cells == 0 {
        return Ok(());
    }
    let array = |name: &str| {
        let found = piece.arrays.iter().find(|a| a.section == Section::Cells && a.name.as_deref() == Some(name));
        found.ok_or_else(|| missing(source, piece, &format!("<Cells> has no array \"{name}\"")))
    };
    let (types, offsets, connectivity) = (array("types")?, array("offsets")?, array("connectivity")?);
    let MixedCells { types: all_types, connectivity: all_indices, offsets: all_offsets } = &mut mesh.cells;
    let first_cell = all_types.len();
    let first_index = all_indices.len();

    for (c, t) in integers(source, document, types, piece.cells)?.into_iter().enumerate() {
        let remedy = "cell types lie between 0 and 255";
        let t = u8::try_from(t)
            .map_err(|_| source.malformed(Place::Cell(first_cell + c), "the type of the cell", t, remedy))?;
        all_types.push(t);
    }
    let mut last = 0;
    for (c, end) in integers(source, document, offsets, piece.cells)?.into_iter().enumerate() {
        let place = Place::Cell(first_cell + c);
        let remedy = format!("offsets must not decrease (the last was {last})");
        let offset = usize::try_from(end).ok().filter(|&end| end >= last);
        last = offset.ok_or_else(|| source.malformed(place, "the offset of the cell", end, remedy))?;
        let end = first_index.checked_add(last);
        all_offsets
            .push(end.ok_or_else(|| source.malformed(place, "the offset of the cell", last, "it is too large"))?);
    }
    let indices = integers(source, document, connectivity, last as u64)?;
    all_indices.reserve(indices.len());
    for (i, index) in indices.into_iter().enumerate() {
        let Some(index) = u32::try_from(index).ok().filter(|&v| u64::from(v) < piece.points) else {
            let cell = all_offsets[first_cell..].partition_point(|&end| end <= first_index + i);
            let remedy = format!("indices must lie between 0 and {}", piece.points.saturating_sub(1));
            let place = Place::Cell(first_cell + cell);
            return Err(source.malformed(place, "a point index out of range", index, remedy));
        };
        all_indices.push(first_point + index);
    }
    Ok(())
}

/// Appends a piece's fields; one that is not in every piece is left out, with a note, as VTK does.
fn read_fields(
    mesh: &mut MixedMesh,
    source: &Source,
    document: &Document,
    piece: &Piece,
    first: bool,
) -> Result<(), IngestError> {
    let mut fields: Vec<Field> = Vec::new();
    for (i, array) in piece.arrays.iter().enumerate() {
        let (location, tuples) = match array.section {
            Section::PointData => (Location::Point, piece.points),
            Section::CellData => (Location::Cell, piece.cells),
            Section::Points | Section::Cells => continue,
        };
        let name = array.name.clone().unwrap_or_else(|| format!("array {i}"));
        let values = floats(source, document, array, count(source, array, tuples)?)?;
        fields.push(Field { name, location, components: array.components, values });
    }
    if first {
        mesh.fields = fields;
        return Ok(());
    }
    let same = |a: &Field, b: &Field| a.name == b.name && a.location == b.location && a.components == b.components;
    let mut kept = Vec::new();
    let mut alone = Vec::new();
    for mut field in std::mem::take(&mut mesh.fields) {
        match fields.iter().position(|f| same(f, &field)) {
            Some(i) => {
                field.values.append(&mut fields.swap_remove(i).values);
                kept.push(field);
            }
            None => alone.push(field.name),
        }
    }
    alone.extend(fields.into_iter().map(|f| f.name));
    mesh.notes.extend(alone.iter().map(|name| format!("field \"{name}\" is not in every piece: it is left out")));
    mesh.fields = kept;
    Ok(())
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
