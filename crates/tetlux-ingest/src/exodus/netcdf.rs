//! NetCDF's classic formats: CDF-1, CDF-2 (64-bit offsets) and CDF-5 (64-bit data).
//!
//! A header lists dimensions, attributes and variables; the numbers follow, all big-endian. Variables along the record
//! dimension (time, for Exodus) lie interleaved, a record after another (NetCDF Users Guide, "File Format
//! Specifications").

use std::cell::Cell;
use std::collections::HashMap;

use crate::source::{ByteOrder, Source, numbers};
use crate::{IngestError, Place};

const DIMENSIONS: u32 = 10;
const VARIABLES: u32 = 11;
const ATTRIBUTES: u32 = 12;
const REMEDY: &str = "the header is damaged: copy or write the file again";

/// A classic file whose header has been read.
pub(super) struct NetCdf<'a> {
    source: &'a Source,
    layout: Layout,
    dimensions: HashMap<&'a [u8], u64>,
    variables: HashMap<&'a [u8], Variable>,
    /// Bytes from one record to the next.
    record_stride: u64,
    /// Bytes of data that were asked for so far. Data of variables do not overlap, so more than the file has are a
    /// sign of a header made to exhaust memory.
    asked: Cell<u64>,
}

/// A named array.
pub(super) struct Variable {
    pub(super) name: String,
    /// Length along each dimension, the slowest first.
    pub(super) shape: Vec<u64>,
    /// Whether the first dimension is the record dimension.
    record: bool,
    kind: Kind,
    /// Where its data begin; of a record variable those of the first record. 0 if it is in HDF5, which finds them by
    /// name.
    begin: u64,
    /// Where its list of attributes is.
    attributes: u64,
}

impl Variable {
    /// A variable in HDF5.
    #[cfg(feature = "hdf5")]
    pub(super) fn in_hdf5(name: String, shape: Vec<u64>) -> Variable {
        Variable { name, shape, record: false, kind: Kind::F64, begin: 0, attributes: 0 }
    }

    /// Where an error about it lies.
    pub(super) fn place(&self) -> Place {
        if self.begin > 0 { Place::Byte(self.begin) } else { Place::File }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    I8,
    Char,
    I16,
    I32,
    F32,
    F64,
    U8,
    U16,
    U32,
    I64,
    U64,
}

impl Kind {
    const ALL: [Kind; 11] = {
        use Kind::*;
        [I8, Char, I16, I32, F32, F64, U8, U16, U32, I64, U64]
    };

    fn of(number: u32) -> Option<Kind> {
        Self::ALL.get((number as usize).checked_sub(1)?).copied()
    }

    fn size(self) -> u64 {
        match self {
            Kind::I8 | Kind::Char | Kind::U8 => 1,
            Kind::I16 | Kind::U16 => 2,
            Kind::I32 | Kind::F32 | Kind::U32 => 4,
            Kind::F64 | Kind::I64 | Kind::U64 => 8,
        }
    }
}

/// Which numbers of a header take eight bytes.
#[derive(Debug, Clone, Copy)]
struct Layout {
    wide_counts: bool,
    wide_offsets: bool,
}

/// Whether these bytes begin like a classic file.
pub(super) fn recognizes(bytes: &[u8]) -> bool {
    matches!(bytes, [b'C', b'D', b'F', 1 | 2 | 5, ..])
}

/// A place in the header.
struct Cursor<'a> {
    source: &'a Source,
    layout: Layout,
    at: u64,
}

impl<'a> Cursor<'a> {
    fn bytes(&mut self, count: u64, size: u64) -> Result<&'a [u8], IngestError> {
        let bytes = self.source.section("the netCDF header", self.at, count, size)?;
        self.at += bytes.len() as u64;
        Ok(bytes)
    }

    /// A number of four bytes, or of eight.
    fn number(&mut self, wide: bool) -> Result<u64, IngestError> {
        let bytes = self.bytes(1, if wide { 8 } else { 4 })?;
        Ok(bytes.iter().fold(0, |number, &byte| number << 8 | u64::from(byte)))
    }

    fn word(&mut self) -> Result<u32, IngestError> {
        // Four bytes are read.
        Ok(self.number(false)? as u32)
    }

    fn count(&mut self) -> Result<u64, IngestError> {
        self.number(self.layout.wide_counts)
    }

    /// Bytes and the padding after them.
    fn padded(&mut self, count: u64, size: u64) -> Result<&'a [u8], IngestError> {
        let bytes = self.bytes(count, size)?;
        self.bytes((bytes.len() as u64).next_multiple_of(4) - bytes.len() as u64, 1)?;
        Ok(bytes)
    }

    fn name(&mut self) -> Result<&'a [u8], IngestError> {
        let length = self.count()?;
        self.padded(length, 1)
    }

    /// The number of entries of a list. Each takes eight bytes or more, so the file's end stops a false one.
    fn list(&mut self, what: &str, tag: u32) -> Result<u64, IngestError> {
        let place = Place::Byte(self.at);
        let found = self.word()?;
        let count = self.count()?;
        if found != tag && !(found == 0 && count == 0) {
            let found = format!("{found} before {count} entries");
            return Err(self.source.malformed(place, format!("the tag of the list of {what}"), found, REMEDY));
        }
        Ok(count)
    }

    fn kind(&mut self) -> Result<Kind, IngestError> {
        let place = Place::Byte(self.at);
        let number = self.word()?;
        Kind::of(number).ok_or_else(|| self.source.malformed(place, "a type's number", number, REMEDY))
    }

    fn attribute(&mut self) -> Result<(&'a [u8], &'a [u8]), IngestError> {
        let (name, kind, count) = (self.name()?, self.kind()?, self.count()?);
        Ok((name, self.padded(count, kind.size())?))
    }

    fn skip_attributes(&mut self) -> Result<(), IngestError> {
        for _ in 0..self.list("attributes", ATTRIBUTES)? {
            self.attribute()?;
        }
        Ok(())
    }
}

impl<'a> NetCdf<'a> {
    /// Reads the header.
    pub(super) fn parse(source: &'a Source) -> Result<Self, IngestError> {
        let version = source.section("the netCDF signature", 0, 4, 1)?[3];
        let layout = Layout { wide_counts: version == 5, wide_offsets: version != 1 };
        let mut cursor = Cursor { source, layout, at: 4 };
        let mut records = cursor.count()?;
        let mut lengths = Vec::new();
        let mut dimensions = HashMap::new();
        for _ in 0..cursor.list("dimensions", DIMENSIONS)? {
            let (name, length) = (cursor.name()?, cursor.count()?);
            // The record dimension has length 0 here.
            dimensions.insert(name, if length == 0 { records } else { length });
            lengths.push(length);
        }
        cursor.skip_attributes()?;
        let mut variables = HashMap::new();
        for _ in 0..cursor.list("variables", VARIABLES)? {
            let name = cursor.name()?;
            let variable = variable(&mut cursor, String::from_utf8_lossy(name).into(), &lengths)?;
            variables.insert(name, variable);
        }
        let record_stride = record_stride(&variables);
        let streamed = if layout.wide_counts { u64::MAX } else { u64::from(u32::MAX) };
        if records == streamed {
            // A file that was being written says to count the records that are there.
            let first = variables.values().filter(|v| v.record).map(|v| v.begin).min().unwrap_or(u64::MAX);
            records = (source.bytes.len() as u64).saturating_sub(first) / record_stride.max(1);
            dimensions.values_mut().filter(|length| **length == streamed).for_each(|length| *length = records);
        }
        for variable in variables.values_mut().filter(|v| v.record) {
            variable.shape[0] = records;
        }
        Ok(NetCdf { source, layout, dimensions, variables, record_stride, asked: Cell::new(0) })
    }

    pub(super) fn dimension(&self, name: &str) -> Option<u64> {
        self.dimensions.get(name.as_bytes()).copied()
    }

    pub(super) fn variable(&self, name: &str) -> Option<&Variable> {
        self.variables.get(name.as_bytes())
    }

    /// All variables, in no order.
    pub(super) fn variables(&self) -> impl Iterator<Item = &Variable> {
        self.variables.values()
    }

    /// The text of an attribute of a variable, without the padding at its end. `None` if there is none.
    pub(super) fn attribute(&self, variable: &Variable, name: &str) -> Option<String> {
        let mut cursor = Cursor { source: self.source, layout: self.layout, at: variable.attributes };
        for _ in 0..cursor.list("attributes", ATTRIBUTES).ok()? {
            let (found, value) = cursor.attribute().ok()?;
            if found == name.as_bytes() {
                return Some(text(value));
            }
        }
        None
    }

    /// The bytes of a variable at fixed indices along its first dimensions.
    fn slab(&self, what: &str, variable: &Variable, leading: &[u64]) -> Result<&'a [u8], IngestError> {
        let Variable { shape, begin, .. } = variable;
        let malformed =
            |what: String, found: String, remedy| self.source.malformed(Place::Byte(*begin), what, found, remedy);
        let fits = leading.len() <= shape.len() && leading.iter().zip(shape).all(|(index, length)| index < length);
        if !fits || (variable.record && leading.is_empty()) {
            let what = format!("the shape of {what}");
            let remedy = "the file follows no version of Exodus II: write it again";
            return Err(malformed(what, format!("{shape:?}, of which {leading:?} is needed"), remedy));
        }
        let within = usize::from(variable.record);
        let mut offset = 0u64;
        for (index, length) in leading.iter().zip(shape).skip(within) {
            offset = offset.saturating_mul(*length).saturating_add(*index);
        }
        let count = shape[leading.len()..].iter().fold(1u64, |n, &length| n.saturating_mul(length));
        let size = variable.kind.size();
        let mut start = begin.saturating_add(offset.saturating_mul(count).saturating_mul(size));
        if variable.record {
            start = start.saturating_add(leading[0].saturating_mul(self.record_stride));
        }
        let bytes = self.source.section(what, start, count, size)?;
        self.asked.set(self.asked.get() + bytes.len() as u64);
        if self.asked.get() > self.source.bytes.len() as u64 {
            return Err(malformed(what.into(), "variables that overlap".into(), REMEDY));
        }
        Ok(bytes)
    }

    /// The numbers of a variable at fixed indices along its first dimensions.
    pub(super) fn numbers(&self, what: &str, variable: &Variable, leading: &[u64]) -> Result<Vec<f64>, IngestError> {
        let bytes = self.slab(what, variable, leading)?;
        let order = ByteOrder::Big;
        Ok(match variable.kind {
            Kind::I8 => numbers!(i8, bytes, order, f64::from),
            Kind::I16 => numbers!(i16, bytes, order, f64::from),
            Kind::I32 => numbers!(i32, bytes, order, f64::from),
            Kind::F32 => numbers!(f32, bytes, order, f64::from),
            Kind::F64 => numbers!(f64, bytes, order, |v| v),
            Kind::U8 => numbers!(u8, bytes, order, f64::from),
            Kind::U16 => numbers!(u16, bytes, order, f64::from),
            Kind::U32 => numbers!(u32, bytes, order, f64::from),
            // Indices beyond 2^53 are out of range, rounded or not.
            Kind::I64 => numbers!(i64, bytes, order, |v| v as f64),
            Kind::U64 => numbers!(u64, bytes, order, |v| v as f64),
            Kind::Char => {
                let remedy = "it must hold numbers: write the file again";
                return Err(self.source.malformed(Place::Byte(variable.begin), what, "text", remedy));
            }
        })
    }

    /// The texts of a variable whose last dimension is their length, without the padding at their ends.
    pub(super) fn texts(&self, what: &str, variable: &Variable) -> Result<Vec<String>, IngestError> {
        let bytes = self.slab(what, variable, &[])?;
        let length = variable.shape.last().copied().unwrap_or(1).max(1);
        // The length is that of bytes in the file, unless there are none.
        Ok(bytes.chunks(usize::try_from(length).unwrap_or(usize::MAX)).map(text).collect())
    }
}

fn variable(cursor: &mut Cursor, name: String, lengths: &[u64]) -> Result<Variable, IngestError> {
    let source = cursor.source;
    let (mut shape, mut record) = (Vec::new(), false);
    for rank in 0..cursor.count()? {
        let place = Place::Byte(cursor.at);
        let id = cursor.count()?;
        let Some(&length) = usize::try_from(id).ok().and_then(|id| lengths.get(id)) else {
            let remedy = format!("there are {}: {REMEDY}", lengths.len());
            return Err(source.malformed(place, "a dimension's number", id, remedy));
        };
        if length == 0 && rank > 0 {
            return Err(source.malformed(place, "the record dimension", format!("as number {rank}"), REMEDY));
        }
        record |= length == 0;
        shape.push(length);
    }
    let attributes = cursor.at;
    cursor.skip_attributes()?;
    let kind = cursor.kind()?;
    // The size stated here is too small a number for large variables; the shape says it as well.
    cursor.count()?;
    let begin = cursor.number(cursor.layout.wide_offsets)?;
    Ok(Variable { name, shape, record, kind, begin, attributes })
}

/// Records are the sum of their variables, each padded to four bytes unless it is the only one.
fn record_stride(variables: &HashMap<&[u8], Variable>) -> u64 {
    let size = |v: &Variable| v.shape[1..].iter().fold(v.kind.size(), |n, &length| n.saturating_mul(length));
    let mut sizes = variables.values().filter(|v| v.record).map(size);
    match (sizes.next(), sizes.next()) {
        (Some(only), None) => only,
        (first, second) => {
            let padded = |n: u64| n.checked_next_multiple_of(4).unwrap_or(u64::MAX);
            first.into_iter().chain(second).chain(sizes).fold(0, |sum, n| sum.saturating_add(padded(n)))
        }
    }
}

/// Text that ends at its length, at a zero or before blanks.
pub(super) fn text(bytes: &[u8]) -> String {
    let end = bytes.iter().position(|&b| b == 0).unwrap_or(bytes.len());
    String::from_utf8_lossy(&bytes[..end]).trim_end().to_string()
}
