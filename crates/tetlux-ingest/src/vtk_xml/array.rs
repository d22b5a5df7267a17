//! The values of one array, from whichever encoding it has.

use std::borrow::Cow;
use std::str::FromStr;

use super::base64::Decoder;
use super::compress::Compressor;
use super::document::{DataArray, Document, Storage};
use crate::source::{ByteOrder, Source, excerpt, numbers};
use crate::{IngestError, Place};

/// Arrays may lie on one another, but all together take no more than so many times the data there are: else a small
/// file could fill any memory.
const SHARING: u64 = 2;

/// The values of an array as real numbers; it must have `expected` of them.
pub(super) fn floats(
    source: &Source,
    document: &Document,
    array: &DataArray,
    expected: u64,
) -> Result<Vec<f64>, IngestError> {
    if let Storage::Text(text) = array.storage {
        return parse(source, array, text, Some(expected));
    }
    let (bytes, order) = (Binary { source, document, array }.decode(Some(expected))?, document.order);
    Ok(array.number.floats(&bytes, order))
}

/// The values of an array of whole numbers, those beyond an `i64` as its largest; it must have `expected` of them, if
/// that is known.
pub(super) fn integers(
    source: &Source,
    document: &Document,
    array: &DataArray,
    expected: Option<u64>,
) -> Result<Vec<i64>, IngestError> {
    if array.number.is_real() {
        let what = "an array of whole numbers of type";
        return Err(source.unsupported(Place::Byte(array.at), what, "Float32 or Float64", "write it as Int64"));
    }
    if let Storage::Text(text) = array.storage {
        return parse(source, array, text, expected);
    }
    let (bytes, order) = (Binary { source, document, array }.decode(expected)?, document.order);
    // None for reals alone, which were refused.
    Ok(array.number.integers(&bytes, order).unwrap_or_default())
}

/// Numbers in words.
fn parse<T: FromStr>(
    source: &Source,
    array: &DataArray,
    text: &str,
    expected: Option<u64>,
) -> Result<Vec<T>, IngestError> {
    let most = expected.unwrap_or(u64::MAX);
    let wrong = |found: String| {
        let what = format!("{} of {most} values", label(array));
        source.malformed(Place::Byte(array.at), what, found, "the number of values must fit the mesh")
    };
    // A number takes two characters at least, its separator counted.
    let mut values = Vec::with_capacity(most.min(text.len() as u64 / 2 + 1) as usize);
    for word in text.split_ascii_whitespace() {
        if values.len() as u64 == most {
            return Err(wrong("more".into()));
        }
        values.push(word.parse().map_err(|_| {
            let what = format!("value {} of {}", values.len(), label(array));
            source.malformed(Place::Byte(array.at), what, word, "write a number")
        })?);
    }
    if expected.is_some_and(|expected| (values.len() as u64) < expected) {
        return Err(wrong(values.len().to_string()));
    }
    Ok(values)
}

/// An array as a message calls it.
pub(super) fn label(array: &DataArray) -> String {
    array.name.as_ref().map_or("an array without a name".into(), |name| format!("array \"{}\"", excerpt(name)))
}

/// An array in binary: a header of lengths, then bytes, compressed or not.
struct Binary<'a> {
    source: &'a Source,
    document: &'a Document<'a>,
    array: &'a DataArray<'a>,
}

/// Bytes as they are, or in base64.
enum Stream<'a> {
    Raw(&'a [u8]),
    Base64(Decoder<'a>),
}

impl<'a> Stream<'a> {
    /// The next `count` bytes, or as many as there are.
    fn read(&mut self, count: usize) -> Cow<'a, [u8]> {
        match self {
            Stream::Raw(bytes) => {
                let (taken, rest) = bytes.split_at(count.min(bytes.len()));
                *bytes = rest;
                Cow::Borrowed(taken)
            }
            Stream::Base64(decoder) => Cow::Owned(decoder.read(count)),
        }
    }
}

impl<'a> Binary<'a> {
    fn decode(&self, expected: Option<u64>) -> Result<Cow<'a, [u8]>, IngestError> {
        let bytes = expected.map(|n| n.saturating_mul(self.array.number.size()));
        if bytes == Some(0) {
            return Ok(Cow::Borrowed(&[]));
        }
        match &self.document.compressor {
            Compressor::None => self.copy(bytes),
            Compressor::Other(name) => {
                let remedy = "write the file with ZLib, LZ4 or LZMA, or uncompressed";
                Err(self.source.unsupported(Place::Byte(self.array.at), "the compressor", name, remedy))
            }
            compressor => self.expand(compressor, bytes),
        }
    }

    /// The array's data, and their place in the file.
    fn stream(&self) -> Result<(Stream<'a>, u64), IngestError> {
        let offset = match self.array.storage {
            Storage::Text(text) | Storage::Base64(text) => {
                return Ok((Stream::Base64(Decoder::new(text.as_bytes())), self.array.at));
            }
            Storage::Appended(offset) => offset,
        };
        let Some(appended) = &self.document.appended else {
            return Err(self.malformed("no <AppendedData>, to which it refers", offset, "write the file again"));
        };
        let at = appended.at.saturating_add(offset);
        let data = usize::try_from(offset).ok().and_then(|offset| appended.bytes.get(offset..));
        let data = data.ok_or_else(|| self.truncated(at, 1, 0))?;
        let stream = if appended.base64 { Stream::Base64(Decoder::new(data)) } else { Stream::Raw(data) };
        Ok((stream, at))
    }

    /// Data that are not compressed: one length, then the bytes, in one stream.
    fn copy(&self, expected: Option<u64>) -> Result<Cow<'a, [u8]>, IngestError> {
        let width = self.width();
        let (mut probe, at) = self.stream()?;
        let header = self.words(&probe.read(width));
        let &[declared] = header.as_slice() else { return Err(self.truncated(at, width as u64, 0)) };
        self.agree(declared, expected)?;
        let (mut stream, _) = self.stream()?;
        let needed = declared.saturating_add(width as u64);
        let all = stream.read(usize::try_from(needed).unwrap_or(usize::MAX));
        if (all.len() as u64) < needed {
            return Err(self.truncated(at, needed, all.len() as u64));
        }
        self.take(needed)?;
        Ok(match all {
            Cow::Borrowed(all) => Cow::Borrowed(&all[width..]),
            Cow::Owned(mut all) => {
                all.drain(..width);
                Cow::Owned(all)
            }
        })
    }

    /// Compressed data: the number of blocks, their size, the last one's if it is smaller, the compressed size of
    /// each; then, in a stream of its own, the blocks.
    fn expand(&self, compressor: &Compressor, expected: Option<u64>) -> Result<Cow<'a, [u8]>, IngestError> {
        let width = self.width();
        let (mut probe, at) = self.stream()?;
        let header = self.words(&probe.read(3 * width));
        let &[blocks, size, last] = header.as_slice() else {
            return Err(self.truncated(at, 3 * width as u64, (header.len() * width) as u64));
        };
        let partial = u64::from(last > 0 && blocks > 0);
        let declared = (blocks - partial).saturating_mul(size).saturating_add(last * partial);
        self.agree(declared, expected)?;

        let (mut stream, _) = self.stream()?;
        let needed = blocks.saturating_add(3).saturating_mul(width as u64);
        let header = self.words(&stream.read(usize::try_from(needed).unwrap_or(usize::MAX)));
        let compressed = header.get(3..).unwrap_or_default();
        if (compressed.len() as u64) < blocks {
            return Err(self.truncated(at, needed, (header.len() * width) as u64));
        }
        let total = compressed.iter().fold(0u64, |sum, &n| sum.saturating_add(n));
        let data = stream.read(usize::try_from(total).unwrap_or(usize::MAX));
        if (data.len() as u64) < total {
            return Err(self.truncated(at, needed.saturating_add(total), needed + data.len() as u64));
        }
        self.take(needed + total)?;
        if declared > total.saturating_mul(compressor.most_growth()) {
            let what = format!("{} cannot become {declared} bytes", label(self.array));
            return Err(self.malformed(what, format!("{total} compressed bytes"), "write the file again"));
        }
        let mut bytes = Vec::new();
        if usize::try_from(declared).map_or(true, |n| bytes.try_reserve_exact(n).is_err()) {
            let what = format!("no memory for {}", label(self.array));
            return Err(self.malformed(what, format!("{declared} bytes"), "free memory, or split the data set"));
        }
        let mut rest = data.as_ref();
        for (b, &length) in compressed.iter().enumerate() {
            let (block, after) = rest.split_at((length as usize).min(rest.len()));
            rest = after;
            let size = if partial == 1 && b as u64 + 1 == blocks { last } else { size };
            compressor.expand(block, size, &mut bytes).map_err(|found| {
                let what = format!("block {b} of {} must expand to {size} bytes", label(self.array));
                self.malformed(what, found, "copy or write the file again")
            })?;
        }
        Ok(Cow::Owned(bytes))
    }

    /// Counts appended data that are taken, so that no file asks for more memory than its length warrants.
    fn take(&self, bytes: u64) -> Result<(), IngestError> {
        let (Storage::Appended(offset), Some(appended)) = (self.array.storage, &self.document.appended) else {
            return Ok(());
        };
        appended.taken.set(appended.taken.get().saturating_add(bytes));
        if appended.taken.get() <= (appended.bytes.len() as u64).saturating_mul(SHARING) {
            return Ok(());
        }
        let what = format!("{} and those before it share appended data", label(self.array));
        Err(self.malformed(what, format!("offset {offset}"), "give each array its own"))
    }

    /// Bytes of one length in a header.
    fn width(&self) -> usize {
        if self.document.wide { 8 } else { 4 }
    }

    fn words(&self, bytes: &[u8]) -> Vec<u64> {
        let order: ByteOrder = self.document.order;
        if self.document.wide { numbers!(u64, bytes, order, |v| v) } else { numbers!(u32, bytes, order, u64::from) }
    }

    fn agree(&self, declared: u64, expected: Option<u64>) -> Result<(), IngestError> {
        let Some(expected) = expected.filter(|&expected| expected != declared) else { return Ok(()) };
        let what = format!(
            "{} has the wrong length: the numbers of points, cells and components ask for {expected} bytes",
            label(self.array)
        );
        Err(self.malformed(what, format!("{declared} bytes"), "mend the header, or write the file again"))
    }

    fn truncated(&self, offset: u64, needed: u64, found: u64) -> IngestError {
        IngestError::Truncated { path: self.source.path.clone(), what: label(self.array), offset, needed, found }
    }

    fn malformed(&self, what: impl Into<String>, found: impl ToString, remedy: &str) -> IngestError {
        self.source.malformed(Place::Byte(self.array.at), what, found, remedy)
    }
}
