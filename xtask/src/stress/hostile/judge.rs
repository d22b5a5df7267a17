//! Reads a file as the program would, and judges what comes of it.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use glam::DVec3;
use tetlux_ingest::{Cache, CacheOutcome, ReadOptions, Split, Surface, read, read_cached};
use tetlux_mesh::procedural::cuboid;
use tetlux_mesh::{Field, NONE, TetMesh};
use tetlux_render::{Model, Renderer};
use tetlux_scene::{Backend, Plan, Scene, SceneFile, TransferSource};
use tetlux_tables::{Design, Precision, Store, Table, TableKind, TableSpec, measure};

use super::worker::Meter;
use crate::calibration;

/// Bytes for each byte of a file: its own, its numbers as `f64` (two characters, or one byte, can be a number), and as
/// points and cells.
pub(super) const FOR_EACH: u64 = 16;

/// The same of a compressed picture: deflate gives 1032 bytes for one, and a pixel of one byte is 16 once it is decoded,
/// beside its four channels of a byte.
pub(super) const FOR_EACH_OF_A_PICTURE: u64 = 1032 * (16 + 4);

/// Longest message, in bytes.
const LONGEST_MESSAGE: usize = 2_000;

/// How a file is read.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Mesh,
    Plot3d,
    Surface,
    Preset,
    Image,
    Scene,
    Table,
    Cache,
    Costs,
}

impl Kind {
    /// Where files of the kind lie in a folder of cases.
    pub(super) fn folder(self, folder: &Path) -> PathBuf {
        match self {
            Kind::Table => folder.join("tables"),
            Kind::Cache => folder.join("cache"),
            _ => folder.into(),
        }
    }

    /// Those of the files there that are damaged; none: all.
    pub(super) fn extensions(self) -> &'static [&'static str] {
        match self {
            Kind::Table => &["exr"],
            Kind::Cache => &["tetlux-mesh"],
            _ => &[],
        }
    }
}

/// What a file was.
#[derive(Debug, PartialEq, Eq)]
pub(super) enum Verdict {
    /// Read, and all of it is right.
    Accepted,
    /// An error that names the file; of something kept, it is made anew.
    Refused,
}

/// What files of a kind are judged with.
pub(super) struct Judge {
    kind: Kind,
    folder: PathBuf,
    renderer: Renderer,
    /// Shown by scenes, presets and image functions, and what a kept mesh must be.
    mesh: TetMesh,
    /// With which presets, image functions and meshes are shown.
    scene: SceneFile,
    table: Table,
}

impl Judge {
    pub(super) fn new(kind: Kind, folder: &Path) -> Result<Judge> {
        let mesh = if kind == Kind::Cache { read_tet(&source(folder))? } else { small_mesh()? };
        let text = "[transfer]\nfit_to_field = true\nrelative_unit_distance = 0.2\n\
                    color = [[0, 1, 0.5, 0.2]]\nopacity = [[0, 0], [1, 2]]\n";
        let scene = SceneFile::parse("the scene of hostile input", text)?;
        let (renderer, table) = (Renderer::without_adapter(), Table::build(&spec())?);
        Ok(Judge { kind, folder: folder.into(), renderer, mesh, scene, table })
    }

    pub(super) fn memory_for_each_byte(&self) -> u64 {
        if self.kind == Kind::Image { FOR_EACH_OF_A_PICTURE } else { FOR_EACH }
    }

    /// Reads a file; what is wrong with what came of it is the error.
    pub(super) fn judge(&self, path: &Path, meter: &mut Meter) -> Result<Verdict, String> {
        match self.kind {
            Kind::Mesh => self.mesh(path, &ReadOptions::default(), meter),
            Kind::Plot3d if path.extension().is_some_and(|e| e == "q") => {
                let options = ReadOptions { solution: Some(path.into()), ..ReadOptions::default() };
                self.mesh(&self.folder.join("grid.xyz"), &options, meter)
            }
            Kind::Plot3d => self.mesh(path, &ReadOptions::default(), meter),
            Kind::Surface => self.surface(path, meter),
            Kind::Preset => self.function(path, TransferSource::Preset { path: path.into(), name: None }, meter),
            Kind::Image => {
                let image = TransferSource::Image { path: path.into(), range: None, max_opacity: 2.0 };
                self.function(path, image, meter)
            }
            Kind::Scene => match meter.reading(|| SceneFile::read(path)) {
                Ok(file) => self.shown(&file, &self.mesh),
                Err(error) => refused(&error, path),
            },
            Kind::Table => self.table(path, meter),
            Kind::Cache => self.cache(meter),
            Kind::Costs => {
                let kept = meter.reading(|| calibration::read(path));
                let sound = kept.iter().all(calibration::Kept::is_sound);
                let verdict = if kept.is_empty() { Verdict::Refused } else { Verdict::Accepted };
                if sound { Ok(verdict) } else { Err("costs that cannot be were read".into()) }
            }
        }
    }

    fn mesh(&self, path: &Path, options: &ReadOptions, meter: &mut Meter) -> Result<Verdict, String> {
        let mixed = match meter.reading(|| read(path, options)) {
            Ok(mixed) => mixed,
            Err(error) => return refused(&error, &self.folder),
        };
        let mesh = match mixed.tetrahedralize(Split::Six) {
            Ok(mesh) => mesh,
            Err(error) => return refused(&error, &self.folder),
        };
        sound(&mesh)?;
        if mesh.fields().is_empty() { Ok(Verdict::Accepted) } else { self.shown(&self.scene, &mesh) }
    }

    /// Fills a surface only where that is cheap: by cells of an eighth of it.
    fn surface(&self, path: &Path, meter: &mut Meter) -> Result<Verdict, String> {
        let report = match meter.reading(|| Surface::read(path)) {
            Ok(surface) => surface.report(),
            Err(error) => return refused(&error, path),
        };
        let [low, high] = report.bounds.map(DVec3::from);
        if !(low.is_finite() && high.is_finite()) {
            return Err(format!("the surface reaches from {low} to {high}"));
        }
        let cell_size = Some(low.distance(high) / 8.0).filter(|size| size.is_finite() && *size > 0.0);
        let options = ReadOptions { cell_size, ..ReadOptions::default() };
        // Whatever the surface, its memory is that of the lattice that was asked for.
        self.mesh(path, &options, &mut Meter::default())
    }

    /// A preset or an image function, on the mesh.
    fn function(&self, path: &Path, transfer: TransferSource, meter: &mut Meter) -> Result<Verdict, String> {
        let field = self.mesh.fields().first().map(|field| field.name.clone());
        let file = SceneFile { transfer, field, ..self.scene.clone() };
        match meter.reading(|| file.scene(&self.mesh, 0)) {
            Ok(scene) => self.pictured(scene, &self.mesh),
            Err(error) => refused(&error, path),
        }
    }

    fn table(&self, path: &Path, meter: &mut Meter) -> Result<Verdict, String> {
        let store = Store::new(self.kind.folder(&self.folder));
        match meter.reading(|| store.read(&spec())) {
            Ok(stored) if stored.table == self.table => Ok(Verdict::Accepted),
            Ok(_) => Err("a table that was not written was believed".into()),
            Err(error) if !error.to_string().contains("cargo xtask build-tables") => {
                Err(format!("no remedy is named: {error}"))
            }
            Err(error) => refused(&error, path),
        }
    }

    fn cache(&self, meter: &mut Meter) -> Result<Verdict, String> {
        let cache = cache(&self.folder);
        let (source, options) = (source(&self.folder), ReadOptions::default());
        let loaded = meter
            .reading(|| read_cached(&source, &options, Split::Six, Some(&cache)))
            .map_err(|error| format!("what is kept made an error: {error}"))?;
        if !same(&loaded.mesh, &self.mesh) {
            return Err("a mesh that was not kept was believed".into());
        }
        Ok(if loaded.outcome == CacheOutcome::Hit { Verdict::Accepted } else { Verdict::Refused })
    }

    /// A scene on a mesh; it need not fit.
    fn shown(&self, file: &SceneFile, mesh: &TetMesh) -> Result<Verdict, String> {
        let field = file.field.clone().or(mesh.fields().first().map(|field| field.name.clone()));
        match (SceneFile { field, surfaces: Vec::new(), ..file.clone() }).scene(mesh, 0) {
            Ok(scene) => self.pictured(scene, mesh),
            Err(error) => clean(&error).map(|()| Verdict::Refused),
        }
    }

    /// A small picture by the processor.
    fn pictured(&self, mut scene: Scene, mesh: &TetMesh) -> Result<Verdict, String> {
        scene.size = [12, 8];
        scene.method.backend = Backend::Cpu;
        let plan = match Plan::new(&scene, mesh, None) {
            Ok(plan) => plan,
            Err(error) => return clean(&error).map(|()| Verdict::Refused),
        };
        match self.renderer.render(&scene, &Model::new(mesh), &plan) {
            Ok(frame) if frame.image.pixels().iter().flatten().all(|v| v.is_finite()) => Ok(Verdict::Accepted),
            Ok(_) => Err("a pixel is not finite".into()),
            Err(error) => clean(&error).map(|()| Verdict::Refused),
        }
    }
}

/// An error that names the file, or one in the folder of collections and partners.
fn refused(error: &dyn std::error::Error, path: &Path) -> Result<Verdict, String> {
    clean(error)?;
    let (message, path) = (error.to_string(), path.display().to_string());
    if message.contains(&path) { Ok(Verdict::Refused) } else { Err(format!("{path} is not in: {message}")) }
}

/// A message of moderate length.
fn clean(error: &dyn std::error::Error) -> Result<(), String> {
    let message = error.to_string();
    match message.len() {
        0 => Err("a message of nothing".into()),
        LONGEST_MESSAGE.. => Err(format!("a message of {} bytes: {}", message.len(), message.get(..200).unwrap_or(""))),
        _ => Ok(()),
    }
}

/// Whether all of a mesh is finite and within bounds; the values of fields are data, and may be anything.
fn sound(mesh: &TetMesh) -> Result<(), String> {
    let (points, cells) = (mesh.points().len(), mesh.cells().len());
    let report = mesh.validate();
    let tuples = |field: &Field| if field.location == tetlux_mesh::Location::Point { points } else { cells };
    for (what, sound) in [
        ("points", mesh.origin().is_finite() && mesh.points().iter().all(|p| p.is_finite())),
        ("cells", mesh.cells().iter().flatten().all(|&v| (v as usize) < points)),
        ("neighbors", mesh.neighbors().iter().flatten().all(|&n| n == NONE || (n as usize) < cells)),
        ("fields", mesh.fields().iter().all(|f| f.values.len() == tuples(f) * f.components)),
        ("bounds", report.bounds.iter().flatten().all(|v| v.is_finite())),
        ("volume", report.volume.is_finite() && report.mean_edge_length.is_finite()),
    ] {
        if !sound {
            return Err(format!("a mesh was made whose {what} are not sound"));
        }
    }
    Ok(())
}

/// Whether two meshes are the same, bit for bit.
pub(in crate::stress) fn same(a: &TetMesh, b: &TetMesh) -> bool {
    let fields = |mesh: &TetMesh| -> Vec<(String, Vec<u64>)> {
        mesh.fields().iter().map(|f| (f.name.clone(), f.values.iter().map(|v| v.to_bits()).collect())).collect()
    };
    (a.origin(), a.points(), a.cells(), a.neighbors()) == (b.origin(), b.points(), b.cells(), b.neighbors())
        && a.assembly() == b.assembly()
        && fields(a) == fields(b)
}

/// Cubes with the fields that the scenes name.
fn small_mesh() -> Result<TetMesh> {
    let parts = cuboid([2; 3], Split::Six, [DVec3::splat(-1.0), DVec3::ONE]);
    let field = |name: &str, f: fn(DVec3) -> f64| Field::point(name, 1, parts.sample(f));
    let fields = vec![field("vorticity", |p| 4.0 + 2.0 * p.x + p.y * p.z), field("scalar", |p| 2.5 + p.length())];
    Ok(TetMesh::assemble(&parts.points, &parts.cells, fields)?)
}

fn read_tet(path: &Path) -> Result<TetMesh> {
    Ok(tetlux_ingest::read_tet_mesh(path, &ReadOptions::default(), Split::Six)?)
}

fn spec() -> TableSpec {
    TableSpec { id: "q".into(), kind: TableKind::Q { design: Design::Q }, size: [12, 10, 1], precision: Precision::F32 }
}

pub(super) fn write_table(folder: &Path) -> Result<()> {
    let table = Table::build(&spec())?;
    Store::new(Kind::Table.folder(folder)).write(&table, &measure(&table)?)?;
    Ok(())
}

fn source(folder: &Path) -> PathBuf {
    folder.join("source.vtk")
}

fn cache(folder: &Path) -> Cache {
    Cache { least_cells: 1, ..Cache::in_folder(Kind::Cache.folder(folder)) }
}

pub(super) fn write_cache(folder: &Path) -> Result<()> {
    let values: Vec<String> = (0..27).map(|i| format!("{}", (i * 7 % 11) as f32 / 4.0)).collect();
    let grid = format!(
        "# vtk DataFile Version 3.0\nkept\nASCII\nDATASET STRUCTURED_POINTS\nDIMENSIONS 3 3 3\nORIGIN 0 0 0\n\
         SPACING 1 1 1\nPOINT_DATA 27\nSCALARS f double\nLOOKUP_TABLE default\n{}\n",
        values.join(" ")
    );
    fs::write(source(folder), grid)?;
    let options = ReadOptions::default();
    read_cached(&source(folder), &options, Split::Six, Some(&cache(folder))).context("the mesh to be kept")?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mesh_that_differs_in_a_bit_is_another() {
        let mesh = small_mesh().unwrap();
        assert!(same(&mesh, &mesh.clone()) && sound(&mesh).is_ok());
        let changed = |index: usize| {
            let mut fields = mesh.fields().to_vec();
            fields[index].values[5] = f64::from_bits(fields[index].values[5].to_bits() ^ 1);
            let points: Vec<DVec3> = (0..mesh.points().len() as u32).map(|p| mesh.world(p)).collect();
            TetMesh::assemble(&points, mesh.cells(), fields).unwrap()
        };
        assert!(!same(&mesh, &changed(0)) && !same(&mesh, &changed(1)));
    }

    #[test]
    fn an_error_must_name_its_file_and_be_short() {
        let error = |text: String| std::io::Error::other(text);
        let path = Path::new("folder/file.vtu");
        assert_eq!(refused(&error("folder/file.vtu: is empty".into()), path), Ok(Verdict::Refused));
        assert!(refused(&error("it is empty".into()), path).is_err());
        assert!(refused(&error(format!("folder/file.vtu: {}", "x".repeat(LONGEST_MESSAGE))), path).is_err());
        assert!(clean(&error(String::new())).is_err());
    }

    #[test]
    fn what_is_whole_is_read_and_what_is_not_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        write_table(folder.path()).unwrap();
        let judge = Judge::new(Kind::Table, folder.path()).unwrap();
        let path = Store::new(Kind::Table.folder(folder.path())).path(&spec());
        assert_eq!(judge.judge(&path, &mut Meter::default()), Ok(Verdict::Accepted));
        fs::write(&path, "no table").unwrap();
        assert_eq!(judge.judge(&path, &mut Meter::default()), Ok(Verdict::Refused));
        // A table that is right by its own hash, and not the one that was kept.
        let other = Judge { table: Table::build(&TableSpec { size: [12, 11, 1], ..spec() }).unwrap(), ..judge };
        write_table(folder.path()).unwrap();
        assert!(other.judge(&path, &mut Meter::default()).unwrap_err().contains("was believed"));
    }
}
