//! Numbers of a file, in words or binary.

use crate::IngestError;
use crate::source::{ByteOrder, numbers};
use crate::words::Words;

/// A place in a file, and how its numbers are written there.
pub(super) struct Input<'a> {
    pub(super) words: Words<'a>,
    /// Byte order of binary numbers; `None` if they are words.
    pub(super) order: Option<ByteOrder>,
    /// Whether the wider whole numbers of version 4.1 have 64 bits, not 32.
    pub(super) wide: bool,
}

impl Input<'_> {
    /// Moves to the beginning of the next line, where binary numbers begin.
    pub(super) fn begin_binary(&mut self) {
        if self.order.is_some() {
            self.words.line();
        }
    }

    /// `count` 32-bit whole numbers.
    pub(super) fn ints(&mut self, what: &str, count: u64) -> Result<Vec<i64>, IngestError> {
        match self.order {
            None => self.words.numbers(what, count),
            Some(order) => Ok(numbers!(i32, self.words.bytes(what, count, 4)?, order, i64::from)),
        }
    }

    /// `count` whole numbers of a size that the file states, below 2^63.
    pub(super) fn sizes(&mut self, what: &str, count: u64) -> Result<Vec<u64>, IngestError> {
        Ok(match (self.order, self.wide) {
            (None, _) => self.words.numbers(what, count)?,
            (Some(order), true) => numbers!(u64, self.words.bytes(what, count, 8)?, order, |v| v),
            (Some(order), false) => numbers!(u32, self.words.bytes(what, count, 4)?, order, u64::from),
        })
    }

    /// `count` real numbers.
    pub(super) fn reals(&mut self, what: &str, count: u64) -> Result<Vec<f64>, IngestError> {
        match self.order {
            None => self.words.numbers(what, count),
            Some(order) => Ok(numbers!(f64, self.words.bytes(what, count, 8)?, order, |v| v)),
        }
    }

    /// Some numbers of a known count.
    pub(super) fn ints_of<const N: usize>(&mut self, what: &str) -> Result<[i64; N], IngestError> {
        let mut all = [0; N];
        all.iter_mut().zip(self.ints(what, N as u64)?).for_each(|(to, from)| *to = from);
        Ok(all)
    }

    /// Some numbers of a known count.
    pub(super) fn sizes_of<const N: usize>(&mut self, what: &str) -> Result<[u64; N], IngestError> {
        let mut all = [0; N];
        all.iter_mut().zip(self.sizes(what, N as u64)?).for_each(|(to, from)| *to = from);
        Ok(all)
    }

    /// How many items there may be, each of so many bytes in binary and in words at least two: to reserve memory by.
    pub(super) fn bounded(&self, count: u64, binary: u64, words: u64) -> usize {
        let size = if self.order.is_some() { binary } else { words };
        count.min(self.words.rest().len() as u64 / size.max(1) + 1) as usize
    }

    /// A tag, which must not be negative.
    pub(super) fn tag(&self, tag: i64) -> Result<u64, IngestError> {
        u64::try_from(tag).map_err(|_| self.words.malformed("a tag", tag, "it must not be negative"))
    }
}
