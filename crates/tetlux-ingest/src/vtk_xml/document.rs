//! The XML of a VTK file: what arrays it holds and where their data are, or what files it lists. No data are decoded
//! here.

use std::cell::Cell;
use std::collections::HashMap;

use quick_xml::events::Event;
use quick_xml::reader::Reader;

use super::compress::Compressor;
use super::lattice::{Extent, Lattice};
use super::tag::Tag;
use crate::number::Number;
use crate::source::{ByteOrder, Source};
use crate::{IngestError, Place};

/// A VTK file's structure.
pub(super) struct Document<'a> {
    pub(super) kind: Kind,
    /// The `type` of the file, and the byte offset of its tag's end.
    pub(super) name: String,
    pub(super) at: u64,
    pub(super) order: ByteOrder,
    /// Whether the lengths before binary data are 64 bits, not 32.
    pub(super) wide: bool,
    pub(super) compressor: Compressor,
    pub(super) lattice: Lattice,
    /// Number of time steps whose arrays the file holds; 0 if they are of no time.
    pub(super) steps: usize,
    pub(super) pieces: Vec<Piece<'a>>,
    pub(super) files: Vec<Listed>,
    pub(super) appended: Option<Appended<'a>>,
}

/// What a file is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Unstructured,
    Structured,
    Rectilinear,
    Image,
    /// Lists the files of the pieces of one data set.
    Parallel,
    /// Lists the files of data sets of their own.
    Blocks,
    /// Lists files by their time.
    Times,
    /// Surfaces and tables.
    Flat,
}

impl Kind {
    pub(super) fn of(name: &str) -> Option<Kind> {
        Some(match name {
            "UnstructuredGrid" => Kind::Unstructured,
            "StructuredGrid" => Kind::Structured,
            "RectilinearGrid" => Kind::Rectilinear,
            "ImageData" => Kind::Image,
            "PUnstructuredGrid" | "PStructuredGrid" | "PRectilinearGrid" | "PImageData" => Kind::Parallel,
            "vtkMultiBlockDataSet"
            | "vtkMultiPieceDataSet"
            | "vtkPartitionedDataSet"
            | "vtkPartitionedDataSetCollection" => Kind::Blocks,
            "Collection" => Kind::Times,
            "PolyData" | "PPolyData" | "Table" | "PTable" => Kind::Flat,
            _ => return None,
        })
    }

    /// Whether files of this kind hold points themselves.
    pub(super) fn holds_data(self) -> bool {
        matches!(self, Kind::Unstructured | Kind::Structured | Kind::Rectilinear | Kind::Image)
    }
}

/// One piece of the mesh, its points numbered from 0.
pub(super) struct Piece<'a> {
    /// Byte offset of the end of its tag.
    pub(super) at: u64,
    /// Number of points and cells, of unstructured grids.
    pub(super) points: u64,
    pub(super) cells: u64,
    /// Its place, of the other grids.
    pub(super) extent: Option<Extent>,
    pub(super) arrays: Vec<DataArray<'a>>,
}

impl<'a> Piece<'a> {
    pub(super) fn array(&self, section: Section, name: &str) -> Option<&DataArray<'a>> {
        self.arrays.iter().find(|a| a.section == section && a.name.as_deref() == Some(name))
    }
}

/// A file that this one lists.
pub(super) struct Listed {
    /// Byte offset of the end of its tag.
    pub(super) at: u64,
    /// Its path, beside the file that lists it.
    pub(super) file: String,
    /// Its time, where files are listed by it.
    pub(super) time: Option<String>,
}

/// The element that an array is in.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
pub(super) enum Section {
    PointData,
    CellData,
    Points,
    Cells,
    Coordinates,
}

pub(super) struct DataArray<'a> {
    pub(super) section: Section,
    pub(super) name: Option<String>,
    pub(super) number: Number,
    pub(super) components: usize,
    pub(super) storage: Storage<'a>,
    /// The time steps it is of; `None`: of all.
    pub(super) steps: Option<Vec<usize>>,
    /// Byte offset of the end of its tag.
    pub(super) at: u64,
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
    /// Reads the XML up to the appended data, from where on a file is not XML; of a file without volumes its kind.
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
                        let root = tag.root()?;
                        if root.kind == Kind::Flat {
                            return Ok(root);
                        }
                        document = Some(root);
                        continue;
                    };
                    let name = element.name();
                    match (name.as_ref(), document.pieces.last_mut()) {
                        (name, None) if name == document.name && document.kind.holds_data() => {
                            document.lattice = tag.lattice()?;
                            document.steps = tag.steps()?;
                        }
                        ("Piece", _) if document.kind.holds_data() => document.pieces.push(tag.piece(document.kind)?),
                        ("Piece", _) if document.kind == Kind::Parallel => {
                            document.files.extend(tag.listed("Source")?);
                        }
                        ("DataSet", _) if matches!(document.kind, Kind::Blocks | Kind::Times) => {
                            document.files.extend(tag.listed("file")?);
                        }
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
        let Some(document) = document else {
            return Err(source.malformed(Place::File, "an XML file without elements", "none", "write it again"));
        };
        let element = match document.kind {
            kind if kind.holds_data() || kind == Kind::Parallel => "Piece",
            _ => "DataSet",
        };
        if document.pieces.is_empty() && document.files.is_empty() {
            let what = format!("a VTK file of type {} without a <{element}>", document.name);
            return Err(source.malformed(Place::File, what, "none", "write the file again"));
        }
        Ok(document)
    }

    /// Keeps the arrays of one time step: of several of one name the last that is not later.
    pub(super) fn select(&mut self, step: usize) {
        for piece in &mut self.pieces {
            let last = |array: &DataArray| array.steps.as_ref()?.iter().copied().filter(|&s| s <= step).max();
            let mut chosen: HashMap<(Section, Option<String>), usize> = HashMap::new();
            for array in &piece.arrays {
                if let Some(s) = last(array) {
                    let best = chosen.entry((array.section, array.name.clone())).or_default();
                    *best = s.max(*best);
                }
            }
            piece.arrays.retain(|array| {
                array.steps.is_none()
                    || last(array).is_some_and(|s| chosen.get(&(array.section, array.name.clone())) == Some(&s))
            });
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
            "Coordinates" => Section::Coordinates,
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
