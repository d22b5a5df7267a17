//! How time and memory grow with cells and with pixels.

use anyhow::Result;
use serde::Serialize;
use tetlux_mesh::{Field, TetMesh, procedural};
use tetlux_render::Stages;
use tetlux_scene::{Backend, CellProjection, SceneFile};

use super::Bench;
use super::measure::{Cost, Course, Way};
use super::patience::ONCE;
use crate::input::{BUILT_IN, Input, SceneArgs, wing};
use crate::memory;
use crate::testbed::meshes::{Setting, cube};

#[derive(Serialize)]
pub(crate) struct Scaling {
    pub(crate) cells: Vec<MeshPoint>,
    pub(crate) pixels: Vec<PicturePoint>,
    /// A mean ray crosses 1.33 n^(1/3) cells of a box split in six: 133 of a million.
    pub(crate) million: Million,
}

/// A mesh, what making it took, and what its pictures take.
#[derive(Serialize)]
pub(crate) struct MeshPoint {
    pub(crate) cells: usize,
    /// From points and cells to a mesh that is ready: merged, oriented, matched.
    pub(crate) assemble_wall_seconds: f64,
    pub(crate) assemble_cpu_seconds: Option<f64>,
    /// Of its points, cells, neighbours and fields.
    pub(crate) mesh_bytes: usize,
    pub(crate) ways: Vec<Grown>,
}

#[derive(Serialize)]
pub(crate) struct PicturePoint {
    pub(crate) side: u32,
    pub(crate) ways: Vec<Grown>,
}

/// A way at one size.
#[derive(Serialize)]
pub(crate) struct Grown {
    pub(crate) name: &'static str,
    pub(crate) cost: Cost,
    pub(crate) device_bytes: u64,
    /// Most that was resident of the whole process while it drew its first frame.
    pub(crate) peak_bytes: Option<u64>,
}

/// The default on a box of a million cells.
#[derive(Serialize)]
pub(crate) struct Million {
    pub(crate) cells: usize,
    pub(crate) size: [u32; 2],
    /// Share of the pixels that see it.
    pub(crate) covered: f64,
    pub(crate) cost: Cost,
}

const WAYS: [Way; 4] = [
    ("CPU", |m| m.backend = Backend::Cpu),
    ("wgpu, march", |m| (m.backend, m.projection) = (Backend::Gpu, CellProjection::March)),
    ("wgpu, tiles", |m| (m.backend, m.projection) = (Backend::Gpu, CellProjection::Tiles)),
    ("wgpu, pt", |m| (m.backend, m.projection) = (Backend::Gpu, CellProjection::Pt)),
];

/// Those of the targets among them.
const CELLS: [usize; 9] = [10_000, 30_000, 100_000, 187_000, 513_000, 1_000_000, 2_000_000, 4_000_000, 8_000_000];
/// Side of the pictures of meshes of every size.
const SIDE: u32 = 400;
const SIDES: [u32; 6] = [50, 100, 200, 400, 800, 1600];
/// Cells of the mesh in pictures of every size.
const PICTURED_CELLS: usize = 100_000;

/// A box of a million cells that fills 60 % of the picture, faint enough that every ray goes through it.
pub(crate) const BOX: Setting = Setting {
    mesh: cube::<55>,
    field: |p| (7.0 * p.x).sin() * (5.0 * p.y).cos() + p.z,
    color: &[[-2.0, 0.1, 0.2, 0.9], [0.0, 0.2, 0.9, 0.4], [2.0, 1.0, 0.5, 0.1]],
    opacity: &[[-2.0, 0.1], [-0.5, 0.4], [0.5, 0.2], [2.0, 0.8]],
    unit_distance: 1.0,
    eye: [2.2, -5.4, 1.7],
    focus: [0.0, 0.0, 0.0],
    view_angle: 28.7,
};

pub(crate) fn scaling(bench: &Bench) -> Result<Scaling> {
    let (cells, sides, side) =
        if bench.quick { (&CELLS[..2], &SIDES[..2], 48) } else { (&CELLS[..], &SIDES[..], SIDE) };
    let (cells, pixels) = (in_cells(bench, cells, side)?, in_pixels(bench, sides)?);
    Ok(Scaling { cells, pixels, million: million(bench)? })
}

/// In ascending order, in which what a smaller mesh leaves behind does not count much.
fn in_cells(bench: &Bench, counts: &[usize], side: u32) -> Result<Vec<MeshPoint>> {
    let mut done = Vec::new();
    let mut ways = WAYS.to_vec();
    for &count in counts {
        bench.tell(&format!("{count} cells"));
        let (mesh, took) = assembled(count)?;
        let input = built_in(mesh, [side; 2])?;
        let point = MeshPoint {
            cells: input.mesh.cells().len(),
            assemble_wall_seconds: took.0,
            assemble_cpu_seconds: took.1,
            mesh_bytes: bytes_of(&input.mesh),
            ways: grown(bench, &mut Course::new(&input, bench), &mut ways)?,
        };
        say!("  {:>9} cells {}", point.cells, told(&point.ways));
        done.push(point);
    }
    Ok(done)
}

fn bytes_of(mesh: &TetMesh) -> usize {
    let fields: usize = mesh.fields().iter().map(|field| size_of_val(&field.values[..])).sum();
    size_of_val(mesh.points()) + size_of_val(mesh.cells()) + size_of_val(mesh.neighbors()) + fields
}

/// The built-in mesh, and the wall and processor seconds from its points and cells.
fn assembled(count: usize) -> Result<(TetMesh, (f64, Option<f64>))> {
    let made = procedural::wing(1, count);
    let mut stages = Stages::default();
    let mesh = stages.run("assemble", || assemble(made.parts, made.field))?;
    let took = stages.into_vec().first().map_or((0.0, None), |stage| (stage.wall, stage.cpu));
    Ok((mesh, took))
}

fn assemble(parts: procedural::Parts, field: Field) -> Result<TetMesh> {
    Ok(TetMesh::assemble(&parts.points, &parts.cells, vec![field])?)
}

fn in_pixels(bench: &Bench, sides: &[u32]) -> Result<Vec<PicturePoint>> {
    let input = built_in(wing(PICTURED_CELLS)?, [SIDE; 2])?;
    let mut course = Course::new(&input, bench);
    let mut ways = WAYS.to_vec();
    let mut done = Vec::new();
    for &side in sides {
        course.scene.size = [side; 2];
        let point = PicturePoint { side, ways: grown(bench, &mut course, &mut ways)? };
        say!("  {side:>4} x {side:<4} pixels {}", told(&point.ways));
        done.push(point);
    }
    Ok(done)
}

/// What each way takes; those that cannot be are not asked again, nor those by wgpu that take more than [`ONCE`].
fn grown(bench: &Bench, course: &mut Course, ways: &mut Vec<Way>) -> Result<Vec<Grown>> {
    let mut all = Vec::new();
    let mut left = Vec::new();
    for &way in ways.iter() {
        memory::forget_peak();
        // No adapter, or a mesh over its limits.
        let Ok((mut runner, _, frame)) = course.start(way) else { continue };
        let peak_bytes = memory::peak();
        course.run_in_turn(std::slice::from_mut(&mut runner), bench.runs)?;
        let cost = runner.cost();
        if cost.seconds() < ONCE || way.0 == WAYS[0].0 {
            left.push(way);
        }
        all.push(Grown { name: way.0, cost, device_bytes: frame.resources.bytes, peak_bytes });
    }
    *ways = left;
    Ok(all)
}

fn told(ways: &[Grown]) -> String {
    ways.iter().map(|way| format!("  {} {:.1} ms CPU", way.name, way.cost.seconds() * 1e3)).collect()
}

/// The built-in scene on a mesh of its kind.
pub(crate) fn built_in(mesh: TetMesh, size: [u32; 2]) -> Result<Input> {
    let mut file = SceneFile::parse("the built-in scene", BUILT_IN)?;
    let flags = SceneArgs { size: Some(size), ..SceneArgs::default() };
    flags.override_scene(&mut file)?;
    flags.bind("wing".to_owned(), file, mesh)
}

fn million(bench: &Bench) -> Result<Million> {
    let setting = if bench.quick { Setting { mesh: cube::<8>, ..BOX } } else { BOX };
    let input = setting.input("box", "a box of a million cells", if bench.quick { 48 } else { 800 })?;
    let mut course = Course::new(&input, bench);
    let (mut runner, _, frame) = course.start(WAYS[0])?;
    course.run_in_turn(std::slice::from_mut(&mut runner), bench.runs)?;
    let cost = runner.cost();
    let pixels = frame.image.pixels();
    let covered = pixels.iter().filter(|pixel| pixel[3] > 0.0).count() as f64 / pixels.len() as f64;
    Ok(Million { cells: input.mesh.cells().len(), size: input.scene.size, covered, cost })
}
