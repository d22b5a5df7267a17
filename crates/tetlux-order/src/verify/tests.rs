use proptest::prelude::*;
use tetlux_mesh::procedural::{Parts, Split, cuboid};

use super::*;

/// Tetrahedra one behind another along z, at heights 0, 2, 4 and so on, each 1 high and round the axis.
fn tower(count: u32) -> TetMesh {
    let mut parts = Parts::default();
    for i in 0..count {
        let foot = DVec3::Z * f64::from(2 * i);
        let corners = [[1.0, 0.0, 0.0], [-0.5, 0.75, 0.0], [-0.5, -0.75, 0.0], [0.0, 0.0, 1.0]];
        parts.append(&Parts { points: corners.map(|c| DVec3::from(c) + foot).to_vec(), cells: vec![[0, 1, 2, 3]] });
    }
    TetMesh::assemble(&parts.points, &parts.cells, vec![]).unwrap()
}

fn order(cells: Vec<u32>, group: Option<std::ops::Range<u32>>) -> Order {
    Order { cells, groups: group.into_iter().collect(), ..Order::default() }
}

/// A bundle round the z axis, and one ray beside the tower.
fn rays() -> Vec<Ray> {
    let ray =
        |x: f64, y: f64| Ray { origin: DVec3::new(x, y, -10.0), direction: DVec3::new(0.0, 0.0, 2.0), start: 0.0 };
    (0..10).map(|i| ray(0.01 * f64::from(i), 0.003)).chain([ray(9.0, 9.0)]).collect()
}

#[test]
fn intervals_are_those_of_the_cells() {
    let mesh = tower(3);
    let verifier = Verifier::new(&mesh);
    let found = verifier.intervals(&rays()[0]);
    let top = height(0.0, 0.003);
    for (i, interval) in found.iter().enumerate() {
        assert_eq!(interval.cell, i as u32);
        // The ray's parameter is half the height above -10.
        let foot = 0.5 * (10.0 + 2.0 * i as f64);
        assert!(
            (interval.entry - foot).abs() < 1e-12 && (interval.exit - foot - 0.5 * top).abs() < 1e-6,
            "{interval:?}"
        );
    }
    assert_eq!(found.len(), 3);
    // From within the second on: its rest and the third.
    let from = Ray { origin: DVec3::new(0.0, 0.003, 2.25), ..rays()[0] };
    let rest = verifier.intervals(&from);
    assert_eq!((rest.len(), rest[0].cell, rest[0].entry), (2, 1, 0.0));
    let line = Ray { start: f64::MIN, ..from };
    assert_eq!(verifier.intervals(&line).len(), 3);
    for bad in [DVec3::ZERO, DVec3::NAN, DVec3::INFINITY] {
        assert_eq!(verifier.intervals(&Ray { direction: bad, ..from }), vec![]);
    }
}

/// Height of a tower's cell above a point of its foot. The top is over the origin, so that each slanting face is as
/// high as the point's barycentric coordinate is large, in units of the origin's.
fn height(x: f64, y: f64) -> f64 {
    let corners = [[1.0, 0.0], [-0.5, 0.75], [-0.5, -0.75]];
    let coordinate = |px: f64, py: f64, i: usize| {
        let ([ax, ay], [bx, by]) = (corners[(i + 1) % 3], corners[(i + 2) % 3]);
        (bx - ax) * (py - ay) - (by - ay) * (px - ax)
    };
    (0..3).map(|i| coordinate(x, y, i) / coordinate(0.0, 0.0, i)).fold(f64::INFINITY, f64::min)
}

#[test]
fn a_right_order_passes_and_planted_swaps_are_found() {
    let mesh = tower(6);
    let right = verify(&mesh, &order((0..6).collect(), None), &rays());
    assert!(right.is_right());
    assert_eq!((right.rays, right.intervals, right.pairs, right.missing), (10, 60, 50, 0));

    // Neighbours swapped: one pair of every ray. Cells 1 and 4 swapped: of the pairs of neighbours (0 1) (1 2) ... the
    // ranks 0 4 2 3 1 5 descend twice; of all pairs with 1 or 4 among them, 4 before 2, 3 and 1, and 2, 3 before 1.
    for (swap, adjacent, all) in [([2, 3], 1, 1), ([1, 4], 2, 5)] {
        let mut cells: Vec<u32> = (0..6).collect();
        cells.swap(swap[0], swap[1]);
        let verifier = Verifier::new(&mesh);
        let planted = order(cells, None);
        for (pairs, expected) in [(Pairs::Adjacent, adjacent), (Pairs::All, all)] {
            let found = verifier.verify(&planted, &rays(), pairs);
            assert!(!found.is_right());
            assert_eq!((found.inversions, &found.inverted), (10 * expected, &(0..10).collect::<Vec<_>>()));
            assert_eq!(found.pairs, if pairs == Pairs::All { 150 } else { 50 });
            let example = &found.examples[0];
            assert_eq!((example.ray, found.examples.len()), (0, EXAMPLES));
            assert!(example.intervals[0].exit < example.intervals[1].entry, "the nearer is named first");
            assert!(example.positions[0] > example.positions[1]);
        }
        // In a group that holds all between them, the order leaves it to the ray.
        let grouped = verify(&mesh, &order(planted.cells, Some(swap[0] as u32..swap[1] as u32 + 1)), &rays());
        assert!(grouped.is_right());
        assert_eq!(grouped.grouped, 10 * (swap[1] - swap[0]) as u64);
    }
    // Seen from the other end everything is inverted.
    let behind: Vec<Ray> = rays()
        .iter()
        .map(|r| Ray { origin: r.origin + DVec3::Z * 30.0, direction: -r.direction, start: 0.0 })
        .collect();
    assert_eq!(verify(&mesh, &order((0..6).collect(), None), &behind).inversions, 50);
}

#[test]
fn cells_left_out_and_repeated_are_counted() {
    let mesh = tower(4);
    let found = verify(&mesh, &order(vec![0, 2, 2, 9], None), &rays());
    assert_eq!((found.missing, found.repeated, found.inversions, found.intervals), (2, 2, 0, 20));
    assert!(!found.is_right());
}

#[test]
fn overlapping_cells_are_counted_apart() {
    // The second stands in the first, the third beyond both.
    let mut parts = Parts::default();
    for foot in [0.0, 0.25, 3.0] {
        let corners = [[1.0, 0.0, 0.0], [-0.5, 0.75, 0.0], [-0.5, -0.75, 0.0], [0.0, 0.0, 1.0]];
        let points = corners.map(|c| DVec3::from(c) + DVec3::Z * foot).to_vec();
        parts.append(&Parts { points, cells: vec![[0, 1, 2, 3]] });
    }
    let mesh = TetMesh::assemble(&parts.points, &parts.cells, vec![]).unwrap();
    for cells in [vec![0, 1, 2], vec![1, 0, 2]] {
        let found = verify(&mesh, &order(cells, None), &rays());
        assert!(found.is_right());
        assert_eq!((found.overlaps, found.rays_overlapping, found.overlap_examples.len()), (10, 10, EXAMPLES));
    }
    // What overlaps hides nothing of the others.
    assert_eq!(verify(&mesh, &order(vec![2, 0, 1], None), &rays()).inverted.len(), 10);
}

/// A random vector in a box.
fn vector(half: f64) -> impl Strategy<Value = DVec3> {
    [-half..half, -half..half, -half..half].prop_map(DVec3::from)
}

proptest! {
    /// The cells of a box along a line add up to the line's part in the box, and follow one another without overlap.
    #[test]
    fn intervals_of_a_grid_fill_the_box(
        origin in vector(3.0),
        toward in vector(0.9),
        far in prop_oneof![Just(1.0), Just(1e6)],
        five in any::<bool>(),
    ) {
        let split = if five { Split::Five } else { Split::Six };
        let parts = cuboid([3, 4, 2], split, [DVec3::splat(-1.0), DVec3::ONE]);
        let mesh = TetMesh::assemble(&parts.points, &parts.cells, vec![]).unwrap();
        let direction = toward - origin;
        prop_assume!(direction.length() > 0.1);
        let ray = Ray { origin: toward - direction * far, direction, start: f64::MIN };
        let found = Verifier::new(&mesh).intervals(&ray);
        let inside = span([glam::Vec3::splat(-1.0), glam::Vec3::ONE], ray.origin, direction, f64::MIN).unwrap();
        let total: f64 = found.iter().map(Interval::length).sum();
        // Parameters of size `far` are rounded, and so are positions a distance of as much from the origin.
        let rounding = 1e-9 * far.max(1e3) / 1e3;
        prop_assert!((total - (inside[1] - inside[0])).abs() < rounding, "{total} of {inside:?}");
        for pair in found.windows(2) {
            prop_assert!(pair[0].exit <= pair[1].entry + f64::EPSILON * far, "{pair:?}");
        }
    }
}
