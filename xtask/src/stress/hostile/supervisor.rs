//! Cases in a process of its own, and another one after each that ends it.

use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::time::Duration;

use anyhow::{Context, Result};
use serde::{Deserialize, Serialize};

/// What a case may take: of processor time, or of waiting with nothing done.
pub(super) const TIME_LIMIT: Duration = Duration::from_secs(10);

/// How often a process is looked at that says nothing. One that does nothing for so many looks in a row waits for what
/// never comes: however busy the machine, a process that could go on would have gone on between two of them.
const LOOK: Duration = Duration::from_millis(100);

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

/// Takes what a process says until it ends, or a case takes it too long.
fn follow(child: &mut Child, case: &mut usize, tally: &mut Tally) -> RecvTimeoutError {
    let told = lines(child);
    let pid = child.id();
    let mut watch = Watch::new(processor_time(pid));
    loop {
        match told.recv_timeout(LOOK) {
            Ok(told) => {
                *case = told.case + 1;
                tally.tell(told);
                watch = Watch::new(processor_time(pid));
            }
            Err(RecvTimeoutError::Timeout) if !watch.is_over(processor_time(pid)) => {}
            Err(end) => return end,
        }
    }
}

/// What a case has taken so far, by looks at its process. What others take of the machine meanwhile is not the case's.
struct Watch {
    /// The process's time when the case began, and at the last look.
    begun: Option<Duration>,
    last: Option<Duration>,
    /// Looks in a row at which nothing had been done since the one before.
    idle: u32,
}

impl Watch {
    fn new(now: Option<Duration>) -> Watch {
        Watch { begun: now, last: now, idle: 0 }
    }

    /// Whether the case has taken too long, by its process's time at one more look; where the system does not tell
    /// it, every look is of a process that waits.
    fn is_over(&mut self, now: Option<Duration>) -> bool {
        self.idle = if now > self.last { 0 } else { self.idle + 1 };
        self.last = now;
        let taken = now.zip(self.begun).map(|(now, begun)| now.saturating_sub(begun));
        taken.is_some_and(|taken| taken > TIME_LIMIT) || LOOK * self.idle >= TIME_LIMIT
    }
}

/// The processor time of a process, user and system, of all its threads, where the system tells (Linux).
fn processor_time(process: u32) -> Option<Duration> {
    in_stat(&std::fs::read_to_string(format!("/proc/{process}/stat")).ok()?)
}

/// The same in the text of /proc/PID/stat: its 14th and 15th field, in hundredths of a second. The second may hold spaces,
/// and ends with the last bracket.
fn in_stat(text: &str) -> Option<Duration> {
    let mut fields = text.rsplit_once(')')?.1.split_whitespace().skip(11).map(str::parse::<u64>);
    let hundredths = fields.next()?.ok()? + fields.next()?.ok()?;
    Some(Duration::from_millis(10 * hundredths))
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

    const LIMIT: u64 = TIME_LIMIT.as_millis() as u64;

    fn at(milliseconds: u64) -> Option<Duration> {
        Some(Duration::from_millis(milliseconds))
    }

    #[test]
    fn a_case_is_over_by_its_own_time_and_not_by_that_of_others() {
        // Beside many others: it has one hundredth of a processor.
        let mut slow = Watch::new(at(700));
        assert!((1..=LIMIT).all(|look| !slow.is_over(at(700 + look))));
        assert!(slow.is_over(at(700 + LIMIT + 1)), "an endless loop");
        // It waits now and then, at last for ever.
        let most = (TIME_LIMIT.as_millis() / LOOK.as_millis()) as u64;
        let mut waiting = Watch::new(at(0));
        assert!((0..3 * most).all(|look| !waiting.is_over(at(look / (most - 1)))));
        assert!((0..most).all(|_| !waiting.is_over(at(9))) && waiting.is_over(at(9)));
        // Where the system tells no process's time there is the clock's.
        let mut unknown = Watch::new(None);
        assert!((1..most).all(|_| !unknown.is_over(None)) && unknown.is_over(None));
    }

    #[test]
    fn a_process_s_time_is_read_whatever_its_name() {
        let text = "12 (a) b (c) R 1 12 12 0 -1 4194304 100 0 0 0 150 25 7 8 20 0 1 0 100 1 1";
        assert_eq!((in_stat(text), in_stat("12 (a) R 1"), in_stat("")), (at(1750), None, None));
        if cfg!(target_os = "linux") {
            assert!(processor_time(std::process::id()).is_some());
        }
    }

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
