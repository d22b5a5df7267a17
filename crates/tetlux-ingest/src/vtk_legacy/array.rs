//! Arrays of numbers, in words or in big-endian binary.

use crate::source::{ByteOrder, numbers};
use crate::words::Words;
use crate::{IngestError, Place};

/// The type of an array's values.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Bit,
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
    Text,
    Variant,
}

impl Kind {
    fn of(name: &str) -> Option<Kind> {
        Some(match name {
            "bit" => Kind::Bit,
            "char" | "signed_char" | "vtktypeint8" => Kind::Int8,
            "unsigned_char" | "vtktypeuint8" => Kind::UInt8,
            "short" | "vtktypeint16" => Kind::Int16,
            "unsigned_short" | "vtktypeuint16" => Kind::UInt16,
            // VTK writes its own type of indices in 32 bits.
            "int" | "vtkidtype" | "vtktypeint32" => Kind::Int32,
            "unsigned_int" | "vtktypeuint32" => Kind::UInt32,
            // As VTK writes them on all systems but Windows.
            "long" | "long_long" | "vtktypeint64" => Kind::Int64,
            "unsigned_long" | "unsigned_long_long" | "vtktypeuint64" => Kind::UInt64,
            "float" => Kind::Float32,
            "double" => Kind::Float64,
            "string" | "utf8_string" => Kind::Text,
            "variant" => Kind::Variant,
            _ => return None,
        })
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

    fn bits(self) -> u64 {
        match self {
            Kind::Bit => 1,
            Kind::Int8 | Kind::UInt8 | Kind::Text | Kind::Variant => 8,
            Kind::Int16 | Kind::UInt16 => 16,
            Kind::Int32 | Kind::UInt32 | Kind::Float32 => 32,
            Kind::Int64 | Kind::UInt64 | Kind::Float64 => 64,
        }
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
    let order = ByteOrder::Big;
    if matches!(kind, Kind::Text | Kind::Variant) {
        return skip_text(words, encoding, kind, what, count).map(|()| None);
    }
    if encoding == Encoding::Ascii {
        return words.numbers(what, count).map(Some);
    }
    let bytes = binary(words, kind, what, count)?;
    Ok(Some(match kind {
        Kind::Bit => (0..count as usize).map(|i| f64::from(bytes[i / 8] >> (7 - i % 8) & 1)).collect(),
        Kind::Int8 => numbers!(i8, bytes, order, f64::from),
        Kind::UInt8 | Kind::Text | Kind::Variant => numbers!(u8, bytes, order, f64::from),
        Kind::Int16 => numbers!(i16, bytes, order, f64::from),
        Kind::UInt16 => numbers!(u16, bytes, order, f64::from),
        Kind::Int32 => numbers!(i32, bytes, order, f64::from),
        Kind::UInt32 => numbers!(u32, bytes, order, f64::from),
        Kind::Int64 => numbers!(i64, bytes, order, |v| v as f64),
        Kind::UInt64 => numbers!(u64, bytes, order, |v| v as f64),
        Kind::Float32 => numbers!(f32, bytes, order, f64::from),
        Kind::Float64 => numbers!(f64, bytes, order, |v| v),
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
    if matches!(kind, Kind::Bit | Kind::Float32 | Kind::Float64 | Kind::Text | Kind::Variant) {
        return Err(words.malformed(what, format!("{kind:?}"), "whole numbers are needed: write it as vtktypeint64"));
    }
    if encoding == Encoding::Ascii {
        return words.numbers(what, count);
    }
    let (bytes, order) = (binary(words, kind, what, count)?, ByteOrder::Big);
    Ok(match kind {
        Kind::Int8 => numbers!(i8, bytes, order, i64::from),
        Kind::UInt8 => numbers!(u8, bytes, order, i64::from),
        Kind::Int16 => numbers!(i16, bytes, order, i64::from),
        Kind::UInt16 => numbers!(u16, bytes, order, i64::from),
        Kind::Int32 => numbers!(i32, bytes, order, i64::from),
        Kind::UInt32 => numbers!(u32, bytes, order, i64::from),
        Kind::UInt64 => numbers!(u64, bytes, order, |v| i64::try_from(v).unwrap_or(i64::MAX)),
        _ => numbers!(i64, bytes, order, |v| v),
    })
}

/// The bytes of `count` values: they begin on the line after their heading.
fn binary<'a>(words: &mut Words<'a>, kind: Kind, what: &str, count: u64) -> Result<&'a [u8], IngestError> {
    words.line();
    match kind {
        Kind::Bit => words.bytes(what, count.div_ceil(8), 1),
        kind => words.bytes(what, count, kind.bits() / 8),
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
