//! `manifest.json`: which tables there are, for people and for other programs. Reading a table does not depend on it.

use std::fs::{self, File};

use serde::{Deserialize, Serialize};
use tetlux_image::{ImageError, write_atomically};

use crate::precision::Precision;
use crate::store::{GENERATOR_VERSION, Metadata, SCHEMA_VERSION, Store, StoreError, file_name};
use crate::table::MeasuredError;

/// Name of the manifest in the folder of tables.
const FILE: &str = "manifest.json";

/// Held while the manifest is changed.
const LOCK: &str = ".manifest.lock";

/// The tables of one version.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Manifest {
    /// [`SCHEMA_VERSION`].
    pub schema: u32,
    /// [`GENERATOR_VERSION`].
    pub generator: u32,
    /// One entry a file, by name.
    pub tables: Vec<Entry>,
}

/// One table.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Entry {
    /// The specification's name.
    pub id: String,
    /// File in the manifest's folder.
    pub file: String,
    /// Nodes along the axes.
    pub size: [u32; 3],
    /// Channels, in order.
    pub channels: Vec<String>,
    /// Texel format.
    pub precision: Precision,
    /// Measured error.
    pub error: MeasuredError,
    /// blake3 of the decoded texels.
    pub hash: String,
}

impl Entry {
    fn new(metadata: &Metadata) -> Self {
        let spec = &metadata.spec;
        Self {
            id: spec.id.clone(),
            file: file_name(spec),
            size: spec.size,
            channels: spec.channels().iter().map(|&name| name.to_owned()).collect(),
            precision: spec.precision,
            error: metadata.error.clone(),
            hash: metadata.hash.clone(),
        }
    }
}

impl Manifest {
    /// The manifest of a store. One that is missing, damaged or of another version counts as empty: it is rebuilt.
    pub fn read(store: &Store) -> Self {
        let empty = Self { schema: SCHEMA_VERSION, generator: GENERATOR_VERSION, tables: Vec::new() };
        let text = fs::read_to_string(store.folder().join(FILE)).unwrap_or_default();
        match serde_json::from_str::<Self>(&text) {
            Ok(manifest) if [manifest.schema, manifest.generator] == [SCHEMA_VERSION, GENERATOR_VERSION] => manifest,
            _ => empty,
        }
    }

    /// Adds tables to the manifest of a store, or replaces the entries of their files. Others that do so at the same time
    /// wait for one another, so that no entry is lost.
    ///
    /// # Errors
    /// [`StoreError::Write`].
    pub fn add<'a>(store: &Store, tables: impl IntoIterator<Item = &'a Metadata>) -> Result<Self, StoreError> {
        let tables: Vec<&Metadata> = tables.into_iter().collect();
        let with = |mut manifest: Self| {
            tables.iter().for_each(|metadata| manifest.insert(metadata));
            manifest
        };
        let before = Self::read(store);
        if before == with(before.clone()) {
            return Ok(before);
        }
        let path = store.folder().join(LOCK);
        let io = |source| ImageError::Io { path: path.clone(), action: "lock", source };
        // Released when it is dropped, and by the system where the program is killed.
        let lock = File::create(&path).map_err(io)?;
        lock.lock().map_err(io)?;
        let manifest = with(Self::read(store));
        manifest.write(store)?;
        Ok(manifest)
    }

    fn insert(&mut self, metadata: &Metadata) {
        let entry = Entry::new(metadata);
        self.tables.retain(|other| other.file != entry.file);
        self.tables.push(entry);
        self.tables.sort_by(|a, b| a.file.cmp(&b.file));
    }

    fn write(&self, store: &Store) -> Result<(), StoreError> {
        let path = store.folder().join(FILE);
        let mut text = serde_json::to_string_pretty(self)
            .map_err(|error| ImageError::Encode { path: path.clone(), reason: error.to_string() })?;
        text.push('\n');
        Ok(write_atomically(&path, |file| file.write_all(text.as_bytes()))?)
    }
}
