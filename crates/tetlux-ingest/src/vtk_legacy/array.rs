//! Arrays of numbers, in words or in big-endian binary.

use crate::number::Number;
use crate::source::ByteOrder;
use crate::words::Words;
use crate::{IngestError, Place};

/// The type of an array's values.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Bit,
    Of(Number),
    Text,
    Variant,
}

impl Kind {
    fn of(name: &str) -> Option<Kind> {
        Some(match name {
            "bit" => Kind::Bit,
            "char" | "signed_char" | "vtktypeint8" => Kind::Of(Number::Int8),
            "unsigned_char" | "vtktypeuint8" => Kind::Of(Number::UInt8),
            "short" | "vtktypeint16" => Kind::Of(Number::Int16),
            "unsigned_short" | "vtktypeuint16" => Kind::Of(Number::UInt16),
            // VTK writes its own type of indices in 32 bits.
            "int" | "vtkidtype" | "vtktypeint32" => Kind::Of(Number::Int32),
            "unsigned_int" | "vtktypeuint32" => Kind::Of(Number::UInt32),
            // As VTK writes them on all systems but Windows.
            "long" | "long_long" | "vtktypeint64" => Kind::Of(Number::Int64),
            "unsigned_long" | "unsigned_long_long" | "vtktypeuint64" => Kind::Of(Number::UInt64),
            "float" => Kind::Of(Number::Float32),
            "double" => Kind::Of(Number::Float64),
            "string" | "utf8_string" => Kind::Text,
            "variant" => Kind::Variant,
            _ => return None,
        })
    }

    fn number(self) -> Option<Number> {
        match self {
            Kind::Of(number) => Some(number),
            Kind::Bit | Kind::Text | Kind::Variant => None,
        }
    }

    /// Reads the name of a type.
    pub(super) fn read(words: &mut Words) -> Result<Kind, IngestError> {
        let name = words.expect("the type of an array")?;
        let lower = String::from_utf8_lossy(name).to_ascii_lowercase();
        Kind::of(&lower).ok_or_else(|| {
            let place = Place::Byte((words.at() - name.len()) as u64);
            let remedy = "write it as int, vtktypeint64, float or double";
            words.source.unsupported(place, "an array of type", &name.escape_ascii().to_string(), remedy)
        })
    }
}

/// Whether the values are words or bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Encoding {
    Ascii,
    Binary,
}

/// `count` values as real numbers; `None` if they are text, which is passed over.
pub(super) fn floats(
    words: &mut Words,
    encoding: Encoding,
    kind: Kind,
    what: &str,
    count: u64,
) -> Result<Option<Vec<f64>>, IngestError> {
    if matches!(kind, Kind::Text | Kind::Variant) {
        return skip_text(words, encoding, kind, what, count).map(|()| None);
    }
    if encoding == Encoding::Ascii {
        return words.numbers(what, count).map(Some);
    }
    let bytes = binary(words, kind, what, count)?;
    Ok(Some(match kind {
        Kind::Bit => (0..count as usize).map(|i| f64::from(bytes[i / 8] >> (7 - i % 8) & 1)).collect(),
        Kind::Of(number) => number.floats(bytes, ByteOrder::Big),
        Kind::Text | Kind::Variant => return Ok(None),
    }))
}

/// `count` whole numbers.
pub(super) fn integers(
    words: &mut Words,
    encoding: Encoding,
    kind: Kind,
    what: &str,
    count: u64,
) -> Result<Vec<i64>, IngestError> {
    let Some(number) = kind.number().filter(|n| !n.is_real()) else {
        let found = kind.number().map_or_else(|| format!("{kind:?}"), |number| format!("{number:?}"));
        return Err(words.malformed(what, found, "whole numbers are needed: write it as vtktypeint64"));
    };
    if encoding == Encoding::Ascii {
        return words.numbers(what, count);
    }
    let bytes = binary(words, kind, what, count)?;
    // None for reals alone, which were refused.
    Ok(number.integers(bytes, ByteOrder::Big).unwrap_or_default())
}

/// The bytes of `count` values: they begin on the line after their heading.
fn binary<'a>(words: &mut Words<'a>, kind: Kind, what: &str, count: u64) -> Result<&'a [u8], IngestError> {
    words.line();
    match kind {
        Kind::Bit => words.bytes(what, count.div_ceil(8), 1),
        kind => words.bytes(what, count, kind.number().map_or(1, Number::size)),
    }
}

/// Passes over `count` texts: a line each, or in binary a length and so many bytes. A variant is its type and a word.
fn skip_text(words: &mut Words, encoding: Encoding, kind: Kind, what: &str, count: u64) -> Result<(), IngestError> {
    words.line();
    for _ in 0..count {
        if kind == Kind::Variant {
            let kind: u8 = words.number(what)?;
            // An empty one (0) has no word, and neither has an empty text (13).
            let line = words.line().ok_or_else(|| words.cut(what))?;
            if line.trim_ascii().is_empty() && !matches!(kind, 0 | 13) {
                return Err(words.cut(what));
            }
        } else if encoding == Encoding::Ascii {
            words.line().ok_or_else(|| words.cut(what))?;
        } else {
            // The two highest bits of the first byte say how many bytes the length has: 8, 4, 2 or 1.
            let first = *words.rest().first().ok_or_else(|| words.cut(what))?;
            let width = [8, 4, 2, 1][usize::from(first >> 6)];
            let length = words.bytes(what, width, 1)?;
            let length = length.iter().fold(0, |n, &b| n << 8 | u64::from(b)) & (u64::MAX >> (66 - 8 * width));
            words.bytes(what, length, 1)?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::source::Source;

    #[test]
    fn texts_in_binary_are_passed_over_whatever_their_length() {
        let mut bytes = b"\n".to_vec();
        for length in [0usize, 1, 63, 64, 16383, 16384, 70000] {
            match length {
                0..64 => bytes.push(0xc0 | length as u8),
                64..16384 => bytes.extend((0x8000 | length as u16).to_be_bytes()),
                _ => bytes.extend((0x4000_0000 | length as u32).to_be_bytes()),
            }
            bytes.extend(std::iter::repeat_n(b'\n', length));
        }
        bytes.extend([0, 0, 0, 0, 0, 0, 0, 2, b'a', b'b']);
        bytes.extend(b" after");
        let source = Source { path: "a".into(), bytes };
        let mut words = Words::new(&source);
        assert_eq!(floats(&mut words, Encoding::Binary, Kind::Text, "x", 8).unwrap(), None);
        assert_eq!(words.word(), Some(&b"after"[..]));
    }
}
