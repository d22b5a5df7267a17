//! The types of numbers that files hold in binary.

use crate::source::{ByteOrder, numbers};

/// The type of an array's numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Number {
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

impl Number {
    /// The type of that name in VTK's XML files.
    pub(crate) fn of_vtk_xml(name: &str) -> Option<Number> {
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
    pub(crate) fn size(self) -> u64 {
        match self {
            Number::Int8 | Number::UInt8 => 1,
            Number::Int16 | Number::UInt16 => 2,
            Number::Int32 | Number::UInt32 | Number::Float32 => 4,
            Number::Int64 | Number::UInt64 | Number::Float64 => 8,
        }
    }

    pub(crate) fn is_real(self) -> bool {
        matches!(self, Number::Float32 | Number::Float64)
    }

    /// The numbers that bytes hold. A rest too short for one is left.
    pub(crate) fn floats(self, bytes: &[u8], order: ByteOrder) -> Vec<f64> {
        match self {
            Number::Int8 => numbers!(i8, bytes, order, f64::from),
            Number::UInt8 => numbers!(u8, bytes, order, f64::from),
            Number::Int16 => numbers!(i16, bytes, order, f64::from),
            Number::UInt16 => numbers!(u16, bytes, order, f64::from),
            Number::Int32 => numbers!(i32, bytes, order, f64::from),
            Number::UInt32 => numbers!(u32, bytes, order, f64::from),
            Number::Int64 => numbers!(i64, bytes, order, |v| v as f64),
            Number::UInt64 => numbers!(u64, bytes, order, |v| v as f64),
            Number::Float32 => numbers!(f32, bytes, order, f64::from),
            Number::Float64 => numbers!(f64, bytes, order, |v| v),
        }
    }

    /// The whole numbers that bytes hold, those beyond an `i64` as its largest; `None` if the type is real.
    pub(crate) fn integers(self, bytes: &[u8], order: ByteOrder) -> Option<Vec<i64>> {
        Some(match self {
            Number::Int8 => numbers!(i8, bytes, order, i64::from),
            Number::UInt8 => numbers!(u8, bytes, order, i64::from),
            Number::Int16 => numbers!(i16, bytes, order, i64::from),
            Number::UInt16 => numbers!(u16, bytes, order, i64::from),
            Number::Int32 => numbers!(i32, bytes, order, i64::from),
            Number::UInt32 => numbers!(u32, bytes, order, i64::from),
            Number::Int64 => numbers!(i64, bytes, order, |v| v),
            Number::UInt64 => numbers!(u64, bytes, order, |v| i64::try_from(v).unwrap_or(i64::MAX)),
            Number::Float32 | Number::Float64 => return None,
        })
    }
}
