//! Hostile input: every reader, and the parsers of scenes and presets, under damage at scale.
//!
//! Cases run in processes of their own, so that not even one that ends its process, or never ends, hides the others.

mod awkward;
mod formats;
mod judge;
#[path = "../../../crates/tetlux-ingest/src/damage/mutation.rs"]
mod mutation;
#[path = "../../../tests/src/random.rs"]
#[expect(unreachable_pub, reason = "a module of the tests' library")]
mod random;
mod supervisor;
pub(crate) mod worker;

use std::fmt::Write;
use std::process::Command;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

use anyhow::{Context, Result};
use serde::Serialize;

use super::Stress;
use super::section::Section;
use crate::progress;
use formats::FORMATS;
pub(super) use judge::same;
pub(super) use random::Random;
use supervisor::{Batch, Tally};

/// Damaged files of all formats together, and of a short run.
const CASES: usize = 100_000;
const CASES_SHORT: usize = 2_400;

/// What all cases are drawn from.
const SEED: u64 = 20_261_126;

/// Cases that a process does at most.
const A_PROCESS: usize = 2_000;

/// Bytes of address space that a process of cases may have: what asks for more fails there, and not the machine.
const ADDRESS_SPACE: u64 = 8 << 30;

/// What is said of a format.
#[derive(Serialize)]
struct Row {
    format: &'static str,
    files: usize,
    #[serde(flatten)]
    tally: Tally,
}

pub(crate) fn run(stress: &Stress) -> Result<Section> {
    let cases = if stress.short { CASES_SHORT } else { CASES };
    let mut batches = batches(cases)?;
    batches.push(Batch { format: awkward::NAME, from: 0, to: awkward::count(stress.short) });
    let rows = tallies(&batches)?;
    let damaged = || rows.iter().filter(|row| row.format != awkward::NAME);
    let sum = |of: fn(&Tally) -> usize| damaged().map(|row| of(&row.tally)).sum::<usize>();
    let failures = rows.iter().flat_map(|row| row.tally.failures.iter().map(|f| format!("{}: {f}", row.format)));
    let failures: Vec<String> = failures.collect();
    let markdown = format!(
        "Each case is a small file of its format with one to three damages, drawn from seed {SEED}: a cut, bits flipped, \
         stretches exchanged, repeated or inserted, the beginning of one file before the end of another, a number in place of \
         a word, a text such as -1, 1e400 or nan in place of digits. It must be refused by an error that names the file, or \
         read: then all of it must be finite and within bounds, and a picture of it by the processor without a pixel that is \
         not. A panic, the end of the process, more than {} s, or more memory than {} MiB and {} times the file \
         ({} times a picture's: it may be compressed a thousandfold) is a failure.\n\n{}\n\
         {} cases of damage: {} clean errors, {} read and right, {} failures. Tables and kept meshes count as read only if they \
         are bit for bit what was kept. The last row is no damage: {}.\n",
        supervisor::TIME_LIMIT.as_secs(),
        worker::ALWAYS >> 20,
        judge::FOR_EACH,
        judge::FOR_EACH_OF_A_PICTURE,
        table(&rows),
        sum(Tally::count),
        sum(|tally| tally.refused),
        sum(|tally| tally.accepted),
        failures.len(),
        awkward::WHAT,
    );
    let figures = serde_json::json!({ "seed": SEED, "formats": rows });
    Ok(Section { title: "Hostile input", markdown, figures, failures })
}

/// The cases shared among the formats, the whole files of each among them, and cut into what one process does.
fn batches(cases: usize) -> Result<Vec<Batch>> {
    let mut batches = Vec::new();
    for (number, format) in FORMATS.iter().enumerate() {
        let share = |n: usize| cases * n / FORMATS.len();
        let all = share(number + 1) - share(number) + format.files()?;
        let starts = (0..all).step_by(A_PROCESS);
        batches.extend(starts.map(|from| Batch { format: format.name, from, to: all.min(from + A_PROCESS) }));
    }
    Ok(batches)
}

/// Does all batches, as many at a time as there are processors.
fn tallies(batches: &[Batch]) -> Result<Vec<Row>> {
    let exe = std::env::current_exe().context("the program's own path")?;
    let bar = progress::bar("hostile input", batches.len() as u32);
    let next = AtomicUsize::new(0);
    let done: Mutex<Vec<(&'static str, Result<Tally>)>> = Mutex::default();
    let threads = std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
    std::thread::scope(|scope| {
        for _ in 0..threads.min(batches.len()) {
            scope.spawn(|| {
                while let Some(batch) = batches.get(next.fetch_add(1, Ordering::Relaxed)) {
                    let tally = supervisor::run(batch, |folder, from| worker::command(&exe, folder, batch, from));
                    done.lock().unwrap_or_else(PoisonError::into_inner).push((batch.format, tally));
                    bar.inc(1);
                }
            });
        }
    });
    bar.finish_and_clear();
    let mut rows = Vec::new();
    for format in FORMATS {
        rows.push(Row { format: format.name, files: format.files()?, tally: Tally::default() });
    }
    rows.push(Row { format: awkward::NAME, files: 0, tally: Tally::default() });
    for (format, tally) in done.into_inner().unwrap_or_else(PoisonError::into_inner) {
        let tally = tally?;
        rows.iter_mut().filter(|row| row.format == format).for_each(|row| row.tally.add(&tally));
    }
    Ok(rows)
}

/// A program under a limit of its address space, where the system has a shell that sets one.
fn limited(program: &std::path::Path) -> Command {
    if cfg!(unix) {
        let mut command = Command::new("sh");
        command.arg("-c").arg(format!("ulimit -v {} && exec \"$0\" \"$@\"", ADDRESS_SPACE >> 10)).arg(program);
        command
    } else {
        Command::new(program)
    }
}

fn table(rows: &[Row]) -> String {
    let mut text = String::from(
        "| format | files | cases | clean errors | read and right | failures | slowest, ms | memory: most, MiB | of the limit |\n\
         |---|---|---|---|---|---|---|---|---|\n",
    );
    for Row { format, files, tally } in rows {
        let memory = match tally.memory {
            Some(bytes) => format!("{:.1} | {:.0} %", bytes as f64 / f64::from(1 << 20), 100.0 * tally.memory_share),
            None => "- | -".into(),
        };
        let Tally { accepted, refused, slowest_seconds, ref failures, .. } = *tally;
        // Writing to a string does not fail.
        let _ = writeln!(
            text,
            "| {format} | {files} | {} | {refused} | {accepted} | {} | {:.1} | {memory} |",
            tally.count(),
            failures.len(),
            1e3 * slowest_seconds
        );
    }
    text
}
