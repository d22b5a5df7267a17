//! Point and cell data.

use std::str::from_utf8;

use tetlux_mesh::{Field, Location};

use super::Reader;
use super::array::Kind;
use crate::number::Number;
use crate::words::Words;
use crate::{IngestError, MixedMesh, StructuredGrid};

/// An array of a FIELD.
pub(super) struct Array {
    pub(super) name: String,
    components: u64,
    tuples: u64,
    /// `None` if it is text.
    values: Option<Vec<f64>>,
}

/// Reads all fields, from the number after POINT_DATA or CELL_DATA on.
pub(super) fn read(reader: &mut Reader, first: String, mesh: &mut MixedMesh) -> Result<(), IngestError> {
    let cells = mesh.cells.types.len() + mesh.grids.iter().map(StructuredGrid::hexahedra).sum::<usize>();
    let (mut location, mut tuples) = (Location::Point, mesh.points.len() as u64);
    let mut next = Some(first);
    while let Some(keyword) = next {
        let mut add = |array: Array| add(mesh, location, tuples, array);
        match keyword.as_str() {
            "point_data" | "cell_data" => {
                let point = keyword == "point_data";
                (location, tuples) = match point {
                    true => (Location::Point, mesh.points.len() as u64),
                    false => (Location::Cell, cells as u64),
                };
                let what = format!("the number of {}", location.plural());
                let found: u64 = reader.words.number(&what)?;
                if found != tuples {
                    let (what, remedy) = (keyword.to_ascii_uppercase(), format!("the mesh has {tuples}"));
                    return Err(reader.words.malformed(what, found, &remedy));
                }
            }
            "metadata" => skip_metadata(&mut reader.words),
            "lookup_table" => skip_table(reader)?,
            "field" => field(reader)?.into_iter().for_each(add),
            "scalars" => add(scalars(reader, tuples)?),
            "color_scalars" => add(colors(reader, tuples)?),
            "texture_coordinates" => {
                let name = name(reader)?;
                let components = reader.words.number("the components of the texture coordinates")?;
                add(array(reader, name, components, tuples)?);
            }
            other => {
                let components = match other {
                    "vectors" | "normals" => 3,
                    "tensors" => 9,
                    "tensors6" => 6,
                    "global_ids" | "pedigree_ids" | "edge_flags" => 1,
                    _ => return Err(reader.unknown(other)),
                };
                let name = name(reader)?;
                add(array(reader, name, components, tuples)?);
            }
        }
        next = reader.keyword();
    }
    Ok(())
}

/// Adds an array to the fields if it fits, or a note.
fn add(mesh: &mut MixedMesh, location: Location, tuples: u64, array: Array) {
    let name = array.name;
    let (Some(values), false) = (array.values, array.components == 0) else {
        mesh.notes.push(format!("field \"{name}\" holds no numbers: it is left out"));
        return;
    };
    if array.tuples != tuples {
        let (found, location) = (array.tuples, location.plural());
        mesh.notes.push(format!("field \"{name}\" has {found} tuples for {tuples} {location}: it is left out"));
        return;
    }
    // The values were there, so their number fits.
    let field = Field { name, location, components: array.components as usize, values };
    if let Some(i) = mesh.fields.iter().position(|f| f.name == field.name && f.location == location) {
        mesh.notes.push(format!("field \"{}\" is there twice: the last one counts", field.name));
        mesh.fields.remove(i);
    }
    mesh.fields.push(field);
}

/// Reads the name of an array, in which VTK writes blanks and the like as `%` and two hexadecimal digits.
fn name(reader: &mut Reader) -> Result<String, IngestError> {
    reader.words.expect("the name of an array").map(decode)
}

fn decode(mut encoded: &[u8]) -> String {
    let mut bytes = Vec::with_capacity(encoded.len());
    while let Some((&byte, rest)) = encoded.split_first() {
        let escaped = (byte == b'%').then(|| rest.split_first_chunk::<2>()).flatten().and_then(|(digits, rest)| {
            let digits = digits.iter().all(u8::is_ascii_hexdigit).then_some(digits)?;
            Some((u8::from_str_radix(from_utf8(digits).ok()?, 16).ok()?, rest))
        });
        let (byte, rest) = escaped.unwrap_or((byte, rest));
        bytes.push(byte);
        encoded = rest;
    }
    String::from_utf8_lossy(&bytes).into_owned()
}

/// Reads type and values of an array.
fn array(reader: &mut Reader, name: String, components: u64, tuples: u64) -> Result<Array, IngestError> {
    let kind = Kind::read(&mut reader.words)?;
    values(reader, name, kind, components, tuples)
}

fn values(reader: &mut Reader, name: String, kind: Kind, components: u64, tuples: u64) -> Result<Array, IngestError> {
    let what = format!("array \"{}\"", crate::source::excerpt(&name));
    let values = reader.floats(kind, &what, components.saturating_mul(tuples))?;
    Ok(Array { name, components, tuples, values })
}

/// Reads what follows SCALARS: name, type, perhaps the number of components; the name of a table of colours; values.
fn scalars(reader: &mut Reader, tuples: u64) -> Result<Array, IngestError> {
    let name = name(reader)?;
    let kind = Kind::read(&mut reader.words)?;
    let rest = reader.words.clone().line().unwrap_or_default().trim_ascii();
    let components = if rest.is_empty() { 1 } else { reader.words.number("the components of the scalars")? };
    if reader.words.peek().is_some_and(|word| word.eq_ignore_ascii_case(b"lookup_table")) {
        reader.words.word();
        reader.words.expect("the name of the lookup table")?;
    }
    values(reader, name, kind, components, tuples)
}

/// Reads what follows COLOR_SCALARS: bytes, written in words as fractions of 255.
fn colors(reader: &mut Reader, tuples: u64) -> Result<Array, IngestError> {
    let name = name(reader)?;
    let components = reader.words.number("the components of the colours")?;
    let mut array = values(reader, name, Kind::Of(Number::UInt8), components, tuples)?;
    if reader.is_ascii() {
        array.values.iter_mut().flatten().for_each(|v| *v = (*v * 255.0).round());
    }
    Ok(array)
}

/// Passes over a table of colours: red, green, blue and opacity of each entry.
fn skip_table(reader: &mut Reader) -> Result<(), IngestError> {
    name(reader)?;
    let entries: u64 = reader.words.number("the length of the lookup table")?;
    reader.floats(Kind::Of(Number::UInt8), "a lookup table", entries.saturating_mul(4)).map(drop)
}

/// Reads what follows FIELD: a name, the number of arrays, and these.
pub(super) fn field(reader: &mut Reader) -> Result<Vec<Array>, IngestError> {
    reader.words.expect("the name of the field data")?;
    let count: u64 = reader.words.number("the number of arrays")?;
    let mut arrays = Vec::new();
    for _ in 0..count {
        while reader.words.peek().is_some_and(|word| word.eq_ignore_ascii_case(b"metadata")) {
            reader.words.word();
            skip_metadata(&mut reader.words);
        }
        let name = name(reader)?;
        if name.eq_ignore_ascii_case("null_array") {
            continue;
        }
        let components = reader.words.number("the number of components")?;
        let tuples = reader.words.number("the number of tuples")?;
        arrays.push(array(reader, name, components, tuples)?);
    }
    Ok(arrays)
}

/// Passes over what follows METADATA, up to an empty line.
pub(super) fn skip_metadata(words: &mut Words) {
    words.line();
    while words.line().is_some_and(|line| !line.trim_ascii().is_empty()) {}
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn escapes_in_names_are_decoded_and_others_left() {
        for (encoded, name) in [("a%20b%25", "a b%"), ("50%", "50%"), ("%zz%2", "%zz%2"), ("%C3%A9%+1", "é%+1")] {
            assert_eq!(decode(encoded.as_bytes()), name);
        }
    }
}
