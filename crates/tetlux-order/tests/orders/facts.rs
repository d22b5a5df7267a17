//! What is found of a mesh once, before any view.

use glam::DVec3;
use proptest::prelude::*;
use tetlux_mesh::procedural::{self, Parts, Split};
use tetlux_order::Facts;

use crate::random::Random;
use crate::shapes::{self, assemble, cube, jittered, thinned};

#[track_caller]
fn facts(parts: &Parts) -> Facts {
    Facts::new(&assemble(parts))
}

/// Convex bodies and the faces they are cut into.
#[test]
fn convex_meshes_are_told_from_others() {
    for split in [Split::Five, Split::Six] {
        assert!(facts(&cube([3, 2, 4], split)).convex(), "{split:?}");
        assert!(facts(&shapes::graded(split)).convex(), "{split:?}");
    }
    assert!(facts(&procedural::filled_ring()).convex());
    for (what, parts) in [
        ("bent", jittered(cube([3, 3, 3], Split::Six), DVec3::splat(0.02), 1)),
        ("torus", shapes::torus([12, 2, 2])),
        ("nested spheres", shapes::nested_spheres()),
        ("comb", shapes::comb()),
        ("holes", shapes::plate_with_holes()),
        ("plates", shapes::plates()),
        ("ring", procedural::ring(5, 60.0)),
        ("three cells", procedural::three_cycle()),
        ("tangle", shapes::tangle(4, 1)),
        ("not conforming", shapes::non_conforming([2, 2, 2])),
        ("part of a grid", thinned(&cube([3, 3, 3], Split::Six), 0.6, 1)),
    ] {
        assert!(!facts(&parts).convex(), "{what}");
    }
    // A hollow of one cell in the middle of a box: its outside is convex, itself is not.
    let middle = |[i, j, k]: [usize; 3]| [i, j, k] != [1, 1, 1];
    let hollow = shapes::carved(&cube([3; 3], Split::Six), [3; 3], Split::Six, middle);
    assert!(!facts(&hollow).convex(), "hollow");
}

#[test]
fn faults_and_components_are_counted() {
    assert_eq!(facts(&shapes::scattered(1)).components(), 27);
    assert_eq!(facts(&shapes::nested_spheres()).components(), 3);
    // Sides between cubes that are split alike show both diagonals: 3 n^2 (n - 1) of them.
    assert_eq!(facts(&shapes::non_conforming([4, 4, 4])).quads_split_both_ways(), 3 * 16 * 3);
    assert_eq!(facts(&cube([4, 4, 4], Split::Five)).quads_split_both_ways(), 0);
    // Two cells on one side of a face.
    let points = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.1, 0.1, 1.0], [0.2, 0.2, 2.0]].map(DVec3::from);
    let folded = facts(&Parts { points: points.to_vec(), cells: vec![[0, 1, 2, 3], [0, 1, 2, 4]] });
    assert_eq!((folded.folded_faces(), folded.convex()), (1, false));
}

proptest! {
    /// A cell alone is convex, whatever its shape and wherever its highest vertex leans.
    #[test]
    fn one_cell_is_convex(seed in any::<u64>()) {
        let mut random = Random::new(seed);
        let points = [(); 4].map(|()| random.point(1.0)).to_vec();
        let cell = facts(&Parts { points, cells: vec![[0, 1, 2, 3]] });
        prop_assert!(cell.convex());
    }
}
