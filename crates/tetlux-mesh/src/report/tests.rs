use glam::DVec3;

use super::*;
use crate::procedural::{Parts, Split, cuboid};

fn report(parts: &Parts) -> Report {
    TetMesh::assemble(&parts.points, &parts.cells, vec![]).unwrap().validate()
}

#[test]
fn a_box_has_the_measures_of_a_box() {
    // Hexahedra of 1 x 2 x 2 split in six: the shortest edge is 1, the longest the diagonal, 3.
    let [a, b, c] = [3, 2, 4];
    let corners = [DVec3::new(5.0, -3.0, 2.0), DVec3::new(8.0, 1.0, 10.0)];
    let found = report(&cuboid([a, b, c], Split::Six, corners));
    assert_eq!(found.bounds, corners.map(|corner| corner.to_array()));
    assert_eq!(found.edge_lengths, [1.0, 3.0]);
    assert_eq!(found.volume, 3.0 * 4.0 * 8.0);
    assert_eq!(found.boundary_faces, 2 * 2 * (a * b + b * c + c * a));
    assert_eq!((found.cells, found.components, found.points_unused), (6 * a * b * c, 1, 0));
    // Each cell follows one order of the axes from corner to corner: it has an edge along each, the diagonals of the
    // first two and of the last two, and the long one. Over the six orders each face diagonal comes equally often.
    let [x, y, z] = [1.0, 2.0, 2.0];
    let faces = [x * x + y * y, y * y + z * z, z * z + x * x].map(f64::sqrt).iter().sum::<f64>() / 3.0;
    let mean = (x + y + z + 2.0 * faces + 3.0) / 6.0;
    assert!((found.mean_edge_length - mean).abs() < 1e-12, "{} for {mean}", found.mean_edge_length);
    assert_eq!(found.faults(), Vec::<String>::new());
}

#[test]
fn parts_that_touch_in_a_point_or_an_edge_are_apart() {
    let unit = |at: DVec3| cuboid([1, 1, 1], Split::Six, [at, at + 1.0]);
    let mut parts = unit(DVec3::ZERO);
    parts.append(&unit(DVec3::ONE));
    parts.append(&unit(DVec3::new(1.0, 1.0, 0.0)));
    // The second shares a corner with the first; the third an edge with the first and a side with the second.
    let found = report(&parts);
    assert_eq!((found.components, found.assembly.points_merged), (2, 6));
    assert_eq!(found.boundary_faces, 3 * 12 - 2 * 2);
}

#[test]
fn a_lone_cell_is_no_quadrilateral() {
    let found = report(&Parts { points: vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z], cells: vec![[0, 1, 2, 3]] });
    assert_eq!((found.quads_split_both_ways, found.boundary_faces), (0, 4));
}

#[test]
fn faults_are_told_with_their_numbers() {
    let mut parts = cuboid([1, 1, 1], Split::Six, [DVec3::ZERO, DVec3::ONE]);
    parts.points.extend([DVec3::splat(0.5), DVec3::splat(0.25), DVec3::ZERO]);
    parts.cells[0].swap(0, 1);
    parts.cells.push([0, 1, 1, 2]);
    parts.cells.push([0, 1, 3, 2]);
    let faults = report(&parts).faults();
    assert_eq!(
        faults,
        [
            "1 coincident points were merged",
            "2 points are used by no cell",
            "1 cells with repeated vertices were dropped",
            "1 inverted cells were turned round",
            "1 cells have zero volume: kept in the adjacency, without optical depth",
        ]
    );
    let report = Report {
        quads_split_both_ways: 3,
        assembly: Assembly { merged_data_differ: 4, faces_non_manifold: 5, faces_folded: 6, ..Assembly::default() },
        points_unused: 0,
        ..report(&parts)
    };
    let faults = report.faults();
    assert_eq!(faults.len(), 4);
    for (fault, start) in faults.iter().zip(["4 merged points", "5 faces", "6 faces", "3 quadrilaterals"]) {
        assert!(fault.starts_with(start), "{fault}");
    }
    // What was looked for and not found is told too.
    let counts = report.checks().map(|check| (check.name, check.count));
    assert_eq!(counts[1..3], [("differing data", 4), ("unused points", 0)]);
}
