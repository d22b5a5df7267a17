//! Words, lines and binary stretches of a file, one after another.

use std::str::FromStr;

use crate::source::Source;
use crate::{IngestError, Place};

/// What to do about a file that ends too soon.
const CUT: &str = "the file is cut short: copy or write it again";

/// A place in a file, that moves on with what is read.
#[derive(Clone)]
pub(crate) struct Words<'a> {
    pub(crate) source: &'a Source,
    at: usize,
}

impl<'a> Words<'a> {
    pub(crate) fn new(source: &'a Source) -> Self {
        Words { source, at: 0 }
    }

    /// Bytes from the start of the file.
    pub(crate) fn at(&self) -> usize {
        self.at
    }

    pub(crate) fn place(&self) -> Place {
        Place::Byte(self.at as u64)
    }

    pub(crate) fn rest(&self) -> &'a [u8] {
        &self.source.bytes[self.at..]
    }

    /// The next line, without its end; `None` at the end of the file.
    pub(crate) fn line(&mut self) -> Option<&'a [u8]> {
        let rest = self.rest();
        if rest.is_empty() {
            return None;
        }
        let length = rest.iter().position(|&b| b == b'\n').unwrap_or(rest.len());
        self.at += (length + 1).min(rest.len());
        let line = &rest[..length];
        Some(line.strip_suffix(b"\r").unwrap_or(line))
    }

    /// The next word, on this line or a later one; `None` if only blanks are left.
    pub(crate) fn word(&mut self) -> Option<&'a [u8]> {
        self.at += self.rest().iter().take_while(|b| b.is_ascii_whitespace()).count();
        let rest = self.rest();
        let length = rest.iter().position(u8::is_ascii_whitespace).unwrap_or(rest.len());
        self.at += length;
        (length > 0).then(|| &rest[..length])
    }

    /// The next word, to be read again.
    pub(crate) fn peek(&self) -> Option<&'a [u8]> {
        self.clone().word()
    }

    /// The next word, which must be there.
    pub(crate) fn expect(&mut self, what: &str) -> Result<&'a [u8], IngestError> {
        self.word().ok_or_else(|| self.cut(what))
    }

    /// The next word as a number.
    pub(crate) fn number<T: FromStr>(&mut self, what: &str) -> Result<T, IngestError> {
        let word = self.expect(what)?;
        parse(word).ok_or_else(|| {
            let place = Place::Byte((self.at - word.len()) as u64);
            self.source.malformed(place, what, word.escape_ascii(), "a number that fits must be there")
        })
    }

    /// The next words as `count` numbers.
    pub(crate) fn numbers<T: FromStr>(&mut self, what: &str, count: u64) -> Result<Vec<T>, IngestError> {
        // A number takes two bytes at least, its separator counted: no more memory is asked for.
        let most = (self.rest().len() as u64).div_ceil(2);
        if count > most {
            self.source.section(what, self.at as u64, count, 2)?;
        }
        let mut values = Vec::with_capacity(count.min(most) as usize);
        for _ in 0..count {
            values.push(self.number(what)?);
        }
        Ok(values)
    }

    /// `count` values of `size` bytes.
    pub(crate) fn bytes(&mut self, what: &str, count: u64, size: u64) -> Result<&'a [u8], IngestError> {
        let bytes = self.source.section(what, self.at as u64, count, size)?;
        self.at += bytes.len();
        Ok(bytes)
    }

    /// Moves past the next occurrence of a text; false, without a move, if there is none.
    pub(crate) fn skip_past(&mut self, text: &[u8]) -> bool {
        let found = self.rest().windows(text.len().max(1)).position(|window| window == text);
        self.at += found.map_or(0, |at| at + text.len());
        found.is_some()
    }

    /// The file ends where `what` should be.
    pub(crate) fn cut(&self, what: &str) -> IngestError {
        self.source.malformed(self.place(), what, "the end of the file", CUT)
    }

    /// Something wrong just before this place.
    pub(crate) fn malformed(&self, what: impl Into<String>, found: impl ToString, remedy: &str) -> IngestError {
        self.source.malformed(self.place(), what, found, remedy)
    }
}

/// A word as a number.
pub(crate) fn parse<T: FromStr>(word: &[u8]) -> Option<T> {
    std::str::from_utf8(word).ok()?.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn source(text: &[u8]) -> Source {
        Source { path: "a".into(), bytes: text.to_vec() }
    }

    #[test]
    fn words_lines_and_bytes_follow_one_another() {
        let source = source(b" one\r\n\n2 3.5\nrest of it\r\nABC$end after");
        let mut words = Words::new(&source);
        assert_eq!((words.peek(), words.word()), (Some(&b"one"[..]), Some(&b"one"[..])));
        assert_eq!((words.line(), words.line()), (Some(&b""[..]), Some(&b""[..])));
        assert_eq!((words.number::<u8>("x").unwrap(), words.numbers::<f64>("y", 1).unwrap()), (2, vec![3.5]));
        assert_eq!((words.line(), words.line()), (Some(&b""[..]), Some(&b"rest of it"[..])));
        assert_eq!(words.bytes("z", 1, 3).unwrap(), b"ABC");
        assert!(words.skip_past(b"$end") && !words.skip_past(b"$end"));
        assert_eq!((words.word(), words.word(), words.line()), (Some(&b"after"[..]), None, None));
    }

    #[test]
    fn what_is_no_number_or_not_there_is_named_with_its_place() {
        let source = source(b"1 two");
        let mut words = Words::new(&source);
        assert!(matches!(words.clone().numbers::<u8>("x", 1 << 60), Err(IngestError::Truncated { .. })));
        let error = words.numbers::<u8>("the count", 2).unwrap_err().to_string();
        assert!(error.contains("byte 2") && error.contains("the count") && error.contains("two"), "{error}");
        assert!(words.number::<u8>("more").unwrap_err().to_string().contains("end of the file"));
    }
}
