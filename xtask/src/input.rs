//! Scene, mesh and flags, as `render`, `compare` and `order` take them.

use std::path::{Path, PathBuf};

use anyhow::{Result, bail};
use clap::Args;
use glam::DVec3;
use tetlux_ingest::{CacheOutcome, Extras, Surface, TetMesh};
use tetlux_mesh::Field;
use tetlux_mesh::procedural::{self, Split};
use tetlux_order::Facts;
use tetlux_render::Model;
use tetlux_scene::{
    Backend, CellProjection, Classification, FieldSpec, Integrator, Interpolation, Order, Plan, Projection, Scene,
    SceneFile, Skip, SurfaceSpec, TablePrecision, Target, TransferSource, UnitDistance,
};

use crate::mesh_args::MeshArgs;
use crate::progress;

/// Flags override the scene file.
#[derive(Args, Clone, Default)]
#[command(next_help_heading = "Scene (flags override the scene file)")]
pub(crate) struct SceneArgs {
    /// Mesh file (see docs/formats.md)
    #[arg(long, value_name = "FILE")]
    pub(crate) mesh: Option<PathBuf>,
    /// A box of N x N x N cubes, six tetrahedra each, instead of a file
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=200), conflicts_with = "mesh")]
    pub(crate) grid: Option<u32>,
    /// Field to show
    #[arg(long, value_name = "NAME")]
    pub(crate) field: Option<String>,
    /// Component of a vector field, from 0; default its magnitude
    #[arg(long, value_name = "I")]
    pub(crate) component: Option<usize>,
    /// Field of the opacity, where it is another than the colour's
    #[arg(long, value_name = "NAME")]
    pub(crate) opacity_field: Option<String>,
    /// Component of the opacity's field, from 0; default its magnitude
    #[arg(long, value_name = "I", requires = "opacity_field")]
    pub(crate) opacity_component: Option<usize>,
    /// Second axis of widgets and of image functions [default: the magnitude of the field's gradient]
    #[arg(long, value_name = "NAME", conflicts_with = "opacity_field")]
    pub(crate) second_field: Option<String>,
    /// Component of the second axis, from 0; default its magnitude
    #[arg(long, value_name = "I", requires = "second_field")]
    pub(crate) second_component: Option<usize>,
    /// Opaque surface in the volume (OBJ, STL), in grey and in the scene's light; may be repeated
    #[arg(long, value_name = "FILE")]
    pub(crate) surface: Vec<PathBuf>,
    /// Which of the scene's cameras, from 0
    #[arg(long, value_name = "I", default_value_t = 0)]
    pub(crate) camera: usize,
    /// Look along parallel rays: half the picture's height in world units
    #[arg(long, value_name = "LENGTH")]
    pub(crate) parallel_scale: Option<f64>,
    /// Picture size in pixels, such as 800x800
    #[arg(long, value_name = "WxH", value_parser = parse_size)]
    pub(crate) size: Option<[u32; 2]>,
    /// World length over which opacity 1 is optical depth 1
    #[arg(long, value_name = "LENGTH")]
    pub(crate) unit_distance: Option<f64>,
    /// auto, gpu or cpu
    #[arg(long, value_name = "NAME")]
    pub(crate) backend: Option<Backend>,
    /// auto, none, centroid, power, mpvo, mpvonc, exact or pixel
    #[arg(long, value_name = "NAME")]
    pub(crate) order: Option<Order>,
    /// How cells become fragments: auto, pt, gator, vicp, balanced, march or tiles
    #[arg(long, value_name = "NAME")]
    pub(crate) projection: Option<CellProjection>,
    /// How fragments come by their segments: auto, ray, perspective or screen-linear
    #[arg(long, value_name = "NAME")]
    pub(crate) interpolation: Option<Interpolation>,
    /// auto, average, linear, psi, q, direct, symmetric, preint, preint-log or preint-q; for widgets and images adaptive,
    /// analytic or approximate
    #[arg(long, value_name = "NAME")]
    pub(crate) integrator: Option<Integrator>,
    /// auto, vertex, post-exact or post-clip
    #[arg(long, value_name = "NAME")]
    pub(crate) classification: Option<Classification>,
    /// Format of tables: auto, u8, u16, f16 or f32
    #[arg(long, value_name = "NAME")]
    pub(crate) table_precision: Option<TablePrecision>,
    /// auto, rgba8, rgba8-dither, rgba16f or rgba32f
    #[arg(long, value_name = "NAME")]
    pub(crate) target: Option<Target>,
    /// Equal pieces a segment of --integrator approximate, 1 to 1000 [default: 10]
    #[arg(long, value_name = "N")]
    pub(crate) pieces: Option<u32>,
    /// Largest error of a pixel, linear: what the plan chooses keeps to it, and `compare` checks it [default: 1e-3]
    #[arg(long, value_name = "E")]
    pub(crate) max_error: Option<f64>,
    /// Do what the scene does not need, to measure what skipping it saves; may be repeated (--explain lists the names)
    #[arg(long, value_name = "NAME")]
    pub(crate) no_skip: Vec<Skip>,
    /// Write composited values to the PNG as they are, as ParaView does
    #[arg(long)]
    pub(crate) display_space: bool,
    #[command(flatten)]
    pub(crate) file: MeshArgs,
}

/// What is rendered.
pub(crate) struct Input {
    /// Short name, for output files.
    pub(crate) name: String,
    pub(crate) title: String,
    pub(crate) mesh: TetMesh,
    pub(crate) scene: Scene,
    pub(crate) display_space: bool,
    /// What is kept beside the mesh between runs.
    pub(crate) extras: Option<Extras>,
    /// The integrator is one of the command line, not of the scene.
    pub(crate) integrator_forced: bool,
}

/// Under which the facts of a mesh are kept beside it.
const FACTS: &str = "order-facts";

impl Input {
    /// The mesh with what was found of it in an earlier run, as far as the plan needs it.
    pub(crate) fn model(&self, plan: &Plan) -> Model<'_> {
        let bytes = if plan.order.needs_facts() { self.extras.as_ref().and_then(|e| e.get(FACTS)) } else { None };
        match bytes.and_then(|bytes| Facts::from_bytes(&bytes, &self.mesh)) {
            Some(facts) => Model::with_facts(&self.mesh, facts),
            None => Model::new(&self.mesh),
        }
    }

    /// Keeps what was found of the mesh for later runs; that it cannot be kept is no fault of the picture's.
    pub(crate) fn keep(&self, model: &Model) {
        if let (Some(extras), Some(facts)) = (&self.extras, model.found_facts()) {
            let _ = extras.store(FACTS, &facts.to_bytes());
        }
    }
}

/// The scene of a mesh that comes without one.
const DEFAULT: &str = include_str!("../../scenes/default.toml");
/// The scene that is rendered where nothing is named.
pub(crate) const BUILT_IN: &str = include_str!("../../scenes/wing.toml");
/// Tetrahedra of its mesh.
const BUILT_IN_CELLS: usize = 100_000;
const BUILT_IN_SEED: u64 = 1;

impl SceneArgs {
    /// Reads a scene and its mesh. `path` is a scene file, or a mesh to be shown with the default scene; without one,
    /// and without a mesh among the flags, it is the built-in scene.
    pub(crate) fn load(&self, path: Option<&Path>) -> Result<Input> {
        if let Some(n) = self.grid {
            if let Some(path) = path {
                bail!("{}: --grid takes the place of a file: leave one of them out", path.display());
            }
            let mesh = progress::during("making the grid", || grid(n as usize))?;
            let mut file = SceneFile::parse("the default scene", DEFAULT)?;
            self.override_scene(&mut file)?;
            return self.bind(format!("grid-{n}"), file, mesh);
        }
        let is_scene = path.is_some_and(is_scene);
        let mesh = if is_scene { None } else { path.or(self.mesh.as_deref()) };
        let (name, mut file) = match (path, mesh) {
            (Some(scene), None) => (stem(scene), SceneFile::read(scene)?),
            (_, Some(mesh)) => (stem(mesh), SceneFile::parse("the default scene", DEFAULT)?),
            (None, None) => ("wing".to_string(), SceneFile::parse("the built-in scene", BUILT_IN)?),
        };
        if let (Some(path), Some(flag)) = (path.filter(|_| !is_scene), &self.mesh) {
            bail!("two meshes are given, {} and {}: keep one of them", path.display(), flag.display());
        }
        self.override_scene(&mut file)?;
        let mesh_path = mesh.map(Path::to_path_buf).or(file.mesh.clone());
        let mut extras = None;
        let mesh = match mesh_path {
            None if path.is_none() || file.built_in => {
                if let Some(flag) = self.file.of_a_file() {
                    bail!("{flag} is for a mesh file, and none is named: name one, or leave the flag out");
                }
                progress::during("making the built-in mesh", || wing(BUILT_IN_CELLS))?
            }
            None => bail!(
                "{}: the scene names no mesh: give one with --mesh FILE, or path = \"...\" or built_in = true under [mesh]",
                file.name
            ),
            Some(path) => {
                let loaded = self.file.load(&path, file.solution.clone(), file.split)?;
                if !matches!(loaded.outcome, CacheOutcome::Off | CacheOutcome::Small) {
                    say!("mesh cache: {}", loaded.outcome);
                }
                extras = loaded.extras;
                loaded.mesh
            }
        };
        if mesh.fields().is_empty() {
            bail!("{name}: the mesh has no fields to show (a PLOT3D grid needs its --solution)");
        }
        if path.is_none() || !is_scene {
            // The first field, as other programs do; the report says which.
            file.field = file.field.or_else(|| mesh.fields().first().map(|f| f.name.clone()));
        }
        Ok(Input { extras, ..self.bind(name, file, mesh)? })
    }

    /// The mesh file that [`load`](Self::load) would read.
    pub(crate) fn mesh_path(&self, path: Option<&Path>) -> Result<Option<PathBuf>> {
        Ok(match path.filter(|p| is_scene(p)) {
            Some(scene) => self.mesh.clone().or(SceneFile::read(scene)?.mesh),
            None => path.map(Path::to_path_buf).or(self.mesh.clone()),
        })
    }

    /// A scene, which flags have overridden, on a mesh.
    pub(crate) fn bind(&self, name: String, mut file: SceneFile, mesh: TetMesh) -> Result<Input> {
        let integrator_forced = self.integrator.is_some();
        let surfaces = std::mem::take(&mut file.surfaces);
        let mut scene = file.scene(&mesh, self.camera)?;
        for spec in surfaces {
            let Surface { points, triangles, notes, .. } =
                progress::during("reading the surface", || Surface::read(&spec.path))?;
            notes.iter().for_each(|note| say!("{}: {note}", spec.path.display()));
            scene.surfaces.push(spec.on(&mesh, &points, triangles)?);
        }
        if let Some(parallel_scale) = self.parallel_scale {
            scene.camera.projection = Projection::Orthographic { parallel_scale };
        }
        Ok(Input {
            name,
            title: file.title,
            mesh,
            scene,
            display_space: file.display_space,
            extras: None,
            integrator_forced,
        })
    }

    /// Sets what flags say.
    pub(crate) fn override_scene(&self, file: &mut SceneFile) -> Result<()> {
        for (flag, value) in [
            ("--unit-distance", self.unit_distance),
            ("--max-error", self.max_error),
            ("--parallel-scale", self.parallel_scale),
        ] {
            if let Some(value) = value
                && !(value > 0.0 && value.is_finite())
            {
                bail!("{flag}: {value} must be positive and finite");
            }
        }
        if self.mesh.is_some() {
            // A solution belongs to its grid.
            (file.mesh, file.solution) = (self.mesh.clone(), None);
        }
        file.solution = self.file.solution.clone().or(file.solution.take());
        file.split = self.file.split.or(file.split);
        if self.field.is_some() {
            (file.field, file.component) = (self.field.clone(), None);
        }
        file.component = self.component.or(file.component);
        let bivariate = matches!(file.transfer, TransferSource::Widgets(_) | TransferSource::Image { .. });
        match (&self.opacity_field, &self.second_field) {
            (Some(_), _) if bivariate => {
                bail!("{}: --opacity-field is for transfer functions of one field: give --second-field", file.name)
            }
            (_, Some(_)) if !bivariate => {
                bail!("{}: --second-field is for widgets and images: give --opacity-field", file.name)
            }
            (Some(name), _) => {
                file.second = Some(FieldSpec { name: name.clone(), component: self.opacity_component });
            }
            (_, Some(name)) => file.second = Some(FieldSpec { name: name.clone(), component: self.second_component }),
            (None, None) => {}
        }
        file.surfaces.extend(self.surface.iter().map(|path| SurfaceSpec::new(path.clone(), file.light)));
        file.size = self.size.unwrap_or(file.size);
        file.unit_distance = self.unit_distance.map_or(file.unit_distance, UnitDistance::Length);
        file.display_space |= self.display_space;
        let method = &mut file.method;
        method.backend = self.backend.unwrap_or(method.backend);
        method.order = self.order.unwrap_or(method.order);
        method.projection = self.projection.unwrap_or(method.projection);
        method.interpolation = self.interpolation.unwrap_or(method.interpolation);
        method.integrator = self.integrator.unwrap_or(method.integrator);
        method.classification = self.classification.unwrap_or(method.classification);
        method.table_precision = self.table_precision.unwrap_or(method.table_precision);
        method.target = self.target.unwrap_or(method.target);
        method.pieces = self.pieces.or(method.pieces);
        method.max_error = self.max_error.unwrap_or(method.max_error);
        method.no_skip = self.no_skip.iter().copied().collect();
        Ok(())
    }
}

/// The mesh of the built-in scene, of about so many cells.
pub(crate) fn wing(cells: usize) -> Result<TetMesh> {
    let wing = procedural::wing(BUILT_IN_SEED, cells);
    Ok(TetMesh::assemble(&wing.parts.points, &wing.parts.cells, vec![wing.field])?)
}

fn grid(n: usize) -> Result<TetMesh> {
    let parts = procedural::cuboid([n; 3], Split::Six, [DVec3::ZERO, DVec3::ONE]);
    let distance = Field::point("distance", 1, parts.sample(|p| p.distance(DVec3::new(0.4, 0.5, 0.6))));
    Ok(TetMesh::assemble(&parts.points, &parts.cells, vec![distance])?)
}

/// Whether a path names a scene, and no mesh.
pub(crate) fn is_scene(path: &Path) -> bool {
    path.extension().is_some_and(|e| e.eq_ignore_ascii_case("toml"))
}

/// The name of a file without its extension.
pub(crate) fn stem(path: &Path) -> String {
    path.file_stem().map_or_else(|| "picture".into(), |s| s.to_string_lossy().into_owned())
}

pub(crate) fn parse_size(text: &str) -> Result<[u32; 2], String> {
    let sides = text.split_once('x').and_then(|(w, h)| Some([w.parse().ok()?, h.parse().ok()?]));
    match sides {
        Some(size) if size.iter().all(|n| (1..=tetlux_image::MAX_SIDE).contains(n)) => Ok(size),
        _ => Err(format!("\"{text}\" is not a size such as 800x800, each side 1 to {}", tetlux_image::MAX_SIDE)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes() {
        assert_eq!(parse_size("640x480"), Ok([640, 480]));
        for bad in ["640", "0x5", "5x0", "x", "axb", "99999x1", "-1x2"] {
            assert!(parse_size(bad).is_err(), "{bad}");
        }
    }
}
