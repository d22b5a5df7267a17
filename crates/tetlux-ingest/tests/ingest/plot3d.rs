//! PLOT3D grids and solutions.

use std::path::Path;

use glam::DVec3;
use tetlux_ingest::{IngestError, MixedMesh, ReadOptions, Split, read};
use tetlux_mesh::Field;

use crate::assert_volume;
use crate::writers::{Folder, PLAIN, Plot3d};

const N: [i32; 3] = [4, 3, 2];

fn read_pair(grid: &[u8], solution: &[u8]) -> Result<MixedMesh, IngestError> {
    let folder = Folder::new();
    let solution = Some(folder.write("q.bin", solution));
    read(&folder.write("xyz.bin", grid), &ReadOptions { solution, ..ReadOptions::default() })
}

fn value(variable: usize, point: usize) -> f32 {
    (100 * variable + point) as f32
}

#[test]
fn grid_and_solution_are_read_in_either_order_with_and_without_iblank() {
    for (big, iblank) in [(false, false), (false, true), (true, false), (true, true)] {
        let writer = Plot3d { big, iblank };
        let mesh = read_pair(&writer.grid(N, |_, u| u * 0.5, |_| -1), &writer.solution(N, value)).unwrap();
        assert_eq!(mesh.points.len(), 24);
        assert_eq!(mesh.points[4 + 3], DVec3::new(1.5, 0.5, 0.0));
        assert_eq!(mesh.cell_counts(), [("hexahedra", 6)]);
        let momentum = (0..24).flat_map(|p| [1, 2, 3].map(|v| f64::from(value(v, p)))).collect();
        let of = |v| (0..24).map(|p| f64::from(value(v, p))).collect();
        let expected = [
            Field::point("Density", 1, of(0)),
            Field::point("Momentum", 3, momentum),
            Field::point("StagnationEnergy", 1, of(4)),
        ];
        assert_eq!(mesh.fields, expected);
        assert_eq!(mesh.notes, [""; 0]);
        let report = mesh.tetrahedralize(Split::Six).unwrap().validate();
        assert_eq!(report.cells, 36);
        assert_volume(report.volume, 6.0 / 8.0);
    }
}

#[test]
fn byte_orders_of_grid_and_solution_may_differ() {
    let little = Plot3d { big: false, iblank: false };
    let mesh = read_pair(&PLAIN.grid(N, |_, u| u, |_| 1), &little.solution(N, value)).unwrap();
    assert_eq!(mesh.fields[0].values[5], 5.0);
}

#[test]
fn hexahedra_with_a_blanked_corner_are_left_out_and_counted() {
    let writer = Plot3d { big: true, iblank: true };
    let folder = Folder::new();
    // The first point is a corner of one hexahedron, point 2 along i of two.
    let path = folder.write("a.xyz", &writer.grid(N, |_, u| u, |p| [0, 1, 0, -1][p.min(3)]));
    let mesh = read(&path, &ReadOptions::default()).unwrap();
    assert_eq!(mesh.cell_counts(), [("hexahedra", 3)]);
    assert_eq!(mesh.notes.len(), 1);
    assert!(mesh.notes[0].starts_with("3 hexahedra"), "{:?}", mesh.notes);
    for (split, cells) in [(Split::Five, 15), (Split::Six, 18)] {
        let mesh = mesh.clone().tetrahedralize(split).unwrap().validate();
        assert_eq!(mesh.cells, cells);
        assert_volume(mesh.volume, 3.0);
    }
}

#[test]
fn a_grid_without_cells_is_read_but_is_no_mesh() {
    let folder = Folder::new();
    let path = folder.write("plane.xyz", &PLAIN.grid([4, 3, 1], |_, u| u, |_| 1));
    let mesh = read(&path, &ReadOptions::default()).unwrap();
    assert_eq!((mesh.points.len(), mesh.cell_counts()), (12, vec![]));
    assert!(matches!(mesh.tetrahedralize(Split::Six), Err(IngestError::Mesh { path: p, .. }) if p == path));
}

#[test]
fn every_truncation_of_grid_and_solution_is_an_error() {
    let folder = Folder::new();
    let options = ReadOptions::default();
    for iblank in [false, true] {
        let writer = Plot3d { big: true, iblank };
        let (grid, solution) = (writer.grid(N, |_, u| u, |_| 1), writer.solution(N, value));
        for length in 0..grid.len() {
            // With iblank cut off whole, the file is the same grid without iblank.
            let whole = length == 12 + 12 * 24;
            assert_eq!(read(&folder.write("g.xyz", &grid[..length]), &options).is_ok(), whole, "{length}");
        }
        for length in 0..solution.len() {
            let error = read_pair(&grid, &solution[..length]).unwrap_err();
            assert!(error.to_string().contains("q.bin"), "{length}: {error}");
        }
    }
}

#[test]
fn bytes_after_the_solution_are_passed_over_with_a_note() {
    let mut solution = PLAIN.solution(N, value);
    solution.extend([7; 9]);
    let mesh = read_pair(&PLAIN.grid(N, |_, u| u, |_| 1), &solution).unwrap();
    assert_eq!(mesh.notes.len(), 1);
    assert!(mesh.notes[0].contains("q.bin") && mesh.notes[0].contains("the last 9 bytes"), "{:?}", mesh.notes);
}

#[test]
fn hostile_dimensions_are_refused() {
    let folder = Folder::new();
    let mut grid = PLAIN.grid(N, |_, u| u, |_| 1);
    for n in [[-4, -3, 2], [0, 3, 2], [i32::MAX; 3], [65536, 65536, 1], [4, 3, 3], [4, 1, 1], [i32::MIN, 1, 1]] {
        (0..3).for_each(|a| grid[4 * a..4 * a + 4].copy_from_slice(&PLAIN.int(n[a])));
        let error = read(&folder.write("g.xyz", &grid), &ReadOptions::default()).unwrap_err();
        assert!(error.to_string().contains("g.xyz"), "{error}");
    }
}

#[test]
fn a_solution_of_another_grid_is_refused() {
    let grid = PLAIN.grid(N, |_, u| u, |_| 1);
    match read_pair(&grid, &PLAIN.solution([4, 2, 3], value)).unwrap_err() {
        IngestError::SolutionDiffers { found, expected, .. } => {
            assert_eq!((found, expected), ([4, 2, 3], N.map(|n| n as u32)))
        }
        error => panic!("{error}"),
    }
    let options = ReadOptions { solution: Some("no such file".into()), ..ReadOptions::default() };
    let folder = Folder::new();
    let error = read(&folder.write("g.xyz", &grid), &options).unwrap_err();
    assert!(matches!(error, IngestError::Io { path, .. } if path == Path::new("no such file")));
}

#[test]
fn a_point_that_is_not_finite_is_named() {
    let folder = Folder::new();
    for bad in [f64::NAN, f64::INFINITY] {
        let place = |p, u| if p == 17 { DVec3::splat(bad) } else { u };
        let path = folder.write("g.xyz", &PLAIN.grid(N, place, |_| 1));
        let error = read(&path, &ReadOptions::default()).unwrap_err();
        assert!(matches!(error, IngestError::NonFinite { point: 17, .. }), "{error}");
    }
}
