use glam::DVec3;
use proptest::prelude::*;
use tetlux_mesh::procedural::{Split, cuboid, for_each_hexahedron, sphere_shell};

use super::*;
use crate::{MixedCells, StructuredGrid};

const N: [usize; 3] = [3, 4, 2];

fn push(cells: &mut MixedCells, number: u8, corners: &[u32]) {
    cells.types.push(number);
    cells.connectivity.extend_from_slice(corners);
    cells.offsets.push(cells.connectivity.len());
}

/// The unit cube as hexahedra, voxels, pairs of wedges and sixes of pyramids; `kinds` chooses for each place.
fn zoo(kinds: &[u8]) -> (MixedMesh, usize) {
    let mut mesh =
        MixedMesh { points: cuboid(N, Split::Six, [DVec3::ZERO, DVec3::ONE]).points, ..MixedMesh::default() };
    let (mut cells, mut centers, mut expected) = (MixedCells::default(), Vec::new(), 0);
    for_each_hexahedron(N.map(|n| n + 1), |[i, j, k], c| {
        let column = kinds[i + N[0] * j];
        // Wedges cut their upper and lower faces: a whole column has them, or none.
        match if column == 3 { 3 } else { (column + kinds[k]) % 3 } {
            0 => push(&mut cells, 12, &c),
            1 => push(&mut cells, 11, &[c[0], c[1], c[3], c[2], c[4], c[5], c[7], c[6]]),
            2 => {
                let center = (mesh.points.len() + centers.len()) as u32;
                centers.push((mesh.points[c[0] as usize] + mesh.points[c[6] as usize]) * 0.5);
                for face in [[0, 1, 2, 3], [4, 7, 6, 5], [0, 4, 5, 1], [1, 5, 6, 2], [2, 6, 7, 3], [3, 7, 4, 0]] {
                    let [p, q, r, s] = face.map(|f: usize| c[f]);
                    push(&mut cells, 14, &[p, q, r, s, center]);
                }
                expected += 6;
            }
            _ => {
                push(&mut cells, 13, &[c[0], c[2], c[1], c[4], c[6], c[5]]);
                push(&mut cells, 13, &[c[0], c[3], c[2], c[4], c[7], c[6]]);
            }
        }
        expected += 6;
    });
    mesh.points.extend(centers);
    mesh.cells = cells;
    (mesh, expected)
}

/// The same mesh with its points in another order: that of their keys.
fn renumbered(mut mesh: MixedMesh, keys: &[u32]) -> MixedMesh {
    let mut order: Vec<u32> = (0..mesh.points.len() as u32).collect();
    order.sort_by_key(|&p| (keys[p as usize % keys.len()], p));
    let mut place = vec![0; order.len()];
    order.iter().enumerate().for_each(|(new, &old)| place[old as usize] = new as u32);
    mesh.points = order.iter().map(|&old| mesh.points[old as usize]).collect();
    mesh.cells.connectivity.iter_mut().for_each(|v| *v = place[*v as usize]);
    mesh
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 100, failure_persistence: None, ..ProptestConfig::default() })]

    /// However the points are numbered, cells of all types fit together: nothing but the cube's surface is boundary.
    #[test]
    fn cells_of_all_types_conform(
        kinds in prop::collection::vec(0u8..4, N[0] * N[1]), keys in prop::collection::vec(any::<u32>(), 97),
    ) {
        let (mesh, expected) = zoo(&kinds);
        let report = renumbered(mesh, &keys).tetrahedralize(Split::Six).unwrap().validate();
        prop_assert_eq!(report.cells, expected);
        prop_assert_eq!((report.assembly.cells_inverted, report.assembly.cells_flat, report.assembly.faces_folded), (0, 0, 0));
        prop_assert_eq!(report.boundary_faces, 4 * (N[0] * N[1] + N[1] * N[2] + N[2] * N[0]));
        // Rounding of the positions to single precision, some 1e-7 of the cube's width each.
        prop_assert!((report.volume - 1.0).abs() < 1e-5, "{}", report.volume);
    }
}

/// The hexahedra of a sphere's shell, listed one by one.
fn shell(counts: [usize; 3]) -> MixedMesh {
    let points = sphere_shell(counts, Split::Six, DVec3::new(5.0, 0.0, 1.0), [1.0, 2.0]).points;
    let mut mesh = MixedMesh { points, ..MixedMesh::default() };
    for_each_hexahedron(counts.map(|n| n + 1), |_, corners| push(&mut mesh.cells, 12, &corners));
    mesh
}

const SHELL: [usize; 3] = [7, 4, 3];

proptest! {
    #![proptest_config(ProptestConfig { cases: 100, failure_persistence: None, ..ProptestConfig::default() })]

    /// Where the grid closes on itself, the two sides' points are numbered alike only once coincident ones are one.
    #[test]
    fn listed_hexahedra_conform_across_a_seam_and_at_collapsed_edges(keys in prop::collection::vec(any::<u32>(), 97)) {
        let report = renumbered(shell(SHELL), &keys).tetrahedralize(Split::Six).unwrap().validate();
        prop_assert_eq!(report.quads_split_both_ways, 0);
        prop_assert_eq!((report.assembly.cells_inverted, report.assembly.cells_flat, report.components), (0, 0, 1));
        // Two spheres of 7 x 4 quadrilaterals, those at the poles triangles.
        prop_assert_eq!(report.boundary_faces, 2 * (7 * 2 * 2 + 7 * 2));
    }
}

/// Seven hexahedra round the axis cannot be two-coloured, so the five-way split does not conform at the seam: what
/// the test above looks for is seen where it is.
#[test]
fn a_seam_that_does_not_conform_is_seen() {
    let mut grid = shell(SHELL);
    grid.cells = MixedCells::default();
    grid.grid = Some(StructuredGrid { counts: SHELL.map(|n| n + 1), blanked: None });
    assert!(grid.tetrahedralize(Split::Five).unwrap().validate().quads_split_both_ways > 0);
}

#[test]
fn cell_data_follow_their_cells() {
    let (mut mesh, expected) = zoo(&[0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3]);
    let numbers = (0..mesh.cells.types.len()).flat_map(|c| [c as f64, -(c as f64)]).collect();
    mesh.fields = vec![Field::cell("number", 2, numbers)];
    let cells = mesh.cells.clone();
    let tets = mesh.tetrahedralize(Split::Six).unwrap();
    assert_eq!(tets.cells().len(), expected);
    for (tet, number) in tets.cells().iter().zip(tets.fields()[0].values.chunks(2)) {
        assert_eq!(number[0], -number[1]);
        let corners = cells.cell(number[0] as usize).unwrap();
        assert!(tet.iter().all(|v| corners.contains(v)));
    }

    // Blanked hexahedra take their data with them: of two on one another only the second is left.
    let mut blanked = vec![false; 12];
    blanked[0] = true;
    let points = cuboid([1, 1, 2], Split::Six, [DVec3::ZERO, DVec3::ONE]).points;
    let grid = Some(StructuredGrid { counts: [2, 2, 3], blanked: Some(blanked) });
    let fields = vec![Field::cell("number", 1, vec![1.0, 2.0])];
    let tets = MixedMesh { points, grid, fields, ..MixedMesh::default() }.tetrahedralize(Split::Five).unwrap();
    assert_eq!(tets.fields()[0].values, [2.0; 5]);
}
