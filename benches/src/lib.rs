//! Scenes that the benchmarks share.

use std::path::Path;
use std::time::Duration;

use glam::DVec3;
use tetlux_ingest::{ReadOptions, read_tet_mesh};
use tetlux_mesh::procedural::{self, Parts, Split};
use tetlux_mesh::{Component, Field, TetMesh};
use tetlux_optics::Classification;
use tetlux_optics::transfer::{ColorNode, OpacityNode, TransferFunction};
use tetlux_render::{Model, Renderer};
use tetlux_scene::{Camera, Method, Plan, Scene};

/// A cube of n^3 hexahedra split in six, with a field that has structure at every scale of the cells.
pub fn cube(n: usize) -> (Parts, Field) {
    let parts = procedural::cuboid([n; 3], Split::Six, [DVec3::splat(-1.0), DVec3::ONE]);
    let values = parts.sample(|p| (7.0 * p.x).sin() * (5.0 * p.y).cos() + p.z);
    (parts, Field::point("waves", 1, values))
}

/// The cube assembled.
pub fn cube_mesh(n: usize) -> TetMesh {
    let (parts, field) = cube(n);
    TetMesh::assemble(&parts.points, &parts.cells, vec![field]).unwrap_or_else(|e| panic!("the cube is a mesh: {e}"))
}

/// The procedural wing's vortices, of about 100 000 cells.
pub fn wing_mesh() -> TetMesh {
    let wing = procedural::wing(1, 100_000);
    TetMesh::assemble(&wing.parts.points, &wing.parts.cells, vec![wing.field]).unwrap_or_else(|e| panic!("{e}"))
}

/// The Blunt Fin, if its file is present.
pub fn blunt_fin_mesh() -> Option<TetMesh> {
    let path = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../shared/data/tets/bluntfin_tets.vtu"));
    let read = || read_tet_mesh(path, &ReadOptions::default(), tetlux_ingest::Split::default());
    path.exists().then(|| read().unwrap_or_else(|e| panic!("{e}")))
}

/// Processor seconds of one stage of so many pictures; of the clock where the processor's are not known.
pub fn stage_time(renderer: &Renderer, scene: &Scene, model: &Model, plan: &Plan, stage: &str, runs: u64) -> Duration {
    let frames = (0..runs).map(|_| renderer.render(scene, model, plan).unwrap_or_else(|e| panic!("{e}")));
    let seconds = frames.map(|frame| {
        let found = frame.stages.iter().find(|s| s.name == stage);
        found.map_or(0.0, |s| s.cpu.unwrap_or(s.wall))
    });
    Duration::from_secs_f64(seconds.sum())
}

/// Nine control points: gentle ramps if `smooth`, else narrow peaks.
pub fn transfer(smooth: bool) -> TransferFunction {
    let node = |i: usize| -2.0 + 0.5 * i as f64;
    let color = (0..9).map(|i| ColorNode { s: node(i), rgb: [0.1 * i as f64, 0.5, 1.0 - 0.1 * i as f64] });
    let opacity = (0..9)
        .map(|i| OpacityNode { s: node(i), opacity: if smooth { 0.1 * i as f64 } else { [0.0, 0.0, 8.0][i % 3] } });
    TransferFunction::new(color.collect(), opacity.collect()).unwrap_or_else(|e| panic!("nodes ascend: {e}"))
}

/// A mesh seen from outside, 400 x 400.
pub fn scene(mesh: &TetMesh, smooth: bool, method: Method) -> Scene {
    Scene {
        scalar: mesh.scalar("waves", Component::Magnitude).unwrap_or_else(|e| panic!("the cube has the field: {e}")),
        second: None,
        no_data: tetlux_optics::NoData::default(),
        classification: Classification::OneField(transfer(smooth)),
        lighting: None,
        emphasis: None,
        surfaces: Vec::new(),
        unit_distance: 1.0,
        camera: Camera::framing(mesh.bounds(), DVec3::new(-1.0, 1.5, -0.8), DVec3::Z),
        size: [400, 400],
        background: [0.0; 3],
        method,
    }
}
