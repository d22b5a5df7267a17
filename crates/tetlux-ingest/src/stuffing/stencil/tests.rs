use glam::DVec3;

use super::super::ALPHA;
use super::super::lattice::{DIRECTIONS, is_long as is_long_direction};
use super::*;

/// Bounds of the dihedral angles in degrees: see `the_bounds_are_those_of_the_extreme_cases`.
pub(in crate::stuffing) const LOWEST: f64 = 9.31;
pub(in crate::stuffing) const HIGHEST: f64 = 161.65;

const NODES: [DVec3; 4] =
    [DVec3::ZERO, DVec3::new(2.0, 0.0, 0.0), DVec3::new(1.0, 1.0, 1.0), DVec3::new(1.0, -1.0, 1.0)];

/// The six angles between faces, in degrees.
pub(in crate::stuffing) fn dihedral_angles(p: [DVec3; 4]) -> Vec<f64> {
    let normals = tetlux_mesh::FACES.map(|[a, b, c]| (p[b] - p[a]).cross(p[c] - p[a]).normalize());
    (0..4).flat_map(|i| (0..i).map(move |j| (-normals[i].dot(normals[j])).acos().to_degrees())).collect()
}

/// All signs of four nodes.
fn all_signs() -> impl Iterator<Item = [i32; 4]> {
    (0..81).map(|n: i32| [n / 27, n / 9 % 3, n / 3 % 3, n % 3].map(|s| s - 1))
}

/// Which nodes can be even: of each long edge one is.
const EVEN: [[usize; 2]; 4] = [[0, 2], [0, 3], [1, 2], [1, 3]];

fn stencil(signs: [i32; 4], even: [usize; 2]) -> Vec<[Corner; 4]> {
    let mut made = Vec::new();
    tetrahedra(signs, |i| even.contains(&i), |corners| made.push(corners));
    made
}

fn volume([a, b, c, d]: [DVec3; 4]) -> f64 {
    (b - a).cross(c - a).dot(d - a)
}

/// With the cuts anywhere, the parts are positive and sum to what is inside: the whole less the corners cut off.
#[test]
fn parts_sum_to_what_is_inside() {
    for (signs, even) in all_signs().flat_map(|s| EVEN.map(|e| (s, e))) {
        let made = stencil(signs, even);
        for at in [0.3, 0.5, 0.7] {
            let point = |[i, j]: Corner| if i == j { NODES[i] } else { NODES[i].lerp(NODES[j], at) };
            let volumes: Vec<f64> = made.iter().map(|corners| volume(corners.map(point))).collect();
            assert!(volumes.iter().all(|&v| v > 0.0), "{signs:?}");
            // What is inside, of a whole of 1, in closed form: the value is 1 inside, 0 at cuts.
            let count = |sign| signs.iter().filter(|&&s| s == sign).count();
            let expected = match (count(1), count(-1)) {
                (0, _) => 0.0,
                (_, 0) => 1.0,
                (1, out) => f64::powi(at, out as i32),
                (2, 1) => 1.0 - (1.0 - at) * (1.0 - at),
                (3, _) => 1.0 - f64::powi(1.0 - at, 3),
                // Two and two: a wedge, of which each quadrilateral cross-section has its sides in proportion.
                _ => at * at * (3.0 - 2.0 * at),
            };
            let total: f64 = volumes.iter().sum::<f64>() / volume(NODES);
            assert!((total - expected).abs() < 1e-12, "{signs:?}: {total} {expected}");
        }
    }
}

/// Two lattice tetrahedra with a face in common cut it alike: what is made depends on the signs and places of the
/// three nodes alone.
#[test]
fn faces_are_cut_alike_from_both_sides() {
    // The triangles on the lattice's own faces, without the fourth node, by signs and parity of the three.
    let face = |out: usize, signs: [i32; 4], even: [usize; 2]| {
        let mut triangles = Vec::new();
        for corners in stencil(signs, even) {
            for f in tetlux_mesh::FACES.map(|f| f.map(|i| corners[i])) {
                if f.iter().flatten().all(|&i| i != out) {
                    let mut f = f;
                    f.sort_unstable();
                    triangles.push(f);
                }
            }
        }
        triangles.sort_unstable();
        triangles
    };
    for (signs, even) in all_signs().flat_map(|s| EVEN.map(|e| (s, e))) {
        for out in 0..4 {
            // Three nodes that are not inside make nothing, but a whole beside them may.
            if (0..4).all(|i| i == out || signs[i] <= 0) {
                continue;
            }
            for other in [-1, 0, 1] {
                let mut others = signs;
                others[out] = other;
                assert_eq!(face(out, signs, even), face(out, others, even), "{signs:?} {out} {other}");
            }
        }
    }
}

/// The bounds, found by trying all extreme cases: every node on the surface unmoved or moved as far as it may in any of
/// 14 directions, every cut as near to either end as it may be. Two nodes cannot have moved towards each other, nor
/// one towards a neighbour that was on its own side. The least and the greatest angle of cases between are no worse
/// in any sample taken.
#[test]
fn the_bounds_are_those_of_the_extreme_cases() {
    let mut range = [f64::INFINITY, 0.0f64];
    for (signs, even) in all_signs().flat_map(|s| EVEN.map(|e| (s, e))) {
        let made = stencil(signs, even);
        let on: Vec<usize> = (0..4).filter(|&i| signs[i] == 0).collect();
        let cuts: Vec<Corner> =
            (0..16).map(|n| [n / 4, n % 4]).filter(|&[i, j]| signs[i] == 1 && signs[j] == -1).collect();
        for moves in 0..15usize.pow(on.len() as u32) {
            let choice = |n: usize| moves / 15usize.pow(n as u32) % 15;
            let Some(nodes) = moved(signs, &on, choice) else { continue };
            for ends in 0..1 << cuts.len() {
                let point = |corner: Corner| {
                    let [i, j] = corner;
                    let Some(c) = cuts.iter().position(|&cut| cut == corner) else { return nodes[i] };
                    let alpha = ALPHA[usize::from(!is_long(i, j))];
                    nodes[i].lerp(nodes[j], if ends >> c & 1 == 0 { alpha } else { 1.0 - alpha })
                };
                for angle in made.iter().flat_map(|corners| dihedral_angles(corners.map(point))) {
                    range = [range[0].min(angle), range[1].max(angle)];
                }
            }
        }
    }
    assert!((LOWEST..LOWEST + 0.01).contains(&range[0]) && (HIGHEST - 0.01..HIGHEST).contains(&range[1]), "{range:?}");
}

/// The nodes with those on the surface moved by choice; `None` if they cannot all have moved so.
fn moved(signs: [i32; 4], on: &[usize], choice: impl Fn(usize) -> usize) -> Option<[DVec3; 4]> {
    let mut nodes = NODES;
    // Pairs of neighbours that were on different sides.
    let mut pairs = Vec::new();
    for (n, &i) in on.iter().enumerate() {
        let c = choice(n);
        if c == 14 {
            continue;
        }
        let direction = c % 7;
        let along = DVec3::from_array(DIRECTIONS[direction].map(f64::from)) * if c < 7 { 1.0 } else { -1.0 };
        nodes[i] += along * ALPHA[usize::from(!is_long_direction(direction))];
        pairs.extend((0..4).find(|&j| NODES[j] == NODES[i] + along).map(|j| (i, j)));
    }
    if pairs.iter().any(|&(i, j)| pairs.contains(&(j, i))) {
        return None;
    }
    let sides = (0..16).map(|bits: i32| [0, 1, 2, 3].map(|i| if bits >> i & 1 == 1 { 1 } else { -1 }));
    let fits = |side: &[i32; 4]| (0..4).all(|i| signs[i] == 0 || signs[i] == side[i]);
    sides.filter(fits).any(|side| pairs.iter().all(|&(i, j)| side[i] != side[j])).then_some(nodes)
}

#[test]
fn angles_of_a_known_tetrahedron_are_found() {
    let corner = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
    let mut angles = dihedral_angles(corner);
    angles.sort_by(f64::total_cmp);
    // Three right angles, and three of acos(1/sqrt(3)).
    let slanted = (1.0 / 3f64.sqrt()).acos().to_degrees();
    assert!(angles.iter().zip([slanted, slanted, slanted, 90.0, 90.0, 90.0]).all(|(a, b)| (a - b).abs() < 1e-12));
    // The lattice's own: 60 and 90 degrees.
    assert!(dihedral_angles(NODES).iter().all(|a| (a - 60.0).abs() < 1e-12 || (a - 90.0).abs() < 1e-12));
}
