use proptest::prelude::*;

use super::*;
use crate::procedural::{Split, cuboid};
use crate::{Component, FACES};

/// Every neighbour's neighbour is the cell itself, and sees their face's vertices in the opposite order.
fn check_adjacency(mesh: &TetMesh) {
    for (c, (cell, around)) in mesh.cells().iter().zip(mesh.neighbors()).enumerate() {
        for f in (0..4).filter(|&f| around[f] != NONE) {
            let other = around[f] as usize;
            let theirs = mesh.cells()[other];
            let [x, y, z] = FACES[f].map(|i| cell[i]);
            let back = (0..4).find(|&g| {
                let [p, q, r] = FACES[g].map(|i| theirs[i]);
                [[p, q, r], [q, r, p], [r, p, q]].contains(&[x, z, y])
            });
            let back = back.unwrap_or_else(|| panic!("cell {other} has no reversed face {f} of cell {c}"));
            assert_eq!(mesh.neighbors()[other][back], c as u32);
        }
    }
}

fn points(list: &[[f64; 3]]) -> Vec<DVec3> {
    list.iter().copied().map(DVec3::from).collect()
}

/// A tetrahedron with its right angle at the first point.
const CORNER: [[f64; 3]; 4] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

#[test]
fn coincident_points_are_merged_and_the_first_kept() {
    // Two tetrahedra on either side of a face whose points are given twice, once with negative zeros; the centre of
    // the box is the origin, so that they stay zeros.
    let list = points(&[
        [0.0, 0.0, -1.0],
        [1.0, 0.0, 0.0],
        [-1.0, 1.0, 0.0],
        [-1.0, -1.0, 0.0],
        [1.0, -0.0, -0.0],
        [-1.0, 1.0, -0.0],
        [-1.0, -1.0, 0.0],
        [0.0, 0.0, 1.0],
    ]);
    let heat = Field::point("heat", 1, vec![0.0, 1.0, f64::NAN, 3.0, 1.0, f64::NAN, 3.5, 7.0]);
    let wind = Field::point("wind", 2, (0..16).map(|i| if i == 8 { 2.0 } else { f64::from(i % 8) }).collect());
    let mesh = TetMesh::assemble(&list, &[[0, 1, 2, 3], [7, 4, 5, 6]], vec![heat, wind]).unwrap();

    let found = mesh.assembly();
    assert_eq!((found.points_given, found.points_merged, mesh.points().len()), (8, 3, 5));
    // Point 6 differs from 3 in heat; of the wind tuples (2, 3), (4, 5), (6, 7) and (2, 1), (2, 3), (4, 5) all differ.
    assert_eq!(found.merged_data_differ, 3);
    let heat = mesh.scalar("heat", Component::Magnitude).unwrap();
    assert_eq!((heat.values[3], heat.values[4], heat.missing), (3.0, 7.0, 1));
    assert_eq!(mesh.fields()[1].values, [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 6.0, 7.0]);
    assert_eq!(mesh.validate().boundary_faces, 6);
    check_adjacency(&mesh);
}

#[test]
fn equal_data_and_missing_data_do_not_differ() {
    let mut list = points(&CORNER);
    list.extend_from_within(2..3);
    let field = Field::point("f", 1, vec![0.0, 1.0, f64::NAN, 3.0, f64::NAN]);
    let mesh = TetMesh::assemble(&list, &[[0, 1, 4, 3]], vec![field]).unwrap();
    assert_eq!((mesh.assembly().points_merged, mesh.assembly().merged_data_differ), (1, 0));
    assert_eq!(mesh.cells(), [[0, 1, 2, 3]]);
}

#[test]
fn cells_with_repeated_vertices_go_and_their_data_with_them() {
    let mut list = points(&CORNER);
    list.push(list[3]);
    let cells = [[0, 1, 2, 2], [0, 1, 2, 3], [0, 1, 3, 4]];
    let rank = Field::cell("rank", 2, vec![0.0, 1.0, 2.0, 3.0, 4.0, 5.0]);
    let mesh = TetMesh::assemble(&list, &cells, vec![rank]).unwrap();
    assert_eq!((mesh.assembly().cells_given, mesh.assembly().cells_repeated), (3, 2));
    assert_eq!((mesh.cells(), &mesh.fields()[0].values[..]), (&[[0, 1, 2, 3]][..], &[2.0, 3.0][..]));
}

#[test]
fn inverted_cells_are_turned() {
    let mesh = TetMesh::assemble(&points(&CORNER), &[[1, 0, 2, 3]], vec![]).unwrap();
    assert_eq!((mesh.assembly().cells_inverted, mesh.assembly().cells_flat), (1, 0));
    // The unit right tetrahedron.
    assert!((mesh.validate().volume - 1.0 / 6.0).abs() < f64::EPSILON);
    assert_eq!(TetMesh::assemble(&points(&CORNER), mesh.cells(), vec![]).unwrap().assembly().cells_inverted, 0);
}

/// A square with two tetrahedra above it, split along one diagonal, and two below, split along the other.
const SQUARE: [[f64; 3]; 6] =
    [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0], [0.5, 0.5, 1.0], [0.5, 0.5, -1.0]];
const ABOVE_AND_BELOW: [[u32; 4]; 4] = [[0, 1, 2, 4], [0, 2, 3, 4], [0, 1, 3, 5], [1, 2, 3, 5]];

proptest! {
    /// A flat cell between the two diagonals closes the adjacency, however it and the others are written.
    #[test]
    fn flat_cells_are_kept_and_fitted(
        flat in Just([0u32, 1, 2, 3]).prop_shuffle(), order in Just([0usize, 1, 2, 3, 4]).prop_shuffle(),
    ) {
        let all: Vec<[u32; 4]> = ABOVE_AND_BELOW.into_iter().chain([flat]).collect();
        let cells: Vec<_> = order.iter().map(|&i| all[i]).collect();
        let mesh = TetMesh::assemble(&points(&SQUARE), &cells, vec![]).unwrap();
        prop_assert_eq!((mesh.assembly().cells_flat, mesh.assembly().faces_folded), (1, 0));
        check_adjacency(&mesh);
        let report = mesh.validate();
        // Twenty faces of cells less the flat one's four, the two between neighbours above and below, twice each.
        prop_assert_eq!((report.boundary_faces, report.components, report.quads_split_both_ways), (8, 1, 0));
    }

    /// Flat cells beside nothing but flat cells agree among themselves: two triangulated layers of a flat hexagon.
    #[test]
    fn flat_cells_alone_agree(
        first in Just([0u32, 1, 2, 3]).prop_shuffle(), second in Just([0u32, 2, 3, 4]).prop_shuffle(),
        third in Just([0u32, 3, 4, 5]).prop_shuffle(),
    ) {
        let list = points(&[[0.0; 3], [2.0, 0.0, 0.0], [3.0, 1.0, 0.0], [3.0, 2.0, 0.0], [1.0, 3.0, 0.0], [0.0, 2.0, 0.0]]);
        let mesh = TetMesh::assemble(&list, &[first, second, third], vec![]).unwrap();
        prop_assert_eq!((mesh.assembly().cells_flat, mesh.assembly().faces_folded), (3, 0));
        check_adjacency(&mesh);
        // Cells 0 and 1 share (0, 2, 3), cells 1 and 2 share (0, 3, 4).
        prop_assert_eq!((mesh.validate().boundary_faces, mesh.validate().components), (8, 1));
    }
}

#[test]
fn without_the_flat_cell_the_square_is_split_both_ways() {
    let report = TetMesh::assemble(&points(&SQUARE), &ABOVE_AND_BELOW, vec![]).unwrap().validate();
    assert_eq!((report.quads_split_both_ways, report.boundary_faces, report.components), (1, 12, 2));
}

#[test]
fn folded_faces_are_boundary() {
    let mut list = points(&CORNER);
    list.push(DVec3::new(0.25, 0.25, 2.0));
    let mesh = TetMesh::assemble(&list, &[[0, 1, 2, 3], [0, 1, 2, 4]], vec![]).unwrap();
    assert_eq!((mesh.assembly().faces_folded, mesh.assembly().faces_non_manifold), (1, 0));
    assert_eq!(mesh.neighbors(), [[NONE; 4]; 2]);
}

#[test]
fn a_cell_given_twice_is_folded_on_every_face() {
    let mesh = TetMesh::assemble(&points(&CORNER), &[[0, 1, 2, 3], [1, 0, 3, 2]], vec![]).unwrap();
    assert_eq!((mesh.assembly().faces_folded, mesh.neighbors()), (4, &[[NONE; 4]; 2][..]));
}

#[test]
fn faces_of_three_cells_are_boundary() {
    let mut list = points(&CORNER);
    list.extend([DVec3::new(0.25, 0.25, 2.0), DVec3::new(0.25, 0.25, -1.0)]);
    let mesh = TetMesh::assemble(&list, &[[0, 1, 2, 3], [0, 1, 2, 4], [0, 1, 2, 5]], vec![]).unwrap();
    assert_eq!((mesh.assembly().faces_folded, mesh.assembly().faces_non_manifold), (0, 1));
    assert_eq!(mesh.neighbors(), [[NONE; 4]; 3]);
}

#[test]
fn faulty_input_is_refused_with_its_place() {
    let list = points(&CORNER);
    let cells = [[0, 1, 2, 3]];
    let refuse = |points: &[DVec3], cells: &[[u32; 4]], fields| TetMesh::assemble(points, cells, fields).unwrap_err();

    assert_eq!(refuse(&[], &[], vec![]), MeshError::Empty { dropped: 0 });
    assert_eq!(refuse(&list, &[[0, 1, 1, 2]], vec![]), MeshError::Empty { dropped: 1 });
    assert_eq!(refuse(&[], &cells, vec![]), MeshError::Index { cell: 0, index: 0, points: 0 });
    assert_eq!(refuse(&list, &[cells[0], [0, 1, 2, 4]], vec![]), MeshError::Index { cell: 1, index: 4, points: 4 });
    for value in [f64::INFINITY, f64::NEG_INFINITY, 1e39] {
        let mut bad = list.clone();
        bad[2].y = value;
        assert!(matches!(refuse(&bad, &cells, vec![]), MeshError::Point { .. }), "{value}");
    }
    let mut bad = list.clone();
    bad[2].y = f64::NAN;
    assert!(matches!(refuse(&bad, &cells, vec![]), MeshError::Point { point: 2, .. }));

    for (field, expected) in [
        (Field::point("f", 1, vec![0.0; 3]), 4),
        (Field::point("f", 3, vec![0.0; 4]), 12),
        (Field::point("f", 0, vec![]), 4),
        (Field::cell("f", 1, vec![0.0; 4]), 1),
        (Field::point("f", usize::MAX, vec![0.0; 4]), usize::MAX),
    ] {
        match refuse(&list, &cells, vec![field]) {
            MeshError::FieldLength { expected: e, .. } => assert_eq!(e, expected),
            other => panic!("{other}"),
        }
    }
}

#[test]
fn place_and_size_do_not_matter() {
    let reference = cuboid([3, 2, 2], Split::Five, [DVec3::ZERO, DVec3::new(3.0, 2.0, 2.0)]);
    let cells = TetMesh::assemble(&reference.points, &reference.cells, vec![]).unwrap().cells().to_vec();
    for scale in [1e-12, 1.0, 1e12] {
        for offset in [DVec3::ZERO, DVec3::new(1e9, -1e9, 1e9) * scale] {
            let place = |p: &DVec3| *p * scale + offset;
            let list: Vec<DVec3> = reference.points.iter().map(place).collect();
            let mesh = TetMesh::assemble(&list, &reference.cells, vec![]).unwrap();
            let found = mesh.assembly();
            assert_eq!((found.points_merged, found.cells_inverted, found.cells_flat), (0, 0, 0), "{scale} {offset}");
            assert_eq!(mesh.cells(), cells);
            // At a billion widths from the origin, doubles are 1.2e-7 of a width apart.
            let volume = 12.0 * scale.powi(3);
            assert!((mesh.validate().volume / volume - 1.0).abs() < 1e-6, "{scale} {offset}");
            for (p, q) in list.iter().enumerate() {
                assert!((mesh.world(p as u32) - *q).abs().max_element() < 1e-6 * scale);
            }
        }
    }
}

#[test]
fn coincident_points_are_named_by_the_first() {
    // In single precision a billionth beside one is one, and a billionth itself is a point.
    let list = points(&[[-1.0; 3], [1.0; 3], [1e-9, 0.0, 0.0], [1.0, 1.0, 1.0 + 1e-9], [0.0; 3], [0.0, -0.0, 0.0]]);
    assert_eq!(coincident(&list).unwrap(), [0, 1, 2, 1, 4, 4]);
    assert_eq!(coincident(&[]).unwrap(), []);
    assert!(matches!(coincident(&[DVec3::NAN]), Err(MeshError::Point { point: 0, .. })));
}
