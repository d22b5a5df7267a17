//! Pictures whose right answer is known, in the cases where renderers of unstructured grids are known to fail.
//!
//! Most are convex bodies with a scalar that is linear throughout: whatever the cells, a ray that enters at scalar s_0
//! and leaves at s_1 after a world length l has the optical depth of [`depth_of`](tetlux_tests::depth_of), and a white
//! body the colour and alpha 1 - exp(-depth).

#![allow(clippy::print_stdout, reason = "the figures that were measured")]

mod classes;
mod close_to_the_eye;
mod coverage;
mod cycles;
mod extremes;
mod eye_inside;
mod grid_rays;
mod layers;
mod long_rays;
mod no_data;
mod random_scenes;
mod thin_sheets;
mod transfer_functions;

use glam::DVec3;
use tetlux_mesh::TetMesh;
use tetlux_scene::Scene;
use tetlux_tests::{Convex, Judged, Way, depth_of, judge, render};

/// What single precision leaves of a pixel: positions, lengths and weights are each good to some 1e-6.
const TOLERANCE: f64 = 1e-5;

/// The value of a ray through a white body whose scalar is `field`: alpha in all four channels.
fn white_ray(
    body: &Convex,
    field: impl Fn(DVec3) -> f64,
    opacity: &[[f64; 2]],
    unit_distance: f64,
    (origin, direction, start): (DVec3, DVec3, f64),
) -> Option<[f64; 4]> {
    let [enter, leave] = body.chord(origin, direction, start)?;
    let s = [enter, leave].map(|t| field(origin + direction * t));
    let depth = depth_of(opacity, s, (leave - enter) * direction.length(), unit_distance);
    Some([-(-depth).exp_m1(); 4])
}

/// Renders a white body every way and judges each picture: none may have a wrong pixel. Returns the last judgement.
fn assert_white(
    what: &str,
    mesh: &TetMesh,
    scene: &Scene,
    body: &Convex,
    field: impl Fn(DVec3) -> f64,
    tolerance: f64,
) -> Judged {
    let opacity: Vec<[f64; 2]> =
        tetlux_tests::transfer_of(scene).opacity_nodes().iter().map(|n| [n.s, n.opacity]).collect();
    let truth = |o, d, start| white_ray(body, &field, &opacity, scene.unit_distance, (o, d, start));
    assert_judged(what, mesh, scene, &Way::ALL, tolerance, truth)
}

/// Renders some ways and judges each picture by the value of each ray.
fn assert_judged(
    what: &str,
    mesh: &TetMesh,
    scene: &Scene,
    ways: &[Way],
    tolerance: f64,
    truth: impl Fn(DVec3, DVec3, f64) -> Option<[f64; 4]>,
) -> Judged {
    let judged: Vec<(Way, Judged)> =
        ways.iter().map(|&way| (way, judge(&render(mesh, scene, way), scene, tolerance, &truth))).collect();
    for (way, judged) in &judged {
        println!("{what}, {way:?}: max {:.1e} over {} pixels", judged.max, judged.covered);
    }
    let faults: Vec<String> = judged
        .iter()
        .filter(|(_, judged)| judged.wrong > 0)
        .map(|(way, judged)| {
            let Judged { max, wrong, covered, worst: ([x, y], found, right), .. } = judged;
            format!("{way:?}: {wrong} of {covered} pixels, by up to {max:.2e}: at ({x}, {y}) {found:?}, not {right:?}")
        })
        .collect();
    assert!(faults.is_empty(), "{what}: wrong by more than {tolerance:.0e}:\n{}", faults.join("\n"));
    judged.last().unwrap_or_else(|| panic!("{what}: no way to render was given")).1
}
