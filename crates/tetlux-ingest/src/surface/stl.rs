//! STL files: triangles one by one, as text ("solid ... facet ... vertex x y z") or binary (80 bytes, a count, and 50
//! bytes each: normal, corners, attributes).

use glam::DVec3;

use super::Surface;
use crate::source::{ByteOrder, Source, numbers};
use crate::words::Words;
use crate::{IngestError, Place};

/// Bytes ahead of a binary file's triangles, and of each triangle.
const HEADER: usize = 84;
const TRIANGLE: usize = 50;

/// Whether the length is that of the binary file the count speaks of, or the text begins as it must.
pub(super) fn recognizes(bytes: &[u8]) -> bool {
    is_binary(bytes) || is_text(bytes)
}

fn is_binary(bytes: &[u8]) -> bool {
    let Some((header, triangles)) = bytes.split_at_checked(HEADER) else { return false };
    let count = u32::from_le_bytes([header[80], header[81], header[82], header[83]]);
    count > 0 && triangles.len() as u64 == u64::from(count) * TRIANGLE as u64
}

fn is_text(bytes: &[u8]) -> bool {
    let start = bytes.trim_ascii_start();
    let line = start.iter().position(|&b| b == b'\n').unwrap_or(start.len());
    let next = start[line..].trim_ascii_start();
    start.starts_with(b"solid") && (next.starts_with(b"facet") || next.starts_with(b"endsolid"))
}

pub(super) fn read(source: &Source) -> Result<Surface, IngestError> {
    let points = if is_text(&source.bytes) && !is_binary(&source.bytes) { text(source)? } else { binary(source)? };
    let triangles = (0..points.len() as u32 / 3).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    Surface::assemble(source, points, triangles, Vec::new())
}

fn binary(source: &Source) -> Result<Vec<DVec3>, IngestError> {
    let header = source.section("the header of a binary STL file", 0, HEADER as u64, 1)?;
    let count = u32::from_le_bytes([header[80], header[81], header[82], header[83]]);
    let triangles = source.section("the triangles", HEADER as u64, u64::from(count), TRIANGLE as u64)?;
    let mut points = Vec::with_capacity(3 * count as usize);
    for triangle in triangles.chunks_exact(TRIANGLE) {
        let values: Vec<f64> = numbers!(f32, triangle[12..48], ByteOrder::Little, f64::from);
        points.extend(values.chunks_exact(3).map(DVec3::from_slice));
    }
    Ok(points)
}

fn text(source: &Source) -> Result<Vec<DVec3>, IngestError> {
    let mut words = Words::new(source);
    let mut points: Vec<DVec3> = Vec::new();
    // Of the current facet.
    let mut corners = 0;
    while let Some(word) = words.word() {
        match word {
            // Names follow, which may be anything.
            b"solid" | b"endsolid" => drop(words.line()),
            b"facet" => {
                words.expect("the facet's normal")?;
                // Normals are often wrong, and follow from the corners.
                (0..3).try_for_each(|_| words.expect("the facet's normal").map(drop))?;
                corners = 0;
            }
            b"vertex" => {
                let mut coordinate = || words.number::<f64>("a corner's coordinate");
                points.push(DVec3::new(coordinate()?, coordinate()?, coordinate()?));
                corners += 1;
            }
            b"endfacet" if corners != 3 => {
                let remedy = "a facet has three between \"facet\" and \"endfacet\"";
                return Err(words.malformed("the corners of a facet", corners, remedy));
            }
            b"endfacet" => corners = 0,
            b"outer" | b"loop" | b"endloop" => {}
            _ => {
                let remedy = "a line of an STL file begins with solid, facet, outer loop, vertex, endloop, endfacet \
                              or endsolid";
                let place = Place::Byte((words.at() - word.len()) as u64);
                return Err(source.malformed(place, "a word", word.escape_ascii(), remedy));
            }
        }
    }
    if corners != 0 {
        return Err(words.cut("\"endfacet\""));
    }
    Ok(points)
}
