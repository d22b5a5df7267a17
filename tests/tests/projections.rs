//! Every projection of cells makes the same picture: that of the f64 reference.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a test's helpers fail and tell like the test")]

use glam::DVec3;
use tetlux_mesh::TetMesh;
use tetlux_mesh::procedural::{Split, cuboid, sphere_shell, wing};
use tetlux_optics::transfer::TransferFunction;
use tetlux_render::Frame;
use tetlux_render::Model;
use tetlux_scene::{Backend, Camera, CellProjection, Integrator, Method, Order, Plan, Scene};
use tetlux_tests::{
    Way, mesh_of, mesh_with, orthographic, perspective, pixel_error, reference, reference_beside, render, renderer,
    scene, transfer, white,
};

/// What projections that find segments by planes or by offsets in single precision may be off by.
const TOLERANCE: f64 = 1e-4;

/// Pixels by which rays are moved to see whether their centres lie on a silhouette.
const BESIDE: f64 = 1e-4;

const SIZE: [u32; 2] = [64, 64];

fn draw(mesh: &TetMesh, scene: &Scene, method: Method) -> Frame {
    let scene = Scene { method: Method { backend: Backend::Gpu, ..method }, ..scene.clone() };
    let plan = Plan::new(&scene, mesh, renderer().device()).unwrap();
    renderer().render(&scene, &Model::new(mesh), &plan).unwrap()
}

fn by(projection: CellProjection) -> Method {
    Method { projection, ..Method::default() }
}

/// Largest error of any pixel that is on no silhouette, and the share of pixels off by more than the tolerance.
fn judged(pixels: &[[f32; 4]], mesh: &TetMesh, scene: &Scene) -> (f64, f64) {
    let truth = reference(mesh, scene);
    let errors: Vec<f64> = pixels.iter().zip(&truth).map(|(&pixel, &right)| pixel_error(pixel, right)).collect();
    let largest = |errors: &mut dyn Iterator<Item = f64>| errors.fold(0.0, f64::max);
    if largest(&mut errors.iter().copied()) <= TOLERANCE {
        return (largest(&mut errors.iter().copied()), 0.0);
    }
    let around = [(-BESIDE, -BESIDE), (-BESIDE, BESIDE), (BESIDE, -BESIDE), (BESIDE, BESIDE)];
    let around = around.map(|(x, y)| reference_beside(mesh, scene, [x, y]));
    // Steeper than a hundred a pixel is no slope.
    let jumps = |i: usize| around.iter().any(|a| (0..4).any(|k| (a[i][k] - truth[i][k]).abs() > 100.0 * BESIDE));
    let off: Vec<f64> = errors.iter().enumerate().filter(|&(i, _)| !jumps(i)).map(|(_, &error)| error).collect();
    let wrong = off.iter().filter(|&&error| error > TOLERANCE).count();
    (largest(&mut off.iter().copied()), wrong as f64 / errors.len() as f64)
}

#[test]
fn a_planted_difference_is_judged() {
    let (_, mesh, inside) = meshes().remove(0);
    let scene = scene(&mesh, without_color(&mesh), cameras(&mesh, inside)[0], SIZE);
    let mut pixels = draw(&mesh, &scene, by(CellProjection::Pt)).image.pixels().to_vec();
    assert!(judged(&pixels, &mesh, &scene).0 <= TOLERANCE);
    pixels[32 * 64 + 32][1] += 2e-4;
    let (error, share) = judged(&pixels, &mesh, &scene);
    assert!((error - 2e-4).abs() < 1e-5 && share == 1.0 / 4096.0, "{error} {share}");
}

/// A body, and a camera inside it or close by, beside those outside.
fn meshes() -> Vec<(&'static str, TetMesh, DVec3)> {
    let field = |p: DVec3| (1.7 * p.x).sin() + p.y * p.z;
    let two = {
        let mut parts = cuboid([3, 2, 2], Split::Five, [-DVec3::ONE, DVec3::new(-0.1, 0.6, 0.7)]);
        parts.append(&cuboid([2, 3, 2], Split::Six, [DVec3::new(0.15, -0.8, -0.9), DVec3::new(1.0, 1.0, 0.4)]));
        parts
    };
    let wing = wing(3, 1500);
    let shell = sphere_shell([9, 5, 2], Split::Six, DVec3::ZERO, [0.55, 1.0]);
    vec![
        (
            "six cells",
            mesh_of(&cuboid([1, 1, 1], Split::Six, [-DVec3::ONE, DVec3::ONE]), field),
            DVec3::new(0.3, 0.2, -0.1),
        ),
        ("a shell", mesh_of(&shell, field), DVec3::new(0.5, 0.4, -0.5)),
        ("two bodies", mesh_of(&two, field), DVec3::new(-0.7, 0.1, 0.2)),
        ("a wing", mesh_with(&wing.parts, wing.field), DVec3::new(0.5, 0.3, 0.2)),
    ]
}

fn cameras(mesh: &TetMesh, inside: DVec3) -> [Camera; 4] {
    let [low, high] = mesh.bounds();
    let (middle, width) = ((low + high) * 0.5, (high - low).max_element());
    let outside = middle + DVec3::new(1.1, -1.6, 0.9) * width;
    [
        perspective(outside, middle, 40.0),
        orthographic(outside, middle, 0.75 * width),
        perspective(inside, middle, 80.0),
        orthographic(inside, middle, 0.6 * width),
    ]
}

/// Luminance and extinction with peaks and steps over a field's range.
fn colors(mesh: &TetMesh) -> TransferFunction {
    let [low, high] = scene(mesh, white(&[[0.0, 1.0]]), perspective(DVec3::X, DVec3::ZERO, 1.0), [1, 1]).scalar.range;
    let at = |t: f64| low + t * (high - low);
    transfer(
        &[[at(0.0), 0.9, 0.1, 0.2], [at(0.4), 0.2, 0.8, 0.3], [at(0.6), 0.1, 0.3, 1.0], [at(1.0), 1.0, 0.9, 0.2]],
        &[[at(0.0), 1.0], [at(0.3), 0.1], [at(0.5), 0.8], [at(0.55), 3.0], [at(0.6), 0.3], [at(1.0), 2.0]],
    )
}

/// The same in white: the order of cells does not matter.
fn without_color(mesh: &TetMesh) -> TransferFunction {
    let nodes: Vec<[f64; 2]> = colors(mesh).opacity_nodes().iter().map(|n| [n.s, n.opacity]).collect();
    white(&nodes)
}

#[test]
fn front_faces_make_the_picture_of_the_silhouettes() {
    for (what, mesh, inside) in meshes() {
        for camera in cameras(&mesh, inside) {
            let white = scene(&mesh, without_color(&mesh), camera, SIZE);
            let (error, _) = judged(draw(&mesh, &white, by(CellProjection::Vicp)).image.pixels(), &mesh, &white);
            println!("{what}, {:?}: {error:.1e}", camera.projection);
            assert!(error <= TOLERANCE, "{what}, {:?}: {error:.1e}", camera.projection);
            // Every fragment comes from the same planes, whatever covers it: no bit differs.
            let colored = scene(&mesh, colors(&mesh), camera, SIZE);
            let ordered = Method { order: Order::Centroid, ..by(CellProjection::Vicp) };
            let picture = draw(&mesh, &colored, ordered).image;
            assert_eq!(picture, render(&mesh, &colored, Way::GpuCentroid), "{what}, {:?}", camera.projection);
            assert!(picture.pixels().iter().any(|p| p[3] > 0.1), "{what} is seen");
        }
    }
}

#[test]
fn a_march_is_right_without_an_order() {
    for (what, mesh, inside) in meshes() {
        for camera in cameras(&mesh, inside) {
            let colored = scene(&mesh, colors(&mesh), camera, SIZE);
            let frame = draw(&mesh, &colored, by(CellProjection::March));
            let (error, _) = judged(frame.image.pixels(), &mesh, &colored);
            println!("{what}, {:?}: {error:.1e}", camera.projection);
            assert!(error <= TOLERANCE, "{what}, {:?}: {error:.1e}", camera.projection);
            // A second opinion, which sorts what this never does.
            let sorted = render(&mesh, &colored, Way::CpuPixel);
            let apart = apart(&frame.image, &sorted);
            assert!(apart <= TOLERANCE, "{what}, {:?}: {apart:.1e} from the CPU's", camera.projection);
            // One compute pipeline, and of the picture one texture: nothing is drawn or sorted.
            assert_eq!((frame.resources.pipelines, frame.resources.textures), (1, 1));
            assert!(frame.image.pixels().iter().any(|p| p[3] > 0.1), "{what} is seen");
        }
    }
}

/// The same segments, composited front to back instead of back to front: roundings of some twenty cells apart.
const ROUNDING: f64 = 2e-6;

/// Largest difference of any value of two pictures.
fn apart(a: &tetlux_image::Image, b: &tetlux_image::Image) -> f64 {
    let pairs = a.pixels().iter().flatten().zip(b.pixels().iter().flatten());
    pairs.map(|(a, b)| f64::from((a - b).abs())).fold(0.0, f64::max)
}

#[test]
fn tiles_make_the_picture_of_the_silhouettes() {
    for (what, mesh, inside) in meshes() {
        for camera in cameras(&mesh, inside) {
            let colored = scene(&mesh, colors(&mesh), camera, SIZE);
            let frame = draw(&mesh, &colored, by(CellProjection::Tiles));
            let (error, _) = judged(frame.image.pixels(), &mesh, &colored);
            let drawn = render(&mesh, &colored, Way::GpuExact);
            let apart = apart(&frame.image, &drawn);
            println!("{what}, {:?}: {error:.1e}, {apart:.1e} from the raster's", camera.projection);
            assert!(error <= TOLERANCE, "{what}, {:?}: {error:.1e}", camera.projection);
            assert!(apart <= ROUNDING, "{what}, {:?}: {apart:.1e} from the raster's", camera.projection);
            assert!(frame.image.pixels().iter().any(|p| p[3] > 0.1), "{what} is seen");
            // Five stages of its own, two of a sort and two of a sum; not even the picture is a texture.
            assert_eq!((frame.resources.pipelines, frame.resources.textures), (9, 0));
            let again = draw(&mesh, &colored, by(CellProjection::Tiles));
            assert_eq!(again.image, frame.image, "{what}, {:?}: again", camera.projection);
        }
    }
}

#[test]
fn interpolation_makes_the_picture_whatever_a_rasteriser_rounds() {
    for (what, mesh, inside) in meshes() {
        for camera in cameras(&mesh, inside) {
            let white = scene(&mesh, without_color(&mesh), camera, SIZE);
            for projection in [CellProjection::Balanced, CellProjection::Gator] {
                let frame = draw(&mesh, &white, by(projection));
                let (error, _) = judged(frame.image.pixels(), &mesh, &white);
                println!("{projection}, {what}, {:?}: {error:.1e}", camera.projection);
                assert!(error <= TOLERANCE, "{projection}, {what}, {:?}: {error:.1e}", camera.projection);
                assert!(frame.image.pixels().iter().any(|p| p[3] > 0.1), "{what} is seen");
            }
        }
    }
}

#[test]
fn pixels_stop_where_the_rest_is_within_its_share_of_the_error() {
    let (what, mesh, inside) = meshes().remove(2);
    let dense = white(&[[0.0, 12.0]]);
    for projection in [CellProjection::March, CellProjection::Tiles] {
        for camera in cameras(&mesh, inside) {
            let scene = scene(&mesh, dense.clone(), camera, SIZE);
            // The integral is as asked, so that nothing else is spent of the budget.
            let method = |max_error| Method { max_error, integrator: Integrator::Direct, ..by(projection) };
            let exact = draw(&mesh, &scene, method(1e-9)).image;
            let stopped = draw(&mesh, &scene, method(6.4e-3)).image;
            let left: Vec<f32> = exact.pixels().iter().zip(stopped.pixels()).map(|(a, b)| a[3] - b[3]).collect();
            // A tenth of the error allowed, and a rounding.
            let share = 0.1 * 6.4e-3 + 1e-6;
            let case = format!("{what}, {projection}, {:?}", camera.projection);
            assert!(left.iter().all(|&rest| (-1e-6..=share).contains(&rest)), "{case}");
            assert!(left.iter().any(|&rest| rest > 1e-5), "{case}: nothing is left out");
        }
    }
}
