//! NetCDF-4: netCDF in HDF5.

use std::cell::Cell;
use std::collections::HashMap;

use netcdf_reader::{NcFile, NcOpenOptions, NcSliceInfo, NcSliceInfoElem};

use super::netcdf::{Variable, text};
use crate::source::Source;
use crate::{IngestError, Place};

/// Bytes that one byte of a compressed file may become: what deflate makes of one at the most (RFC 1951).
const MOST_GROWTH: u64 = 1032;

const REMEDY: &str = "copy or write the file again, or convert it, as with `nccopy -k cdf5 IN OUT`";

/// A file whose variables are known.
pub(super) struct Hdf5<'a> {
    source: &'a Source,
    file: NcFile,
    variables: HashMap<String, Variable>,
    /// Bytes of numbers and texts that may still be asked for: a small file may promise any number of them.
    left: Cell<u64>,
}

impl<'a> Hdf5<'a> {
    /// Reads what the file lists.
    pub(super) fn open(source: &'a Source) -> Result<Self, IngestError> {
        let length = source.bytes.len();
        let most = (length as u64).saturating_mul(MOST_GROWTH);
        let options = NcOpenOptions {
            // What is read is read once.
            chunk_cache_bytes: length.min(1 << 20),
            max_chunk_bytes: usize::try_from(most).unwrap_or(usize::MAX),
            max_read_bytes: usize::try_from(most).unwrap_or(usize::MAX),
            max_object_header_bytes: length,
            ..NcOpenOptions::default()
        };
        let damaged = |why: &dyn ToString| source.malformed(Place::File, "netCDF-4 in HDF5", why.to_string(), REMEDY);
        let file = NcFile::from_bytes_with_options(&source.bytes, options).map_err(|why| damaged(&why))?;
        let variables = file.variables().map_err(|why| damaged(&why))?;
        let named =
            |v: &netcdf_reader::NcVariable| (v.name().to_string(), Variable::in_hdf5(v.name().into(), v.shape()));
        let variables = variables.iter().map(named).collect();
        Ok(Hdf5 { source, file, variables, left: Cell::new(most) })
    }

    pub(super) fn dimension(&self, name: &str) -> Option<u64> {
        self.file.dimension(name).ok().map(|dimension| dimension.size)
    }

    pub(super) fn variable(&self, name: &str) -> Option<&Variable> {
        self.variables.get(name)
    }

    pub(super) fn variables(&self) -> impl Iterator<Item = &Variable> {
        self.variables.values()
    }

    pub(super) fn attribute(&self, variable: &Variable, name: &str) -> Option<String> {
        let value = self.file.variable(&variable.name).ok()?.attribute(name)?.value.as_string()?;
        Some(text(value.as_bytes()))
    }

    pub(super) fn numbers(&self, what: &str, variable: &Variable, leading: &[u64]) -> Result<Vec<f64>, IngestError> {
        let shape = &variable.shape;
        if leading.len() > shape.len() || !leading.iter().zip(shape).all(|(index, length)| index < length) {
            let found = format!("{shape:?}, of which {leading:?} is needed");
            let remedy = "the file follows no version of Exodus II: write it again";
            return Err(self.source.malformed(Place::File, format!("the shape of {what}"), found, remedy));
        }
        self.ask(what, &shape[leading.len()..], size_of::<f64>() as u64)?;
        let whole = NcSliceInfo::all(shape.len() - leading.len()).selections;
        let selections = leading.iter().map(|&index| NcSliceInfoElem::Index(index)).chain(whole).collect();
        let values = self.file.read_variable_slice_as_f64(&variable.name, &NcSliceInfo { selections });
        values.map(|values| values.into_iter().collect()).map_err(|why| self.damaged(what, &why))
    }

    pub(super) fn texts(&self, what: &str, variable: &Variable) -> Result<Vec<String>, IngestError> {
        self.ask(what, &variable.shape, 1)?;
        // As texts of their own, or as characters along a last dimension.
        if let Ok(texts) = self.file.read_variable_as_strings(&variable.name) {
            return Ok(texts.iter().map(|t| text(t.as_bytes())).collect());
        }
        let bytes = self.file.read_variable_raw_bytes(&variable.name).map_err(|why| self.damaged(what, &why))?;
        let length = variable.shape.last().copied().unwrap_or(1).max(1);
        Ok(bytes.chunks(usize::try_from(length).unwrap_or(usize::MAX)).map(text).collect())
    }

    /// Counts what is asked for.
    fn ask(&self, what: &str, shape: &[u64], size: u64) -> Result<(), IngestError> {
        let bytes = shape.iter().fold(size, |n, &length| n.saturating_mul(length));
        let left = self.left.get().checked_sub(bytes).ok_or_else(|| {
            let found = format!("{shape:?} in a file of {} bytes", self.source.bytes.len());
            self.source.malformed(Place::File, format!("the size of {what}"), found, REMEDY)
        })?;
        self.left.set(left);
        Ok(())
    }

    fn damaged(&self, what: &str, why: &dyn ToString) -> IngestError {
        self.source.malformed(Place::File, what, why.to_string(), REMEDY)
    }
}
