//! The bytes of a file, and numbers read from them.

use std::fs;
use std::path::{Path, PathBuf};

use tetlux_mesh::cache::SourceFile;

use crate::cache::stamp;
use crate::{IngestError, Place};

/// Byte order of the numbers in a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum ByteOrder {
    Little,
    Big,
}

/// A whole file in memory.
pub(crate) struct Source {
    pub(crate) path: PathBuf,
    pub(crate) bytes: Vec<u8>,
}

/// Opens files, and keeps a record of each if one is wanted.
#[derive(Default)]
pub(crate) struct Files {
    /// `None` if no record is wanted, or a path is no text.
    pub(crate) record: Option<Vec<SourceFile>>,
}

impl Files {
    /// As [`Source::open`].
    pub(crate) fn open(&mut self, path: &Path) -> Result<Source, IngestError> {
        // Taken before the content: what changes between the two is found to have changed.
        let stamp = if self.record.is_some() { stamp(path) } else { None };
        let source = Source::open(path)?;
        self.record = self.record.take().and_then(|mut record| {
            let path = std::path::absolute(path).ok()?.to_str()?.to_owned();
            let (size, hash) = (source.bytes.len() as u64, blake3::hash(&source.bytes).into());
            record.push(SourceFile { path, size, stamp: stamp.unwrap_or_default(), hash });
            Some(record)
        });
        Ok(source)
    }
}

impl Source {
    /// Reads a regular file that is not empty.
    pub(crate) fn open(path: &Path) -> Result<Source, IngestError> {
        let io = |source| IngestError::Io { path: path.into(), source };
        let metadata = fs::metadata(path).map_err(io)?;
        if !metadata.is_file() {
            let found = if metadata.is_dir() { "a directory" } else { "no regular file" };
            return Err(IngestError::NotAFile { path: path.into(), found });
        }
        let bytes = fs::read(path).map_err(io)?;
        if bytes.is_empty() {
            return Err(IngestError::Empty { path: path.into() });
        }
        Ok(Source { path: path.into(), bytes })
    }

    /// `count` values of `size` bytes from `offset` on.
    pub(crate) fn section(&self, what: &str, offset: u64, count: u64, size: u64) -> Result<&[u8], IngestError> {
        let needed = count.saturating_mul(size);
        let found = (self.bytes.len() as u64).saturating_sub(offset);
        if needed > found {
            return Err(IngestError::Truncated { path: self.path.clone(), what: what.into(), offset, needed, found });
        }
        // Both ends lie inside the file, so they fit a usize.
        Ok(&self.bytes[offset as usize..(offset + needed) as usize])
    }

    pub(crate) fn malformed(
        &self,
        place: Place,
        what: impl Into<String>,
        found: impl ToString,
        remedy: impl Into<String>,
    ) -> IngestError {
        let (what, found, remedy) = (what.into(), excerpt(&found.to_string()), remedy.into());
        IngestError::Malformed { path: self.path.clone(), place, what, found, remedy }
    }

    pub(crate) fn unsupported(
        &self,
        place: Place,
        what: &'static str,
        found: &str,
        remedy: impl Into<String>,
    ) -> IngestError {
        IngestError::Unsupported { path: self.path.clone(), place, what, found: excerpt(found), remedy: remedy.into() }
    }
}

/// A value as a message can bear it.
pub(crate) fn excerpt(text: &str) -> String {
    const LONGEST: usize = 60;
    if text.chars().count() <= LONGEST {
        return text.to_string();
    }
    text.chars().take(LONGEST).chain("...".chars()).collect()
}

/// The numbers of type `$from` that `$bytes` hold in `$order`, each given to `$to`. A rest too short for one is left.
macro_rules! numbers {
    ($from:ty, $bytes:expr, $order:expr, $to:expr) => {{
        let chunks = $bytes.as_chunks::<{ size_of::<$from>() }>().0.iter();
        match $order {
            crate::source::ByteOrder::Little => chunks.map(|c| $to(<$from>::from_le_bytes(*c))).collect(),
            crate::source::ByteOrder::Big => chunks.map(|c| $to(<$from>::from_be_bytes(*c))).collect(),
        }
    }};
}
pub(crate) use numbers;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_follow_the_byte_order() {
        let bytes = [0u8, 0, 0, 40, 0, 0, 1, 0, 9];
        let big: Vec<i32> = numbers!(i32, bytes, ByteOrder::Big, |v| v);
        let little: Vec<i32> = numbers!(i32, bytes, ByteOrder::Little, |v| v);
        assert_eq!(big, [40, 256]);
        assert_eq!(little, [40 << 24, 1 << 16]);
    }

    #[test]
    fn a_section_past_the_end_is_refused_however_long() {
        let source = Source { path: "a".into(), bytes: vec![0; 10] };
        assert_eq!(source.section("x", 2, 2, 4).unwrap().len(), 8);
        for (offset, count) in [(2, 3), (11, 1), (u64::MAX, 1), (0, u64::MAX)] {
            assert!(matches!(source.section("x", offset, count, 4), Err(IngestError::Truncated { .. })));
        }
    }
}
