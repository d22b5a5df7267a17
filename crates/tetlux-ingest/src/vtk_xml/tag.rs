//! What the tags of a VTK file say.

use std::cell::Cell;
use std::str::FromStr;

use quick_xml::XmlVersion;
use quick_xml::events::BytesStart;

use super::compress::Compressor;
use super::document::{Appended, DataArray, Document, Kind, Listed, Piece, Section, Storage};
use super::lattice::{Extent, Lattice};
use crate::number::Number;
use crate::source::{ByteOrder, Source};
use crate::{IngestError, Place};

/// An opening tag, and the byte offset of its end.
pub(super) struct Tag<'s, 'e> {
    pub(super) source: &'s Source,
    pub(super) element: &'e BytesStart<'s>,
    pub(super) at: u64,
}

impl<'s> Tag<'s, '_> {
    pub(super) fn root(&self) -> Result<Document<'s>, IngestError> {
        if self.element.name().as_ref() != "VTKFile" {
            let found = self.element.name().as_ref().to_string();
            return Err(self.malformed("the root element of a VTK file", found, "it must be VTKFile"));
        }
        let name = self.attribute("type")?.unwrap_or_default();
        let kind = Kind::of(&name).ok_or_else(|| {
            self.unsupported("a VTKFile of type", &name, "save it as an unstructured grid (.vtu), or another grid")
        })?;
        let order = match self.attribute("byte_order")?.as_deref() {
            Some("LittleEndian") | None => ByteOrder::Little,
            Some("BigEndian") => ByteOrder::Big,
            Some(other) => return Err(self.unsupported("byte_order", other, "write LittleEndian or BigEndian")),
        };
        let wide = match self.attribute("header_type")?.as_deref() {
            Some("UInt32") | None => false,
            Some("UInt64") => true,
            Some(other) => return Err(self.unsupported("header_type", other, "write UInt32 or UInt64")),
        };
        let compressor = Compressor::of(self.attribute("compressor")?.as_deref());
        let (lattice, pieces, files) = (Lattice::default(), Vec::new(), Vec::new());
        let at = self.at;
        Ok(Document { kind, name, at, order, wide, compressor, lattice, steps: 0, pieces, files, appended: None })
    }

    pub(super) fn piece(&self, kind: Kind) -> Result<Piece<'s>, IngestError> {
        let (mut points, mut cells, mut extent) = (0, 0, None);
        if kind == Kind::Unstructured {
            [points, cells] = [self.number("NumberOfPoints")?, self.number("NumberOfCells")?];
        } else {
            extent = self.extent("Extent")?;
        }
        Ok(Piece { at: self.at, points, cells, extent, arrays: Vec::new() })
    }

    pub(super) fn lattice(&self) -> Result<Lattice, IngestError> {
        let default = Lattice::default();
        Ok(Lattice {
            whole: self.extent("WholeExtent")?,
            origin: self.numbers("Origin")?.unwrap_or(default.origin),
            spacing: self.numbers("Spacing")?.unwrap_or(default.spacing),
            direction: self.numbers("Direction")?.unwrap_or(default.direction),
        })
    }

    /// Number of time steps that a data set's tag names.
    pub(super) fn steps(&self) -> Result<usize, IngestError> {
        Ok(self.attribute("TimeValues")?.map_or(0, |values| values.split_ascii_whitespace().count()))
    }

    /// The file that an attribute names; none where a block is empty.
    pub(super) fn listed(&self, attribute: &str) -> Result<Option<Listed>, IngestError> {
        let time = self.attribute("timestep")?;
        Ok(self.attribute(attribute)?.map(|file| Listed { at: self.at, file, time }))
    }

    pub(super) fn data_array(&self, section: Section) -> Result<DataArray<'s>, IngestError> {
        let number = self.attribute("type")?.unwrap_or_default();
        let number = Number::of_vtk_xml(&number).ok_or_else(|| {
            self.unsupported("an array of type", &number, "write it as Int8 to UInt64, Float32 or Float64")
        })?;
        let components = match self.attribute("NumberOfComponents")? {
            None => 1,
            Some(text) => text
                .trim()
                .parse()
                .ok()
                .filter(|&n: &usize| n > 0)
                .ok_or_else(|| self.malformed("NumberOfComponents", text, "it must be a whole number from 1 on"))?,
        };
        let storage = match self.attribute("format")?.as_deref() {
            Some("ascii") | None => Storage::Text(""),
            Some("binary") => Storage::Base64(""),
            Some("appended") => Storage::Appended(self.number("offset")?),
            Some(other) => return Err(self.unsupported("the format", other, "write appended, binary or ascii")),
        };
        let steps =
            match self.attribute("TimeStep")? {
                None => None,
                Some(text) => Some(self.words(&text).ok_or_else(|| {
                    self.malformed("TimeStep", text, "it must be one or more whole numbers from 0 on")
                })?),
            };
        Ok(DataArray { section, name: self.attribute("Name")?, number, components, storage, steps, at: self.at })
    }

    pub(super) fn appended(&self) -> Result<Appended<'s>, IngestError> {
        let base64 = match self.attribute("encoding")?.as_deref() {
            Some("base64") | None => true,
            Some("raw") => false,
            Some(other) => return Err(self.unsupported("the encoding", other, "write raw or base64")),
        };
        let start = self.at as usize;
        let rest = &self.source.bytes[start..];
        let Some(underscore) = rest.iter().position(|b| !b.is_ascii_whitespace()).filter(|&i| rest[i] == b'_') else {
            let found = rest.iter().take(16).copied().collect::<Vec<u8>>().escape_ascii().to_string();
            return Err(self.malformed("the appended data", found, "they must begin with an underscore"));
        };
        // The data may hold anything, this tag too: its last occurrence counts.
        const END: &[u8] = b"</AppendedData";
        let Some(end) = rest.windows(END.len()).rposition(|w| w == END) else {
            let found = "the end of the file";
            return Err(self.malformed("the appended data are not closed", found, "copy or write the file again"));
        };
        let bytes = rest.get(underscore + 1..end).unwrap_or_default();
        Ok(Appended { base64, bytes, at: (start + underscore + 1) as u64, taken: Cell::new(0) })
    }

    fn attribute(&self, name: &str) -> Result<Option<String>, IngestError> {
        let bad = |e: String| self.malformed("an attribute", e, "write the file again");
        match self.element.try_get_attribute(name).map_err(|e| bad(e.to_string()))? {
            Some(a) => {
                let value = a.normalized_value(XmlVersion::Implicit1_0).map_err(|e| bad(e.to_string()))?;
                Ok(Some(value.into_owned()))
            }
            None => Ok(None),
        }
    }

    fn number(&self, name: &str) -> Result<u64, IngestError> {
        let text = self.attribute(name)?.unwrap_or_else(|| "nothing".into());
        text.trim().parse().map_err(|_| self.malformed(name, text, "it must be a whole number from 0 on"))
    }

    fn extent(&self, name: &str) -> Result<Option<Extent>, IngestError> {
        let Some(text) = self.attribute(name)? else { return Ok(None) };
        let words: Option<[i32; 6]> = self.words(&text).and_then(|words| words.try_into().ok());
        match words {
            Some(words) => Ok(Some(Extent::new(words))),
            None => Err(self.malformed(name, text, "it must be six whole numbers: first and last of i, j and k")),
        }
    }

    fn numbers<const N: usize>(&self, name: &str) -> Result<Option<[f64; N]>, IngestError> {
        let Some(text) = self.attribute(name)? else { return Ok(None) };
        match self.words(&text).and_then(|words| words.try_into().ok()) {
            Some(numbers) => Ok(Some(numbers)),
            None => Err(self.malformed(name, text, &format!("it must be {N} numbers"))),
        }
    }

    /// The words of a text, each a number.
    fn words<T: FromStr>(&self, text: &str) -> Option<Vec<T>> {
        text.split_ascii_whitespace().map(|word| word.parse().ok()).collect()
    }

    fn malformed(&self, what: &str, found: impl ToString, remedy: &str) -> IngestError {
        self.source.malformed(Place::Byte(self.at), what, found, remedy)
    }

    fn unsupported(&self, what: &'static str, found: &str, remedy: &str) -> IngestError {
        self.source.unsupported(Place::Byte(self.at), what, found, remedy)
    }
}
