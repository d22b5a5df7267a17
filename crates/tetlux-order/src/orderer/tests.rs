use glam::DVec3;
use tetlux_mesh::procedural::{Split, cuboid, sphere_shell};

use super::*;

fn view(eye: DVec3) -> Sampling {
    let forward = -eye.normalize();
    let right = forward.any_orthonormal_vector();
    let down = forward.cross(right);
    Sampling { eye, right, down, forward, pixel: 0.02, size: [64, 48], near: 0.0, orthographic: false }
}

fn ball() -> TetMesh {
    let parts = sphere_shell([12, 8, 3], Split::Six, DVec3::ZERO, [0.6, 1.0]);
    TetMesh::assemble(&parts.points, &parts.cells, vec![]).unwrap()
}

fn cube() -> TetMesh {
    let parts = cuboid([3; 3], Split::Six, [DVec3::splat(-1.0), DVec3::ONE]);
    TetMesh::assemble(&parts.points, &parts.cells, vec![]).unwrap()
}

#[test]
fn auto_says_what_it_does() {
    let sampling = view(DVec3::new(3.0, 1.0, 2.0));
    for (mesh, method, reason) in [(cube(), Method::Mpvo, "is convex"), (ball(), Method::Exact, "not convex")] {
        let facts = Facts::new(&mesh);
        let mut orderer = Orderer::new();
        let report = &orderer.order(&mesh, &facts, &sampling, Method::Auto).report;
        assert_eq!(report.method, method);
        assert!(report.reason.contains(reason));
        assert_eq!(report.gap_arrows > 0, method == Method::Exact);
        assert!(report.stages.iter().any(|stage| stage.name == "search" && stage.wall > 0.0));
    }
}

#[test]
fn the_last_order_is_given_again_until_something_changes() {
    let (mesh, other) = (ball(), cube());
    let (facts, other_facts) = (Facts::new(&mesh), Facts::new(&other));
    let (here, there) = (view(DVec3::new(3.0, 1.0, 2.0)), view(DVec3::new(-3.0, 1.0, 2.0)));
    let mut orderer = Orderer::new();
    let first = orderer.order(&mesh, &facts, &here, Method::Exact).clone();
    let again = orderer.order(&mesh, &facts.clone(), &here, Method::Exact).clone();
    assert!(again.report.reason.contains("nothing has changed") && again.report.stages.is_empty());
    assert_eq!((again.cells, again.report.gap_arrows), (first.cells.clone(), first.report.gap_arrows));
    let moved = orderer.order(&mesh, &facts, &there, Method::Exact).cells.clone();
    assert_ne!(moved, first.cells);
    assert_eq!(orderer.order(&other, &other_facts, &there, Method::Exact).cells.len(), other.cells().len());
    // What was found in between leaves no trace.
    assert_eq!(orderer.order(&mesh, &facts, &here, Method::Exact).cells, first.cells);
}

#[test]
fn facts_of_another_mesh_are_noticed() {
    let (mesh, other) = (ball(), cube());
    let mut orderer = Orderer::new();
    let order = orderer.order(&mesh, &Facts::new(&other), &view(DVec3::X * 4.0), Method::Exact);
    assert!(order.report.reason.contains("another mesh"));
    assert!(order.cells.iter().copied().eq(0..mesh.cells().len() as u32));
}

#[test]
fn every_method_places_every_cell_once() {
    for mesh in [ball(), cube()] {
        let facts = Facts::new(&mesh);
        let mut orderer = Orderer::new();
        // Also from where there is nothing to see, and from nowhere.
        let odd = [DVec3::NAN, DVec3::splat(1e300), DVec3::X * 1e-300].map(|eye| Sampling { eye, ..view(DVec3::X) });
        let blind =
            [Sampling { size: [0, 0], ..view(DVec3::X * 2.0) }, Sampling { pixel: 0.0, ..view(DVec3::X * 2.0) }];
        let parallel = Sampling { orthographic: true, ..view(DVec3::new(1.0, 2.0, 3.0)) };
        for sampling in odd.iter().chain(&blind).chain([&parallel]) {
            for method in Method::ALL {
                let mut cells = orderer.order(&mesh, &facts, sampling, method).cells.clone();
                cells.sort_unstable();
                assert!(cells.into_iter().eq(0..mesh.cells().len() as u32), "{method}, {sampling:?}");
            }
        }
    }
}

#[test]
fn any_number_of_threads_finds_the_same_order() {
    let mesh = ball();
    let facts = Facts::new(&mesh);
    let find = |threads, method| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| Orderer::new().order(&mesh, &facts, &view(DVec3::new(0.2, 0.1, 0.3)), method).cells.clone())
    };
    for method in Method::ALL {
        assert_eq!(find(1, method), find(4, method), "{method}");
    }
}

#[test]
fn bits_ascend_with_numbers() {
    let numbers = [f32::NEG_INFINITY, -2.0, -1e-30, 0.0, 1e-30, 1.5, f32::INFINITY];
    assert!(numbers.windows(2).all(|w| ascending(w[0]) < ascending(w[1])));
}
