//! Meshes without cycles: the right methods invert nothing.

use glam::DVec3;
use tetlux_mesh::procedural::Split;
use tetlux_order::Method::{Auto, Centroid, Exact, Mpvo, Mpvonc, Power};

use crate::shapes::{self, assemble, carved, cube, jittered, thinned};
use crate::{Judge, assert_all_right, views};

/// Half of what moves a corner's tetrahedron inside out in a grid of five, and less than that in one of six.
const JITTER: f64 = 0.12;

#[test]
fn regular_grids_by_every_exact_method() {
    // Convex, and locally Delaunay with every cube on one sphere.
    for split in [Split::Six, Split::Five] {
        let what = format!("grid, {split:?}");
        assert_all_right(&what, &cube([5, 4, 6], split), &[Exact, Mpvo, Power, Auto]);
    }
}

#[test]
fn bent_hexahedra() {
    for split in [Split::Six, Split::Five] {
        // Points of the boundary move too: the mesh is not convex.
        let bent = jittered(cube([5, 5, 5], split), DVec3::splat(JITTER * 0.4), 7);
        assert_all_right(&format!("bent, {split:?}"), &bent, &[Exact, Auto]);
    }
    let squashed = jittered(cube([8, 8, 2], Split::Six), DVec3::new(0.03, 0.03, 0.12), 3);
    assert_all_right("bent plate", &squashed, &[Exact]);
}

#[test]
fn parts_of_grids() {
    for (seed, split) in [(1, Split::Six), (2, Split::Five)] {
        let bent = jittered(cube([6, 6, 6], split), DVec3::splat(JITTER / 3.0), seed);
        assert_all_right("40 % of a grid", &thinned(&bent, 0.4, seed), &[Exact, Auto]);
    }
    let counts = [7, 7, 7];
    let checks = carved(&cube(counts, Split::Six), counts, Split::Six, |[i, j, k]| (i + j + k) % 2 == 0);
    assert_all_right("every other cube", &checks, &[Exact]);
}

#[test]
fn delaunay_meshes() {
    for seed in 0..3 {
        // In general position no ties arise; what is left out of a Delaunay mesh leaves the rest in order.
        let cloud = shapes::cloud(150, seed);
        assert_all_right("cloud", &cloud, &[Exact, Power]);
        assert_all_right("40 % of a cloud", &thinned(&cloud, 0.4, seed), &[Exact, Power]);
    }
    assert_all_right("slivers", &shapes::slivers(5), &[Exact, Power]);
}

#[test]
fn holes_gaps_and_components() {
    assert_all_right("torus", &shapes::torus([16, 3, 3]), &[Exact, Auto]);
    assert_all_right("nested spheres", &shapes::nested_spheres(), &[Exact]);
    assert_all_right("comb", &shapes::comb(), &[Exact]);
    assert_all_right("60 holes", &shapes::plate_with_holes(), &[Exact]);
    assert_all_right("plates", &shapes::plates(), &[Exact]);
    assert_all_right("scattered boxes", &shapes::scattered(4), &[Exact]);
}

#[test]
fn edges_of_a_millionth() {
    for split in [Split::Six, Split::Five] {
        let graded = shapes::graded(split);
        let mesh = assemble(&graded);
        let [shortest, longest] = mesh.validate().edge_lengths;
        assert!(longest > 1e5 * shortest, "{shortest} to {longest}");
        assert_all_right("graded", &graded, &[Exact, Mpvo]);
        assert_all_right("half of graded", &thinned(&graded, 0.5, 9), &[Exact]);
        // Close to the small cells.
        let mut judge = Judge::new("graded", &mesh);
        for distance in [1e-6, 1e-5, 1e-3] {
            let view = views::perspective(DVec3::new(0.3, 0.5, 0.7) * distance, DVec3::X * 0.01, 1.0, 48);
            judge.assert_right("among the smallest", &view, Exact);
        }
    }
}

#[test]
fn cells_that_do_not_meet_face_to_face() {
    // The sides of hexahedra are split along both diagonals. Where they are plane, cells still do not overlap.
    let plane = shapes::non_conforming([4, 4, 4]);
    assert_all_right("not conforming, plane", &plane, &[Exact]);
    // Where they are bent, there are gaps and overlaps of a share of the jitter.
    let mesh = assemble(&jittered(plane, DVec3::splat(0.02), 11));
    let mut judge = Judge::new("not conforming, bent", &mesh);
    for (from, view) in views::views(&mesh, 48, 2) {
        judge.assert_right(from, &view, Exact);
    }
}

#[test]
fn what_is_not_exact_is_found_wrong() {
    // The judge sees what it should: by centroid, rays are wrong on every one of these.
    let graded = jittered(cube([10, 10, 3], Split::Six), DVec3::splat(0.03), 1);
    for (what, parts) in [("bent grid", graded), ("torus", shapes::torus([16, 3, 3])), ("comb", shapes::comb())] {
        let mesh = assemble(&parts);
        let mut judge = Judge::new(what, &mesh);
        let inverted = |judge: &mut Judge<'_>, method| -> usize {
            views::views(&mesh, 48, 1).iter().map(|(_, view)| judge.judge(view, method).inverted.len()).sum()
        };
        assert!(inverted(&mut judge, Centroid) > 1000, "{what}");
        let (mpvo, mpvonc) = (inverted(&mut judge, Mpvo), inverted(&mut judge, Mpvonc));
        println!("{what}: {mpvo} rays wrong by mpvo, {mpvonc} by mpvonc");
    }
}
