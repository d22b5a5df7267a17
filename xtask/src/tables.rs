//! The tables that a method looks values up in.

use std::path::PathBuf;
use std::sync::Arc;

use anyhow::Result;
use tetlux_render::table_specs;
use tetlux_scene::Plan;
use tetlux_tables::{Store, Table, TableKind, TableSpec};

use crate::input::Input;
use crate::progress;

/// Where `build-tables` writes.
pub(crate) const FOLDER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../tables");

/// The tables of a plan: those of its transfer function are built, all others read. No plan chooses a method with tables
/// unasked, so that a table which cannot be used is an error; it names the command that builds it.
pub(crate) fn load(input: &Input, plan: &Plan) -> Result<Vec<Arc<Table>>> {
    let store = Store::new(PathBuf::from(FOLDER));
    let load = |spec: &TableSpec| -> Result<Arc<Table>> {
        Ok(Arc::new(match spec.kind {
            TableKind::PreIntegrated { .. } | TableKind::MeanExtinction { .. } | TableKind::ColorRatio { .. } => {
                progress::during("building tables", || Table::build(spec))?
            }
            _ => store.read(spec)?.table,
        }))
    };
    table_specs(&input.scene, &input.mesh, plan).iter().map(load).collect()
}

/// The same, for programs that are to run at once: a table that is not stored is built for this run.
pub(crate) fn load_or_build(input: &Input, plan: &Plan) -> Result<Vec<Arc<Table>>> {
    let store = Store::new(PathBuf::from(FOLDER));
    let load = |spec: &TableSpec| -> Result<Arc<Table>> {
        let stored = store.path(spec).exists().then(|| store.read(spec)).transpose()?;
        Ok(Arc::new(match stored {
            Some(stored) => stored.table,
            None => progress::during("building tables", || Table::build(spec))?,
        }))
    };
    table_specs(&input.scene, &input.mesh, plan).iter().map(load).collect()
}
