//! Tables on disk: OpenEXR files that say what they hold, and are not believed until it is found true.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};
use tetlux_image::{ImageError, open_file};

use crate::axis::Axis;
use crate::exr_file::{self, Opened, picture_size};
use crate::precision::Precision;
use crate::spec::{SpecError, TableSpec};
use crate::table::{MeasuredError, Table};

#[cfg(test)]
mod tests;

/// Version of the metadata and of the layout of texels in a file.
pub const SCHEMA_VERSION: u32 = 1;

/// Version of the generators: raised when any of them gives other texels for the same specification.
pub const GENERATOR_VERSION: u32 = 1;

/// Longest metadata read, in bytes: far above a transfer function of a thousand nodes.
const MAX_METADATA: usize = 1 << 20;

/// What a file says about itself: the JSON text of its attribute `tetlux`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Metadata {
    /// The specification's name.
    pub id: String,
    /// [`SCHEMA_VERSION`] of the writer.
    pub schema: u32,
    /// [`GENERATOR_VERSION`] of the writer.
    pub generator: u32,
    /// [`key`] of the specification.
    pub key: String,
    /// The canonical parameters.
    pub spec: TableSpec,
    /// The axes that follow from them.
    pub axes: Vec<Axis>,
    /// Error against f64 integrals.
    pub error: MeasuredError,
    /// [`Table::hash`] of the texels.
    pub hash: String,
}

/// Why a stored table is not used. Each message names the file and the command that mends it.
#[derive(Debug, thiserror::Error)]
pub enum StoreError {
    /// The specification itself is not valid.
    #[error(transparent)]
    Spec(#[from] SpecError),
    /// There is no such file.
    #[error("{path}: no such table{hint}; run `{remedy}`", path = .path.display())]
    Missing {
        /// The file.
        path: PathBuf,
        /// Files of the same name, of another version or specification, in words; may be empty.
        hint: String,
        /// The command.
        remedy: String,
    },
    /// The file cannot be opened.
    #[error("{path}: cannot open the table: {source}; run `{remedy}`", path = .path.display())]
    Open {
        /// The file.
        path: PathBuf,
        /// The system's reason.
        source: io::Error,
        /// The command.
        remedy: String,
    },
    /// The file is no OpenEXR file, is truncated or damaged, or has no valid metadata.
    #[error("{path}: damaged table: {reason}; run `{remedy}`", path = .path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
        /// What was found.
        reason: String,
        /// The command.
        remedy: String,
    },
    /// Another version wrote it.
    #[error(
        "{path}: table of schema {} and generator {}, but this program has {SCHEMA_VERSION} and {GENERATOR_VERSION}; \
         run `{remedy}`", .found[0], .found[1], path = .path.display()
    )]
    Version {
        /// The file.
        path: PathBuf,
        /// Schema and generator version found.
        found: [u64; 2],
        /// The command.
        remedy: String,
    },
    /// It holds another table than its name says.
    #[error("{path}: table of key {found}, expected {expected}: other parameters; run `{remedy}`", path = .path.display())]
    Key {
        /// The file.
        path: PathBuf,
        /// The key found.
        found: String,
        /// The key of the specification.
        expected: String,
        /// The command.
        remedy: String,
    },
    /// It has another size than the specification says.
    #[error(
        "{path}: table of {} x {} texels, expected {} x {}; run `{remedy}`",
        .found[0], .found[1], .expected[0], .expected[1], path = .path.display()
    )]
    Size {
        /// The file.
        path: PathBuf,
        /// Width and height found.
        found: [usize; 2],
        /// Width and height expected: slices are stacked.
        expected: [usize; 2],
        /// The command.
        remedy: String,
    },
    /// A texel is NaN or infinite.
    #[error("{path}: texel {index} is {value}; run `{remedy}`", path = .path.display())]
    NotFinite {
        /// The file.
        path: PathBuf,
        /// Its place among the interleaved values.
        index: usize,
        /// The value.
        value: f32,
        /// The command.
        remedy: String,
    },
    /// The texels are not those that were written.
    #[error("{path}: the texels' hash is {found}, the file states {expected}; run `{remedy}`", path = .path.display())]
    Hash {
        /// The file.
        path: PathBuf,
        /// The hash of the texels.
        found: String,
        /// The hash in the metadata.
        expected: String,
        /// The command.
        remedy: String,
    },
    /// A file cannot be written.
    #[error(transparent)]
    Write(#[from] ImageError),
}

/// A table and what is known of it.
#[derive(Clone, Debug, PartialEq)]
pub struct StoredTable {
    /// The table.
    pub table: Table,
    /// Its metadata.
    pub metadata: Metadata,
}

/// 16 hexadecimal digits of the blake3 of the canonical parameters and both versions: the same for the same table.
pub fn key(spec: &TableSpec) -> String {
    // Plain data without maps keyed by anything but text: serialising it cannot fail; a NaN, which no valid
    // specification has, would become null.
    let parameters = serde_json::to_string(spec).unwrap_or_default();
    let text = format!("tetlux table {SCHEMA_VERSION} {GENERATOR_VERSION} {parameters}");
    blake3::hash(text.as_bytes()).to_hex()[..16].to_owned()
}

/// The command that builds the table of `spec`.
pub fn remedy(spec: &TableSpec) -> String {
    let mut command = format!("cargo xtask build-tables --only {}", spec.id);
    let Ok(default) = TableSpec::named(&spec.id) else { return command };
    if spec.size != default.size {
        let size: Vec<String> = spec.size.iter().map(u32::to_string).collect();
        command += &format!(" --size {}", size[..spec.axes().len()].join("x"));
    }
    if spec.precision != default.precision {
        command += &format!(" --precision {}", spec.precision.name());
    }
    command
}

/// A folder of tables.
#[derive(Clone, Debug)]
pub struct Store {
    folder: PathBuf,
}

impl Store {
    /// The tables in `folder`, which need not exist yet.
    pub fn new(folder: impl Into<PathBuf>) -> Self {
        Self { folder: folder.into() }
    }

    /// The folder.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// Where the table of `spec` is or will be: `ID-vGENERATOR-KEY.exr`.
    pub fn path(&self, spec: &TableSpec) -> PathBuf {
        self.folder.join(file_name(spec))
    }

    /// Reads a table, and gives it only if the versions, the key, the size and the hash of its texels are right and
    /// every texel is finite.
    ///
    /// # Errors
    /// [`StoreError`] says which of these is wrong.
    pub fn read(&self, spec: &TableSpec) -> Result<StoredTable, StoreError> {
        let (opened, metadata) = self.open(spec)?;
        let (path, remedy) = (self.path(spec), remedy(spec));
        let texels = opened.texels(spec.channels());
        let texels =
            texels.map_err(|reason| StoreError::Damaged { path: path.clone(), reason, remedy: remedy.clone() })?;
        if let Some((index, &value)) = texels.iter().enumerate().find(|(_, value)| !value.is_finite()) {
            return Err(StoreError::NotFinite { path, index, value, remedy });
        }
        let Some(table) = Table::from_texels(spec, texels) else {
            return Err(StoreError::Damaged { path, reason: "a wrong number of texels".to_owned(), remedy });
        };
        let found = table.hash();
        if found != metadata.hash {
            return Err(StoreError::Hash { path, found, expected: metadata.hash, remedy });
        }
        Ok(StoredTable { table, metadata })
    }

    /// Checks versions, key and size of a stored table without decoding its texels.
    ///
    /// # Errors
    /// [`StoreError`] says which is wrong.
    pub fn read_metadata(&self, spec: &TableSpec) -> Result<Metadata, StoreError> {
        self.open(spec).map(|(_, metadata)| metadata)
    }

    /// Writes a table; the folder is made if it is not there. The file appears whole or not at all.
    ///
    /// # Errors
    /// [`StoreError::Write`].
    pub fn write(&self, table: &Table, error: &MeasuredError) -> Result<StoredTable, StoreError> {
        let spec = table.spec();
        let path = self.path(spec);
        fs::create_dir_all(&self.folder).map_err(|source| {
            StoreError::Write(ImageError::Io { path: self.folder.clone(), action: "create the folder", source })
        })?;
        let metadata = Metadata {
            id: spec.id.clone(),
            schema: SCHEMA_VERSION,
            generator: GENERATOR_VERSION,
            key: key(spec),
            spec: spec.clone(),
            axes: table.axes().to_vec(),
            error: error.clone(),
            hash: table.hash(),
        };
        let text = serde_json::to_string(&metadata)
            .map_err(|error| ImageError::Encode { path: path.clone(), reason: error.to_string() })?;
        let half = spec.precision == Precision::F16;
        exr_file::write(&path, picture_size(spec.size), spec.channels(), table.texels(), half, &text)?;
        Ok(StoredTable { table: table.clone(), metadata })
    }

    fn open(&self, spec: &TableSpec) -> Result<(Opened, Metadata), StoreError> {
        spec.validate()?;
        let (path, remedy) = (self.path(spec), remedy(spec));
        let file = match open_file(&path) {
            Ok(file) => file,
            Err(source) if source.kind() == io::ErrorKind::NotFound => {
                let hint = self.others(spec);
                return Err(StoreError::Missing { path, hint, remedy });
            }
            Err(source) => return Err(StoreError::Open { path, source, remedy }),
        };
        let damaged = |reason: String| StoreError::Damaged { path: path.clone(), reason, remedy: remedy.clone() };
        let opened = Opened::new(file).map_err(damaged)?;
        let text = opened.metadata().map_err(damaged)?;
        if text.len() > MAX_METADATA {
            return Err(damaged(format!("metadata of {} bytes", text.len())));
        }
        // The versions first, by themselves: the rest of another version's metadata may have any form.
        let versions: Versions = serde_json::from_str(&text).map_err(|e| damaged(format!("metadata: {e}")))?;
        if versions.schema != u64::from(SCHEMA_VERSION) || versions.generator != u64::from(GENERATOR_VERSION) {
            return Err(StoreError::Version { path, found: [versions.schema, versions.generator], remedy });
        }
        let metadata: Metadata = serde_json::from_str(&text).map_err(|e| damaged(format!("metadata: {e}")))?;
        let expected = key(spec);
        if metadata.key != expected || metadata.spec != *spec {
            let found = if metadata.key == expected { key(&metadata.spec) } else { metadata.key };
            return Err(StoreError::Key { path, found, expected, remedy });
        }
        let (found, expected) = (opened.size(), picture_size(spec.size));
        if found != expected {
            return Err(StoreError::Size { path, found, expected, remedy });
        }
        Ok((opened, metadata))
    }

    /// Names, in words, other files of the same id.
    fn others(&self, spec: &TableSpec) -> String {
        let prefix = format!("{}-v", spec.id);
        let names = fs::read_dir(&self.folder).into_iter().flatten().flatten();
        let mut names: Vec<String> = names
            .filter_map(|entry| entry.file_name().into_string().ok())
            .filter(|name| name.starts_with(&prefix) && name.ends_with(".exr"))
            .collect();
        names.sort();
        if names.is_empty() {
            return String::new();
        }
        format!(" (there is {}, of another version or specification)", names.join(", "))
    }
}

/// Name of the file of `spec`.
pub(crate) fn file_name(spec: &TableSpec) -> String {
    format!("{}-v{GENERATOR_VERSION}-{}.exr", spec.id, key(spec))
}

#[derive(Deserialize)]
struct Versions {
    schema: u64,
    generator: u64,
}
