use glam::DVec3;
use tetlux_mesh::procedural::{Parts, Split, cuboid};

use super::*;
use crate::Sampling;
use crate::exact::Viewpoint;
use crate::signs::{cell_arrows, face_codes};

/// Crossings of one ray: depth, cell, and whether it enters.
fn walked(crossings: &[(f64, u32, bool)]) -> Findings {
    let mut crossings: Vec<Crossing> =
        crossings.iter().map(|&(depth, cell, entry)| Crossing { depth, cell, pixel: 0, entry }).collect();
    let mut findings = Findings::default();
    findings.clear();
    walk(&mut crossings, 1e-6, &mut findings);
    findings.arrows.sort_unstable();
    findings
}

fn arrow(from: u64, to: u64) -> u64 {
    from << 32 | to
}

#[test]
fn pieces_follow_one_another() {
    let found =
        walked(&[(1.0, 1, true), (2.0, 2, false), (3.0, 3, true), (4.0, 3, false), (5.0, 4, true), (6.0, 5, false)]);
    assert_eq!(found.arrows, [arrow(2, 3), arrow(3, 4)]);
    assert_eq!((found.overlap_pixels, found.overlapping.len()), (0, 0));
    // From inside, the first piece has no entry.
    assert_eq!(walked(&[(2.0, 2, false), (3.0, 3, true), (4.0, 4, false)]).arrows, [arrow(2, 3)]);
    assert!(walked(&[(2.0, 2, false)]).arrows.is_empty());
}

#[test]
fn crossings_at_one_depth_change_places() {
    // Touching pieces, the second entered before the first is left.
    let found = walked(&[(1.0, 1, true), (2.0, 3, true), (2.0 + 1e-7, 2, false), (4.0, 4, false)]);
    assert_eq!((found.arrows, found.overlap_pixels), (vec![arrow(2, 3)], 0));
    // A piece of no thickness, left before it is entered.
    let found = walked(&[(1.0, 1, true), (2.0, 1, false), (3.0, 2, false), (3.0 + 1e-7, 3, true)]);
    assert_eq!((found.arrows, found.overlap_pixels), (vec![arrow(1, 3)], 0));
}

#[test]
fn overlapping_pieces_lead_to_one_another() {
    let found =
        walked(&[(0.1, 9, true), (0.2, 9, false), (1.0, 1, true), (2.0, 3, true), (2.5, 2, false), (4.0, 4, false)]);
    let both = |a, b| [arrow(a, b), arrow(b, a)];
    let mut expected = [&both(1, 3)[..], &both(3, 2), &both(2, 4), &[arrow(9, 1)]].concat();
    expected.sort_unstable();
    assert_eq!(found.arrows, expected);
    assert_eq!(found.overlap_pixels, 1);
    // The eye in two pieces.
    assert_eq!(walked(&[(1.0, 1, false), (2.0, 2, false)]).arrows, both(1, 2));
}

/// Arrows across gaps as seen from an eye.
fn arrows(mesh: &TetMesh, eye: DVec3, orthographic: bool) -> Vec<u64> {
    let facts = Facts::new(mesh);
    let (right, down, forward) = (DVec3::Y, DVec3::NEG_Z, DVec3::NEG_X);
    let pixel = if orthographic { 0.1 } else { 0.05 };
    let sampling = Sampling { eye, right, down, forward, pixel, size: [37, 50], near: 0.0, orthographic };
    let at = if orthographic { DVec3::X } else { eye - mesh.origin() };
    let viewpoint = Viewpoint::new(at, !orthographic);
    let (mut codes, mut states) = (vec![], vec![]);
    face_codes(mesh, &facts, &viewpoint, &mut codes);
    let inside = cell_arrows(&facts, &codes, &mut states);
    let mut gaps = Gaps::default();
    gaps.find(mesh, &facts, &codes, &Rays::new(&sampling, mesh.origin()), inside);
    assert_eq!((gaps.overlap_pixels, gaps.overlap_cells), (0, 0));
    gaps.arrows
}

fn boxes(places: &[f64]) -> TetMesh {
    let mut parts = Parts::default();
    for &x in places {
        parts.append(&cuboid([1, 2, 2], Split::Six, [DVec3::new(x, -1.0, -1.0), DVec3::new(x + 1.0, 1.0, 1.0)]));
    }
    TetMesh::assemble(&parts.points, &parts.cells, vec![]).unwrap()
}

#[test]
fn arrows_lead_from_box_to_box() {
    // 24 cells each; seen from the last.
    let mesh = boxes(&[0.0, 2.0, 5.0]);
    for orthographic in [false, true] {
        for (eye, most) in [(9.0, 2), (5.5, 2), (4.0, 1), (3.0, 1)] {
            let found = arrows(&mesh, DVec3::new(eye, 0.1, 0.2), orthographic);
            assert!(!found.is_empty());
            let boxes = |arrow: u64| ((arrow >> 32) as u32 / 24, arrow as u32 / 24);
            assert!(found.iter().all(|&arrow| boxes(arrow).0 == boxes(arrow).1 + 1), "to the next box: {found:?}");
            let pairs: std::collections::BTreeSet<_> = found.iter().map(|&arrow| boxes(arrow)).collect();
            assert_eq!(pairs.len(), if orthographic { 2 } else { most }, "from {eye}: {pairs:?}");
        }
    }
    assert!(arrows(&boxes(&[0.0]), DVec3::new(9.0, 0.1, 0.2), false).is_empty());
}

#[test]
fn any_number_of_threads_finds_the_same() {
    let mesh = boxes(&[0.0, 2.0, 5.0]);
    let find = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| arrows(&mesh, DVec3::new(9.0, 0.1, 0.2), false))
    };
    let one = find(1);
    assert!(one.len() > 10 && one == find(3));
}
