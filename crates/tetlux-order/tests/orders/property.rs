//! Random small meshes from random places.

use glam::DVec3;
use proptest::prelude::*;
use tetlux_mesh::procedural::{Parts, Split};
use tetlux_order::Method::{Auto, Exact};

use crate::random::Random;
use crate::shapes::{self, assemble, cube, jittered, thinned};
use crate::{Judge, views};

/// A small mesh whose cells do not overlap.
fn small_mesh(random: &mut Random) -> Parts {
    let seed = random.below(usize::MAX) as u64;
    let counts = [(); 3].map(|()| 1 + random.below(3));
    let split = if random.below(2) == 0 { Split::Five } else { Split::Six };
    let spacing = DVec3::from(counts.map(|n| 2.0 / n as f64));
    match random.below(5) {
        0 => cube(counts, split),
        1 => jittered(cube(counts, split), spacing * 0.1, seed),
        2 => thinned(&jittered(cube(counts, split), spacing * 0.1, seed), 0.5, seed),
        3 => thinned(&shapes::cloud(6 + random.below(20), seed), 0.7, seed),
        _ => apart(random),
    }
}

/// Tetrahedra of any shape, each in a box of its own.
fn apart(random: &mut Random) -> Parts {
    let mut parts = Parts::default();
    for place in 0..27 {
        let middle = DVec3::from([place % 3, place / 3 % 3, place / 9].map(|i| f64::from(i) - 1.0));
        let points = [(); 4].map(|()| middle + random.point(0.49)).to_vec();
        parts.append(&Parts { points, cells: vec![[0, 1, 2, 3]] });
    }
    thinned(&parts, 0.6, random.below(1000) as u64)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1000))]

    #[test]
    fn exact_orders_have_no_inversion(seed in any::<u64>()) {
        let random = &mut Random::new(seed);
        let parts = small_mesh(random);
        prop_assume!(!parts.cells.is_empty());
        let mesh = assemble(&parts);
        let mut judge = Judge::new("a small mesh", &mesh);
        let all = views::views(&mesh, 24, seed);
        let (from, view) = &all[random.below(all.len())];
        for method in [Exact, Auto] {
            judge.assert_right(from, view, method);
        }
        // What is left to the rays is little: cycles are rare where nothing overlaps.
        let report = &judge.order(view, Exact).report;
        prop_assert!(report.cells_in_groups <= mesh.cells().len() / 2 + 3, "{report:?}");
    }
}
