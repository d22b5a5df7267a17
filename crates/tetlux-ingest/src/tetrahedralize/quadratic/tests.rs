use std::collections::BTreeMap;

use glam::DVec3;
use proptest::prelude::*;
use tetlux_mesh::Field;
use tetlux_mesh::procedural::Split;

use super::super::conformity::faces_that_differ;
use super::super::tests::{N, assert_conforms, cases, keys, kinds, moves, shuffled, surface, zoo};
use crate::{MixedCells, MixedMesh};

/// A quadratic type as VTK 9 answers to GetEdge and GetFace: its number, the ends of the edge of each mid-edge point,
/// the corners of the face of each mid-face point, and whether there is a point in the middle.
type Points = (u8, &'static [[usize; 2]], &'static [[usize; 4]], bool);

/// The quadratic twin of a linear type, without and with points in the middle of quadrilaterals.
fn twin(linear: u8, middles: bool) -> Points {
    match (linear, middles) {
        (10, _) => (24, &[[0, 1], [1, 2], [2, 0], [0, 3], [1, 3], [2, 3]], &[], false),
        (12, false) => (25, HEXAHEDRON, &[], false),
        (12, true) => (
            29,
            HEXAHEDRON,
            &[[0, 4, 7, 3], [1, 2, 6, 5], [0, 1, 5, 4], [3, 7, 6, 2], [0, 3, 2, 1], [4, 5, 6, 7]],
            true,
        ),
        (13, false) => (26, WEDGE, &[], false),
        (13, true) => (32, WEDGE, &[[0, 1, 4, 3], [1, 2, 5, 4], [2, 0, 3, 5]], false),
        (14, false) => (27, PYRAMID, &[], false),
        (14, true) => (27, PYRAMID, &[[0, 3, 2, 1]], false),
        _ => panic!("{linear}"),
    }
}

const HEXAHEDRON: &[[usize; 2]] =
    &[[0, 1], [1, 2], [3, 2], [0, 3], [4, 5], [5, 6], [7, 6], [4, 7], [0, 4], [1, 5], [2, 6], [3, 7]];
const WEDGE: &[[usize; 2]] = &[[0, 1], [1, 2], [2, 0], [3, 4], [4, 5], [5, 3], [0, 3], [1, 4], [2, 5]];
const PYRAMID: &[[usize; 2]] = &[[0, 1], [1, 2], [2, 3], [3, 0], [0, 4], [1, 4], [2, 4], [3, 4]];

/// The mesh with every cell that `chosen` picks made quadratic: points in the middle of edges, and perhaps of faces.
/// Those inside the unit cube are moved by up to `bend`.
fn quadratic(mesh: &MixedMesh, middles: impl Fn(usize) -> Option<bool>, moves: &[[f64; 3]], bend: f64) -> MixedMesh {
    let mut points = mesh.points.clone();
    let mut known: BTreeMap<Vec<u32>, u32> = BTreeMap::new();
    let mut middle = |ends: &[u32]| {
        let mut key = ends.to_vec();
        key.sort_unstable();
        *known.entry(key).or_insert_with(|| {
            let mut at = ends.iter().map(|&v| points[v as usize]).sum::<DVec3>() / ends.len() as f64;
            if at.min_element() > 0.0 && at.max_element() < 1.0 {
                at += DVec3::from(moves[points.len() % moves.len()]) * bend;
            }
            points.push(at);
            points.len() as u32 - 1
        })
    };
    let mut cells = MixedCells::default();
    for (c, &number) in mesh.cells.types.iter().enumerate() {
        let corners = mesh.cells.cell(c).unwrap();
        let Some(middles) = middles(c) else {
            cells.push(number, corners);
            continue;
        };
        let (number, edges, faces, center) = twin(number, middles);
        let mut all = corners.to_vec();
        all.extend(edges.iter().map(|edge| middle(&edge.map(|i| corners[i]))));
        all.extend(faces.iter().map(|face| middle(&face.map(|i| corners[i]))));
        if center {
            all.push(middle(corners));
        }
        cells.push(number, &all);
    }
    MixedMesh { points, cells, ..mesh.clone() }
}

/// Tetrahedra of a quadratic cell.
fn parts(mesh: &MixedMesh, cell: usize) -> usize {
    match (mesh.cells.types[cell], mesh.cells.cell(cell).unwrap().len()) {
        (24, 10) => 8,
        // Eight corners, eight triangles across these, six squares.
        (25, 20) => 8 + 8 + 12,
        // Six corners, six triangles across these, two triangles and three squares.
        (26, 15) => 6 + 6 + 2 + 6,
        // Four corners of the base and two halves of the apex; across these four triangles and a square; four triangles
        // of the sides and the base's square.
        (27, 13) => 4 + 2 + 4 + 2 + 4 + 2,
        (27, 14) => 6 * 2 + 4,
        (29, 27) => 8 * 6,
        (32, 18) => 8 * 3,
        other => panic!("{other:?}"),
    }
}

/// Pyramids cut to tetrahedra by the rule of the smallest corner, so that all linear types but polyhedra are there.
fn linear(kinds: &[u8], keys: &[u32], moves: &[[f64; 3]]) -> MixedMesh {
    let mesh = shuffled(&zoo(kinds, 3, moves), keys);
    let mut cells = MixedCells::default();
    for c in 0..mesh.cells.types.len() {
        cells.push(mesh.cells.types[c], mesh.cells.cell(c).unwrap());
    }
    MixedMesh { cells, ..mesh }
}

/// The hexahedra of a mesh cut to tetrahedra, which then have triangles alone to share.
fn tetrahedra(mesh: &MixedMesh) -> MixedMesh {
    let tets = mesh.clone().tetrahedralize(Split::Six).unwrap();
    let mut cells = MixedCells::default();
    tets.cells().iter().for_each(|cell| cells.push(10, cell));
    let points = (0..tets.points().len() as u32).map(|p| tets.world(p)).collect();
    MixedMesh { points, cells, ..MixedMesh::default() }
}

proptest! {
    #![proptest_config(cases(100))]

    /// Quadratic cells of all types fit together, straight or bent, without and with points in their faces.
    #[test]
    fn quadratic_cells_conform(
        kinds in kinds(), keys in keys(), moves in moves(), middles in any::<bool>(), bend in prop::sample::select(vec![0.0, 0.01]),
    ) {
        let mesh = quadratic(&linear(&kinds, &keys, &moves), |_| Some(middles), &moves, bend);
        let mesh = shuffled(&mesh, &keys);
        prop_assert_eq!(faces_that_differ(&mesh), 0);
        let expected: usize = (0..mesh.cells.types.len()).map(|c| parts(&mesh, c)).sum();
        // Each square of the surface is cut in eight, or in six; but in eight above and below wedges.
        let wedges = mesh.cells.types.iter().filter(|&&t| t == 26).count();
        let expected_surface = if middles { surface(8) } else { surface(6) + 2 * (8 - 6) * wedges / (2 * N[2]) };
        let tets = assert_conforms(mesh, expected_surface);
        prop_assert_eq!(tets.cells().len(), expected);
    }

    #[test]
    fn quadratic_tetrahedra_conform(kinds in kinds(), keys in keys(), moves in moves(), bend in prop::sample::select(vec![0.0, 0.01])) {
        let linear = tetrahedra(&linear(&kinds, &keys, &moves));
        let mesh = shuffled(&quadratic(&linear, |_| Some(false), &moves, bend), &keys);
        let expected = 8 * mesh.cells.types.len();
        prop_assert_eq!(assert_conforms(mesh, surface(2 * 4)).cells().len(), expected);
    }

    /// Wherever cells of different kinds meet they are counted: half of the cube linear, or with points in the faces.
    #[test]
    fn faces_that_cannot_fit_are_counted(keys in keys(), linear in any::<bool>()) {
        let cube = zoo(&[0; 12], 3, &[[0.0; 3]]);
        let mesh = quadratic(&cube, |c| if c % 3 == 0 { Some(false) } else if linear { None } else { Some(true) }, &[[0.0; 3]], 0.0);
        // Three hexahedra along x, the first of which is different.
        prop_assert_eq!(faces_that_differ(&shuffled(&mesh, &keys)), 4 * 2);
    }
}

/// The middle of a hexahedron and a wedge has the value of the cell's own interpolation: exact for a quadratic field.
#[test]
fn added_points_have_the_cells_own_interpolation() {
    for (linear, corners, center) in [
        (
            12,
            [
                [0., 0., 0.],
                [1., 0., 0.],
                [1., 1., 0.],
                [0., 1., 0.],
                [0., 0., 1.],
                [1., 0., 1.],
                [1., 1., 1.],
                [0., 1., 1.],
            ]
            .to_vec(),
            [0.5; 3],
        ),
        (
            13,
            [[0., 0., 0.], [1., 0., 0.], [0., 1., 0.], [0., 0., 1.], [1., 0., 1.], [0., 1., 1.]].to_vec(),
            [1.0 / 3.0, 1.0 / 3.0, 0.5],
        ),
    ] {
        let points: Vec<DVec3> = corners.into_iter().map(DVec3::from).collect();
        let mut cells = MixedCells::default();
        cells.push(linear, &(0..points.len() as u32).collect::<Vec<_>>());
        let mut mesh =
            quadratic(&MixedMesh { points, cells, ..MixedMesh::default() }, |_| Some(false), &[[0.0; 3]], 0.0);
        let field = |p: DVec3| 3.0 + p.x * p.y - 2.0 * p.z * p.z + p.x * p.x + p.y * p.z;
        mesh.fields = vec![Field::point("quadratic", 1, mesh.points.iter().map(|&p| field(p)).collect())];
        let tets = mesh.tetrahedralize(Split::Six).unwrap();
        let added = tets.points().len() - 1;
        let at = tets.world(added as u32);
        // Rounding to single precision; of a dozen terms in the sum to double precision.
        assert!((at - DVec3::from(center)).abs().max_element() < 1e-7, "{at}");
        assert!((tets.fields()[0].values[added] - field(DVec3::from(center))).abs() < 1e-14);
    }
}

/// A quadratic hexahedron with an edge of its base and of its top drawn together is a quadratic wedge, and fits one.
#[test]
fn collapsed_quadratic_hexahedra_are_wedges() {
    let corners = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]];
    let points: Vec<DVec3> = corners.iter().map(|&c: &[i32; 3]| DVec3::from(c.map(f64::from))).collect();
    let mut cells = MixedCells::default();
    cells.push(13, &[0, 1, 2, 4, 5, 6]);
    cells.push(13, &[0, 2, 3, 4, 6, 7]);
    let wedges = quadratic(&MixedMesh { points, cells, ..MixedMesh::default() }, |_| Some(false), &[[0.0; 3]], 0.0);
    for key in 0..40u32 {
        let keys: Vec<u32> = (0..97u32).map(|i| (i * 37 + 11 * key) % 97).collect();
        let mut mesh = shuffled(&wedges, &keys);
        let Some(&[a, b, c, d, e, f, ab, bc, ca, de, ef, fd, ad, be, cf]) = mesh.cells.cell(1) else { panic!() };
        let other = mesh.cells.cell(0).unwrap().to_vec();
        mesh.cells = MixedCells::default();
        mesh.cells.push(26, &other);
        // Corners 2 and 3 are one, and 6 and 7, with the points between them.
        mesh.cells.push(25, &[a, b, c, c, d, e, f, f, ab, bc, c, ca, de, ef, f, fd, ad, be, cf, cf]);
        let report = mesh.tetrahedralize(Split::Six).unwrap().validate();
        // The cube's corners and their means are exact in single precision, but for the middle of the wedge.
        assert!((report.volume - 1.0).abs() < 1e-6, "{}", report.volume);
        // Four walls of six triangles, and two of two triangles cut in four each.
        assert_eq!((report.boundary_faces, report.components), (4 * 6 + 2 * 8, 1));
        let assembly = report.assembly;
        assert_eq!((assembly.cells_inverted, assembly.cells_flat, assembly.cells_repeated), (0, 0, 0));
        assert_eq!((report.quads_split_both_ways, assembly.faces_folded), (0, 0));
    }
}
