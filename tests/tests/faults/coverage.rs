//! What is lit where nothing is, and dark where something is, by however little.

use glam::DVec3;
use tetlux_mesh::procedural::{Split, grid};
use tetlux_tests::{Way, mesh_of, perspective, reference, reference_beside, render, scene, white};

/// Spacing in the middle of a graded cube over that at its surface.
const GRADING: f64 = 1e-6;

/// Hexahedra from its middle to its surface.
const COUNT: usize = 8;

/// Single precision knows a place in a picture to so much of its side.
const BESIDE: f64 = 1e-6;

/// What rounding leaves of nothing in the truth.
const NOTHING: f64 = 1e-14;

#[test]
fn a_graded_mesh_is_lit_where_it_is_and_nowhere_else() {
    // Beside the silhouette tiles lit a pixel by 2e-8: the ray missed a cell, but two of its planes, one along the other, were
    // nearer to each other there than rounding.
    let half = COUNT as f64;
    let growth = GRADING.powf(-1.0 / (half - 1.0));
    let place = |u: f64| {
        let steps = ((2.0 * u - 1.0) * half).round();
        steps.signum() * (growth.powf(steps.abs()) - 1.0) / (growth.powf(half) - 1.0)
    };
    let parts = grid([2 * COUNT; 3], Split::Six, |u| DVec3::new(place(u.x), place(u.y), place(u.z)));
    let mesh = mesh_of(&parts, |p| (p.length() / GRADING).ln_1p() / GRADING.recip().ln_1p() / 1.05);
    let camera = perspective(DVec3::new(1.6, -2.9, 1.3), DVec3::ZERO, 36.0);
    let scene = scene(&mesh, white(&[[0.0, 0.4], [1.0, 0.6]]), camera, [64, 56]);
    let by = BESIDE * 64.0;
    let mut truths = vec![reference(&mesh, &scene)];
    truths.extend([[-by, -by], [by, -by], [-by, by], [by, by]].map(|by| reference_beside(&mesh, &scene, by)));
    for way in Way::RIGHT {
        let picture = render(&mesh, &scene, way);
        for (i, pixel) in picture.pixels().iter().enumerate() {
            let alphas = || truths.iter().map(|truth| truth[i][3]);
            let is_lit = pixel.iter().any(|&c| c != 0.0);
            let at = [i % 64, i / 64];
            assert!(!is_lit || alphas().any(|alpha| alpha > 0.0), "{way:?} at {at:?}: {pixel:?}, where nothing is");
            assert!(
                is_lit || alphas().any(|alpha| alpha <= NOTHING),
                "{way:?} at {at:?}: nothing, not {:?}",
                truths[0][i]
            );
        }
    }
}
