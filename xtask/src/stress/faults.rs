//! Faults: of devices, of disks, of programs that are killed, and of what is kept between runs.

mod device;
mod disk;
mod kept;
mod kill;
pub(super) mod program;
mod together;

use std::fmt::Write;

use anyhow::Result;
use serde::Serialize;

use super::Stress;
use super::section::Section;
pub(crate) use device::run_without_memory;

/// A kind of fault.
#[derive(Serialize)]
struct Row {
    /// What was done.
    what: &'static str,
    /// How often.
    times: usize,
    /// What came of it.
    outcome: String,
    /// What did not hold, each with its place.
    #[serde(skip)]
    failures: Vec<String>,
}

impl Row {
    fn new(what: &'static str) -> Row {
        Row { what, times: 0, outcome: String::new(), failures: Vec::new() }
    }

    /// Counts a try, and what did not hold of it.
    fn add(&mut self, held: Result<(), String>) {
        self.times += 1;
        self.failures.extend(held.err());
    }
}

pub(crate) fn run(stress: &Stress) -> Result<Section> {
    let mut rows = Vec::new();
    for part in [device::rows, disk::rows, kill::rows, together::rows, kept::rows] {
        rows.extend(part(stress)?);
    }
    let failures =
        rows.iter().flat_map(|row| row.failures.iter().map(move |failure| format!("{}: {failure}", row.what)));
    let mut markdown = String::from("| fault | times | what came of it | failures |\n|---|---|---|---|\n");
    for Row { what, times, outcome, failures } in &rows {
        // Writing to a string does not fail.
        let _ = writeln!(markdown, "| {what} | {times} | {outcome} | {} |", failures.len());
    }
    Ok(Section { title: "Faults", failures: failures.collect(), markdown, figures: serde_json::to_value(&rows)? })
}
