//! `cargo xtask cache`

use std::time::Duration;

use anyhow::{Context, Result};
use tetlux_ingest::{Cache, CacheEntry};

use crate::calibration;

pub(crate) const EXAMPLES: &str = "\
Examples:
  cargo xtask cache
  cargo xtask cache --clear
  TETLUX_CACHE_DIR=/scratch/tetlux cargo xtask render mesh.vtu

Meshes of 100 000 tetrahedra and more are kept in the user's cache folder, or in that which the environment variable
TETLUX_CACHE_DIR names, 8 GiB at most; the least recently used go first. Beside them, in adapter-costs.json, is kept what
graphics adapters were measured to take.";

#[derive(clap::Args)]
pub(crate) struct Args {
    /// Remove all of them, and what graphics adapters were measured to take
    #[arg(long)]
    clear: bool,
}

pub(crate) fn run(args: &Args) -> Result<()> {
    let cache = Cache::of_user().context(
        "no folder for a cache is known: set the environment variable TETLUX_CACHE_DIR to one, or HOME to yours",
    )?;
    let folder = cache.folder.display();
    if args.clear {
        let (meshes, bytes) = cache.clear().with_context(|| format!("{folder}: cannot be cleared"))?;
        calibration::forget(&cache.folder).with_context(|| format!("{folder}: cannot be cleared"))?;
        say!("{folder}: {meshes} meshes removed, {}", size(bytes));
        return Ok(());
    }
    let entries = cache.entries().with_context(|| format!("{folder}: cannot be listed"))?;
    if !entries.is_empty() {
        say!("{:>10} {:>10} {:>10}  source", "tetrahedra", "size", "last used");
    }
    for CacheEntry { cells, bytes, used, source, state, .. } in &entries {
        let age = used.elapsed().unwrap_or_default();
        let source = source.as_deref().unwrap_or("unknown");
        let state = state.as_ref().err().map_or(String::new(), |why| format!(" (stale: {why})"));
        say!("{cells:>10} {:>10} {:>10}  {source}{state}", size(*bytes), ago(age));
    }
    let total = entries.iter().map(|entry| entry.bytes).sum();
    say!("{folder}: {} meshes, {} of {}", entries.len(), size(total), size(cache.most_bytes));
    Ok(())
}

fn size(bytes: u64) -> String {
    let units = ["B", "KiB", "MiB", "GiB"];
    let unit = (0..units.len() - 1).find(|&u| bytes < 1 << (10 * (u + 1))).unwrap_or(units.len() - 1);
    match unit {
        0 => format!("{bytes} B"),
        _ => format!("{:.1} {}", bytes as f64 / (1u64 << (10 * unit)) as f64, units[unit]),
    }
}

fn ago(age: Duration) -> String {
    match age.as_secs() {
        seconds @ ..120 => format!("{seconds} s ago"),
        seconds @ ..7_200 => format!("{} min ago", seconds / 60),
        seconds @ ..172_800 => format!("{} h ago", seconds / 3_600),
        seconds => format!("{} d ago", seconds / 86_400),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_and_ages_are_told_in_fitting_units() {
        assert_eq!([1023, 1024, 8 << 30, 3 << 40].map(size), ["1023 B", "1.0 KiB", "8.0 GiB", "3072.0 GiB"]);
        let ages = [0, 119, 120, 7_200, 172_800].map(|s| ago(Duration::from_secs(s)));
        assert_eq!(ages, ["0 s ago", "119 s ago", "2 min ago", "2 h ago", "2 d ago"]);
    }
}
