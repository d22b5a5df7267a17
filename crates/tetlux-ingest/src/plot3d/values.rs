//! The numbers of a PLOT3D file, one variable after another.

use super::layout::{Encoding, Layout, is_separator};
use crate::source::{ByteOrder, Source};
use crate::{IngestError, Place};

/// A place in a file, that moves on with what is read.
pub(super) struct Values<'a> {
    source: &'a Source,
    layout: &'a Layout,
    /// In bytes, or in numbers of a text.
    at: u64,
    /// In bytes, of a text.
    byte: usize,
}

impl<'a> Values<'a> {
    pub(super) fn new(source: &'a Source, layout: &'a Layout) -> Self {
        Values { source, layout, at: 0, byte: 0 }
    }

    /// Passes over what precedes `start`, in bytes, or in numbers of a text.
    pub(super) fn skip_to(&mut self, start: u64) {
        if self.layout.encoding == Encoding::Text {
            for _ in self.at..start {
                self.word();
            }
        }
        self.at = start;
    }

    /// Calls `each` with place and value of the next reals.
    pub(super) fn reals(&mut self, count: usize, mut each: impl FnMut(usize, f64)) -> Result<(), IngestError> {
        let Encoding::Binary { order, .. } = self.layout.encoding else {
            return self.texts(count, "a number", real, each);
        };
        let size = if self.layout.wide { 8 } else { 4 };
        let bytes = self.source.section("the values", self.at, count as u64, size)?;
        self.at += bytes.len() as u64;
        let mut at = 0;
        let mut give = |value: f64| {
            each(at, value);
            at += 1;
        };
        match (self.layout.wide, order) {
            (false, ByteOrder::Little) => bytes.as_chunks().0.iter().for_each(|c| give(f32::from_le_bytes(*c).into())),
            (false, ByteOrder::Big) => bytes.as_chunks().0.iter().for_each(|c| give(f32::from_be_bytes(*c).into())),
            (true, ByteOrder::Little) => bytes.as_chunks().0.iter().for_each(|c| give(f64::from_le_bytes(*c))),
            (true, ByteOrder::Big) => bytes.as_chunks().0.iter().for_each(|c| give(f64::from_be_bytes(*c))),
        }
        Ok(())
    }

    /// Which of the next integers are 0.
    pub(super) fn zeros(&mut self, count: usize) -> Result<Vec<bool>, IngestError> {
        if self.layout.encoding == Encoding::Text {
            let mut zeros = Vec::new();
            let parse = |word: &str| word.parse::<i64>().ok();
            self.texts(count, "a whole number (iblank)", parse, |_, value| zeros.push(value == 0))?;
            return Ok(zeros);
        }
        let bytes = self.source.section("iblank", self.at, count as u64, 4)?;
        self.at += bytes.len() as u64;
        // Zero is the same in either byte order.
        Ok(bytes.as_chunks::<4>().0.iter().map(|word| *word == [0; 4]).collect())
    }

    /// The next word of a text and where it begins.
    fn word(&mut self) -> (usize, &'a [u8]) {
        let rest = &self.source.bytes[self.byte..];
        let start = rest.iter().take_while(|b| is_separator(b)).count();
        let length = rest[start..].iter().take_while(|b| !is_separator(b)).count();
        let place = self.byte + start;
        self.byte = place + length;
        (place, &self.source.bytes[place..self.byte])
    }

    fn texts<T>(
        &mut self,
        count: usize,
        what: &str,
        parse: impl Fn(&str) -> Option<T>,
        mut each: impl FnMut(usize, T),
    ) -> Result<(), IngestError> {
        for at in 0..count {
            let (place, word) = self.word();
            let Some(value) = str::from_utf8(word).ok().and_then(&parse) else {
                let (place, what) = (Place::Byte(place as u64), format!("{what} of a PLOT3D text"));
                let remedy = "write each number out: repeat counts as 3*1.0 are not read";
                return Err(self.source.malformed(place, what, word.escape_ascii(), remedy));
            };
            each(at, value);
        }
        self.at += count as u64;
        Ok(())
    }
}

/// A real as C or Fortran write it.
fn real(word: &str) -> Option<f64> {
    word.parse().ok().or_else(|| word.replace(['d', 'D'], "e").parse().ok())
}
