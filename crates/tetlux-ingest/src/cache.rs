//! Meshes kept between runs.
//!
//! A mesh is kept under the path of its file and the options it was read with, and names every file that was read: those
//! of a collection, a grid's solution, a partner. It is used only if all of these are what they were. A file is taken to
//! be so if its size and its stamp are; else its content is hashed and compared. The stamp is of what a file system
//! changes with every change of a file and no program can set back: on Unix the times of the last change of content and
//! of state, to the nanosecond, and the file's number. It is relied on only if it was two seconds old when the file was
//! read, so that no clock is too coarse to tell a later change.

mod folder;
mod read_cached;

pub use folder::{Cache, CacheEntry};
pub use read_cached::{CacheOutcome, Extras, Loaded, Miss, read_cached};

use std::fs;
use std::path::Path;
use std::time::{SystemTime, UNIX_EPOCH};

/// Seconds after which a change shows in a stamp, whatever the file system: FAT counts in steps of two.
const SETTLED: i64 = 2;

/// What the file system says of a file's last change; `None` if it cannot be relied on.
pub(crate) fn stamp(path: &Path) -> Option<[i64; 6]> {
    let now = SystemTime::now().duration_since(UNIX_EPOCH).ok()?.as_secs() as i64;
    settled(raw_stamp(&fs::metadata(path).ok()?)?, now)
}

/// A stamp, if at a time in seconds no later change can have the same.
fn settled(stamp: [i64; 6], now: i64) -> Option<[i64; 6]> {
    // The places of the two times, in seconds.
    [stamp[0], stamp[2]].iter().all(|&time| time <= now - SETTLED).then_some(stamp)
}

#[cfg(unix)]
fn raw_stamp(metadata: &fs::Metadata) -> Option<[i64; 6]> {
    use std::os::unix::fs::MetadataExt;
    let m = metadata;
    Some([m.mtime(), m.mtime_nsec(), m.ctime(), m.ctime_nsec(), m.ino() as i64, m.dev() as i64])
}

#[cfg(not(unix))]
fn raw_stamp(metadata: &fs::Metadata) -> Option<[i64; 6]> {
    let parts = |time: SystemTime| {
        let since = time.duration_since(UNIX_EPOCH).ok()?;
        Some((since.as_secs() as i64, i64::from(since.subsec_nanos())))
    };
    let (modified, created) = (parts(metadata.modified().ok()?)?, parts(metadata.created().ok()?)?);
    Some([modified.0, modified.1, created.0, created.1, 0, 0])
}

#[cfg(test)]
mod tests;
