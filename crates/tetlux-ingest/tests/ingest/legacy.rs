//! Legacy VTK, Gmsh and TetGen files that VTK, Gmsh and meshio wrote (by tests/files/make_legacy.py).

use std::path::{Path, PathBuf};

use tetlux_ingest::{MixedMesh, ReadOptions, Split, read};
use tetlux_mesh::procedural::for_each_hexahedron;

fn files(folder: &str) -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/files").join(folder);
    let mut files: Vec<PathBuf> = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.sort();
    files
}

/// Mean x of the points of each cell.
fn means(mesh: &MixedMesh) -> Vec<f64> {
    let mean = |points: &[u32]| points.iter().map(|&v| mesh.points[v as usize].x).sum::<f64>() / points.len() as f64;
    let mut means: Vec<f64> = (0..mesh.cells.types.len()).map(|c| mean(mesh.cells.cell(c).unwrap())).collect();
    mesh.grids.iter().for_each(|grid| for_each_hexahedron(grid.counts, |_, corners| means.push(mean(&corners))));
    means
}

/// Words have seven digits or so, and numbers here are below a hundred.
const ROUNDING: f64 = 1e-4;

fn assert_close(found: &[f64], expected: &[f64], name: &str) {
    assert_eq!(found.len(), expected.len(), "{name}");
    assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < ROUNDING), "{name}: {found:?}, not {expected:?}");
}

/// Reads a file, compares its fields, and gives its volume.
fn volume(path: &Path, point: &str, cell: &str) -> f64 {
    let mesh = read(path, &ReadOptions::default()).unwrap();
    let name = path.display().to_string();
    let field = |name: &str| &mesh.fields.iter().find(|f| f.name == name).unwrap().values;
    let expected: Vec<f64> = mesh.points.iter().map(|p| p.x + 2.0 * p.y + 3.0 * p.z).collect();
    assert_close(field(point), &expected, &name);
    assert_close(field(cell), &means(&mesh), &name);
    let report = mesh.tetrahedralize(Split::Six).unwrap().validate();
    assert_eq!(report.quads_split_both_ways, 0, "{name}");
    report.volume
}

#[test]
fn vtk_files_have_the_fields_and_volume_they_were_written_with() {
    let files = files("vtk_legacy");
    assert_eq!(files.len(), 18);
    for path in &files {
        let name = path.file_name().unwrap().to_str().unwrap();
        let expected = match name.split('_').next().unwrap() {
            // Polyhedron, voxel and hexahedron 1 each, a pyramid 1/3, a wedge 1/2, a tetrahedron 1/6.
            "cells" => 4.0,
            "image" => 1.5 * 2.0 * 2.0,
            "rectilinear" => 4.0 * 3.0 * 2.0,
            "structured" => 3.0 * 2.0,
            // Two cubes and two pyramids.
            "meshio" => 2.0 + 2.0 / 3.0,
            other => panic!("{other}"),
        };
        let found = volume(path, "f", "c");
        assert!((found - expected).abs() < ROUNDING, "{name}: {found}");
    }
}

#[test]
fn gmsh_files_have_the_fields_and_volume_they_were_written_with() {
    let files = files("gmsh");
    assert_eq!(files.len(), 32);
    for path in &files {
        let name = path.file_name().unwrap().to_str().unwrap();
        let expected = match name.split('_').next().unwrap() {
            "pyramid" => 1.0 / 3.0,
            "meshio" if name.contains("22") => 2.0 + 2.0 / 3.0,
            // Corner 0 and the opposite corner of a cube, cut off by the plane between.
            "meshio" => 1.0 / 6.0 + 1.0 / 3.0,
            _ => 1.0,
        };
        let found = volume(path, "f", "c");
        assert!((found - expected).abs() < ROUNDING, "{name}: {found}");
    }
}

/// meshio writes a field that is alone as the marker.
#[test]
fn tetgen_files_are_read_by_either_name() {
    let files = files("tetgen");
    assert_eq!(files.len(), 2);
    for path in &files {
        let found = volume(path, "marker", "region");
        assert!((found - 0.5).abs() < ROUNDING, "{found}");
    }
}
