//! A netCDF file of either kind: classic, or in HDF5.

#[cfg(feature = "hdf5")]
use super::hdf5::Hdf5;
use super::netcdf::{self, NetCdf, Variable};
use crate::source::Source;
use crate::{IngestError, Place};

/// How HDF5 files begin, and with them those of netCDF-4.
pub(super) const HDF5: &[u8] = b"\x89HDF\r\n\x1a\n";

/// A file whose header has been read.
pub(super) enum File<'a> {
    Classic(NetCdf<'a>),
    #[cfg(feature = "hdf5")]
    Hdf5(Hdf5<'a>),
}

/// The same call of whichever reader it is.
macro_rules! either {
    ($file:expr, $inner:ident => $call:expr) => {
        match $file {
            File::Classic($inner) => $call,
            #[cfg(feature = "hdf5")]
            File::Hdf5($inner) => $call,
        }
    };
}

impl<'a> File<'a> {
    pub(super) fn open(source: &'a Source) -> Result<Self, IngestError> {
        if source.bytes.starts_with(HDF5) {
            #[cfg(feature = "hdf5")]
            return Hdf5::open(source).map(File::Hdf5);
            #[cfg(not(feature = "hdf5"))]
            {
                let remedy = "build with the feature hdf5, or convert it, as with `nccopy -k cdf5 IN OUT`";
                return Err(source.unsupported(Place::File, "Exodus II or other data in", "HDF5 (netCDF-4)", remedy));
            }
        }
        if !netcdf::recognizes(&source.bytes) {
            let start = source.bytes[..source.bytes.len().min(8)].escape_ascii();
            let remedy = "a netCDF file begins with CDF and 1, 2 or 5: write it again";
            return Err(source.malformed(Place::Byte(0), "the netCDF signature", start, remedy));
        }
        NetCdf::parse(source).map(File::Classic)
    }

    /// The length of a dimension.
    pub(super) fn dimension(&self, name: &str) -> Option<u64> {
        either!(self, file => file.dimension(name))
    }

    pub(super) fn variable(&self, name: &str) -> Option<&Variable> {
        either!(self, file => file.variable(name))
    }

    /// All variables, in no order.
    pub(super) fn variables(&self) -> Box<dyn Iterator<Item = &Variable> + '_> {
        either!(self, file => Box::new(file.variables()))
    }

    /// The text of an attribute of a variable, without the padding at its end. `None` if there is none.
    pub(super) fn attribute(&self, variable: &Variable, name: &str) -> Option<String> {
        either!(self, file => file.attribute(variable, name))
    }

    /// The numbers of a variable at fixed indices along its first dimensions.
    pub(super) fn numbers(&self, what: &str, variable: &Variable, leading: &[u64]) -> Result<Vec<f64>, IngestError> {
        either!(self, file => file.numbers(what, variable, leading))
    }

    /// The texts of a variable whose last dimension is their length, without the padding at their ends.
    pub(super) fn texts(&self, what: &str, variable: &Variable) -> Result<Vec<String>, IngestError> {
        either!(self, file => file.texts(what, variable))
    }
}
