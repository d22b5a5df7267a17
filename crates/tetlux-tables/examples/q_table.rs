//! Builds the default table of q, states its error, keeps it on disk and blends a segment with it.
//!
//! Run with `cargo run -p tetlux-tables --example q_table [FOLDER]`; without a folder the table goes to a temporary one.

#![allow(clippy::print_stdout, reason = "an example shows its results")]

use std::error::Error;
use std::path::PathBuf;

use tetlux_tables::{Store, Table, TableSpec, measure, sample_weights};

fn main() -> Result<(), Box<dyn Error>> {
    let temporary = tempfile::tempdir()?;
    let folder = std::env::args_os().nth(1).map_or_else(|| temporary.path().to_owned(), PathBuf::from);

    let spec = TableSpec::default_q();
    let table = Table::build(&spec)?;
    let error = measure(&table)?;
    println!("{} x {} nodes, {} bytes", spec.size[0], spec.size[1], table.bytes());
    println!(
        "error of {}: max {:.2e}, mean {:.2e} over {} points",
        error.quantity, error.max, error.mean, error.points
    );

    let store = Store::new(folder);
    store.write(&table, &error)?;
    let stored = store.read(&spec)?;
    println!("kept as {}", store.path(&spec).display());

    // A segment of optical depth 3, denser at its back: red light there, blue light in front.
    let [alpha, back, front] = sample_weights(&stored.table, 4.0, 2.0);
    println!("alpha {alpha:.5}, red {back:.5}, blue {front:.5}");
    Ok(())
}
