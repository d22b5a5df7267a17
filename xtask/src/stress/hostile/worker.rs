//! The process that does cases, and says of each what came of it.

use std::panic::{self, AssertUnwindSafe};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::{Mutex, PoisonError};
use std::time::Instant;

use anyhow::{Context, Result, bail};

use super::formats::{FORMATS, Seed, damaged};
use super::judge::{Judge, Verdict};
use super::random::Random;
use super::supervisor::{Batch, Told};
use super::{SEED, awkward, limited};
use crate::memory;

/// Bytes that reading may take whatever the file: a lattice that no array tells of, what decompressors begin with.
pub(super) const ALWAYS: u64 = 4 << 20;

/// The cases of `stress`, in a process of their own: `stress` itself starts it.
#[derive(clap::Args)]
pub(crate) struct Args {
    format: String,
    from: usize,
    to: usize,
    folder: PathBuf,
}

/// The process that does cases of a batch from one on.
pub(super) fn command(exe: &Path, folder: &Path, batch: &Batch, from: usize) -> Command {
    let mut command = limited(exe);
    command.arg("stress-cases").arg(batch.format).args([from, batch.to].map(|n| n.to_string())).arg(folder);
    // One thread, and an allocator that gives back what it can: then memory is that of the case.
    command.env("RAYON_NUM_THREADS", "1").env("MALLOC_MMAP_THRESHOLD_", "65536").env("MALLOC_TRIM_THRESHOLD_", "65536");
    command
}

/// What reading took.
#[derive(Default)]
pub(super) struct Meter {
    taken: Option<u64>,
}

impl Meter {
    /// Does the part of a case whose memory counts.
    pub(super) fn reading<T>(&mut self, work: impl FnOnce() -> T) -> T {
        memory::forget_peak();
        let before = memory::peak();
        let result = work();
        self.taken = memory::peak().zip(before).map(|(peak, before)| peak.saturating_sub(before));
        result
    }
}

/// Where a panic was, for the case that it ends.
static PANIC: Mutex<String> = Mutex::new(String::new());

pub(crate) fn run(args: &Args) -> Result<()> {
    panic::set_hook(Box::new(|info| {
        *PANIC.lock().unwrap_or_else(PoisonError::into_inner) = info.to_string().replace('\n', " ");
    }));
    if args.format == awkward::NAME {
        let paths = awkward::Paths::new(&args.folder)?;
        return each(args, |case, meter| (paths.judge(case, meter), u64::MAX));
    }
    let number = FORMATS.iter().position(|format| format.name == args.format);
    let Some(number) = number else { bail!("{}: no such format", args.format) };
    let format = &FORMATS[number];
    let seeds = format.seeds(&args.folder)?;
    let judge = Judge::new(format.kind, &args.folder)?;
    let largest = seeds.iter().map(|seed| seed.bytes.len()).max().unwrap_or_default();
    each(args, |case, meter| {
        let whole = seeds.get(case);
        let (Seed { path, bytes }, damaged) = match whole {
            Some(seed) => (seed, seed.bytes.clone()),
            None => {
                let mut random = Random::new(SEED ^ (number as u64) << 56 ^ (case as u64) << 24);
                let (which, damaged) = damaged(&seeds, &mut random);
                (&seeds[which], damaged)
            }
        };
        // Collections read others beside themselves, each no larger than the largest.
        let limit = ALWAYS + judge.memory_for_each_byte() * damaged.len().max(largest) as u64;
        let write = |bytes: &[u8]| std::fs::write(path, bytes).map_err(|e| format!("{}: {e}", path.display()));
        let verdict = write(&damaged).and_then(|()| judge.judge(path, meter));
        let verdict = match verdict {
            Ok(Verdict::Refused) if whole.is_some() => Err(format!("{} is whole, and was refused", path.display())),
            verdict => write(bytes).and(verdict),
        };
        (verdict, limit)
    })
}

/// Does cases one after another; each gives its verdict, and the memory that it may take.
fn each(args: &Args, one: impl Fn(usize, &mut Meter) -> (Result<Verdict, String>, u64)) -> Result<()> {
    for case in args.from..args.to {
        let start = Instant::now();
        let mut meter = Meter::default();
        let done = panic::catch_unwind(AssertUnwindSafe(|| one(case, &mut meter)));
        let panicked = |_| (Err(PANIC.lock().unwrap_or_else(PoisonError::into_inner).clone()), u64::MAX);
        let (verdict, memory_limit) = done.unwrap_or_else(panicked);
        let told = Told {
            case,
            accepted: matches!(verdict, Ok(Verdict::Accepted)),
            seconds: start.elapsed().as_secs_f64(),
            memory: meter.taken,
            memory_limit,
            failure: verdict.err(),
        };
        say!("{}", serde_json::to_string(&told).context("a line of figures")?);
    }
    Ok(())
}
