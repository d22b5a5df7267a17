use glam::DVec3;
use proptest::prelude::*;
use tetlux_mesh::procedural::{Parts, Split, cuboid, sphere_shell};

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

/// Which pixels are looked at closely: as the outline less one of its lines tells, and as faces do; nothing if some vertex
/// is not well before the eye.
fn looked_at(mesh: &TetMesh, sampling: &Sampling, missing: Option<usize>) -> Option<[Vec<bool>; 2]> {
    let facts = Facts::new(mesh);
    let at = if sampling.orthographic { -sampling.forward } else { sampling.eye - mesh.origin() };
    let (rays, mut codes) = (Rays::new(sampling, mesh.origin()), vec![]);
    face_codes(mesh, &facts, &Viewpoint::new(at, !sampling.orthographic), &mut codes);
    let mut outline = Outline::default();
    if !outline.find(mesh, &facts, &codes, &rays) {
        return None;
    }
    if let Some(missing) = missing {
        outline.lines.remove(missing % outline.lines.len());
    }
    let [width, height] = sampling.size;
    let area = Pixels { columns: 0..width, rows: 0..height };
    let mut band = Band::default();
    let many = |band: &Band| {
        let count = |pixel| band.counts.get(pixel).is_some_and(|&count| count > SIMPLE);
        (0..(width * height) as usize).map(count).collect::<Vec<bool>>()
    };
    band.wind(&rays, outline.lines.iter(), &area);
    let by_outline = many(&band);
    let corners = |face: usize| facts.vertices(mesh, face).1.map(|v| mesh.points()[v as usize]);
    let face = |face| Face::new(mesh, &facts, face, codes[face], rays.bounds(corners(face)));
    let faces: Vec<Face> = (facts.interior..facts.owners.len()).filter_map(face).collect();
    band.count(&View { rays: &rays, inside: false, tolerance: 0.0 }, faces.iter(), &area);
    Some([by_outline, many(&band)])
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn outlines_wind_as_often_as_faces_cover(
        eye in prop::array::uniform3(-1.0f64..1.0), away in 6.0f64..30.0, width in 0.1f64..2.0,
        orthographic in any::<bool>(), mirrored in any::<bool>(), shell in any::<bool>(), missing in any::<usize>(),
    ) {
        let mesh = if shell {
            let parts = sphere_shell([12, 8, 1], Split::Six, DVec3::ZERO, [2.0, 3.0]);
            TetMesh::assemble(&parts.points, &parts.cells, vec![]).unwrap()
        } else {
            boxes(&[0.0, 2.0, 5.0])
        };
        let eye = DVec3::from(eye) * away;
        prop_assume!(eye.length() > 1.0);
        let forward = -eye.normalize();
        let right = forward.any_orthonormal_vector() * if mirrored { -1.0 } else { 1.0 };
        let pixel = width / 50.0 * if orthographic { away } else { 1.0 };
        let down = forward.cross(right) * if mirrored { -1.0 } else { 1.0 };
        let eye = eye + mesh.origin();
        let view = Sampling { eye, right, down, forward, pixel, size: [37, 50], near: 0.0, orthographic };
        let Some([by_outline, by_faces]) = looked_at(&mesh, &view, None) else { return Ok(()) };
        let missed = by_faces.iter().zip(&by_outline).filter(|(face, outline)| **face && !**outline).count();
        let doubted = by_outline.iter().zip(&by_faces).filter(|(outline, face)| **outline && !**face).count();
        prop_assert_eq!(missed, 0);
        // Lines cross some hundred rows, and doubt two thousandths of a pixel in each.
        prop_assert!(doubted < 20, "{} pixels", doubted);
        // Without a line, rows that it crossed wind otherwise, to their ends.
        let many = by_faces.iter().filter(|&&many| many).count();
        if many > 100 {
            let planted = (0..100).any(|i| looked_at(&mesh, &view, Some(missing.wrapping_add(i))).unwrap()[0] != by_outline);
            prop_assert!(planted);
        }
    }
}
