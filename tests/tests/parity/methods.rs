//! Methods by name: exact ones agree with the reference, each artifact shows, and none takes what it does not use. That
//! every combination renders or is refused is judged in combinations.rs.

use std::sync::Arc;

use glam::DVec3;
use tetlux_mesh::procedural::{Parts, Split, cuboid};
use tetlux_mesh::{Field, TetMesh};
use tetlux_render::{Frame, Model, Resources, table_specs};
use tetlux_scene::{
    Backend, CellProjection, Classification, Integrator, Interpolation, Method, Order, Plan, Scene, SkipSet,
    TablePrecision, Target,
};
use tetlux_tables::{Table, TableCache};
use tetlux_tests::{
    Random, largest_error, mesh_of, mesh_with, orthographic, perspective, pixel_error, reference, renderer, scene,
    transfer, transfer_of,
};

pub(crate) fn all<T: Copy + PartialEq + Default>(values: &[T]) -> Vec<T> {
    // `Auto` is one of the others.
    values.iter().copied().filter(|v| *v != T::default()).collect()
}

pub(crate) const GPU: Method = Method {
    backend: Backend::Gpu,
    order: Order::Centroid,
    projection: CellProjection::Pt,
    interpolation: Interpolation::Ray,
    integrator: Integrator::Direct,
    classification: Classification::PostExact,
    table_precision: TablePrecision::Auto,
    target: Target::Rgba32f,
    pieces: None,
    max_error: 1e-3,
    no_skip: SkipSet::NONE,
};

fn planned(mesh: &TetMesh, scene: &Scene, method: Method) -> Plan {
    let scene = Scene { method, ..scene.clone() };
    Plan::new(&scene, mesh, renderer().device()).unwrap_or_else(|e| panic!("{method:?}: {e}"))
}

pub(crate) fn frame(mesh: &TetMesh, scene: &Scene, method: Method, cache: &TableCache) -> Frame {
    let plan = planned(mesh, scene, method);
    let tables: Vec<Arc<Table>> =
        table_specs(scene, mesh, &plan).iter().map(|spec| cache.get_or_build(spec).unwrap()).collect();
    renderer().render_with(scene, &Model::new(mesh), &plan, &tables).unwrap_or_else(|e| panic!("{method:?}: {e}"))
}

pub(crate) fn cache() -> TableCache {
    TableCache::new(1 << 28)
}

/// A small block of cells in colour.
pub(crate) fn block() -> (TetMesh, Scene) {
    let parts = cuboid([3, 2, 2], Split::Six, [-DVec3::ONE, DVec3::ONE]);
    let mesh = mesh_of(&parts, |p| (2.0 * p.x).sin() + p.y * p.z);
    let tf = transfer(
        &[[-1.0, 0.9, 0.1, 0.2], [0.0, 0.2, 0.8, 0.3], [1.5, 1.0, 0.9, 0.2]],
        &[[-1.0, 1.0], [-0.5, 0.1], [0.2, 0.5], [0.9, 2.0]],
    );
    let scene = scene(&mesh, tf, perspective(DVec3::new(2.5, -3.0, 1.8), DVec3::ZERO, 45.0), [64, 64]);
    (mesh, scene)
}

/// The integrals of a transfer function of one field.
pub(crate) fn integrators() -> Vec<Integrator> {
    all(Integrator::ALL).into_iter().filter(|integrator| !integrator.is_for_two_fields()).collect()
}

/// One cell alone: its order cannot be wrong. Seen so that it is of class 1a, 1b, 2, and with a face edge-on.
fn single_cells(opacity: &[[f64; 2]], color: &[[f64; 4]]) -> Vec<(TetMesh, Scene)> {
    let points = [[-1.0, -0.7, 0.1], [1.1, -0.6, -0.2], [0.1, 1.0, 0.0], [0.05, -0.1, 1.2]].map(DVec3::from);
    let parts = Parts { points: points.to_vec(), cells: vec![[0, 1, 2, 3]] };
    let mesh = mesh_with(&parts, Field::point("s", 1, vec![0.1, 0.9, 0.3, 0.7]));
    let tf = transfer(color, opacity);
    let middle = DVec3::new(0.05, 0.0, 0.3);
    let eyes = [[0.2, -0.1, 5.0], [0.1, 0.1, -4.0], [3.0, 3.5, 1.0], [-3.0, 0.4, 2.0], [4.0, -0.655, -2.0]];
    let cameras = eyes.iter().flat_map(|&eye| {
        let eye = DVec3::from(eye);
        [perspective(eye, middle, 32.0), orthographic(eye, middle, 1.4)]
    });
    cameras.map(|camera| (mesh.clone(), scene(&mesh, tf.clone(), camera, [64, 64]))).collect()
}

/// The largest error of any pixel.
fn worst_error(mesh: &TetMesh, scene: &Scene, method: Method, cache: &TableCache) -> f64 {
    largest_error(frame(mesh, scene, method, cache).image.pixels(), &reference(mesh, scene))
}

const COLORS: [[f64; 4]; 3] = [[0.0, 0.9, 0.1, 0.2], [0.4, 0.2, 0.8, 0.3], [1.0, 0.1, 0.3, 1.0]];
const OPACITIES: [[f64; 2]; 4] = [[0.0, 0.3], [0.35, 2.0], [0.5, 0.8], [0.9, 4.0]];

#[test]
fn exact_methods_agree_with_the_reference() {
    let scenes = single_cells(&OPACITIES, &COLORS);
    let cache = cache();
    // The error of q's table in each of a few pieces is 4.7e-5 of their alpha; elsewhere that of single precision.
    let tolerance = 1e-4;
    for integrator in [Integrator::Direct, Integrator::Symmetric, Integrator::Q] {
        for classification in [Classification::PostExact, Classification::PostClip] {
            let method = Method { integrator, classification, ..GPU };
            for (mesh, scene) in &scenes {
                let worst = worst_error(mesh, scene, method, &cache);
                assert!(worst <= tolerance, "{integrator} {classification} {:?}: {worst:.1e}", scene.camera);
            }
        }
    }
    let perspective = |projection| (projection, Interpolation::Perspective);
    for (projection, interpolation) in [
        perspective(CellProjection::Pt),
        perspective(CellProjection::Gator),
        (CellProjection::Vicp, Interpolation::Auto),
        (CellProjection::Balanced, Interpolation::Auto),
    ] {
        let method = Method { projection, interpolation, ..GPU };
        for (mesh, scene) in &scenes {
            let worst = worst_error(mesh, scene, method, &cache);
            assert!(worst <= tolerance, "{projection} {:?}: {worst:.1e}", scene.camera);
        }
    }
    // Where the transfer function is linear, classification at the vertices loses nothing.
    let linear = single_cells(&[[0.0, 0.3], [1.0, 4.0]], &[COLORS[0], COLORS[2]]);
    for interpolation in [Interpolation::Ray, Interpolation::Perspective] {
        let method = Method { classification: Classification::Vertex, interpolation, ..GPU };
        for (mesh, scene) in &linear {
            let worst = worst_error(mesh, scene, method, &cache);
            assert!(worst <= tolerance, "vertex {interpolation} {:?}: {worst:.1e}", scene.camera);
        }
        let (mesh, scene) = &scenes[0];
        assert!(worst_error(mesh, scene, method, &cache) > 10.0 * tolerance, "and much where it is not");
    }
    // Linear in the picture is another thing in perspective, and the same along parallel rays.
    let method = Method { interpolation: Interpolation::ScreenLinear, ..GPU };
    let errors: Vec<f64> = scenes.iter().map(|(mesh, scene)| worst_error(mesh, scene, method, &cache)).collect();
    assert!(errors.iter().step_by(2).all(|&e| e > 10.0 * tolerance), "perspective: {errors:?}");
    assert!(errors.iter().skip(1).step_by(2).all(|&e| e <= tolerance), "orthographic: {errors:?}");
}

/// Cells one behind the other, seen along the pile: the order of their centroids is right.
fn pile() -> (TetMesh, Scene) {
    let mut random = Random::new(41);
    let mut parts = Parts { points: Vec::new(), cells: Vec::new() };
    for layer in 0..12u32 {
        let depth = |share: f64| DVec3::Z * (0.3 * (f64::from(layer) + share));
        let turn = f64::from(layer);
        let corner = |angle: f64| DVec3::new((turn + angle).cos(), (turn + angle).sin(), 0.0);
        let random_depth = |random: &mut Random| depth(random.between(0.0, 0.3));
        for angle in [0.0, 2.0, 4.0] {
            parts.points.push(corner(angle) + random_depth(&mut random));
        }
        parts.points.push(DVec3::new(random.between(-0.2, 0.2), random.between(-0.2, 0.2), 0.0) + depth(0.9));
        parts.cells.push([0, 1, 2, 3].map(|k| 4 * layer + k));
    }
    let values = parts.points.iter().map(|_| random.between(0.0, 1.0)).collect();
    let mesh = mesh_with(&parts, Field::point("s", 1, values));
    let tf = transfer(&COLORS, &OPACITIES);
    let scene = scene(&mesh, tf, perspective(DVec3::new(0.1, -0.2, 6.0), DVec3::new(0.0, 0.0, 2.0), 40.0), [64, 64]);
    (mesh, scene)
}

#[test]
fn errors_by_method() {
    let (mesh, scene) = pile();
    let cache = cache();
    let truth = reference(&mesh, &scene);
    let error = |method: Method| {
        let image = frame(&mesh, &scene, method, &cache).image;
        image.pixels().iter().zip(&truth).map(|(&p, &t)| pixel_error(p, t)).fold(0.0, f64::max)
    };
    println!("largest error of a pixel, {} cells, 64 x 64, centroid order:", mesh.cells().len());
    let exact = error(GPU);
    for integrator in integrators() {
        println!("  {integrator:14} {:.1e}", error(Method { integrator, ..GPU }));
    }
    for interpolation in all(Interpolation::ALL) {
        println!("  {interpolation:14} {:.1e}", error(Method { interpolation, ..GPU }));
    }
    for classification in all(Classification::ALL) {
        println!("  {classification:14} {:.1e}", error(Method { classification, ..GPU }));
    }
    for target in all(Target::ALL) {
        println!("  {target:14} {:.1e}", error(Method { target, ..GPU }));
    }
    for table_precision in all(TablePrecision::ALL) {
        println!(
            "  psi in {table_precision:7} {:.1e}",
            error(Method { integrator: Integrator::Psi, table_precision, ..GPU })
        );
    }
    // What each artifact costs at least, against what is exact.
    assert!(exact < 1e-4, "{exact:.1e}");
    for worse in [
        Method { integrator: Integrator::Average, ..GPU },
        Method { classification: Classification::Vertex, ..GPU },
        Method { interpolation: Interpolation::ScreenLinear, ..GPU },
        Method { target: Target::Rgba8, ..GPU },
        Method { integrator: Integrator::PreintLog, ..GPU },
        Method { integrator: Integrator::Psi, table_precision: TablePrecision::U8, ..GPU },
    ] {
        assert!(error(worse) > 10.0 * exact, "{worse:?}");
    }
}

#[test]
fn cells_around_the_eye_are_drawn_by_every_geometry() {
    let (mesh, scene) = block();
    let inside = perspective(DVec3::new(0.2, 0.1, -0.3), DVec3::X, 90.0);
    let parallel = orthographic(DVec3::new(0.2, 0.1, -0.3), DVec3::X, 1.2);
    let cache = cache();
    for camera in [inside, parallel] {
        let scene = Scene { camera, ..scene.clone() };
        let exact = frame(&mesh, &scene, GPU, &cache).image;
        assert!(exact.pixels().iter().filter(|p| p[3] > 0.1).count() > 64 * 64 / 2, "the mesh is all around");
        for projection in [CellProjection::Pt, CellProjection::Gator] {
            let method = Method { projection, interpolation: Interpolation::Perspective, ..GPU };
            let image = frame(&mesh, &scene, method, &cache).image;
            let values = image.pixels().iter().flatten().zip(exact.pixels().iter().flatten());
            let apart = values.map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
            assert!(apart < 1e-4, "{projection}: {apart:.1e}");
        }
    }
}

#[test]
fn a_method_takes_what_it_uses_and_nothing_else() {
    let (mesh, scene) = block();
    let cache = cache();
    let taken = |method: Method| frame(&mesh, &scene, method, &cache).resources;
    let (cells, points) = (mesh.cells().len() as u64, mesh.points().len() as u64);
    // View, pieces, points, cells, order, points as seen, batch, projected cells, readback.
    // Between six control points, below and above.
    let pieces = 7;
    let default = Resources {
        pipelines: 2,
        buffers: 9,
        textures: 1,
        bytes: 96 + pieces * 48 + points * (16 + 16) + cells * (16 + 4 + 80) + 16 + 2 * 64 * 64 * 16,
        cells: cells as usize,
    };
    let plain = taken(GPU);
    assert_eq!(plain, default, "no table, no texture but the picture");
    let gator = taken(Method { projection: CellProjection::Gator, interpolation: Interpolation::Perspective, ..GPU });
    assert_eq!(gator, Resources { pipelines: 1, buffers: 8, bytes: plain.bytes - cells * 80, ..plain });
    let q = taken(Method { integrator: Integrator::Q, ..GPU });
    assert_eq!(q, Resources { buffers: 10, textures: 2, bytes: plain.bytes + 80 + 128 * 128 * 4, ..plain });
    let bytes = Method { integrator: Integrator::Q, table_precision: TablePrecision::U8, ..GPU };
    assert_eq!(taken(bytes).bytes, plain.bytes + 80 + 128 * 128);
    let preint = taken(Method { integrator: Integrator::Preint, ..GPU });
    // A table in place of the transfer function.
    assert_eq!((preint.buffers, preint.textures), (9, 2));
    let ratio = taken(Method { integrator: Integrator::PreintQ, ..GPU });
    assert_eq!((ratio.buffers, ratio.textures), (9, 3));
    // A march has its own tables in place of order, batch and projected cells: limits, neighbours, starts, entries.
    let march =
        Method { projection: CellProjection::March, order: Order::None, interpolation: Interpolation::Auto, ..GPU };
    let marched = taken(march);
    assert_eq!((marched.pipelines, marched.buffers, marched.textures), (1, 9, 1));
    let looked_up = taken(Method { integrator: Integrator::Q, ..march });
    let table = 80 + 128 * 128 * 4;
    assert_eq!(looked_up, Resources { buffers: 10, textures: 2, bytes: marched.bytes + table, ..marched });
    let halves = taken(Method { target: Target::Rgba16f, ..GPU });
    assert_eq!(halves.bytes, plain.bytes - 64 * 64 * 8 * 2);
    let clipped = taken(Method { classification: Classification::PostClip, ..GPU });
    assert!(clipped.buffers == 10 && clipped.cells > plain.cells, "{clipped:?}");
    // Scalars of cells are a buffer only where there are any.
    let by_cell = mesh_with(
        &cuboid([3, 2, 2], Split::Six, [-DVec3::ONE, DVec3::ONE]),
        Field::cell("s", 1, (0..cells).map(|c| c as f64).collect()),
    );
    let scene = tetlux_tests::scene(&by_cell, transfer_of(&scene).clone(), scene.camera, [64, 64]);
    assert_eq!(frame(&by_cell, &scene, GPU, &cache).resources.buffers, 10);
}

#[test]
fn a_table_that_is_not_given_is_asked_for_by_name() {
    let (mesh, scene) = block();
    let plan = planned(&mesh, &scene, Method { integrator: Integrator::Q, ..GPU });
    let error = renderer().render(&scene, &Model::new(&mesh), &plan).unwrap_err().to_string();
    assert!(error.contains("\"q\"") && error.contains("table_specs"), "{error}");
}
