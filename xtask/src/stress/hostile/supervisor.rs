//! Cases in a process of its own, and another one after each that ends it.

use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::time::Duration;

use anyhow::{Context, Result};
use serde::{Deserialize, Serialize};

/// What a case may take.
pub(super) const TIME_LIMIT: Duration = Duration::from_secs(10);

/// Cases of a format for one process.
pub(super) struct Batch {
    pub(super) format: &'static str,
    pub(super) from: usize,
    pub(super) to: usize,
}

/// What a process says of a case, in a line.
#[derive(Serialize, Deserialize)]
pub(super) struct Told {
    pub(super) case: usize,
    pub(super) accepted: bool,
    pub(super) seconds: f64,
    /// Bytes that reading took at the most, where the system tells, and how many it may.
    pub(super) memory: Option<u64>,
    pub(super) memory_limit: u64,
    /// What was wrong, if anything.
    pub(super) failure: Option<String>,
}

/// What cases came to.
#[derive(Serialize, Default)]
pub(super) struct Tally {
    /// Read, and right.
    pub(super) accepted: usize,
    /// Answered with a clean error.
    pub(super) refused: usize,
    pub(super) failures: Vec<String>,
    pub(super) slowest_seconds: f64,
    /// The most that a case took, and the largest share of what one may.
    pub(super) memory: Option<u64>,
    pub(super) memory_share: f64,
}

impl Tally {
    pub(super) fn count(&self) -> usize {
        self.accepted + self.refused + self.failures.len()
    }

    pub(super) fn add(&mut self, other: &Tally) {
        self.accepted += other.accepted;
        self.refused += other.refused;
        self.failures.extend(other.failures.iter().cloned());
        self.slowest_seconds = self.slowest_seconds.max(other.slowest_seconds);
        self.memory = self.memory.max(other.memory);
        self.memory_share = self.memory_share.max(other.memory_share);
    }

    fn tell(&mut self, told: Told) {
        self.slowest_seconds = self.slowest_seconds.max(told.seconds);
        self.memory = self.memory.max(told.memory);
        let share = told.memory.unwrap_or_default() as f64 / told.memory_limit.max(1) as f64;
        self.memory_share = self.memory_share.max(share);
        match told.failure {
            Some(failure) => self.failures.push(format!("case {}: {failure}", told.case)),
            None if share > 1.0 => {
                let (taken, limit) = (told.memory.unwrap_or_default(), told.memory_limit);
                self.failures.push(format!("case {}: took {taken} bytes of memory, and may take {limit}", told.case));
            }
            None if told.accepted => self.accepted += 1,
            None => self.refused += 1,
        }
    }
}

/// Does the cases of a batch; `command` is the process that does them in a folder, from one of them on.
pub(super) fn run(batch: &Batch, command: impl Fn(&Path, usize) -> Command) -> Result<Tally> {
    let mut tally = Tally::default();
    let mut case = batch.from;
    while case < batch.to {
        let folder = tempfile::tempdir().context("a folder for hostile files")?;
        let mut child = command(folder.path(), case)
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .context("the program itself cannot be started")?;
        let end = follow(&mut child, &mut case, &mut tally);
        // It has ended, or is to.
        let _ = child.kill();
        let status = child.wait()?;
        match end {
            _ if case >= batch.to => {}
            RecvTimeoutError::Timeout => {
                tally.failures.push(format!("case {case}: took more than {} s", TIME_LIMIT.as_secs()));
                case += 1;
            }
            RecvTimeoutError::Disconnected => {
                tally.failures.push(format!("case {case}: ended the process: {status}"));
                case += 1;
            }
        }
    }
    Ok(tally)
}

/// Takes what a process says until it ends or says nothing for too long.
fn follow(child: &mut Child, case: &mut usize, tally: &mut Tally) -> RecvTimeoutError {
    let told = lines(child);
    loop {
        match told.recv_timeout(TIME_LIMIT) {
            Ok(told) => {
                *case = told.case + 1;
                tally.tell(told);
            }
            Err(end) => return end,
        }
    }
}

fn lines(child: &mut Child) -> Receiver<Told> {
    let (sender, receiver) = channel();
    if let Some(stdout) = child.stdout.take() {
        std::thread::spawn(move || {
            for line in BufReader::new(stdout).lines().map_while(Result::ok) {
                // A line that was not finished is that of a case that was not.
                let Ok(told) = serde_json::from_str(&line) else { return };
                if sender.send(told).is_err() {
                    return;
                }
            }
        });
    }
    receiver
}

#[cfg(test)]
#[cfg(unix)]
mod tests {
    use super::*;

    fn told(case: usize, memory: u64, failure: Option<&str>) -> String {
        let failure = failure.map(str::to_owned);
        let told = Told { case, accepted: case == 0, seconds: 0.5, memory: Some(memory), memory_limit: 100, failure };
        serde_json::to_string(&told).unwrap()
    }

    /// A process that says this and then does that.
    fn process(lines: &[String], then: &str) -> Command {
        let mut command = Command::new("sh");
        command.arg("-c").arg(format!("printf '%s\\n' \"$@\"; {then}")).arg("sh").args(lines);
        command
    }

    #[test]
    fn every_case_is_accounted_for_though_processes_end() {
        let batch = Batch { format: "planted", from: 0, to: 6 };
        let command = |_: &Path, from: usize| match from {
            // Two cases, and in the third the process is killed.
            0 => process(&[told(0, 10, None), told(1, 20, None)], "kill -9 $$"),
            // The next is too large, the one after it wrong, and the last never told of.
            3 => process(&[told(3, 101, None), told(4, 5, Some("planted"))], "exit 0"),
            _ => panic!("case {from} was done already"),
        };
        let tally = run(&batch, command).unwrap();
        assert_eq!((tally.accepted, tally.refused, tally.count(), tally.memory), (1, 1, 6, Some(101)));
        let expected = ["case 2: ended", "case 3: took 101 bytes", "case 4: planted", "case 5: ended"];
        assert_eq!(tally.failures.len(), expected.len(), "{:?}", tally.failures);
        for (failure, expected) in tally.failures.iter().zip(expected) {
            assert!(failure.starts_with(expected), "{failure}");
        }
    }
}
