//! A file, and the files it lists.

use std::collections::HashSet;
use std::path::{Path, PathBuf};

use super::document::{Document, Kind, Listed};
use super::ghosts::Ghosts;
use super::join::{Part, join};
use super::{BYTE_ORDER_MARK, lattice, unstructured};
use crate::source::{Files, Source};
use crate::{IngestError, Place};

/// Collections may list collections, but not deeper.
const DEEPEST: usize = 8;

/// What is in a file.
pub(super) enum Contents {
    Parts(Vec<Part>),
    /// No volumes; the error says so.
    Flat(IngestError),
}

/// Reads files, each once.
pub(super) struct Reader<'a> {
    files: &'a mut Files,
    time: Option<usize>,
    seen: HashSet<PathBuf>,
}

impl<'a> Reader<'a> {
    /// A reader of this file and those it lists, at a time step.
    pub(super) fn new(path: &Path, time: Option<usize>, files: &'a mut Files) -> Self {
        let mut reader = Reader { files, time, seen: HashSet::new() };
        reader.first_time(path);
        reader
    }

    /// Whether this file was not read before.
    fn first_time(&mut self, path: &Path) -> bool {
        self.seen.insert(path.canonicalize().unwrap_or_else(|_| path.into()))
    }

    /// Reads a file, which so many others led to.
    pub(super) fn contents(&mut self, mut source: Source, depth: usize) -> Result<Contents, IngestError> {
        if source.bytes.starts_with(BYTE_ORDER_MARK) {
            source.bytes.drain(..BYTE_ORDER_MARK.len());
        }
        let mut document = Document::parse(&source)?;
        match document.kind {
            Kind::Flat => {
                let remedy = "it has no cells with volume: save a grid";
                let place = Place::Byte(document.at);
                Ok(Contents::Flat(source.unsupported(place, "a VTKFile of type", &document.name, remedy)))
            }
            Kind::Parallel => self.pieces(&source, &document, depth).map(Contents::Parts),
            Kind::Blocks => self.blocks(&source, &document.files, depth).map(Contents::Parts),
            Kind::Times => {
                let note = self.select(&source, &mut document)?;
                let mut parts = self.blocks(&source, &document.files, depth)?;
                parts.iter_mut().take(1).for_each(|part| part.mesh.note(note.clone()));
                Ok(Contents::Parts(parts))
            }
            _ => self.data(&source, &mut document, depth).map(Contents::Parts),
        }
    }

    /// The pieces in the file itself.
    fn data(&self, source: &Source, document: &mut Document, depth: usize) -> Result<Vec<Part>, IngestError> {
        let step = self.time.unwrap_or(document.steps.saturating_sub(1));
        if step >= document.steps.max(usize::from(self.time.is_none())) {
            return Err(no_step(source, step, document.steps));
        }
        document.select(step);
        let (mut parts, mut cells) = (Vec::new(), 0);
        for piece in &document.pieces {
            let (mut mesh, extent) = if document.kind != Kind::Unstructured {
                lattice::read(source, document, piece)?
            } else if piece.points > 0 || piece.cells > 0 {
                (unstructured::read(source, document, piece, cells)?, None)
            } else {
                continue;
            };
            cells += mesh.cells.types.len();
            // A file of its own is checked when all is read.
            if depth > 0 {
                mesh.check()?;
            }
            if document.steps > 1 && parts.is_empty() {
                mesh.note(format!("time step {step} of {} is read", document.steps));
            }
            let ghosts = Ghosts::take(&mut mesh.fields);
            parts.push(Part { mesh, extent, ghosts });
        }
        Ok(parts)
    }

    /// The pieces in files that make one data set.
    fn pieces(&mut self, source: &Source, document: &Document, depth: usize) -> Result<Vec<Part>, IngestError> {
        let mut parts = Vec::new();
        for listed in &document.files {
            match self.open(source, listed, depth)? {
                Contents::Parts(more) => parts.extend(more),
                Contents::Flat(why) => return Err(within(source, why)),
            }
        }
        Ok(parts)
    }

    /// Data sets in files, each joined to one mesh; those without volumes are left out with a note.
    fn blocks(&mut self, source: &Source, files: &[Listed], depth: usize) -> Result<Vec<Part>, IngestError> {
        let (mut parts, mut flat) = (Vec::new(), Vec::new());
        let mut last = None;
        for listed in files {
            match self.open(source, listed, depth)? {
                Contents::Parts(more) => {
                    let mesh = join(source.path.clone(), more);
                    parts.push(Part { mesh, extent: None, ghosts: Ghosts::default() });
                }
                Contents::Flat(why) => {
                    flat.push(format!("{} has no cells with volume: it is left out", listed.file));
                    last = Some(why);
                }
            }
        }
        match (parts.first_mut(), last) {
            (Some(part), _) => flat.into_iter().for_each(|note| part.mesh.note(note)),
            (None, Some(why)) => return Err(within(source, why)),
            (None, None) => {}
        }
        Ok(parts)
    }

    /// Reads a file that another lists.
    fn open(&mut self, source: &Source, listed: &Listed, depth: usize) -> Result<Contents, IngestError> {
        let place = Place::Byte(listed.at);
        let path = source.path.parent().unwrap_or(Path::new("")).join(&listed.file);
        if depth == DEEPEST {
            let what = format!("files that list files, more than {DEEPEST} deep");
            return Err(source.malformed(place, what, &listed.file, "list the files in one"));
        }
        let file = self.files.open(&path).map_err(|why| within(source, why))?;
        if !self.first_time(&path) {
            let remedy = "each file may be listed once, and none in itself";
            return Err(source.malformed(place, "a file that was listed before", &listed.file, remedy));
        }
        self.contents(file, depth + 1).map_err(|why| within(source, why))
    }

    /// Keeps the files of one time, and says which; within them no step is chosen.
    fn select(&mut self, source: &Source, document: &mut Document) -> Result<String, IngestError> {
        let mut times: Vec<Option<String>> = Vec::new();
        for listed in &document.files {
            // Files of one time follow one another.
            if times.last() != Some(&listed.time) {
                times.push(listed.time.clone());
            }
        }
        let step = self.time.take().unwrap_or(times.len().saturating_sub(1));
        let Some(time) = times.get(step) else { return Err(no_step(source, step, times.len())) };
        document.files.retain(|listed| listed.time == *time);
        Ok(format!("time step {step} of {} is read: {}", times.len(), time.as_deref().unwrap_or("of no time")))
    }
}

fn within(source: &Source, why: IngestError) -> IngestError {
    IngestError::Listed { path: source.path.clone(), source: Box::new(why) }
}

fn no_step(source: &Source, step: usize, steps: usize) -> IngestError {
    IngestError::NoSuchTimeStep { path: source.path.clone(), step: step as u64, count: steps as u64 }
}
