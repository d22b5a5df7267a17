//! Random meshes, transfer functions and cameras against the f64 reference.

use glam::DVec3;
use tetlux_mesh::TetMesh;
use tetlux_mesh::procedural::{Split, cuboid};
use tetlux_optics::transfer::TransferFunction;
use tetlux_scene::{Camera, Scene};
use tetlux_tests::{
    Random, Way, largest_error, mesh_of, orthographic, perspective, pixel_error, reference, render, scene, transfer,
};

/// Some twenty segments a pixel, each with cuts and weights in single precision.
const TOLERANCE: f64 = 1e-4;

const CASES: usize = 44;

/// A grid displaced at random, surface included, with a smooth scalar.
fn random_mesh(random: &mut Random) -> TetMesh {
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
    let (color, opacity) = (places(1 + one_color as usize * 0 + 5), places(6));
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

fn random_camera(random: &mut Random) -> Camera {
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
    let range = mesh.scalar(tetlux_tests::FIELD, Default::default()).map_or([0.0, 1.0], |s| s.range);
    let transfer = random_transfer(&mut random, range, one_color);
    let camera = random_camera(&mut random);
    let mut scene = scene(&mesh, transfer, camera, [96, 96]);
    scene.unit_distance = random.between(0.3, 3.0);
    (mesh, scene)
}

/// Renders a random scene and asserts every pixel; the largest error.
fn assert_close(seed: u64, one_color: bool, way: Way) -> f64 {
    let (mesh, scene) = random_scene(seed, one_color);
    let truth = reference(&mesh, &scene);
    let image = render(&mesh, &scene, way);
    let max = largest_error(image.pixels(), &truth);
    if max > TOLERANCE {
        for (i, (&p, &t)) in
            image.pixels().iter().zip(&truth).enumerate().filter(|(_, (p, t))| pixel_error(**p, **t) > TOLERANCE)
        {
            println!("seed {seed} pixel {} {}: {p:?} {t:?}", i % 96, i / 96);
        }
    }
    println!("seed {seed}: {max:.1e}");
    max
}

#[test]
fn sorted_pixels_agree_with_the_reference() {
    let worst = (0..CASES as u64).map(|seed| assert_close(seed, false, Way::CpuPixel)).fold(0.0, f64::max);
    assert!(worst < TOLERANCE, "largest error {worst:.2e}");
}

#[test]
fn one_luminance_needs_no_order() {
    let worst = (100..100 + CASES as u64).map(|seed| assert_close(seed, true, Way::GpuNone)).fold(0.0, f64::max);
    assert!(worst < TOLERANCE, "largest error {worst:.2e}");
}
