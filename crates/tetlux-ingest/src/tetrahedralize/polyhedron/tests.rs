use glam::DVec3;
use tetlux_mesh::Field;
use tetlux_mesh::procedural::Split;

use crate::{MixedCells, MixedMesh};

const CUBE: [[f64; 3]; 8] =
    [[0., 0., 0.], [2., 0., 0.], [2., 2., 0.], [0., 2., 0.], [0., 0., 2.], [2., 0., 2.], [2., 2., 2.], [0., 2., 2.]];
const FACES: [[u32; 4]; 6] = [[0, 1, 2, 3], [4, 7, 6, 5], [0, 4, 5, 1], [1, 5, 6, 2], [2, 6, 7, 3], [3, 7, 4, 0]];

fn points() -> Vec<DVec3> {
    CUBE.map(DVec3::from).to_vec()
}

fn of(points: Vec<DVec3>, faces: &[&[u32]]) -> MixedMesh {
    let mut cells = MixedCells::default();
    let all: Vec<u32> = (0..points.len() as u32).collect();
    cells.push_polyhedron(&all, faces);
    MixedMesh { points, cells, ..MixedMesh::default() }
}

#[test]
fn the_middle_has_the_mean_of_the_corners() {
    let mut mesh = of(points(), &FACES.each_ref().map(|f| f.as_slice()));
    let values: Vec<f64> = (0..8).flat_map(|i| [f64::from(1 << i), f64::from(i)]).collect();
    mesh.fields = vec![Field::point("powers", 2, values), Field::cell("rank", 1, vec![7.0])];
    let tets = mesh.tetrahedralize(Split::Six).unwrap();
    // Two a face; 255 of eight, and 28 of eight.
    assert_eq!((tets.cells().len(), tets.world(8)), (12, DVec3::ONE));
    assert_eq!(tets.fields()[0].values[16..], [255.0 / 8.0, 3.5]);
    assert_eq!(tets.fields()[1].values, [7.0; 12]);
    assert_eq!((tets.validate().volume, tets.assembly().cells_inverted), (8.0, 0));
}

/// Whichever of the faces are seen from inside, none is lost and none inverted.
#[test]
fn faces_may_run_either_way() {
    for turned in 0u32..64 {
        let mut faces = FACES;
        (0..6).filter(|f| turned >> f & 1 == 1).for_each(|f| faces[f].reverse());
        let tets = of(points(), &faces.each_ref().map(|f| f.as_slice())).tetrahedralize(Split::Six).unwrap();
        assert_eq!((tets.validate().volume, tets.assembly().cells_inverted), (8.0, 0));
    }
}

#[test]
fn a_tetrahedron_stays_one() {
    let tets = of(
        CUBE[..4].iter().map(|&p| DVec3::from(p)).chain([DVec3::Z]).collect(),
        &[&[0, 1, 2], &[0, 1, 4], &[1, 4, 2], &[0, 2, 4]],
    )
    .tetrahedralize(Split::Six)
    .unwrap();
    assert_eq!((tets.cells().len(), tets.assembly().cells_inverted), (1, 0));
}

/// Collapsed faces, repeated corners, points listed by no face; and hardly a polyhedron at all.
#[test]
fn degenerate_polyhedra_are_what_is_left_of_them() {
    // The cube with corners 5, 6 and 7 drawn into 4: a pyramid over its base, the face above gone.
    let drawn = FACES.map(|face| face.map(|v| if v > 4 { 4 } else { v }));
    let report = of(points(), &drawn.each_ref().map(|f| f.as_slice())).tetrahedralize(Split::Six).unwrap().validate();
    // A base of 4 and a height of 2; the middle, at 4/5 and 2/5, is rounded to single precision.
    assert!((report.volume - 8.0 / 3.0).abs() < 1e-6, "{}", report.volume);
    assert_eq!((report.cells, report.boundary_faces), (6, 6));

    let hardly: [&[&[u32]]; 3] =
        [&[], &[&[0, 1, 2], &[2, 1, 0]], &[&[0, 0, 0], &[1, 1, 1], &[2, 2, 2], &[3, 3, 3], &[0, 1, 1]]];
    for faces in hardly {
        assert!(of(points(), faces).tetrahedralize(Split::Six).is_err(), "nothing to render");
    }
}
