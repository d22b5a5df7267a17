use glam::DVec3;
use tetlux_mesh::Field;

use super::*;
use crate::StructuredGrid;

fn points(count: usize) -> Vec<DVec3> {
    (0..count).map(|i| DVec3::splat(i as f64)).collect()
}

/// A tetrahedron, a polyhedron of the same shape, and a grid of one hexahedron.
fn block() -> MixedMesh {
    let mut cells = MixedCells::default();
    cells.push(10, &[0, 1, 2, 3]);
    cells.push_polyhedron(&[0, 1, 2, 3], &[&[1, 2, 3], &[0, 3, 2], &[0, 1, 3], &[0, 2, 1]]);
    let grids = vec![StructuredGrid { first_point: 4, counts: [2, 2, 2], blanked: None }];
    MixedMesh { points: points(12), cells, grids, ..MixedMesh::default() }
}

#[test]
fn cells_are_numbered_on() {
    let mut mesh = block();
    mesh.append(block());
    mesh.check().unwrap();
    assert_eq!(mesh.cell_counts(), [("tetrahedra", 2), ("hexahedra", 2), ("polyhedra", 2)]);
    assert_eq!(mesh.cells.cell(2).unwrap(), [12, 13, 14, 15]);
    let theirs = mesh.cells.faces(3).unwrap();
    assert_eq!(
        theirs,
        mesh.cells.faces(1).unwrap().iter().map(|f| f.iter().map(|v| v + 12).collect()).collect::<Vec<Vec<u32>>>()
    );
    assert_eq!(mesh.grids[1].first_point, 16);

    // Blocks with and without polyhedra, either way round.
    let mut plain = MixedMesh { points: points(4), ..MixedMesh::default() };
    plain.cells.push(10, &[0, 1, 2, 3]);
    for (mut a, b) in [(plain.clone(), block()), (block(), plain)] {
        a.append(b);
        a.check().unwrap();
        assert_eq!(a.cell_counts(), [("tetrahedra", 2), ("hexahedra", 1), ("polyhedra", 1)]);
    }
}

#[test]
fn cell_fields_stay_with_their_cells() {
    let with = |values: [f64; 6]| MixedMesh { fields: vec![Field::cell("f", 2, values.to_vec())], ..block() };
    let mut mesh = with([1.0, 1.5, 2.0, 2.5, 3.0, 3.5]);
    mesh.append(with([4.0, 4.5, 5.0, 5.5, 6.0, 6.5]));
    mesh.check().unwrap();
    assert_eq!(mesh.fields[0].values, [1.0, 1.5, 2.0, 2.5, 4.0, 4.5, 5.0, 5.5, 3.0, 3.5, 6.0, 6.5]);
}

#[test]
fn a_field_of_one_block_is_missing_on_the_other() {
    let mut mesh = MixedMesh { fields: vec![Field::cell("a", 1, vec![1.0, 2.0, 3.0])], ..block() };
    let theirs = vec![Field::point("b", 1, vec![7.0; 12]), Field::cell("a", 2, vec![5.0; 6])];
    mesh.append(MixedMesh { fields: theirs, ..block() });
    mesh.check().unwrap();
    let missing = |name: &str| -> Vec<bool> {
        mesh.fields.iter().find(|f| f.name == name).unwrap().values.iter().map(|v| v.is_nan()).collect()
    };
    assert_eq!(missing("a"), [false, false, true, true, false, true]);
    assert_eq!(missing("a'"), [true, true, true, true, false, false, false, false, true, true, false, false]);
    assert_eq!(missing("b"), [[true; 12], [false; 12]].concat());
    assert_eq!(mesh.notes.len(), 2, "{:?}", mesh.notes);

    // To nothing, a block is added as it is.
    let mut empty = MixedMesh::default();
    empty.append(mesh.clone());
    assert_eq!((empty.fields.len(), empty.notes), (3, mesh.notes));
}

#[test]
fn no_more_than_so_many_fields_are_made() {
    let mut mesh = MixedMesh::default();
    for i in 0..MOST_FIELDS + 5 {
        let fields = vec![Field::point(format!("f{i}"), 1, vec![0.0])];
        mesh.append(MixedMesh { points: points(1), fields, ..MixedMesh::default() });
    }
    assert_eq!((mesh.fields.len(), mesh.points.len(), mesh.notes.len()), (MOST_FIELDS, MOST_FIELDS + 5, MOST_FIELDS));
}

#[test]
fn a_broken_face_stream_stays_broken() {
    for stream in [vec![4, 3, 0], vec![2, u32::MAX, 0, 0], vec![u32::MAX]] {
        let mut broken = block();
        broken.cells.face_stream = stream;
        let mut mesh = block();
        mesh.append(broken);
        assert!(mesh.check().is_err());
    }
}
