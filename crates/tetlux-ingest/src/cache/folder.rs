//! The folder that caches lie in.

use std::ffi::OsString;
use std::fs::{self, File};
use std::io::{self, BufReader, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::time::SystemTime;

use tetlux_mesh::cache::CacheReader;

use super::read_cached::{Miss, up_to_date};

/// Extension of stored meshes, and of what is stored beside them.
const MESH: &str = "tetlux-mesh";
const EXTRA: &str = "tetlux-extra";

/// How files begin that are being written.
const UNFINISHED: &str = ".tetlux-cache-";

/// A folder of stored meshes.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Cache {
    /// Where they lie; made when there is something to store.
    pub folder: PathBuf,
    /// Meshes of fewer tetrahedra are not stored: their files are read as fast.
    pub least_cells: usize,
    /// Bytes that all stored meshes may have together: those that were not used for longest are removed.
    pub most_bytes: u64,
}

/// A stored mesh: see [`Cache::entries`].
#[derive(Debug)]
pub struct CacheEntry {
    /// The file it is stored in.
    pub path: PathBuf,
    /// Bytes it takes, with what is stored beside it.
    pub bytes: u64,
    /// When it was written or last used.
    pub used: SystemTime,
    /// The file that was read; `None` if the entry itself cannot be.
    pub source: Option<String>,
    /// Tetrahedra.
    pub cells: u64,
    /// Whether it would be used, or why not.
    pub state: Result<(), Miss>,
}

impl Cache {
    /// The user's cache: in the folder that the environment variable `TETLUX_CACHE_DIR` names, else in `tetlux` in the
    /// platform's folder for caches (`XDG_CACHE_HOME` or `~/.cache`; `~/Library/Caches`; `%LOCALAPPDATA%`). `None` if
    /// none of them is known.
    pub fn of_user() -> Option<Cache> {
        user_folder(|name| std::env::var_os(name)).map(Cache::in_folder)
    }

    /// A cache in a folder, for meshes of 100 000 tetrahedra or more, and of 8 GiB at most.
    pub fn in_folder(folder: impl Into<PathBuf>) -> Cache {
        Cache { folder: folder.into(), least_cells: 100_000, most_bytes: 8 << 30 }
    }

    /// The stored meshes, that which was used last first. No folder is no entries.
    ///
    /// # Errors
    /// If the folder cannot be listed.
    pub fn entries(&self) -> io::Result<Vec<CacheEntry>> {
        let files = self.files()?;
        let beside = |stem: &str| -> u64 { files.iter().filter(|f| f.extra && f.stem == stem).map(|f| f.bytes).sum() };
        let mut entries: Vec<CacheEntry> = files
            .iter()
            .filter(|f| !f.extra)
            .map(|f| {
                let (source, cells, state) = match open(&f.path) {
                    Ok((reader, _)) => {
                        let origin = reader.origin();
                        let source = origin.sources.first().map(|source| source.path.clone());
                        (source, reader.cells(), up_to_date(origin).map(|_| ()))
                    }
                    Err(miss) => (None, 0, Err(miss)),
                };
                let bytes = f.bytes + beside(&f.stem);
                CacheEntry { path: f.path.clone(), bytes, used: f.used, source, cells, state }
            })
            .collect();
        entries.sort_by_key(|entry| std::cmp::Reverse(entry.used));
        Ok(entries)
    }

    /// Removes all that is stored, and nothing else that may lie in the folder; gives the number of meshes and the bytes.
    ///
    /// # Errors
    /// If the folder cannot be listed or a file not be removed.
    pub fn clear(&self) -> io::Result<(usize, u64)> {
        let (mut meshes, mut bytes) = (0, 0);
        for file in self.files()? {
            fs::remove_file(&file.path)?;
            meshes += usize::from(!file.extra);
            bytes += file.bytes;
        }
        Ok((meshes, bytes))
    }

    /// Where the mesh of a key is stored.
    pub(super) fn path(&self, key: &str) -> PathBuf {
        self.folder.join(format!("{}.{MESH}", &blake3::hash(key.as_bytes()).to_hex()[..32]))
    }

    /// Where something is stored beside the mesh of a key.
    pub(super) fn extra_path(&self, key: &str, name: &str) -> PathBuf {
        self.path(key).with_extension(format!("{name}.{EXTRA}"))
    }

    /// Writes a file whole or not at all, readable by the user alone: a mesh may come of a private file.
    pub(super) fn store(&self, path: &Path, write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> io::Result<()> {
        make_folder(&self.folder)?;
        let file = tempfile::Builder::new().prefix(UNFINISHED).tempfile_in(&self.folder)?;
        let mut buffered = BufWriter::with_capacity(1 << 20, file);
        write(&mut buffered)?;
        buffered.into_inner().map_err(io::IntoInnerError::into_error)?.persist(path)?;
        // What cannot be removed now is tried again with the next.
        let _ = self.remove_least_used(path);
        Ok(())
    }

    /// Removes what was not used for longest until the rest is small enough; `kept` stays.
    fn remove_least_used(&self, kept: &Path) -> io::Result<()> {
        let mut files = self.files()?;
        files.sort_by_key(|file| file.used);
        let mut total: u64 = files.iter().map(|file| file.bytes).sum();
        for file in files.iter().filter(|file| file.path != kept) {
            if total <= self.most_bytes {
                break;
            }
            fs::remove_file(&file.path)?;
            total -= file.bytes;
        }
        Ok(())
    }

    /// All files that are ours, those too that a program did not finish writing.
    fn files(&self) -> io::Result<Vec<Stored>> {
        let listing = match fs::read_dir(&self.folder) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(Vec::new()),
            listing => listing?,
        };
        let mut files = Vec::new();
        for entry in listing {
            let entry = entry?;
            let name = entry.file_name();
            let Some(name) = name.to_str() else { continue };
            let (stem, extension) = name.split_once('.').unwrap_or_default();
            let extra = name.starts_with(UNFINISHED) || extension.ends_with(&format!(".{EXTRA}"));
            // Another process may remove a file between listing and asking.
            let Ok(metadata) = entry.metadata() else { continue };
            if metadata.is_file() && (extra || extension == MESH) {
                let used = metadata.modified().unwrap_or(SystemTime::UNIX_EPOCH);
                let (stem, bytes) = (stem.to_owned(), metadata.len());
                files.push(Stored { path: entry.path(), stem, extra, bytes, used });
            }
        }
        Ok(files)
    }
}

/// A file in the folder.
struct Stored {
    path: PathBuf,
    stem: String,
    /// No mesh, but something beside one.
    extra: bool,
    bytes: u64,
    used: SystemTime,
}

/// A stored mesh's header, the rest to be read, and the length of all.
pub(super) fn open(path: &Path) -> Result<(CacheReader<BufReader<File>>, u64), Miss> {
    let file = File::open(path).map_err(|_| Miss::Absent)?;
    let length = file.metadata().map_err(|_| Miss::Absent)?.len();
    let reader = CacheReader::new(BufReader::new(file)).map_err(Miss::Unfit)?;
    Ok((reader, length))
}

/// Notes that a stored mesh was used: it is kept the longer.
pub(super) fn note_use(path: &Path) {
    // Where it cannot be noted the entry counts as old.
    let _ = File::options().append(true).open(path).and_then(|file| file.set_modified(SystemTime::now()));
}

/// The folder and those above it; only the user may look into what is made.
fn make_folder(folder: &Path) -> io::Result<()> {
    let mut builder = fs::DirBuilder::new();
    #[cfg(unix)]
    std::os::unix::fs::DirBuilderExt::mode(&mut builder, 0o700);
    builder.recursive(true).create(folder)
}

/// The folder of the user's cache, by environment variables.
pub(super) fn user_folder(variable: impl Fn(&str) -> Option<OsString>) -> Option<PathBuf> {
    let folder = |name: &str| variable(name).filter(|value| !value.is_empty()).map(PathBuf::from);
    if let Some(folder) = folder("TETLUX_CACHE_DIR") {
        return Some(folder);
    }
    let caches = if cfg!(windows) {
        folder("LOCALAPPDATA")
    } else if cfg!(target_os = "macos") {
        folder("HOME").map(|home| home.join("Library/Caches"))
    } else {
        // The specification has relative paths passed over.
        folder("XDG_CACHE_HOME").filter(|path| path.is_absolute()).or(folder("HOME").map(|home| home.join(".cache")))
    };
    Some(caches?.join("tetlux"))
}
