//! The program itself, as a user runs it, in a folder of its own.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use anyhow::{Context, Result};
use tempfile::TempDir;

/// How files begin that are being written, results and kept ones.
const UNFINISHED: &str = ".tetlux-";

pub(super) struct Program {
    exe: PathBuf,
    folder: TempDir,
}

impl Program {
    pub(super) fn new() -> Result<Program> {
        let exe = std::env::current_exe().context("the program's own path")?;
        Ok(Program { exe, folder: tempfile::tempdir().context("a folder for faults")? })
    }

    pub(super) fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// The program with arguments, its cache in the folder.
    pub(super) fn command(&self, args: &[&str]) -> Command {
        self.prepared(Command::new(&self.exe), args)
    }

    /// The same as a child of a shell that has run something before.
    pub(super) fn after(&self, first: &str, args: &[&str]) -> Command {
        let mut command = Command::new("sh");
        command.arg("-c").arg(format!("{first}; exec \"$0\" \"$@\"")).arg(&self.exe);
        self.prepared(command, args)
    }

    fn prepared(&self, mut command: Command, args: &[&str]) -> Command {
        command.args(args).current_dir(self.folder.path()).env("TETLUX_CACHE_DIR", self.path("cache"));
        command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
        command
    }

    /// Runs it, and expects it to succeed.
    pub(super) fn succeed(&self, args: &[&str]) -> Result<(), String> {
        succeeded(&run(self.command(args))?)
    }

    /// What a file holds; `None` if it is not there.
    pub(super) fn read(&self, name: &str) -> Option<Vec<u8>> {
        fs::read(self.path(name)).ok()
    }

    pub(super) fn write(&self, name: &str, bytes: impl AsRef<[u8]>) -> Result<()> {
        fs::write(self.path(name), bytes).with_context(|| name.to_owned())
    }

    /// Removes files and folders that may be there.
    pub(super) fn remove(&self, names: &[&str]) -> Result<()> {
        for path in names.iter().map(|name| self.path(name)) {
            if path.is_dir() {
                fs::remove_dir_all(path)?;
            } else if path.exists() {
                fs::remove_file(path)?;
            }
        }
        Ok(())
    }

    /// Files that were begun and not finished, here and in the folders below.
    pub(super) fn unfinished(&self) -> Vec<PathBuf> {
        let mut found = Vec::new();
        unfinished(self.folder.path(), &mut found);
        found
    }

    /// The one file of a folder with an extension.
    pub(super) fn only(&self, folder: &str, extension: &str) -> Result<PathBuf> {
        let mut entries = fs::read_dir(self.path(folder))?.filter_map(|entry| Some(entry.ok()?.path()));
        let found = entries.find(|path| path.extension().is_some_and(|e| e == extension));
        found.with_context(|| format!("{folder}: no .{extension}"))
    }
}

fn unfinished(folder: &Path, found: &mut Vec<PathBuf>) {
    // A folder may go, and a file be renamed, while it is looked at.
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        if entry.file_type().is_ok_and(|kind| kind.is_dir()) {
            unfinished(&entry.path(), found);
        } else if entry.file_name().to_string_lossy().starts_with(UNFINISHED) {
            found.push(entry.path());
        }
    }
}

pub(super) fn run(mut command: Command) -> Result<Output, String> {
    command.output().map_err(|error| format!("the program cannot be started: {error}"))
}

pub(super) fn succeeded(output: &Output) -> Result<(), String> {
    if output.status.success() { Ok(()) } else { Err(format!("{}: {}", output.status, said(output))) }
}

/// Whether it ended with status 2 and an error that holds one of the parts, and did not panic.
pub(super) fn failed(output: &Output, parts: &[&str]) -> Result<(), String> {
    let message = said(output);
    let clean = output.status.code() == Some(2) && message.contains("error: ") && !message.contains("panicked");
    let named = parts.is_empty() || parts.iter().any(|part| message.contains(part));
    if clean && named { Ok(()) } else { Err(format!("{} where an error was due: {message}", output.status)) }
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).trim().replace('\n', " ")
}

/// Makes a link; false where that cannot be done.
#[cfg(unix)]
pub(in crate::stress) fn symlink(to: impl AsRef<Path>, at: &Path) -> bool {
    std::os::unix::fs::symlink(to, at).is_ok()
}

#[cfg(not(unix))]
pub(in crate::stress) fn symlink(_: impl AsRef<Path>, _: &Path) -> bool {
    false
}
