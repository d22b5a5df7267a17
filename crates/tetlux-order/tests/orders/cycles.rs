//! Cells that occlude one another in a ring, and cells that overlap.

use glam::DVec3;
use tetlux_mesh::{TetMesh, procedural};
use tetlux_order::Method::{Auto, Exact, Mpvo};
use tetlux_order::{Method, Sampling};

use crate::shapes::{self, assemble};
use crate::views::{self, perspective};
use crate::{Judge, SIDE};

/// Sizes of the groups.
fn groups(judge: &mut Judge<'_>, view: &Sampling, method: Method) -> Vec<u32> {
    let order = judge.order(view, method);
    assert_eq!(order.report.cells_in_groups, order.groups.iter().map(|g| g.len()).sum::<usize>());
    order.groups.iter().map(|g| g.end - g.start).collect()
}

/// Asserts the groups of a view, and that nothing outside them is inverted.
#[track_caller]
fn assert_groups(what: &str, mesh: &TetMesh, view: &Sampling, methods: &[Method], expected: &[u32]) {
    let mut judge = Judge::new(what, mesh);
    for &method in methods {
        assert_eq!(groups(&mut judge, view, method), expected, "{what}, {method}");
        judge.assert_right("its ring", view, method);
    }
}

#[test]
fn three_cells_without_a_common_face() {
    let mesh = assemble(&procedural::three_cycle());
    let view = perspective(DVec3::splat(12.0), DVec3::ZERO, 0.2, 64);
    assert_groups("three cells", &mesh, &view, &[Exact, Auto], &[3]);
    // That they are a ring is no matter of taste: no order of the three is right.
    let mut judge = Judge::new("three cells", &mesh);
    for cells in [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]] {
        let order = tetlux_order::Order { cells: cells.to_vec(), ..Default::default() };
        assert!(!judge.verifier.verify(&order, &views::rays(&view), Default::default()).is_right(), "{cells:?}");
    }
    // From elsewhere they are none.
    let aside = perspective(DVec3::new(12.0, 0.5, 0.25), DVec3::ZERO, 0.2, 64);
    assert_eq!(groups(&mut judge, &aside, Exact), []);
    judge.assert_right("aside", &aside, Exact);
}

#[test]
fn rings_of_any_size() {
    for k in 3..=32 {
        let mesh = assemble(&procedural::ring(k, 60.0));
        for height in [8.0, -8.0] {
            let along = perspective(DVec3::new(0.013, 0.007, height), DVec3::Z * 0.5, 0.2, 96);
            assert_groups(&format!("ring of {k} from {height}"), &mesh, &along, &[Exact], &[k]);
        }
        let aside = perspective(DVec3::new(8.0, 1.0, 3.0), DVec3::Z * 0.5, 0.2, 96);
        assert_groups(&format!("ring of {k} from aside"), &mesh, &aside, &[Exact], &[]);
    }
}

#[test]
fn a_convex_mesh_with_a_cycle_through_faces() {
    let mesh = assemble(&procedural::filled_ring());
    let report = mesh.validate();
    // 11 cells of 4 faces, 18 of them shared.
    assert_eq!((report.cells, report.boundary_faces, report.components), (11, 44 - 2 * 18, 1));
    assert_eq!((report.assembly.faces_folded, report.assembly.cells_flat), (0, 0));
    let along = perspective(DVec3::new(0.013, 0.007, 8.0), DVec3::Z * 0.5, 0.2, 96);
    assert_groups("filled ring", &mesh, &along, &[Exact, Mpvo, Auto], &[9]);
}

#[test]
fn overlapping_cells_end_with_a_report() {
    for (count, seed) in [(2, 1), (30, 2), (400, 3)] {
        let mesh = assemble(&shapes::tangle(count, seed));
        let mut judge = Judge::new("tangle", &mesh);
        for (from, view) in views::views(&mesh, SIDE, seed) {
            for method in Method::ALL {
                let found = judge.judge(&view, method);
                assert_eq!((found.missing, found.repeated), (0, 0), "{from}, {method}");
                if method == Exact && count > 100 && from == "away" {
                    // Every cell is tangled with others: what has no order is said to have none.
                    let report = &judge.order(&view, method).report;
                    assert!(found.grouped > found.pairs && report.overlap_pixels > 0, "{from}: {report:?}");
                }
            }
        }
    }
}
