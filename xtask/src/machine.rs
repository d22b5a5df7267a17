//! What was measured on, and what of.

use std::process::Command;
use std::time::{SystemTime, UNIX_EPOCH};

use serde::Serialize;
use tetlux_render::Renderer;

use crate::memory;

#[derive(Serialize)]
pub(crate) struct Machine {
    processor: String,
    threads: usize,
    instruction_sets: Vec<&'static str>,
    memory_bytes: Option<u64>,
    system: String,
    adapter: Option<String>,
    driver: Option<String>,
    tetlux: String,
    compiler: Option<String>,
    date: Option<String>,
}

impl Machine {
    pub(crate) fn new(renderer: &Renderer) -> Machine {
        let build = if cfg!(debug_assertions) { ", NOT an optimised build" } else { "" };
        let commit = said("git", &["describe", "--always", "--dirty"]).map_or(String::new(), |c| format!(", {c}"));
        let seconds = SystemTime::now().duration_since(UNIX_EPOCH).ok().map(|since| since.as_secs());
        Machine {
            processor: processor().unwrap_or_else(|| std::env::consts::ARCH.to_owned()),
            threads: std::thread::available_parallelism().map_or(1, std::num::NonZero::get),
            instruction_sets: instruction_sets(),
            memory_bytes: memory::of_machine(),
            system: said("uname", &["-sr"]).unwrap_or_else(|| std::env::consts::OS.to_owned()),
            adapter: renderer.device().map(|device| device.name.clone()),
            driver: renderer.driver().map(str::to_owned),
            tetlux: format!("{}{commit}{build}", env!("CARGO_PKG_VERSION")),
            compiler: said("rustc", &["--version"]),
            date: seconds.map(|seconds| date(seconds / 86_400)),
        }
    }

    /// Names and what they are.
    pub(crate) fn rows(&self) -> Vec<[String; 2]> {
        let unknown = || "-".to_owned();
        let gib = |bytes: u64| format!("{:.1} GiB", bytes as f64 / f64::from(1 << 30));
        [
            ("processor", self.processor.clone()),
            ("threads", self.threads.to_string()),
            ("instruction sets", self.instruction_sets.join(", ")),
            ("memory", self.memory_bytes.map_or_else(unknown, gib)),
            ("system", self.system.clone()),
            ("graphics adapter", self.adapter.clone().unwrap_or_else(|| "none".into())),
            ("driver", self.driver.clone().unwrap_or_else(unknown)),
            ("tetlux", self.tetlux.clone()),
            ("compiler", self.compiler.clone().unwrap_or_else(unknown)),
            ("date", self.date.clone().unwrap_or_else(unknown)),
        ]
        .map(|(name, value)| [name.to_owned(), value])
        .into()
    }
}

/// What a program says, if it is there and all is well.
fn said(program: &str, args: &[&str]) -> Option<String> {
    let output = Command::new(program).args(args).output().ok().filter(|output| output.status.success())?;
    let text = String::from_utf8_lossy(&output.stdout).trim().to_owned();
    (!text.is_empty()).then_some(text)
}

fn processor() -> Option<String> {
    let text = std::fs::read_to_string("/proc/cpuinfo").ok()?;
    let name = text.lines().find_map(|line| line.strip_prefix("model name")?.split_once(':'));
    name.map(|(_, name)| name.trim().to_owned()).or_else(|| said("sysctl", &["-n", "machdep.cpu.brand_string"]))
}

/// Those that the processor has of what tiles may be drawn with, the best first.
fn instruction_sets() -> Vec<&'static str> {
    #[cfg(any(target_arch = "x86_64", target_arch = "x86"))]
    let all = [
        ("AVX-512", std::is_x86_feature_detected!("avx512f")),
        ("AVX2", std::is_x86_feature_detected!("avx2")),
        ("FMA", std::is_x86_feature_detected!("fma")),
        ("SSE4.2", std::is_x86_feature_detected!("sse4.2")),
    ];
    #[cfg(target_arch = "aarch64")]
    let all = [("NEON", std::arch::is_aarch64_feature_detected!("neon"))];
    #[cfg(not(any(target_arch = "x86_64", target_arch = "x86", target_arch = "aarch64")))]
    let all: [(&str, bool); 0] = [];
    all.into_iter().filter(|(_, has)| *has).map(|(name, _)| name).collect()
}

/// A day since 1 January 1970 in the Gregorian calendar, as 2026-01-31.
fn date(day: u64) -> String {
    // Years that begin in March have their leap day at the end; 400 of them have 146 097 days.
    let shifted = day + 719_468;
    let (era, of_era) = (shifted / 146_097, shifted % 146_097);
    let year_of_era = (of_era - of_era / 1_460 + of_era / 36_524 - of_era / 146_096) / 365;
    let of_year = of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
    let from_march = (5 * of_year + 2) / 153;
    let month = if from_march < 10 { from_march + 3 } else { from_march - 9 };
    let year = era * 400 + year_of_era + u64::from(month <= 2);
    format!("{year:04}-{month:02}-{:02}", of_year - (153 * from_march + 2) / 5 + 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn days_have_their_dates() {
        // 946 684 800 s is the beginning of 2000; leap days of a year that 400 divides, and of one that 100 alone does not.
        let days = [0, 10_957, 10_957 + 59, 10_957 + 366, 19_782];
        assert_eq!(days.map(date), ["1970-01-01", "2000-01-01", "2000-02-29", "2001-01-01", "2024-02-29"]);
    }

    #[test]
    fn a_program_that_fails_or_is_absent_says_nothing() {
        assert_eq!(said("no-such-program-anywhere", &[]), None);
        assert_eq!(said("rustc", &["--no-such-flag"]), None);
    }
}
