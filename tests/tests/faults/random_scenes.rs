//! Random meshes, transfer functions and cameras against the f64 reference.

use glam::DVec3;
use tetlux_mesh::TetMesh;
use tetlux_mesh::procedural::{Parts, Split, cuboid};
use tetlux_optics::Classification;
use tetlux_optics::transfer::TransferFunction;
use tetlux_scene::{Camera, Scene};
use tetlux_tests::{
    FIELD, Random, Way, mesh_of, orthographic, perspective, pixel_error, reference, reference_beside, render, scene,
    transfer, transfer_of,
};

/// Some twenty segments a pixel, each with cuts and weights in single precision.
const TOLERANCE: f64 = 1e-4;

const CASES: u64 = 44;

/// Width and height of the pictures.
const SIDE: usize = 96;

/// A grid displaced at random, surface included.
pub(super) fn random_parts(random: &mut Random) -> Parts {
    let counts = [0; 3].map(|_| 1 + random.below(4));
    let corner = DVec3::new(random.between(0.5, 2.0), random.between(0.5, 2.0), random.between(0.5, 2.0));
    let split = if random.below(2) == 0 { Split::Five } else { Split::Six };
    let mut parts = cuboid(counts, split, [-corner, corner]);
    for p in &mut parts.points {
        // An eighth of a spacing either way: no cell turns inside out.
        for axis in 0..3 {
            p[axis] += 2.0 * corner[axis] / counts[axis] as f64 * random.between(-0.125, 0.125);
        }
    }
    parts
}

/// The same with a smooth scalar.
fn random_mesh(random: &mut Random) -> TetMesh {
    let parts = random_parts(random);
    let wave = DVec3::new(random.between(-2.0, 2.0), random.between(-2.0, 2.0), random.between(-2.0, 2.0));
    let mesh = mesh_of(&parts, |p| wave.dot(p).sin() + 0.3 * p.z);
    assert_eq!((mesh.assembly().cells_inverted, mesh.assembly().faces_folded), (0, 0), "the cells do not overlap");
    mesh
}

/// Up to 12 nodes of each kind over the range, among them steps and narrow peaks.
fn random_transfer(random: &mut Random, [low, high]: [f64; 2], one_color: bool) -> TransferFunction {
    let place = |u: f64| low + (high - low) * u;
    let mut places = |count: usize| {
        let mut places: Vec<f64> = (0..count).map(|_| place(random.between(-0.1, 1.1))).collect();
        places.sort_by(f64::total_cmp);
        places
    };
    let (color, opacity) = (places(6), places(6));
    let mut nodes = Vec::new();
    for s in color {
        let rgb = [0; 3].map(|_| random.between(0.0, 1.0));
        nodes.push([s, rgb[0], rgb[1], rgb[2]]);
        if random.below(3) == 0 {
            nodes.push([s, rgb[2], rgb[0], rgb[1]]);
        }
    }
    if one_color {
        nodes = vec![[low, 0.25, 1.0, 0.5]];
    }
    let mut heights = Vec::new();
    for s in opacity {
        match random.below(4) {
            // A step.
            0 => heights.extend([[s, random.between(0.0, 2.0)], [s, random.between(0.0, 2.0)]]),
            // A peak of a hundredth of the range.
            1 => {
                let half = 0.005 * (high - low);
                heights.extend([[s - half, 0.0], [s, random.between(0.0, 30.0)], [s + half, 0.0]]);
            }
            2 => heights.push([s, 0.0]),
            _ => heights.push([s, random.between(0.0, 3.0)]),
        }
    }
    heights.sort_by(|a, b| a[0].total_cmp(&b[0]));
    heights.truncate(12);
    transfer(&nodes, &heights)
}

pub(super) fn random_camera(random: &mut Random) -> Camera {
    let mut direction = || DVec3::new(random.between(-1.0, 1.0), random.between(-1.0, 1.0), random.between(-1.0, 1.0));
    let (toward, focus) = (direction(), direction() * 0.3);
    // From well outside to deep inside.
    let position = focus + toward.normalize_or(DVec3::X) * random.between(0.2, 6.0);
    match random.below(2) {
        0 => perspective(position, focus, random.between(20.0, 100.0)),
        _ => orthographic(position, focus, random.between(0.8, 2.5)),
    }
}

fn random_scene(seed: u64, one_color: bool) -> (TetMesh, Scene) {
    let mut random = Random::new(seed);
    let mesh = random_mesh(&mut random);
    let range = mesh.scalar(FIELD, Default::default()).map_or([0.0, 1.0], |s| s.range);
    let transfer = random_transfer(&mut random, range, one_color);
    let camera = random_camera(&mut random);
    let mut scene = scene(&mesh, transfer, camera, [SIDE as u32; 2]);
    scene.unit_distance = random.between(0.3, 3.0);
    (mesh, scene)
}

/// Scalars, normalised to the field's range, are good to this share of it: a few units of the last place.
const SCALAR_ROUNDING: f64 = 3e-7;

/// Positions in pictures of a hundred pixels are good to this many pixels: a few units of the last place.
const PIXEL_ROUNDING: f64 = 1.5e-5;

/// How far the truth itself moves where scalars and rays are moved by their rounding: more than any tolerance where a
/// ray runs along a step or grazes a face.
fn sensitivity(mesh: &TetMesh, scene: &Scene, truth: &[[f64; 4]]) -> Vec<f64> {
    let [low, high] = scene.scalar.range;
    let shifted = |shift: f64| {
        let nodes = transfer_of(scene);
        let (color, opacity) = (nodes.color_nodes(), nodes.opacity_nodes());
        let color: Vec<[f64; 4]> = color.iter().map(|n| [n.s + shift, n.rgb[0], n.rgb[1], n.rgb[2]]).collect();
        let opacity: Vec<[f64; 2]> = opacity.iter().map(|n| [n.s + shift, n.opacity]).collect();
        reference(
            mesh,
            &Scene { classification: Classification::OneField(transfer(&color, &opacity)), ..scene.clone() },
        )
    };
    let by_scalars = [-1.0, 1.0].map(|sign| shifted(sign * SCALAR_ROUNDING * (high - low)));
    let p = PIXEL_ROUNDING;
    let by_pixels = [[-p, 0.0], [p, 0.0], [0.0, -p], [0.0, p]].map(|by| reference_beside(mesh, scene, by));
    let moved = |pictures: &[Vec<[f64; 4]>], i: usize| {
        pictures.iter().map(|picture| pixel_error(picture[i].map(|c| c as f32), truth[i])).fold(0.0, f64::max)
    };
    (0..truth.len()).map(|i| moved(&by_scalars, i) + moved(&by_pixels, i)).collect()
}

/// Renders random scenes and asserts every pixel, but for the few whose truth hangs on the last places of scalars or positions.
fn assert_close(seeds: std::ops::Range<u64>, one_color: bool, way: Way) {
    let (mut max, mut covered, mut excused) = (0.0f64, 0, 0);
    for seed in seeds {
        let (mesh, scene) = random_scene(seed, one_color);
        let truth = reference(&mesh, &scene);
        let image = render(&mesh, &scene, way);
        covered += truth.iter().filter(|t| t[3] > 0.0).count();
        let errors: Vec<f64> = image.pixels().iter().zip(&truth).map(|(&p, &t)| pixel_error(p, t)).collect();
        let over: Vec<usize> = (0..errors.len()).filter(|&i| errors[i] > TOLERANCE).collect();
        max = errors.iter().filter(|&&e| e <= TOLERANCE).fold(max, |m, &e| m.max(e));
        if !over.is_empty() {
            let sensitivity = sensitivity(&mesh, &scene, &truth);
            for i in over {
                assert!(
                    errors[i] <= TOLERANCE + sensitivity[i],
                    "seed {seed}, pixel ({}, {}): {:?}, not {:?}: off by {:.1e}, and rounding explains {:.1e}",
                    i % SIDE,
                    i / SIDE,
                    image.pixels()[i],
                    truth[i],
                    errors[i],
                    sensitivity[i]
                );
                excused += 1;
            }
        }
    }
    println!("{way:?}: max {max:.1e} over {covered} pixels; {excused} hang on rounding");
    assert!(covered > CASES as usize * SIDE * SIDE / 10, "the scenes are seen: {covered} pixels");
    assert!(excused * 50_000 <= covered, "{excused} of {covered} pixels");
}

#[test]
fn sorted_pixels_agree_with_the_reference() {
    assert_close(0..CASES, false, Way::CpuPixel);
}

#[test]
fn one_luminance_needs_no_order() {
    assert_close(100..100 + CASES, true, Way::GpuNone);
}
