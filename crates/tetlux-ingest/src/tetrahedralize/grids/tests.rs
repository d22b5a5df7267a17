use glam::DVec3;
use tetlux_mesh::procedural::{Split, cuboid, grid};

use crate::{MixedMesh, StructuredGrid};

/// Blocks of 2 x 3 x 2 hexahedra beside one another along x, each with its axes as `turn` has them.
fn blocks(turns: &[fn(DVec3) -> DVec3]) -> MixedMesh {
    const N: [usize; 3] = [2, 2, 2];
    let mut mesh = MixedMesh::default();
    for (b, turn) in turns.iter().enumerate() {
        let points = grid(N, Split::Six, |u| (turn(u) + DVec3::X * b as f64) * 2.0).points;
        let grids = vec![StructuredGrid { first_point: 0, counts: N.map(|n| n + 1), blanked: None }];
        mesh.append(MixedMesh { points, grids, ..MixedMesh::default() });
    }
    mesh
}

const PLAIN: fn(DVec3) -> DVec3 = |u| u;
const BACK: fn(DVec3) -> DVec3 = |u| DVec3::new(1.0 - u.x, 1.0 - u.y, u.z);
const AROUND: fn(DVec3) -> DVec3 = |u| DVec3::new(u.y, u.z, u.x);
const ASIDE: fn(DVec3) -> DVec3 = |u| DVec3::new(u.x, 1.0 - u.z, u.y);

#[test]
fn blocks_conform_whichever_way_they_run() {
    for turns in [[PLAIN, PLAIN, PLAIN], [PLAIN, BACK, PLAIN], [AROUND, PLAIN, ASIDE], [ASIDE, BACK, AROUND]] {
        for split in [Split::Five, Split::Six] {
            let tets = blocks(&turns).tetrahedralize(split).unwrap();
            let report = tets.validate();
            // 6 x 2 x 2 cubes of 1.
            assert_eq!((report.volume, report.components, report.quads_split_both_ways), (24.0, 1, 0));
            assert_eq!(report.boundary_faces, 2 * 2 * (6 * 2 + 6 * 2 + 2 * 2));
            assert_eq!(report.cells, 24 * if split == Split::Five { 5 } else { 6 });
        }
    }
}

/// Three cubes in a ring cannot alternate, nor can a block that meets a listed cell: they are cut in six.
#[test]
fn where_five_do_not_conform_there_are_six() {
    // Three blocks of one hexahedron each round a hole.
    let mut mesh = MixedMesh::default();
    for b in 0..3 {
        let ray = |i: i32| DVec3::from([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [-1.0, -1.0, 0.0]][i as usize % 3]);
        let base = [ray(b), ray(b) * 2.0, ray(b + 1), ray(b + 1) * 2.0];
        let points = base.iter().copied().chain(base.iter().map(|&p| p + DVec3::Z)).collect();
        let grids = vec![StructuredGrid { first_point: 0, counts: [2; 3], blanked: None }];
        mesh.append(MixedMesh { points, grids, ..MixedMesh::default() });
    }
    let report = mesh.clone().tetrahedralize(Split::Five).unwrap().validate();
    assert_eq!((report.cells, report.quads_split_both_ways, report.boundary_faces), (18, 0, 3 * 2 * 4));

    let points = cuboid([1, 1, 1], Split::Six, [DVec3::ZERO, DVec3::ONE]).points;
    let above: Vec<DVec3> = points.iter().map(|&p| p + DVec3::Z).collect();
    let mut mesh = MixedMesh::default();
    mesh.append(MixedMesh {
        points,
        grids: vec![StructuredGrid { first_point: 0, counts: [2; 3], blanked: None }],
        ..MixedMesh::default()
    });
    let mut listed = MixedMesh { points: above, ..MixedMesh::default() };
    listed.cells.push(11, &[0, 1, 2, 3, 4, 5, 6, 7]);
    mesh.append(listed);
    let report = mesh.tetrahedralize(Split::Five).unwrap().validate();
    assert_eq!((report.cells, report.boundary_faces, report.quads_split_both_ways), (12, 20, 0));
}

/// A C-grid's two ends lie on one another and run opposite ways.
#[test]
fn six_conform_where_a_grid_folds_back_on_itself() {
    // Round a wing from 3 to its nose at -1 and back; behind its end at 1 both sides meet.
    let inner = [[3.0, 0.0], [2.0, 0.0], [1.0, 0.0], [0.0, 0.25], [-1.0, 0.0]];
    let outer = [[3.0, 2.0], [2.0, 2.0], [1.0, 2.0], [0.0, 2.0], [-3.0, 0.0]];
    let counts = [2 * inner.len() - 1, 2, 3];
    let mut points = Vec::new();
    for k in 0..counts[2] {
        for side in [inner, outer] {
            let below = side[..4].iter().rev().map(|&[x, y]| [x, -y]);
            points.extend(side.into_iter().chain(below).map(|[x, y]| DVec3::new(x, y, k as f64)));
        }
    }
    let grids = vec![StructuredGrid { first_point: 0, counts, blanked: None }];
    let mesh = MixedMesh { points, grids, ..MixedMesh::default() };
    let report = mesh.tetrahedralize(Split::Six).unwrap().validate();
    assert_eq!((report.quads_split_both_ways, report.assembly.points_merged), (0, 9));
    // Two layers of eight hexahedra: above and below, round the outside, on the wing, and at both ends.
    assert_eq!(report.boundary_faces, 2 * (2 * 8 + 2 * 8 + 2 * 4 + 2 * 2));
    assert_eq!((report.assembly.faces_non_manifold, report.assembly.faces_folded, report.components), (0, 0, 1));
}
