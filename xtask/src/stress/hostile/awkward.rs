//! Paths that are unusual, and what is at them no file, or not for long.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::atomic::{AtomicBool, Ordering};

use anyhow::{Context, Result};

use super::formats::FORMATS;
use super::judge::{Judge, Kind, Verdict};
use super::random::Random;
use super::worker::Meter;
use crate::stress::faults::program::symlink;

pub(super) const NAME: &str = "awkward paths";

pub(super) const WHAT: &str = "every kind of reader on names with spaces, in other scripts, with quotes and line ends, of 240 \
    bytes, without an extension, deep in folders (all must be read); on a folder, a pipe, a device without an end, an empty \
    file, a link to nothing and one to itself (all must be refused, the file by its name); and a mesh that another thread \
    cuts short again and again while it is read";

/// The kinds of readers, each by a format that has it.
const READERS: [&str; 6] = ["VTK XML", "STL", "ParaView preset", "image function, EXR", "image function, PNG", "scene"];

/// Names of files that must be read.
const NAMES: [&str; 6] =
    ["with spaces in it", "Größe τ → 体積", "quotes ' \" and\nlines", "a.b.c", "-n", "deep/er/and/deeper/a"];

/// A name as long as file systems take them, and one that is too long for any.
const LONG: usize = 240;
const TOO_LONG: usize = 300;

/// Times that a file is read while it is cut.
const CUTS: [usize; 2] = [200, 20];

/// A path, and whether what is there must be read.
struct Case {
    reader: usize,
    path: PathBuf,
    readable: bool,
}

pub(super) struct Paths {
    judges: Vec<Judge>,
    cases: Vec<Case>,
    /// A mesh, and its bytes, that is cut while it is read.
    cut: (PathBuf, Vec<u8>),
}

/// The number of cases.
pub(super) fn count(short: bool) -> usize {
    READERS.len() * (good_names("x").len() + NOT_FILES.len() + 1) + CUTS[usize::from(short)]
}

/// What is no file, and how it comes to be at a path; false where the system has no such thing.
type NotFile = (&'static str, fn(&Path) -> bool);

const NOT_FILES: [NotFile; 7] = [
    ("folder", |path| fs::create_dir(path).is_ok()),
    ("pipe", |path| Command::new("mkfifo").arg(path).status().is_ok_and(|status| status.success())),
    ("zeros", |path| Path::new("/dev/zero").exists() && symlink("/dev/zero", path)),
    ("random", |path| Path::new("/dev/urandom").exists() && symlink("/dev/urandom", path)),
    ("empty", |path| fs::write(path, "").is_ok()),
    ("nothing", |path| symlink("not there", path)),
    ("itself", |path| path.file_name().is_some_and(|name| symlink(name, path))),
];

fn good_names(extension: &str) -> Vec<String> {
    let with = |name: String| format!("{name}.{extension}");
    let mut names: Vec<String> = NAMES.iter().map(|name| with((*name).to_owned())).collect();
    names.push(with("x".repeat(LONG - 1 - extension.len())));
    // Content decides.
    names.push("without extension".into());
    names
}

impl Paths {
    pub(super) fn new(folder: &Path) -> Result<Paths> {
        let (mut judges, mut cases, mut cut) = (Vec::new(), Vec::new(), None);
        for (reader, name) in READERS.into_iter().enumerate() {
            let format = FORMATS.iter().find(|format| format.name == name).context("the formats have it")?;
            let folder = folder.join(reader.to_string());
            fs::create_dir(&folder)?;
            let seeds = format.seeds(&folder)?;
            // The one that needs no other file.
            let seed = seeds.iter().find(|seed| !seed.path.ends_with("blocks.vtm")).context("there are files")?;
            let extension = seed.path.extension().unwrap_or_default().to_string_lossy().into_owned();
            for name in good_names(&extension) {
                let path = folder.join(name);
                fs::create_dir_all(path.parent().unwrap_or(&folder))?;
                // What a system does not take for a name cannot be read there.
                let readable = fs::write(&path, &seed.bytes).is_ok();
                cases.push(Case { reader, path, readable });
            }
            for (what, make) in NOT_FILES {
                let path = folder.join(format!("{what}.{extension}"));
                make(&path);
                cases.push(Case { reader, path, readable: false });
            }
            let path = folder.join("y".repeat(TOO_LONG)).with_extension(extension);
            cases.push(Case { reader, path, readable: false });
            judges.push(Judge::new(format.kind, &folder)?);
            if format.kind == Kind::Mesh {
                cut = Some((folder.join("cut.vtu"), seed.bytes.clone()));
            }
        }
        Ok(Paths { judges, cases, cut: cut.context("a mesh is among the readers")? })
    }

    pub(super) fn judge(&self, case: usize, meter: &mut Meter) -> Result<Verdict, String> {
        let Some(Case { reader, path, readable }) = self.cases.get(case) else {
            return self.judge_cut(case, meter);
        };
        match (self.judges[*reader].judge(path, meter)?, readable) {
            (Verdict::Refused, true) => Err(format!("{} is whole, and was refused", path.display())),
            (Verdict::Accepted, false) => Err(format!("{} is no file, and was read", path.display())),
            (verdict, _) => Ok(verdict),
        }
    }

    /// Reads a file that is cut, written and cut again meanwhile.
    fn judge_cut(&self, case: usize, meter: &mut Meter) -> Result<Verdict, String> {
        let ((path, bytes), done) = (&self.cut, AtomicBool::new(false));
        let mut random = Random::new(case as u64);
        std::thread::scope(|scope| {
            scope.spawn(|| {
                while !done.load(Ordering::Relaxed) {
                    // What does not succeed is not there to be read.
                    let _ = fs::write(path, bytes);
                    let length = random.below(bytes.len()) as u64;
                    let _ = fs::File::options().write(true).open(path).and_then(|file| file.set_len(length));
                }
            });
            let verdict = self.judges[0].judge(path, meter);
            done.store(true, Ordering::Relaxed);
            verdict
        })
    }
}
