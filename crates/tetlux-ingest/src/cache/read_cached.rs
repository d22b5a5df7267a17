//! Reading a mesh by way of the cache.

use std::fmt;
use std::fs::{self, File};
use std::io::{self, Read};
use std::path::{Path, PathBuf};

use tetlux_mesh::TetMesh;
use tetlux_mesh::cache::{CacheMiss, Origin, SourceFile};
use tetlux_mesh::procedural::Split;

use super::folder::{Cache, note_use, open};
use super::stamp;
use crate::read::read_files;
use crate::source::Files;
use crate::{IngestError, ReadOptions};

/// Raised whenever another mesh may come of the same files and options: a test compares what comes of all test files.
pub(crate) const READERS: u32 = 1;

/// A mesh, and what was found when its files were read, now or earlier.
#[derive(Debug)]
pub struct Loaded {
    /// The mesh.
    pub mesh: TetMesh,
    /// Cells of each type in the files: see [`MixedMesh::cell_counts`](crate::MixedMesh::cell_counts).
    pub cell_counts: Vec<(String, u64)>,
    /// What the readers passed over or left out, a sentence each.
    pub notes: Vec<String>,
    /// How the mesh was had.
    pub outcome: CacheOutcome,
    /// Where other things can be stored beside the mesh; `None` if it is not stored.
    pub extras: Option<Extras>,
}

/// How a mesh was had.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum CacheOutcome {
    /// From the cache.
    Hit,
    /// From its files, for this reason; it is stored now.
    Stored(Miss),
    /// From its files; too small to be stored.
    Small,
    /// From its files; it could not be stored, for this reason.
    NotStored(String),
    /// From its files: no cache was given.
    Off,
}

/// Why a mesh was not had from the cache.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum Miss {
    /// It was not stored, with these options.
    #[error("it was not stored before")]
    Absent,
    /// What is stored cannot be used.
    #[error("the stored mesh is not used: {0}")]
    Unfit(CacheMiss),
    /// Another version made it.
    #[error("another version of tetlux stored it")]
    Version,
    /// A file is not what it was.
    #[error("{0} has changed")]
    Changed(String),
}

impl fmt::Display for CacheOutcome {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            CacheOutcome::Hit => write!(f, "used"),
            CacheOutcome::Stored(Miss::Absent) => write!(f, "stored"),
            CacheOutcome::Stored(miss) => write!(f, "stored anew: {miss}"),
            CacheOutcome::Small => write!(f, "not used for so small a mesh"),
            CacheOutcome::NotStored(why) => write!(f, "cannot be used: {why}"),
            CacheOutcome::Off => write!(f, "not used"),
        }
    }
}

/// Reads a file and makes tetrahedra of its cells, as [`read_tet_mesh`](crate::read_tet_mesh), or has the mesh from the
/// cache if it is there and every file is what it was; else stores it if it is large enough.
///
/// Whatever is wrong with the cache is told by [`Loaded::outcome`], and never an error.
pub fn read_cached(
    path: &Path,
    options: &ReadOptions,
    split: Split,
    cache: Option<&Cache>,
) -> Result<Loaded, IngestError> {
    let Some(cache) = cache else { return read_anew(path, options, split, None).map(|(loaded, _)| loaded) };
    let Some(key) = key(path, options, split) else {
        let (mut loaded, _) = read_anew(path, options, split, None)?;
        loaded.outcome = CacheOutcome::NotStored("the path is no valid text".into());
        return Ok(loaded);
    };
    match load(cache, &key) {
        Ok(loaded) => Ok(loaded),
        Err(miss) => {
            let (mut loaded, sources) = read_anew(path, options, split, Some(Vec::new()))?;
            store(cache, key, sources, miss, &mut loaded);
            Ok(loaded)
        }
    }
}

/// What is stored beside a mesh, such as what was found of it at some cost: gone, or not found, once the mesh is another.
#[derive(Debug)]
pub struct Extras {
    cache: Cache,
    key: String,
    /// Of the mesh that is stored there.
    identity: [u8; 32],
}

impl Extras {
    /// What was stored under a name; `None` if there is nothing of just this mesh.
    pub fn get(&self, name: &str) -> Option<Vec<u8>> {
        let bytes = fs::read(self.path(name)?).ok()?;
        let (hash, content) = bytes.split_at_checked(32)?;
        (self.hash(content).as_bytes() == hash).then(|| content.to_vec())
    }

    /// Stores something in place of what is there of this name; false if the name has other than letters, digits and
    /// hyphens.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn store(&self, name: &str, content: &[u8]) -> io::Result<bool> {
        let Some(path) = self.path(name) else { return Ok(false) };
        self.cache.store(&path, |file| {
            file.write_all(self.hash(content).as_bytes())?;
            file.write_all(content)
        })?;
        Ok(true)
    }

    fn path(&self, name: &str) -> Option<PathBuf> {
        let plain = !name.is_empty() && name.bytes().all(|b| b.is_ascii_alphanumeric() || b == b'-');
        plain.then(|| self.cache.extra_path(&self.key, name))
    }

    /// The hash of something that belongs to the mesh.
    fn hash(&self, content: &[u8]) -> blake3::Hash {
        blake3::Hasher::new_keyed(&self.identity).update(content).finalize()
    }
}

/// All that decides what mesh is meant, but for the files' content; `None` if a path is no text.
fn key(path: &Path, options: &ReadOptions, split: Split) -> Option<String> {
    let absolute = |path: &Path| Some(std::path::absolute(path).ok()?.to_str()?.to_owned());
    let ReadOptions { solution, time, cell_size, expressions } = options;
    let solution = match solution {
        Some(path) => Some(absolute(path)?),
        None => None,
    };
    let expressions: Vec<(&str, &str)> = expressions.iter().map(|(name, e)| (name.as_str(), e.text())).collect();
    let cell_size = cell_size.map(f64::to_bits);
    Some(format!("{:?} {solution:?} {time:?} {cell_size:?} {expressions:?} {split:?}", absolute(path)?))
}

fn maker() -> String {
    format!("tetlux {}, readers {READERS}", env!("CARGO_PKG_VERSION"))
}

fn load(cache: &Cache, key: &str) -> Result<Loaded, Miss> {
    let path = cache.path(key);
    let (reader, length) = open(&path)?;
    let mut origin = reader.origin().clone();
    if origin.options != key {
        return Err(Miss::Absent);
    }
    let newer = up_to_date(&origin)?;
    let mesh = reader.mesh(length).map_err(Miss::Unfit)?;
    let extras = Extras { cache: cache.clone(), key: key.into(), identity: origin.identity() };
    if newer.iter().zip(&origin.sources).any(|(stamp, source)| *stamp != source.stamp) {
        // The content was compared: the next time the stamps will do. If that fails it is compared again.
        newer.into_iter().zip(&mut origin.sources).for_each(|(stamp, source)| source.stamp = stamp);
        let _ = cache.store(&path, |file| mesh.write_cache(&origin, file));
    } else {
        note_use(&path);
    }
    let Origin { cell_counts, notes, .. } = origin;
    Ok(Loaded { mesh, cell_counts, notes, outcome: CacheOutcome::Hit, extras: Some(extras) })
}

/// Whether this version made the mesh and its files are what they were; gives their stamps as they are now, all zero
/// where they cannot be relied on.
pub(super) fn up_to_date(origin: &Origin) -> Result<Vec<[i64; 6]>, Miss> {
    if origin.maker != maker() {
        return Err(Miss::Version);
    }
    origin.sources.iter().map(|source| unchanged(source).ok_or_else(|| Miss::Changed(source.path.clone()))).collect()
}

fn unchanged(source: &SourceFile) -> Option<[i64; 6]> {
    let path = Path::new(&source.path);
    let now = stamp(path).unwrap_or_default();
    let metadata = fs::metadata(path).ok().filter(|m| m.is_file() && m.len() == source.size)?;
    if now == source.stamp && now != <[i64; 6]>::default() {
        return Some(now);
    }
    let mut hasher = blake3::Hasher::new();
    let mut file = File::open(path).ok()?;
    let mut chunk = vec![0; (256 << 10).min(metadata.len().max(1) as usize)];
    loop {
        match file.read(&mut chunk) {
            Ok(0) => break,
            Ok(count) => drop(hasher.update(&chunk[..count])),
            Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
            Err(_) => return None,
        }
    }
    (*hasher.finalize().as_bytes() == source.hash).then_some(now)
}

/// Reads the files, and keeps a record of them if one is wanted.
fn read_anew(
    path: &Path,
    options: &ReadOptions,
    split: Split,
    record: Option<Vec<SourceFile>>,
) -> Result<(Loaded, Option<Vec<SourceFile>>), IngestError> {
    let mut files = Files { record };
    let mut mixed = read_files(path, options, &mut files)?;
    let cell_counts = mixed.cell_counts().into_iter().map(|(name, count)| (name.to_string(), count as u64)).collect();
    let notes = std::mem::take(&mut mixed.notes);
    let mesh = mixed.tetrahedralize(split)?;
    Ok((Loaded { mesh, cell_counts, notes, outcome: CacheOutcome::Off, extras: None }, files.record))
}

fn store(cache: &Cache, key: String, sources: Option<Vec<SourceFile>>, miss: Miss, loaded: &mut Loaded) {
    let Some(sources) = sources else {
        loaded.outcome = CacheOutcome::NotStored("the path of a file is no valid text".into());
        return;
    };
    let mesh = &loaded.mesh;
    if mesh.cells().len() < cache.least_cells {
        loaded.outcome = CacheOutcome::Small;
        return;
    }
    let values: usize = mesh.fields().iter().map(|field| field.values.len()).sum();
    let bytes = size_of_val(mesh.points()) + 2 * size_of_val(mesh.cells()) + size_of::<f64>() * values;
    if bytes as u64 > cache.most_bytes {
        let most = cache.most_bytes;
        loaded.outcome = CacheOutcome::NotStored(format!("the mesh takes {bytes} bytes, and the cache holds {most}"));
        return;
    }
    let (cell_counts, notes) = (loaded.cell_counts.clone(), loaded.notes.clone());
    let origin = Origin { maker: maker(), options: key.clone(), sources, cell_counts, notes };
    loaded.outcome = match cache.store(&cache.path(&key), |file| mesh.write_cache(&origin, file)) {
        Ok(()) => {
            loaded.extras = Some(Extras { cache: cache.clone(), key, identity: origin.identity() });
            CacheOutcome::Stored(miss)
        }
        Err(error) => CacheOutcome::NotStored(format!("{}: {error}", cache.folder.display())),
    };
}
