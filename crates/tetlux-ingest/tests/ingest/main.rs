//! What the readers make of files: written here in every encoding, broken in every place, and real ones.
#![expect(clippy::unwrap_used, clippy::print_stdout, reason = "a test's helpers fail and tell like the test")]

mod cached;
#[path = "../../src/damage.rs"]
mod damage;
mod hostile;
mod legacy;
mod plot3d;
mod real;
mod unused;
mod vtk_xml;
mod vtu;
mod writers;

use std::path::{Path, PathBuf};

use glam::DVec3;
use tetlux_ingest::{IngestError, MixedMesh, ReadOptions, Split, read, read_tet_mesh};
use writers::Folder;

#[test]
fn a_missing_file_a_directory_and_an_empty_file_are_told_apart() {
    let folder = Folder::new();
    let options = ReadOptions::default();
    assert!(matches!(read(Path::new("no such file.vtu"), &options), Err(IngestError::Io { .. })));
    let error = read(folder.path(), &options).unwrap_err();
    assert!(error.to_string().contains("a directory"), "{error}");
    let path = folder.write("empty.vtu", b"");
    assert!(matches!(read(&path, &options), Err(IngestError::Empty { path: p }) if p == path));
}

#[test]
fn an_unknown_format_is_answered_with_those_that_are_read() {
    let folder = Folder::new();
    let path = folder.write("mesh.dat", b"OFF\n4 4 6\n\xff and so on, longer than four numbers");
    let error = read(&path, &ReadOptions::default()).unwrap_err().to_string();
    for part in ["mesh.dat", "OFF", "\\xff", ".vtu", "PLOT3D"] {
        assert!(error.contains(part), "{error}");
    }
}

#[test]
fn the_content_decides_and_not_the_extension() {
    let folder = Folder::new();
    let mesh = writers::two_hexahedra();
    let bytes = writers::vtu(&mesh, writers::Encoding::default());
    let path = folder.write("vtu named.xyz", &bytes);
    assert_eq!(read(&path, &ReadOptions::default()).unwrap().points, mesh.points);
    let path = folder.write("plot3d named.vtu", &writers::PLAIN.grid([2, 2, 3], |_, u| u, |_| 1));
    assert_eq!(read(&path, &ReadOptions::default()).unwrap().cell_counts(), [("hexahedra", 2)]);
}

#[test]
fn the_two_steps_together_are_the_two_steps() {
    let folder = Folder::new();
    let path = folder.write("a.vtu", &writers::vtu(&writers::two_hexahedra(), writers::Encoding::default()));
    let options = ReadOptions::default();
    let together = read_tet_mesh(&path, &options, Split::Six).unwrap();
    let apart = read(&path, &options).unwrap().tetrahedralize(Split::Six).unwrap();
    assert_eq!((together.points(), together.cells()), (apart.points(), apart.cells()));
    assert_eq!(together.fields(), apart.fields());
}

#[test]
fn an_inconsistent_mesh_is_refused_and_not_indexed() {
    let good = writers::two_hexahedra();
    assert!(good.clone().tetrahedralize(Split::Six).is_ok());
    let mut broken: Vec<MixedMesh> = vec![good; 7];
    broken[0].cells.connectivity[3] = 12;
    broken[1].cells.offsets[0] = 17;
    broken[2].cells.offsets.pop();
    broken[3].fields[0].values.pop();
    broken[4].fields[1].values.pop();
    broken[5].points[2].y = f64::NAN;
    broken[6].cells.connectivity.push(0);
    for mesh in broken {
        assert!(mesh.tetrahedralize(Split::Six).is_err());
    }
    let grid = tetlux_ingest::StructuredGrid { first_point: 0, counts: [2, 2, 3], blanked: Some(vec![false; 11]) };
    let mesh =
        MixedMesh { points: vec![DVec3::ZERO; 12], grids: vec![grid], path: PathBuf::new(), ..MixedMesh::default() };
    assert_eq!(mesh.cell_counts(), []);
    assert!(mesh.tetrahedralize(Split::Six).is_err());
}

/// A volume of a few cells whose corners are exact: sixths are summed, each rounded.
fn assert_volume(found: f64, expected: f64) {
    assert!((found - expected).abs() < 1e-14 * expected, "{found}, not {expected}");
}
