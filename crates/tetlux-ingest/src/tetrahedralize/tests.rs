use glam::DVec3;
use proptest::prelude::*;
use tetlux_mesh::procedural::{Split, cuboid, for_each_hexahedron, sphere_shell};

use super::*;
use crate::{MixedCells, StructuredGrid};

pub(super) const N: [usize; 3] = [3, 4, 2];

/// Corners of the six pyramids of a hexahedron, but for the apex in its middle.
const BASES: [[usize; 4]; 6] = [[0, 1, 2, 3], [4, 7, 6, 5], [0, 4, 5, 1], [1, 5, 6, 2], [2, 6, 7, 3], [3, 7, 4, 0]];

/// The unit cube as hexahedra, six pyramids each, pairs of wedges, voxels, polyhedra and six pyramid-shaped polyhedra;
/// `kinds` of `allowed` for each place. Points inside are moved at random by up to a twentieth of the distance
/// between them, so that faces are not plane; by twice as much, the middle of a pyramid, a tenth above its base, may lie
/// below that.
pub(super) fn zoo(kinds: &[u8], allowed: u8, moves: &[[f64; 3]]) -> MixedMesh {
    let spacing = DVec3::from(N.map(|n| 1.0 / n as f64));
    let mut mesh =
        MixedMesh { points: cuboid(N, Split::Six, [DVec3::ZERO, DVec3::ONE]).points, ..MixedMesh::default() };
    for (p, point) in mesh.points.iter_mut().enumerate() {
        if point.min_element() > 0.0 && point.max_element() < 1.0 {
            *point += DVec3::from(moves[p % moves.len()]) * 0.05 * spacing;
        }
    }
    let MixedMesh { points, cells, .. } = &mut mesh;
    for_each_hexahedron(N.map(|n| n + 1), |[i, j, k], c| {
        // Wedges cut their upper and lower faces: a whole column has them, or none.
        let column = kinds[i + N[0] * j] % allowed;
        let other = [0, 1, 3, 4, 5][usize::from((column + kinds[k]) % (allowed - 1))];
        let mut pyramids = |cells: &mut MixedCells, polyhedra: bool| {
            let apex = points.len() as u32;
            points.push(c.iter().map(|&v| points[v as usize]).sum::<DVec3>() / 8.0);
            for base in BASES {
                let [p, q, r, s] = base.map(|f: usize| c[f]);
                if polyhedra {
                    // Some faces seen from outside, some from inside.
                    let faces: [&[u32]; 5] =
                        [&[s, p, q, r], &[p, apex, q], &[r, q, apex], &[s, r, apex], &[apex, p, s]];
                    cells.push_polyhedron(&[p, q, r, s, apex], &faces);
                } else {
                    cells.push(14, &[p, q, r, s, apex]);
                }
            }
        };
        match if column == 2 { 2 } else { other } {
            0 => cells.push(12, &c),
            1 => pyramids(cells, false),
            2 => {
                // VTK's documentation and its interpolation number wedges in opposite senses: one of each.
                cells.push(13, &[c[0], c[2], c[1], c[4], c[6], c[5]]);
                cells.push(13, &[c[0], c[2], c[3], c[4], c[6], c[7]]);
            }
            3 => cells.push(11, &[c[0], c[1], c[3], c[2], c[4], c[5], c[7], c[6]]),
            4 => {
                let faces = BASES.map(|base| base.map(|f| c[f]));
                cells.push_polyhedron(&c, &faces.each_ref().map(|face| face.as_slice()));
            }
            _ => pyramids(cells, true),
        }
    });
    mesh
}

/// The same mesh with its points and cells in another order: that of their keys.
pub(super) fn shuffled(mesh: &MixedMesh, keys: &[u32]) -> MixedMesh {
    let order = |count: usize, step: usize| {
        let mut order: Vec<u32> = (0..count as u32).collect();
        order.sort_by_key(|&p| (keys[p as usize * step % keys.len()], p));
        order
    };
    let points = order(mesh.points.len(), 1);
    let mut place = vec![0; points.len()];
    points.iter().enumerate().for_each(|(new, &old)| place[old as usize] = new as u32);
    let renumbered = |ids: &[u32]| ids.iter().map(|&v| place[v as usize]).collect::<Vec<_>>();
    let mut cells = MixedCells::default();
    for c in order(mesh.cells.types.len(), 5) {
        let (number, corners) = (mesh.cells.types[c as usize], renumbered(mesh.cells.cell(c as usize).unwrap()));
        if number == POLYHEDRON {
            let faces: Vec<Vec<u32>> = mesh.cells.faces(c as usize).unwrap().into_iter().map(renumbered).collect();
            cells.push_polyhedron(&corners, &faces.iter().map(Vec::as_slice).collect::<Vec<_>>());
        } else {
            cells.push(number, &corners);
        }
    }
    let points = points.iter().map(|&old| mesh.points[old as usize]).collect();
    MixedMesh { points, cells, ..mesh.clone() }
}

/// Splits the unit cube's cells and asserts that they fill it and conform: whatever is not on its surface, of
/// `boundary` triangles, is shared by two tetrahedra. A linear field stays linear at every point, those added too.
pub(super) fn assert_conforms(mut mesh: MixedMesh, boundary: usize) -> TetMesh {
    let field = |p: DVec3| 1.0 + 2.0 * p.x - 3.0 * p.y + 0.5 * p.z;
    mesh.fields = vec![Field::point("linear", 1, mesh.points.iter().map(|&p| field(p)).collect())];
    let given = mesh.points.len();
    let tets = mesh.tetrahedralize(Split::Six).unwrap();
    let report = tets.validate();
    let assembly = report.assembly;
    assert_eq!((assembly.cells_inverted, assembly.cells_flat, assembly.cells_repeated), (0, 0, 0));
    assert_eq!((assembly.faces_folded, assembly.faces_non_manifold, report.quads_split_both_ways), (0, 0, 0));
    assert_eq!((report.boundary_faces, report.components, report.points_unused), (boundary, 1, 0));
    assert!(assembly.points_given >= given);
    // Rounding of the positions to single precision, some 1e-7 of the cube's width each.
    assert!((report.volume - 1.0).abs() < 1e-5, "{}", report.volume);
    for (p, value) in tets.fields()[0].values.iter().enumerate() {
        let expected = field(tets.world(p as u32));
        // The same rounding of each coordinate, times the slopes, 5.5 together.
        assert!((value - expected).abs() < 1e-6, "{value}, not {expected}");
    }
    tets
}

/// Triangles on the cube's surface where each quadrilateral has `each`.
pub(super) fn surface(each: usize) -> usize {
    2 * each * (N[0] * N[1] + N[1] * N[2] + N[2] * N[0])
}

/// Tetrahedra of a linear cell.
fn parts(mesh: &MixedMesh, cell: usize) -> usize {
    match mesh.cells.types[cell] {
        11 | 12 => 6,
        13 => 3,
        14 => 2,
        _ => mesh.cells.faces(cell).unwrap().iter().map(|face| face.len() - 2).sum(),
    }
}

pub(super) fn moves() -> impl Strategy<Value = Vec<[f64; 3]>> {
    prop::collection::vec(prop::array::uniform3(-1.0..1.0), 31)
}

pub(super) fn keys() -> impl Strategy<Value = Vec<u32>> {
    prop::collection::vec(any::<u32>(), 97)
}

pub(super) fn kinds() -> impl Strategy<Value = Vec<u8>> {
    prop::collection::vec(0u8..60, N[0] * N[1])
}

/// Proptest's settings, with the number of cases that TETLUX_STRESS_CASES asks for.
pub(super) fn cases(usual: u32) -> ProptestConfig {
    let stress = std::env::var("TETLUX_STRESS_CASES").ok().and_then(|n| n.parse().ok());
    ProptestConfig { cases: stress.unwrap_or(usual), failure_persistence: None, ..ProptestConfig::default() }
}

proptest! {
    #![proptest_config(cases(200))]

    /// However points and cells are numbered, cells of all types fit together.
    #[test]
    fn cells_of_all_types_conform(kinds in kinds(), keys in keys(), moves in moves()) {
        let mesh = shuffled(&zoo(&kinds, 6, &moves), &keys);
        let expected: usize = (0..mesh.cells.types.len()).map(|c| parts(&mesh, c)).sum();
        prop_assert_eq!(assert_conforms(mesh, surface(2)).cells().len(), expected);
    }

    /// Tetrahedra fit as well if their faces are cut by the same rule.
    #[test]
    fn pyramids_may_be_tetrahedra_cut_from_the_smallest_corner(kinds in kinds(), keys in keys(), moves in moves()) {
        let mesh = shuffled(&zoo(&kinds, 6, &moves), &keys);
        let mut cells = MixedCells::default();
        for c in 0..mesh.cells.types.len() {
            let corners = mesh.cells.cell(c).unwrap();
            match (mesh.cells.types[c], corners) {
                (14, &[p, q, r, s, apex]) if keys[c % keys.len()] % 2 == 0 => {
                    let base = if p.min(r) < q.min(s) { [p, q, r, s] } else { [q, r, s, p] };
                    cells.push(10, &[base[0], base[1], base[2], apex]);
                    cells.push(10, &[base[0], base[2], base[3], apex]);
                }
                (42, _) => cells.push_polyhedron(corners, &mesh.cells.faces(c).unwrap()),
                (number, _) => cells.push(number, corners),
            }
        }
        assert_conforms(MixedMesh { cells, ..mesh }, surface(2));
    }

    /// A cell turned inside out is mended, and each of its tetrahedra counted.
    #[test]
    fn inverted_cells_are_mended(kinds in kinds(), keys in keys(), which in any::<prop::sample::Index>()) {
        let mut mesh = shuffled(&zoo(&kinds, 3, &[[0.0; 3]]), &keys);
        let cell = which.index(mesh.cells.types.len());
        let (start, end) = (if cell == 0 { 0 } else { mesh.cells.offsets[cell - 1] }, mesh.cells.offsets[cell]);
        let corners = &mut mesh.cells.connectivity[start..end];
        let expected = match mesh.cells.types[cell] {
            12 => { corners.rotate_left(4); 6 }
            14 => { corners[..4].reverse(); 2 }
            _ => { corners.rotate_left(3); 0 }
        };
        let report = mesh.tetrahedralize(Split::Six).unwrap().validate();
        prop_assert_eq!(report.assembly.cells_inverted, expected);
        prop_assert_eq!((report.boundary_faces, report.assembly.faces_folded), (surface(2), 0));
        // As above.
        prop_assert!((report.volume - 1.0).abs() < 1e-5, "{}", report.volume);
    }
}

/// A hexahedron with corners that are one is what is left of it, and fits what is beside it.
#[test]
fn collapsed_hexahedra_lose_no_volume() {
    // The corners of the unit cube, then those above it.
    let corners = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]];
    let points: Vec<DVec3> = corners.iter().map(|&c: &[i32; 3]| DVec3::from(c.map(f64::from))).collect();
    let mut cells = MixedCells::default();
    // A hexahedron that is a wedge, half the cube; a wedge that is a pyramid; a hexahedron that is a tetrahedron.
    cells.push(12, &[0, 1, 2, 2, 4, 5, 6, 6]);
    cells.push(13, &[0, 2, 3, 4, 6, 3]);
    cells.push(12, &[4, 6, 7, 7, 3, 3, 3, 3]);
    let mesh = MixedMesh { points, cells, ..MixedMesh::default() };
    let volumes = |mesh: MixedMesh| mesh.tetrahedralize(Split::Six).map(|tets| tets.validate());
    // 1/2 for the first; a pyramid over 0 2 6 4 with its apex at 3, of 1/3; the last, 4 6 7 3, a tetrahedron of 1/6.
    let report = volumes(mesh.clone()).unwrap();
    // Corners of the cube are exact in single precision.
    assert!((report.volume - 1.0).abs() < 1e-12, "{}", report.volume);
    assert_eq!((report.cells, report.boundary_faces, report.components), (6, 12, 1));
    assert_eq!((report.assembly.cells_repeated, report.assembly.cells_flat, report.quads_split_both_ways), (0, 0, 0));

    // The same with points repeated instead of indices.
    let mut copied = mesh;
    let MixedMesh { points, cells, .. } = &mut copied;
    for v in &mut cells.connectivity {
        points.push(points[*v as usize]);
        *v = points.len() as u32 - 1;
    }
    let other = volumes(copied).unwrap();
    assert_eq!((other.cells, other.boundary_faces, other.volume), (6, 12, report.volume));
}

/// Prisms of five and six sides fit the polyhedra that describe the same.
#[test]
fn prisms_conform_with_polyhedra() {
    for (number, sides) in [(15, 5u32), (16, 6)] {
        let angle = |i: u32| f64::from(i) * std::f64::consts::TAU / f64::from(sides);
        let ring = |z: f64| (0..sides).map(move |i| DVec3::new(angle(i).cos(), angle(i).sin(), z));
        let points: Vec<DVec3> = ring(0.0).chain(ring(1.0)).chain(ring(2.0)).collect();
        let mut cells = MixedCells::default();
        cells.push(number, &(0..2 * sides).collect::<Vec<_>>());
        let bottom: Vec<u32> = (sides..2 * sides).collect();
        let top: Vec<u32> = (2 * sides..3 * sides).collect();
        let sides_of = |i: u32| [sides + i, sides + (i + 1) % sides, 2 * sides + (i + 1) % sides, 2 * sides + i];
        let walls: Vec<[u32; 4]> = (0..sides).map(sides_of).collect();
        let faces: Vec<&[u32]> = [&bottom[..], &top[..]].into_iter().chain(walls.iter().map(|w| &w[..])).collect();
        cells.push_polyhedron(&[bottom.clone(), top.clone()].concat(), &faces);
        let mesh = MixedMesh { points, cells, ..MixedMesh::default() };
        for key in 0..40u32 {
            let keys: Vec<u32> = (0..97u32).map(|i| (i * 37 + 11 * key) % 97).collect();
            let report = shuffled(&mesh, &keys).tetrahedralize(Split::Six).unwrap().validate();
            let volume = f64::from(sides) * angle(1).sin();
            // Rounding of the positions to single precision.
            assert!((report.volume / volume - 1.0).abs() < 1e-6, "{}", report.volume);
            let n = sides as usize;
            assert_eq!((report.boundary_faces, report.components), (2 * (n - 2) + 4 * n, 1));
            assert_eq!((report.assembly.cells_inverted, report.assembly.cells_flat), (0, 0));
        }
    }
}

/// The hexahedra of a sphere's shell, listed one by one.
fn shell(counts: [usize; 3]) -> MixedMesh {
    let points = sphere_shell(counts, Split::Six, DVec3::new(5.0, 0.0, 1.0), [1.0, 2.0]).points;
    let mut mesh = MixedMesh { points, ..MixedMesh::default() };
    for_each_hexahedron(counts.map(|n| n + 1), |_, corners| mesh.cells.push(12, &corners));
    mesh
}

const SHELL: [usize; 3] = [7, 4, 3];

proptest! {
    #![proptest_config(cases(100))]

    /// Where the grid closes on itself, the two sides' points are numbered alike only once coincident ones are one.
    #[test]
    fn listed_hexahedra_conform_across_a_seam_and_at_collapsed_edges(keys in keys()) {
        let report = shuffled(&shell(SHELL), &keys).tetrahedralize(Split::Six).unwrap().validate();
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
    grid.grids = vec![StructuredGrid { first_point: 0, counts: SHELL.map(|n| n + 1), blanked: None }];
    assert!(grid.tetrahedralize(Split::Five).unwrap().validate().quads_split_both_ways > 0);
}

#[test]
fn cell_data_follow_their_cells() {
    let mut mesh = zoo(&[0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3], 4, &[[0.0; 3]]);
    let expected: usize = (0..mesh.cells.types.len()).map(|c| parts(&mesh, c)).sum();
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
    let grids = vec![StructuredGrid { first_point: 0, counts: [2, 2, 3], blanked: Some(blanked) }];
    let fields = vec![Field::cell("number", 1, vec![1.0, 2.0])];
    let tets = MixedMesh { points, grids, fields, ..MixedMesh::default() }.tetrahedralize(Split::Five).unwrap();
    assert_eq!(tets.fields()[0].values, [2.0; 5]);
}
