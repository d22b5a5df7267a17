//! Orders judged along rays, on meshes of every kind and from every kind of place.
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a test's helpers fail and tell like the test")]

mod cycles;
mod facts;
mod grids;
mod property;
mod random;
mod real;
mod shapes;
mod views;

use tetlux_mesh::TetMesh;
use tetlux_mesh::procedural::Parts;
use tetlux_order::verify::{Pairs, Verification, Verifier};
use tetlux_order::{Facts, Method, Order, Orderer, Sampling};

/// Pixels along each side of a picture.
const SIDE: u32 = 48;

/// A mesh ready to be ordered and judged.
struct Judge<'a> {
    what: &'a str,
    mesh: &'a TetMesh,
    facts: Facts,
    verifier: Verifier<'a>,
    orderer: Orderer,
}

impl<'a> Judge<'a> {
    fn new(what: &'a str, mesh: &'a TetMesh) -> Judge<'a> {
        Judge { what, mesh, facts: Facts::new(mesh), verifier: Verifier::new(mesh), orderer: Orderer::new() }
    }

    fn order(&mut self, view: &Sampling, method: Method) -> &Order {
        self.orderer.order(self.mesh, &self.facts, view, method)
    }

    /// What the rays of a view's pixels say.
    fn judge(&mut self, view: &Sampling, method: Method) -> Verification {
        let order = self.orderer.order(self.mesh, &self.facts, view, method);
        self.verifier.verify(order, &views::rays(view), Pairs::Adjacent)
    }

    /// Asserts that an order is a permutation without an inversion.
    #[track_caller]
    fn assert_right(&mut self, from: &str, view: &Sampling, method: Method) -> Verification {
        let found = self.judge(view, method);
        let place = format!("{}, {from}, {method}", self.what);
        assert!(
            found.is_right() && found.missing == 0,
            "{place}: {} of {} pairs inverted, {} cells missing, {} repeated; {:?}, {view:?}",
            found.inversions,
            found.pairs,
            found.missing,
            found.repeated,
            found.examples.first()
        );
        found
    }
}

/// Asserts that methods are right from everywhere, and need no groups for it; gives the pairs checked.
#[track_caller]
fn assert_all_right(what: &str, parts: &Parts, methods: &[Method]) -> u64 {
    let mesh = shapes::assemble(parts);
    let mut judge = Judge::new(what, &mesh);
    let mut pairs = 0;
    for (from, view) in views::views(&mesh, SIDE, 1) {
        for &method in methods {
            let found = judge.assert_right(from, &view, method);
            let groups = &judge.order(&view, method).groups;
            assert!(groups.is_empty(), "{what}, {from}, {method}: groups {groups:?}");
            assert_eq!(found.overlaps, 0, "{what}, {from}: {:?}", found.overlap_examples.first());
            pairs += found.pairs;
        }
    }
    assert!(pairs > 10_000, "{what}: the rays see the mesh, {pairs} pairs");
    pairs
}
