//! The XML of a VTU file: what arrays it holds and where their data are. No data are decoded here.

use std::cell::Cell;

use quick_xml::XmlVersion;
use quick_xml::events::{BytesStart, Event};
use quick_xml::reader::Reader;

use crate::source::{ByteOrder, Source};
use crate::{IngestError, Place};

/// A VTU file's structure.
pub(super) struct Document<'a> {
    pub(super) order: ByteOrder,
    /// Whether the lengths before binary data are 64 bits, not 32.
    pub(super) wide: bool,
    /// Whether binary data are compressed with zlib.
    pub(super) compressed: bool,
    pub(super) pieces: Vec<Piece<'a>>,
    pub(super) appended: Option<Appended<'a>>,
}

/// One piece of the mesh, its points numbered from 0.
pub(super) struct Piece<'a> {
    /// Byte offset of the end of its tag.
    pub(super) at: u64,
    pub(super) points: u64,
    pub(super) cells: u64,
    pub(super) arrays: Vec<DataArray<'a>>,
}

/// The element that an array is in.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Section {
    PointData,
    CellData,
    Points,
    Cells,
}

pub(super) struct DataArray<'a> {
    pub(super) section: Section,
    pub(super) name: Option<String>,
    pub(super) number: Number,
    pub(super) components: usize,
    pub(super) storage: Storage<'a>,
    /// Byte offset of the end of its tag.
    pub(super) at: u64,
}

/// The type of an array's numbers.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Number {
    Int8,
    UInt8,
    Int16,
    UInt16,
    Int32,
    UInt32,
    Int64,
    UInt64,
    Float32,
    Float64,
}

/// Where an array's data are.
#[derive(Clone, Copy)]
pub(super) enum Storage<'a> {
    /// In the element, as numbers in words.
    Text(&'a str),
    /// In the element, in base64.
    Base64(&'a str),
    /// So many bytes (or characters) into the appended data.
    Appended(u64),
}

/// What follows the underscore in `<AppendedData>`.
pub(super) struct Appended<'a> {
    pub(super) base64: bool,
    pub(super) bytes: &'a [u8],
    /// Byte offset of `bytes`.
    pub(super) at: u64,
    /// Bytes that arrays have taken so far: more than there are, and they lie on one another.
    pub(super) taken: Cell<u64>,
}

impl<'a> Document<'a> {
    /// Reads the XML up to the appended data, from where on a file is not XML.
    pub(super) fn parse(source: &'a Source) -> Result<Document<'a>, IngestError> {
        let mut reader = Reader::from_reader(source.bytes.as_slice());
        let mut document: Option<Document<'a>> = None;
        let (mut open, mut section, mut in_array) = (0usize, None, None);
        loop {
            let event = reader.read_event();
            let at = reader.buffer_position();
            let event = event.map_err(|e| {
                source.malformed(Place::Byte(reader.error_position()), "the XML", e, "write the file again")
            })?;
            match event {
                Event::Start(ref element) | Event::Empty(ref element) => {
                    let tag = Tag { source, element, at };
                    let starts = matches!(event, Event::Start(_));
                    open += usize::from(starts);
                    let Some(document) = &mut document else {
                        document = Some(tag.root()?);
                        continue;
                    };
                    let name = element.name();
                    match (name.as_ref(), document.pieces.last_mut()) {
                        ("Piece", _) => document.pieces.push(tag.piece()?),
                        ("AppendedData", _) => {
                            document.appended = Some(tag.appended()?);
                            break;
                        }
                        ("DataArray", Some(piece)) => {
                            if let Some(section) = section {
                                piece.arrays.push(tag.data_array(section)?);
                                in_array = starts.then_some(open);
                            }
                        }
                        (name, _) if starts => section = Section::of(name).or(section),
                        _ => {}
                    }
                }
                Event::Text(text) if in_array == Some(open) => {
                    let array = document.as_mut().and_then(|d| d.pieces.last_mut()?.arrays.last_mut());
                    // Borrowed from the slice that the reader reads.
                    if let (Some(array), std::borrow::Cow::Borrowed(text)) = (array, text.into_inner()) {
                        array.add_text(text);
                    }
                }
                Event::End(element) => {
                    if in_array == Some(open) {
                        in_array = None;
                    }
                    open = open.saturating_sub(1);
                    if Section::of(element.name().as_ref()).is_some() {
                        section = None;
                    }
                }
                Event::Eof if open > 0 => {
                    let found = format!("the end of the file with {open} elements open");
                    return Err(source.malformed(Place::Byte(at), "the XML", found, "copy or write the file again"));
                }
                Event::Eof => break,
                _ => {}
            }
        }
        match document {
            Some(document) if !document.pieces.is_empty() => Ok(document),
            _ => Err(source.malformed(Place::File, "a VTU file without a <Piece>", "none", "write the file again")),
        }
    }
}

impl Section {
    fn of(name: &str) -> Option<Section> {
        Some(match name {
            "PointData" => Section::PointData,
            "CellData" => Section::CellData,
            "Points" => Section::Points,
            "Cells" => Section::Cells,
            _ => return None,
        })
    }
}

impl<'a> DataArray<'a> {
    /// Takes the first text that is not blank.
    fn add_text(&mut self, text: &'a str) {
        if let Storage::Text(data) | Storage::Base64(data) = &mut self.storage
            && data.trim_ascii().is_empty()
        {
            *data = text;
        }
    }
}

impl Number {
    fn of(name: &str) -> Option<Number> {
        Some(match name {
            "Int8" => Number::Int8,
            "UInt8" => Number::UInt8,
            "Int16" => Number::Int16,
            "UInt16" => Number::UInt16,
            "Int32" => Number::Int32,
            "UInt32" => Number::UInt32,
            "Int64" => Number::Int64,
            "UInt64" => Number::UInt64,
            "Float32" => Number::Float32,
            "Float64" => Number::Float64,
            _ => return None,
        })
    }

    /// Bytes of one.
    pub(super) fn size(self) -> u64 {
        match self {
            Number::Int8 | Number::UInt8 => 1,
            Number::Int16 | Number::UInt16 => 2,
            Number::Int32 | Number::UInt32 | Number::Float32 => 4,
            Number::Int64 | Number::UInt64 | Number::Float64 => 8,
        }
    }
}

/// An opening tag, and the byte offset of its end.
struct Tag<'s, 'e> {
    source: &'s Source,
    element: &'e BytesStart<'s>,
    at: u64,
}

impl<'s> Tag<'s, '_> {
    fn root(&self) -> Result<Document<'s>, IngestError> {
        if self.element.name().as_ref() != "VTKFile" {
            let found = self.element.name().as_ref().to_string();
            return Err(self.malformed("the root element of a VTU file", found, "it must be VTKFile"));
        }
        let kind = self.attribute("type")?.unwrap_or_default();
        if kind != "UnstructuredGrid" {
            return Err(self.unsupported("a VTKFile of type", &kind, "save it as an unstructured grid (.vtu)"));
        }
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
        let compressed = match self.attribute("compressor")?.as_deref() {
            None | Some("") => false,
            Some("vtkZLibDataCompressor") => true,
            Some(other) => {
                return Err(self.unsupported("the compressor", other, "write the file with ZLib, or uncompressed"));
            }
        };
        Ok(Document { order, wide, compressed, pieces: Vec::new(), appended: None })
    }

    fn piece(&self) -> Result<Piece<'s>, IngestError> {
        let [points, cells] = [self.number("NumberOfPoints")?, self.number("NumberOfCells")?];
        Ok(Piece { at: self.at, points, cells, arrays: Vec::new() })
    }

    fn data_array(&self, section: Section) -> Result<DataArray<'s>, IngestError> {
        let number = self.attribute("type")?.unwrap_or_default();
        let number = Number::of(&number).ok_or_else(|| {
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
        Ok(DataArray { section, name: self.attribute("Name")?, number, components, storage, at: self.at })
    }

    fn appended(&self) -> Result<Appended<'s>, IngestError> {
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

    fn malformed(&self, what: &str, found: impl ToString, remedy: &str) -> IngestError {
        self.source.malformed(Place::Byte(self.at), what, found, remedy)
    }

    fn unsupported(&self, what: &'static str, found: &str, remedy: &str) -> IngestError {
        self.source.unsupported(Place::Byte(self.at), what, found, remedy)
    }
}
