//! VTK's legacy files (VTK User's Guide, "VTK file formats"), versions 1.0 to 5.1, in words or big-endian binary.

mod array;
mod attributes;
mod cells;
mod grid;

use glam::DVec3;

use crate::source::Source;
use crate::words::Words;
use crate::{IngestError, MixedMesh, Place};
use array::{Encoding, Kind, floats};
use cells::Cells;
use grid::Lattice;

/// How the files begin; VTK looks at no more.
const MAGIC: &[u8] = b"# vtk DataFile";
const DATASETS: &str = "read are UNSTRUCTURED_GRID, STRUCTURED_GRID, RECTILINEAR_GRID and STRUCTURED_POINTS";

/// Whether these bytes begin as a legacy file does.
pub(crate) fn recognizes(bytes: &[u8]) -> bool {
    bytes.get(..MAGIC.len()).is_some_and(|start| start.eq_ignore_ascii_case(MAGIC))
}

/// A file, and how its arrays are written.
struct Reader<'a> {
    words: Words<'a>,
    encoding: Encoding,
}

/// Reads the points, cells and fields of a file.
pub(crate) fn read(source: Source) -> Result<MixedMesh, IngestError> {
    let (mut reader, dataset) = Reader::open(&source)?;
    let mut mesh = MixedMesh { path: source.path.clone(), ..MixedMesh::default() };
    let attributes = match dataset.as_str() {
        "unstructured_grid" => reader.unstructured(&mut mesh)?,
        "structured_grid" | "rectilinear_grid" | "structured_points" => reader.structured(&dataset, &mut mesh)?,
        _ => return Err(no_volume(&reader.words, &dataset)),
    };
    if let Some(location) = attributes {
        attributes::read(&mut reader, location, &mut mesh)?;
    }
    grid::blank(&mut mesh);
    Ok(mesh)
}

fn no_volume(words: &Words, dataset: &str) -> IngestError {
    let remedy = match dataset {
        "polydata" => format!("it holds a surface, which has no volume: {DATASETS}"),
        _ => format!("{DATASETS}: save it as one of these"),
    };
    words.source.unsupported(words.place(), "a data set of type", &dataset.to_ascii_uppercase(), remedy)
}

impl<'a> Reader<'a> {
    /// Reads up to the type of the data set, given in lower case.
    fn open(source: &'a Source) -> Result<(Self, String), IngestError> {
        let mut words = Words::new(source);
        let first = words.line().unwrap_or_default();
        if !recognizes(first) {
            let remedy = "it must begin \"# vtk DataFile Version\"";
            return Err(words.malformed("the first line of a legacy VTK file", first.escape_ascii(), remedy));
        }
        words.line().ok_or_else(|| words.cut("the title"))?;
        let word = words.expect("ASCII or BINARY")?;
        let encoding = match word.to_ascii_lowercase().as_slice() {
            b"ascii" => Encoding::Ascii,
            b"binary" => Encoding::Binary,
            _ => return Err(words.malformed("the third line", word.escape_ascii(), "it must be ASCII or BINARY")),
        };
        let mut reader = Reader { words, encoding };
        match reader.keyword().as_deref() {
            Some("dataset") => {}
            // Files of fields alone have no data set.
            Some("field") => return Err(no_volume(&reader.words, "field")),
            Some(other) => return Err(reader.unknown(other)),
            None => return Err(reader.words.cut("DATASET")),
        }
        let dataset = reader.words.expect("the type of the data set")?;
        Ok((reader, String::from_utf8_lossy(dataset).to_ascii_lowercase()))
    }

    /// The next keyword in lower case, past lines that begin with `#`. `None` at the end of the file.
    fn keyword(&mut self) -> Option<String> {
        loop {
            let word = self.words.word()?;
            if !word.starts_with(b"#") {
                return Some(word.escape_ascii().to_string().to_ascii_lowercase());
            }
            self.words.line();
        }
    }

    fn unknown(&self, keyword: &str) -> IngestError {
        let remedy = "no such keyword is known here: look whether a count before it is wrong";
        self.words.malformed("a keyword", keyword.to_ascii_uppercase(), remedy)
    }

    fn floats(&mut self, kind: Kind, what: &str, count: u64) -> Result<Option<Vec<f64>>, IngestError> {
        floats(&mut self.words, self.encoding, kind, what, count)
    }

    /// Reads an array that must be of numbers.
    fn reals(&mut self, kind: Kind, what: &str, count: u64) -> Result<Vec<f64>, IngestError> {
        let values = self.floats(kind, what, count)?;
        values.ok_or_else(|| self.words.malformed(what, "text", "numbers are needed"))
    }

    fn points(&mut self) -> Result<Vec<DVec3>, IngestError> {
        let count: u64 = self.words.number("the number of points")?;
        let kind = Kind::read(&mut self.words)?;
        let values = self.reals(kind, "the points", count.saturating_mul(3))?;
        Ok(values.as_chunks().0.iter().map(|&p: &[f64; 3]| DVec3::from(p)).collect())
    }

    /// What both kinds of data set have between their points; false if it is something else.
    fn passed_over(&mut self, keyword: &str, mesh: &mut MixedMesh) -> Result<bool, IngestError> {
        match keyword {
            "metadata" => attributes::skip_metadata(&mut self.words),
            "field" => {
                let arrays = attributes::field(self)?;
                let names: Vec<String> = arrays.into_iter().map(|array| format!("\"{}\"", array.name)).collect();
                let note = format!("data of the file as a whole are left out: {}", names.join(", "));
                mesh.notes.extend((!names.is_empty()).then_some(note));
            }
            _ => return Ok(false),
        }
        Ok(true)
    }

    /// Reads points and cells, and gives the keyword that begins the fields.
    fn unstructured(&mut self, mesh: &mut MixedMesh) -> Result<Option<String>, IngestError> {
        let (mut cells, mut types) = (None, None);
        let end = loop {
            let Some(keyword) = self.keyword() else { break None };
            match keyword.as_str() {
                "points" => mesh.points = self.points()?,
                "cells" => cells = Some(Cells::read(self)?),
                "cell_types" => types = Some(cells::types(self)?),
                "point_data" | "cell_data" => break Some(keyword),
                other if self.passed_over(other, mesh)? => {}
                other => return Err(self.unknown(other)),
            }
        };
        match (cells, types) {
            (Some(cells), Some(types)) => mesh.cells = cells.assemble(self, types, mesh.points.len())?,
            (None, None) => {}
            (Some(_), None) => {
                return Err(self.words.malformed("CELL_TYPES", "nothing", "write the types of the cells"));
            }
            (None, Some(_)) => return Err(self.words.malformed("CELLS", "nothing", "write the points of the cells")),
        }
        Ok(end)
    }

    /// Reads the points of a grid, and gives the keyword that begins the fields.
    fn structured(&mut self, dataset: &str, mesh: &mut MixedMesh) -> Result<Option<String>, IngestError> {
        let mut lattice = Lattice::default();
        let end = loop {
            let Some(keyword) = self.keyword() else { break None };
            match keyword.as_str() {
                "point_data" | "cell_data" => break Some(keyword),
                "points" => lattice.points = Some(self.points()?),
                other if lattice.read(self, other)? || self.passed_over(other, mesh)? => {}
                other => return Err(self.unknown(other)),
            }
        };
        lattice.assemble(self, dataset, mesh)?;
        Ok(end)
    }
}

/// The end of the file as a place, for what is found to be wrong only there.
fn whole() -> Place {
    Place::File
}

#[cfg(test)]
mod tests;
