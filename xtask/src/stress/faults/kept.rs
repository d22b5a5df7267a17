//! What is kept between runs, of another version or key, and damaged at every place.

use std::fs;
use std::path::Path;

use anyhow::{Context, Result};
use tetlux_ingest::{Cache, CacheOutcome, Loaded, Miss, ReadOptions, Split, read_cached};
use tetlux_mesh::cache::CacheReader;
use tetlux_tables::{Design, Precision, Store, StoreError, Table, TableKind, TableSpec, measure};

use super::super::Stress;
use super::super::hostile::same;
use super::Row;

/// Of the places of a file every this many are tried in a short run.
const STEP: [usize; 2] = [1, 41];

/// Damage to bytes at one of them, and its name.
type Damage = (&'static str, fn(&[u8], usize) -> Vec<u8>);

const DAMAGES: [Damage; 2] = [
    ("cut", |bytes, at| bytes[..at].to_vec()),
    ("a bit flipped", |bytes, at| {
        let mut bytes = bytes.to_vec();
        bytes[at] ^= 1 << (at % 8);
        bytes
    }),
];

pub(super) fn rows(stress: &Stress) -> Result<Vec<Row>> {
    let step = STEP[usize::from(stress.short)];
    let folder = tempfile::tempdir().context("a folder for what is kept")?;
    let tables = Tables::new(&folder.path().join("tables"))?;
    let meshes = Meshes::new(folder.path())?;
    Ok(vec![tables.damaged(step)?, tables.of_another()?, meshes.damaged(step)?, meshes.of_another()?])
}

fn spec(design: Design) -> TableSpec {
    TableSpec { id: "q".into(), kind: TableKind::Q { design }, size: [14, 12, 1], precision: Precision::F32 }
}

struct Tables {
    store: Store,
    table: Table,
    bytes: Vec<u8>,
}

impl Tables {
    fn new(folder: &Path) -> Result<Tables> {
        let (store, table) = (Store::new(folder), Table::build(&spec(Design::Q))?);
        store.write(&table, &measure(&table)?)?;
        let bytes = fs::read(store.path(table.spec()))?;
        Ok(Tables { store, table, bytes })
    }

    /// Reads what stands in the table's place: the same table, or an error that names the file and the command.
    fn read(&self, bytes: &[u8]) -> Result<Result<(), StoreError>, String> {
        let path = self.store.path(self.table.spec());
        fs::write(&path, bytes).map_err(|error| error.to_string())?;
        match self.store.read(self.table.spec()) {
            Ok(stored) if stored.table == self.table => Ok(Ok(())),
            Ok(_) => Err("another table was believed".into()),
            Err(error) => {
                let message = error.to_string();
                let named =
                    message.contains(&path.display().to_string()) && message.contains("cargo xtask build-tables");
                if named { Ok(Err(error)) } else { Err(format!("no file or no remedy is named: {message}")) }
            }
        }
    }

    fn damaged(&self, step: usize) -> Result<Row> {
        let mut row = Row::new("a table cut, or a bit of it flipped, at every byte");
        let mut unread = 0;
        for (what, damage) in DAMAGES {
            for at in (0..self.bytes.len()).step_by(step) {
                let read = self.read(&damage(&self.bytes, at)).map_err(|failure| format!("{what} at {at}: {failure}"));
                unread += usize::from(matches!(read, Ok(Ok(()))));
                row.add(read.map(|_| ()));
            }
        }
        row.outcome = format!(
            "an error that names the file and the command that builds it anew; {unread} changed what nothing reads, and the \
             table is the same bit for bit"
        );
        Ok(row)
    }

    fn of_another(&self) -> Result<Row> {
        let mut row = Row::new("a table of another version, or of another key");
        let replaced = |from: &str, to: &str| -> Result<Vec<u8>> {
            let at =
                self.bytes.windows(from.len()).position(|w| w == from.as_bytes()).context("the metadata is plain")?;
            let mut bytes = self.bytes.clone();
            bytes[at..at + to.len()].copy_from_slice(to.as_bytes());
            Ok(bytes)
        };
        for name in ["schema", "generator"] {
            let read = self.read(&replaced(&format!("\"{name}\":1"), &format!("\"{name}\":7"))?);
            row.add(match read {
                Ok(Err(StoreError::Version { .. })) => Ok(()),
                read => Err(format!("{name} 7: {read:?}")),
            });
        }
        let other = Table::build(&spec(Design::R4))?;
        self.store.write(&other, &measure(&other)?)?;
        let read = self.read(&fs::read(self.store.path(other.spec()))?);
        row.add(match read {
            Ok(Err(StoreError::Key { .. })) => Ok(()),
            read => Err(format!("another key: {read:?}")),
        });
        row.outcome = "an error that says which, and names the command that builds it anew".into();
        Ok(row)
    }
}

struct Meshes {
    source: std::path::PathBuf,
    cache: Cache,
    whole: Loaded,
    entry: std::path::PathBuf,
    bytes: Vec<u8>,
}

impl Meshes {
    fn new(folder: &Path) -> Result<Meshes> {
        let source = folder.join("small.vtk");
        let values: String = (0..8).map(|i| format!("{i}.5 ")).collect();
        fs::write(
            &source,
            format!(
                "# vtk DataFile Version 3.0\nsmall\nASCII\nDATASET STRUCTURED_POINTS\nDIMENSIONS 2 2 2\nORIGIN 0 0 0\n\
                 SPACING 1 1 1\nPOINT_DATA 8\nSCALARS f double\nLOOKUP_TABLE default\n{values}\n"
            ),
        )?;
        let cache = Cache { least_cells: 1, ..Cache::in_folder(folder.join("cache")) };
        let whole = read_cached(&source, &ReadOptions::default(), Split::Six, Some(&cache))?;
        let entry = cache.entries()?.into_iter().next().context("the mesh is kept")?.path;
        let bytes = fs::read(&entry)?;
        Ok(Meshes { source, cache, whole, entry, bytes })
    }

    /// Reads by way of what stands in the kept mesh's place: the mesh is right whatever that is.
    fn read(&self, bytes: &[u8]) -> Result<CacheOutcome, String> {
        fs::write(&self.entry, bytes).map_err(|error| error.to_string())?;
        let loaded = read_cached(&self.source, &ReadOptions::default(), Split::Six, Some(&self.cache));
        let loaded = loaded.map_err(|error| format!("an error: {error}"))?;
        if same(&loaded.mesh, &self.whole.mesh) { Ok(loaded.outcome) } else { Err("another mesh was believed".into()) }
    }

    fn damaged(&self, step: usize) -> Result<Row> {
        let mut row = Row::new("a kept mesh cut, or a bit of it flipped, at every byte");
        for (what, damage) in DAMAGES {
            for at in (0..self.bytes.len()).step_by(step) {
                let held = match self.read(&damage(&self.bytes, at)) {
                    Ok(CacheOutcome::Stored(_)) => Ok(()),
                    Ok(outcome) => Err(format!("it was {outcome}")),
                    Err(failure) => Err(failure),
                };
                row.add(held.map_err(|failure| format!("{what} at {at}: {failure}")));
            }
        }
        row.outcome = "made anew, and kept anew; the mesh is the same bit for bit".into();
        Ok(row)
    }

    fn of_another(&self) -> Result<Row> {
        let mut row = Row::new("a kept mesh of another version, layout or file");
        let mut layout = self.bytes.clone();
        // The schema's place, behind the magic.
        layout[8] ^= 0x40;
        let origin = CacheReader::new(&self.bytes[..]).map_err(anyhow::Error::msg)?.origin().clone();
        let forged = |change: fn(&mut tetlux_mesh::cache::Origin)| -> Result<Vec<u8>> {
            let (mut origin, mut bytes) = (origin.clone(), Vec::new());
            change(&mut origin);
            self.whole.mesh.write_cache(&origin, &mut bytes)?;
            Ok(bytes)
        };
        let version = forged(|origin| origin.maker = "tetlux 0.0.0, readers 1".into())?;
        let options = forged(|origin| origin.options.push('x'))?;
        let content = forged(|origin| {
            origin.sources.iter_mut().for_each(|source| (source.stamp, source.hash[0]) = ([0; 6], !source.hash[0]));
        })?;
        for (bytes, expected) in [
            (layout, Miss::Unfit(tetlux_mesh::cache::CacheMiss::Schema)),
            (version, Miss::Version),
            (options, Miss::Absent),
            (content, Miss::Changed(self.source.display().to_string())),
        ] {
            row.add(match self.read(&bytes) {
                Ok(CacheOutcome::Stored(miss)) if miss == expected => Ok(()),
                read => Err(format!("{read:?} where {expected:?} was due")),
            });
        }
        // And as it was, it is used.
        row.add(match self.read(&self.bytes) {
            Ok(CacheOutcome::Hit) => Ok(()),
            read => Err(format!("{read:?} of what is right")),
        });
        row.outcome = "told, made anew and kept anew; as it was, it is used".into();
        Ok(row)
    }
}
