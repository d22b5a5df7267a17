//! The NASA data sets, where they are at hand: real meshes with coincident points, flat cells and a thousandfold range
//! of sizes.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a test's helpers fail and tell like the test")]

use std::path::PathBuf;

use tetlux_ingest::{ReadOptions, Split, read_tet_mesh};
use tetlux_mesh::TetMesh;
use tetlux_scene::SceneFile;
use tetlux_tests::{Way, pixel_error, reference, render};

/// The default error budget of a picture.
const TOLERANCE: f64 = 1e-3;

/// A file of the data sets; `None`, with a line that says so, where it is absent.
fn data(name: &str) -> Option<PathBuf> {
    let path = PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../shared/data")).join(name);
    if !path.exists() {
        println!("the data set {name} is absent: not tested");
    }
    path.exists().then_some(path)
}

fn scene_file(name: &str) -> SceneFile {
    let path = PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../scenes")).join(name);
    SceneFile::read(&path).unwrap()
}

/// Judges the scene's first camera at a reduced size.
fn assert_scene(what: &str, mesh: &TetMesh, mut file: SceneFile) {
    file.size = [160, 160];
    let scene = file.scene(mesh, 0).unwrap();
    let truth = reference(mesh, &scene);
    let pictures = [Way::CpuPixel, Way::CpuCentroid, Way::GpuCentroid].map(|way| render(mesh, &scene, way));
    let errors = |i: usize| pictures[i].pixels().iter().zip(&truth).map(|(&p, &t)| pixel_error(p, t));
    let sorted = errors(0).fold(0.0, f64::max);
    let misordered = errors(2).filter(|&e| e > TOLERANCE).count();
    let covered = truth.iter().filter(|t| t[3] > 0.0).count();
    let cpu = pictures[1].pixels().iter().map(|p| p.map(f64::from));
    let parity = pictures[2].pixels().iter().zip(cpu).map(|(&g, c)| pixel_error(g, c)).fold(0.0, f64::max);
    println!(
        "{what}: {covered} pixels, sorted max {sorted:.1e}; by centroid {misordered} over {TOLERANCE:.0e}, back ends {parity:.1e} apart"
    );
    assert!(covered > 1500, "{what}: {covered} pixels are seen");
    // What is wrong by centroid is wrong for its order alone: the same cells, sorted, are right in every pixel.
    assert!(sorted < TOLERANCE, "{what}: off by up to {sorted:.1e}");
    assert!(parity < TOLERANCE, "{what}: the back ends differ by {parity:.1e}");
}

#[test]
fn tetrahedra_from_vtu() {
    for (mesh, scenes) in [
        ("tets/bluntfin_tets.vtu", ["bluntfin-smooth.toml", "bluntfin-spiky.toml"]),
        ("tets/post_tets.vtu", ["post-smooth.toml", "post-spiky.toml"]),
    ] {
        let Some(path) = data(mesh) else { continue };
        let mesh = read_tet_mesh(&path, &ReadOptions::default(), Split::default()).unwrap();
        for scene in scenes {
            assert_scene(scene, &mesh, scene_file(scene));
        }
    }
}

#[test]
fn hexahedra_from_plot3d() {
    for (grid, solution, scene, field) in [
        ("bluntfinxyz.bin", "bluntfinq.bin", "bluntfin-spiky.toml", "Density"),
        ("postxyz.bin", "postq.bin", "post-smooth.toml", "Momentum"),
    ] {
        let (Some(grid), Some(solution)) = (data(grid), data(solution)) else { continue };
        let options = ReadOptions { solution: Some(solution), ..ReadOptions::default() };
        for split in [Split::Five, Split::Six] {
            let mesh = read_tet_mesh(&grid, &options, split).unwrap();
            let file = SceneFile { field: Some(field.into()), ..scene_file(scene) };
            assert_scene(&format!("{scene}, PLOT3D, {split:?}"), &mesh, file);
        }
    }
}
