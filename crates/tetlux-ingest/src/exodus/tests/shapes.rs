//! Each kind of element, with its points where Exodus and VTK define them: at corners and in the middle of corners.

use super::writer::{F64, File, I32};
use super::*;

type Middles = &'static [&'static [usize]];

/// A kind, its corners' positions, and which corners each further point is the middle of, in Exodus and in VTK.
struct Kind {
    names: &'static [&'static str],
    vtk: u8,
    corners: &'static [[f64; 3]],
    exodus: Middles,
    of_vtk: Middles,
}

const CUBE: &[[f64; 3]] =
    &[[0., 0., 0.], [1., 0., 0.], [1., 2., 0.], [0., 2., 0.], [0., 0., 4.], [1., 0., 4.], [1., 2., 4.], [0., 2., 4.]];
const TETRAHEDRON: &[[f64; 3]] = &[[0., 0., 0.], [1., 0., 0.], [0., 2., 0.], [0., 0., 4.]];
const WEDGE: &[[f64; 3]] = &[[0., 0., 0.], [1., 0., 0.], [0., 2., 0.], [0., 0., 4.], [1., 0., 4.], [0., 2., 4.]];
const PYRAMID: &[[f64; 3]] = &[[0., 0., 0.], [1., 0., 0.], [1., 2., 0.], [0., 2., 0.], [0., 0., 4.]];

const TETRAHEDRON_EDGES: Middles = &[&[0, 1], &[1, 2], &[2, 0], &[0, 3], &[1, 3], &[2, 3]];
const PYRAMID_EDGES: Middles = &[&[0, 1], &[1, 2], &[2, 3], &[3, 0], &[0, 4], &[1, 4], &[2, 4], &[3, 4]];

/// Figures of the Exodus II report, and vtkQuadraticHexahedron, vtkTriQuadraticHexahedron, vtkQuadraticWedge.
#[rustfmt::skip]
const KINDS: &[Kind] = &[
    Kind { names: &["HEX", "HEX8", "hexahedron"], vtk: 12, corners: CUBE, exodus: &[], of_vtk: &[] },
    Kind {
        names: &["HEX20", "Hex"], vtk: 25, corners: CUBE,
        exodus: &[
            &[0, 1], &[1, 2], &[2, 3], &[3, 0], &[0, 4], &[1, 5], &[2, 6], &[3, 7], &[4, 5], &[5, 6], &[6, 7], &[7, 4],
        ],
        of_vtk: &[
            &[0, 1], &[1, 2], &[2, 3], &[3, 0], &[4, 5], &[5, 6], &[6, 7], &[7, 4], &[0, 4], &[1, 5], &[2, 6], &[3, 7],
        ],
    },
    Kind {
        names: &["HEX27"], vtk: 29, corners: CUBE,
        exodus: &[
            &[0, 1], &[1, 2], &[2, 3], &[3, 0], &[0, 4], &[1, 5], &[2, 6], &[3, 7], &[4, 5], &[5, 6], &[6, 7], &[7, 4],
            &[0, 1, 2, 3, 4, 5, 6, 7], &[0, 1, 2, 3], &[4, 5, 6, 7], &[0, 3, 7, 4], &[1, 2, 6, 5], &[0, 1, 5, 4],
            &[2, 3, 7, 6],
        ],
        of_vtk: &[
            &[0, 1], &[1, 2], &[2, 3], &[3, 0], &[4, 5], &[5, 6], &[6, 7], &[7, 4], &[0, 4], &[1, 5], &[2, 6], &[3, 7],
            &[0, 3, 7, 4], &[1, 2, 6, 5], &[0, 1, 5, 4], &[2, 3, 7, 6], &[0, 1, 2, 3], &[4, 5, 6, 7],
            &[0, 1, 2, 3, 4, 5, 6, 7],
        ],
    },
    Kind { names: &["TET4", "TETRA", "tet", "TETRA4"], vtk: 10, corners: TETRAHEDRON, exodus: &[], of_vtk: &[] },
    Kind {
        names: &["TET10", "TETRA10", "tetra"], vtk: 24, corners: TETRAHEDRON,
        exodus: TETRAHEDRON_EDGES, of_vtk: TETRAHEDRON_EDGES,
    },
    Kind { names: &["WEDGE", "wedge6"], vtk: 13, corners: WEDGE, exodus: &[], of_vtk: &[] },
    Kind {
        names: &["WEDGE15"], vtk: 26, corners: WEDGE,
        exodus: &[&[0, 1], &[1, 2], &[2, 0], &[0, 3], &[1, 4], &[2, 5], &[3, 4], &[4, 5], &[5, 3]],
        of_vtk: &[&[0, 1], &[1, 2], &[2, 0], &[3, 4], &[4, 5], &[5, 3], &[0, 3], &[1, 4], &[2, 5]],
    },
    Kind { names: &["PYRAMID", "pyramid5"], vtk: 14, corners: PYRAMID, exodus: &[], of_vtk: &[] },
    Kind { names: &["PYRAMID13"], vtk: 27, corners: PYRAMID, exodus: PYRAMID_EDGES, of_vtk: PYRAMID_EDGES },
];

fn points(corners: &[[f64; 3]], middles: Middles) -> Vec<DVec3> {
    let corner = |c: &usize| DVec3::from_array(corners[*c]);
    let middle = |of: &&[usize]| of.iter().map(corner).sum::<DVec3>() / of.len() as f64;
    (0..corners.len()).map(|c| corner(&c)).chain(middles.iter().map(middle)).collect()
}

fn element(version: u8, name: &'static str, points: &[DVec3]) -> File {
    let n = points.len();
    let dimensions = vec![("num_dim", 3), ("num_nodes", n as u64), ("one", 1)];
    let mut file = File { version, records: 0, dimensions, variables: Vec::new() };
    for (axis, name) in ["coordx", "coordy", "coordz"].into_iter().enumerate() {
        file.add(name, &["num_nodes"], F64, points.iter().map(|p| p[axis]).collect());
    }
    file.add("connect1", &["one", "num_nodes"], I32, (1..=n).map(|i| i as f64).collect());
    file.variable("connect1").elem_type = Some(name);
    file
}

#[test]
fn points_of_each_kind_come_in_the_order_of_vtk() {
    for kind in KINDS {
        for (&name, version) in kind.names.iter().zip([1, 2, 5].into_iter().cycle()) {
            let mesh = load(element(version, name, &points(kind.corners, kind.exodus)).bytes(), None).unwrap();
            assert_eq!(mesh.cells.types, [kind.vtk], "{name}");
            let found: Vec<DVec3> = mesh.cells.connectivity.iter().map(|&p| mesh.points[p as usize]).collect();
            assert_eq!(found, points(kind.corners, kind.of_vtk), "{name}");
            assert_eq!(mesh.notes, [""; 0], "{name}");
        }
    }
}

#[test]
fn points_beyond_those_of_a_kind_are_noted_and_passed_over() {
    // A hexahedron with a point in its middle, which VTK has no cell for.
    let middle: Middles = &[&[0, 1, 2, 3, 4, 5, 6, 7]];
    let mesh = load(element(1, "HEX9", &points(CUBE, middle)).bytes(), None).unwrap();
    assert_eq!((mesh.cells.types.as_slice(), mesh.cells.connectivity.len()), ([12].as_slice(), 8));
    assert!(mesh.notes.len() == 1 && mesh.notes[0].contains("the first 8 count"), "{:?}", mesh.notes);
}

#[test]
fn an_element_of_too_few_points_or_an_unknown_kind_is_left_out() {
    for name in ["HEX8", "TRUSS", "SPHERE", "NFACED"] {
        let error = load(element(1, name, &points(TETRAHEDRON, &[])).bytes(), None).unwrap_err().to_string();
        assert!(error.contains(name) && error.contains("no block has cells with volume"), "{error}");
    }
}
