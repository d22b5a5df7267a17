use glam::DVec3;
use proptest::prelude::*;
use tetlux_mesh::NONE;
use tetlux_mesh::procedural::{Parts, Split, cuboid};

use super::*;

fn grid(counts: [usize; 3]) -> TetMesh {
    let parts = cuboid(counts, Split::Six, [DVec3::ZERO, DVec3::new(1.0, 0.7, 1.3)]);
    TetMesh::assemble(&parts.points, &parts.cells, vec![]).unwrap()
}

/// Codes and arrows as seen from an eye in the mesh's coordinates.
fn seen(mesh: &TetMesh, facts: &Facts, eye: &Viewpoint) -> (Vec<u8>, Vec<u8>, bool, Doubts) {
    let (mut codes, mut arrows) = (vec![], vec![]);
    let doubts = face_codes(mesh, facts, eye, &mut codes);
    let inside = cell_arrows(facts, &codes, &mut arrows);
    (codes, arrows, inside, doubts)
}

proptest! {
    #[test]
    fn every_code_is_that_of_exact_arithmetic(
        at in prop::array::uniform3(-3.0f64..3.0), corner in 0usize..4, finite in any::<bool>(), place in 0..3,
    ) {
        let mesh = grid([3, 2, 2]);
        let facts = Facts::new(&mesh);
        let vertex = |v: usize| mesh.points()[mesh.cells()[17][v] as usize].as_dvec3();
        // Anywhere, on a vertex, or in the plane of three.
        let at = match place {
            0 => DVec3::from(at),
            1 => vertex(corner),
            _ => vertex(0) + 2.0 * (vertex(1) - vertex(0)) - (vertex(2) - vertex(0)),
        };
        let eye = Viewpoint::new(at, finite);
        let (codes, arrows, _, doubts) = seen(&mesh, &facts, &eye);
        prop_assert!(doubts.exact <= doubts.in_double);
        for face in 0..facts.owners.len() {
            let (cell, vertices) = facts.vertices(&mesh, face);
            let [a, b, c] = vertices.map(|v| mesh.points()[v as usize]);
            let sign = plane_sign(a, b, c, &eye).value;
            let place = (facts.owners[face] & 3) as usize;
            let neighbor = mesh.neighbors()[cell as usize][place];
            let arrow = |cell: u32, place: usize| arrows[cell as usize] >> place & 1 == 1;
            if neighbor == NONE {
                prop_assert_eq!((is_entry(codes[face]), is_exit(codes[face])), (sign > 0, sign < 0));
                prop_assert!(!arrow(cell, place), "no arrow leaves the mesh");
            } else {
                let back = mesh.neighbors()[neighbor as usize].iter().position(|&n| n == cell).unwrap();
                prop_assert_eq!((arrow(cell, place), arrow(neighbor, back)), (sign < 0, sign > 0));
            }
        }
    }
}

#[test]
fn the_eye_is_inside_where_it_is() {
    let mesh = grid([2, 2, 2]);
    let facts = Facts::new(&mesh);
    let inside = |at: DVec3, finite| seen(&mesh, &facts, &Viewpoint::new(at, finite)).2;
    assert!(inside(DVec3::new(0.1, 0.2, 0.3), true));
    assert!(inside(DVec3::ZERO, true), "on a vertex of the middle");
    assert!(!inside(DVec3::new(0.6, 0.0, 0.0), true));
    assert!(!inside(DVec3::new(0.1, 0.2, 0.3), false), "never if it is infinitely far away");
}

#[test]
fn single_precision_decides_almost_all() {
    let mesh = grid([12, 12, 12]);
    let facts = Facts::new(&mesh);
    let (_, _, _, doubts) = seen(&mesh, &facts, &Viewpoint::new(DVec3::new(1.9, -2.3, 0.7), true));
    assert!(doubts.in_double * 1000 < facts.owners.len(), "{doubts:?}");
    // Looked at along the grid, two thirds of its planes are seen edge-on: all of them are doubtful, and decided.
    let (codes, _, _, doubts) = seen(&mesh, &facts, &Viewpoint::new(DVec3::X, false));
    let edge_on = codes[..facts.owners.len()].iter().filter(|&&code| code == 0).count();
    assert!(edge_on > facts.owners.len() / 4 && doubts.in_double >= edge_on);
}

#[test]
fn slivers_and_extremes_are_decided_exactly() {
    // A needle 1e-12 wide beside a cell of 1e6: planes that single precision does not know.
    let points = [[0.0; 3], [1e6, 0.0, 0.0], [5e5, 1e-12, 0.0], [3e5, 0.0, 1e-12], [0.0, -1e6, 4e5]].map(DVec3::from);
    let parts = Parts { points: points.to_vec(), cells: vec![[0, 1, 2, 3], [0, 1, 3, 4]] };
    let mesh = TetMesh::assemble(&parts.points, &parts.cells, vec![]).unwrap();
    let facts = Facts::new(&mesh);
    for at in [DVec3::new(1e-7, 2e-9, 0.3), DVec3::splat(1e35), DVec3::splat(1e-35)] {
        let eye = Viewpoint::new(at, true);
        let (codes, ..) = seen(&mesh, &facts, &eye);
        for face in facts.interior..facts.owners.len() {
            let [a, b, c] = facts.vertices(&mesh, face).1.map(|v| mesh.points()[v as usize]);
            let sign = plane_sign(a, b, c, &eye).value;
            assert_eq!((is_entry(codes[face]), is_exit(codes[face])), (sign > 0, sign < 0), "{at}, face {face}");
        }
    }
}
