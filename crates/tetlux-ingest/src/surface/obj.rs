//! Wavefront OBJ files: of their statements `v` and `f`, the others passed over.

use glam::DVec3;

use super::Surface;
use super::polygon;
use crate::source::Source;
use crate::words::{Words, parse};
use crate::{IngestError, Place};

/// Statements an OBJ file has, for telling one by its content.
const STATEMENTS: [&[u8]; 13] =
    [b"v", b"vt", b"vn", b"vp", b"f", b"l", b"p", b"o", b"g", b"s", b"mtllib", b"usemtl", b"usemap"];

/// Whether the first line that is neither empty nor a comment is a statement of an OBJ file.
pub(super) fn recognizes(bytes: &[u8]) -> bool {
    let lines = bytes.split(|&b| b == b'\n').map(<[u8]>::trim_ascii);
    let Some(line) = lines.into_iter().find(|line| !line.is_empty() && !line.starts_with(b"#")) else { return false };
    let mut words = line.split(u8::is_ascii_whitespace);
    words.next().is_some_and(|word| STATEMENTS.contains(&word)) && words.next().is_some() && line.is_ascii()
}

pub(super) fn read(source: &Source) -> Result<Surface, IngestError> {
    let mut points: Vec<DVec3> = Vec::new();
    let (mut triangles, mut polygon) = (Vec::new(), Vec::new());
    let (mut lines, mut curved) = (0, 0);
    let mut words = Words::new(source);
    loop {
        let place = words.place();
        let Some(line) = words.line() else { break };
        let joined;
        let mut line = line;
        // A backslash at the end joins the next line to this one.
        if line.ends_with(b"\\") {
            let mut whole = Vec::new();
            while let Some(start) = line.strip_suffix(b"\\") {
                whole.extend_from_slice(start);
                whole.push(b' ');
                line = words.line().unwrap_or_default();
            }
            whole.extend_from_slice(line);
            joined = whole;
            line = &joined;
        }
        let mut parts = line.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty());
        match parts.next() {
            Some(b"v") => points.push(vertex(source, place, parts)?),
            Some(b"f") => {
                polygon.clear();
                for word in parts.take_while(|word| !word.starts_with(b"#")) {
                    polygon.push(corner(source, place, word, points.len())?);
                }
                if polygon.len() < 3 {
                    let remedy = "a face needs three corners at least";
                    return Err(source.malformed(place, "the corners of a face", polygon.len(), remedy));
                }
                polygon::triangles(&points, &polygon, &mut triangles);
            }
            Some(b"l" | b"p") => lines += 1,
            Some(b"curv" | b"surf") => curved += 1,
            _ => {}
        }
    }
    let mut notes = Vec::new();
    for (count, what) in [(lines, "lines and points"), (curved, "free-form curves and surfaces")] {
        if count > 0 {
            notes.push(format!("{what}: {count}, left out"));
        }
    }
    Surface::assemble(source, points, triangles, notes)
}

/// Coordinates; what follows them (a weight or a colour) is passed over.
fn vertex<'a>(source: &Source, place: Place, words: impl Iterator<Item = &'a [u8]>) -> Result<DVec3, IngestError> {
    let (mut at, mut found) = ([0.0; 3], 0);
    for (value, word) in at.iter_mut().zip(words) {
        let remedy = "a number must be there";
        *value =
            parse(word).ok_or_else(|| source.malformed(place, "a vertex's coordinate", word.escape_ascii(), remedy))?;
        found += 1;
    }
    match found {
        3 => Ok(DVec3::from_array(at)),
        _ => Err(source.malformed(place, "the coordinates of a vertex", found, "there must be three")),
    }
}

/// The point of a corner `v`, `v/vt`, `v//vn` or `v/vt/vn`: from 1 on, or backwards from -1.
fn corner(source: &Source, place: Place, word: &[u8], points: usize) -> Result<u32, IngestError> {
    let index = word.split(|&b| b == b'/').next().unwrap_or_default();
    let found: Option<i64> = parse(index);
    let count = points as i64;
    let at = match found {
        Some(n) if (1..=count).contains(&n) => Some(n - 1),
        Some(n) if (-count..0).contains(&n) => Some(count + n),
        _ => None,
    };
    at.and_then(|at| u32::try_from(at).ok()).ok_or_else(|| {
        let remedy = format!("it must be one of the {points} vertices ahead of it, from 1 on or backwards from -1");
        source.malformed(place, "a corner of a face", word.escape_ascii(), remedy)
    })
}
