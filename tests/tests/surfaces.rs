//! Opaque surfaces in the volume, by every way of rendering: the picture of the f64 reference.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a test's helpers fail and tell like the test")]

use std::cell::OnceCell;

use glam::DVec3;
use tetlux_mesh::TetMesh;
use tetlux_mesh::procedural::{Parts, Split, cuboid, three_cycle};
use tetlux_mesh::{Component, Field};
use tetlux_optics::{Classification, Light};
use tetlux_render::{Frame, Model, table_specs};
use tetlux_scene::{
    Backend, Camera, CellProjection, Integrator, Interpolation, Lighting, Method, Order, Plan, Scene, Surface,
    SurfaceSpec, Target,
};
use tetlux_tables::TableCache;
use tetlux_tests::{
    Random, largest_error, mesh_of, mesh_with, orthographic, perspective, pixel_error, reference, reference_beside,
    renderer, scene, transfer,
};

/// What projections that find segments by planes or by offsets in single precision may be off by.
const TOLERANCE: f64 = 1e-4;

/// Pixels by which rays are moved to see whether their centres lie on a silhouette, of the mesh or of a surface.
const BESIDE: f64 = 1e-4;

/// Where values are interpolated over triangles, these may lie 1/256 pixel beside their place: so much of the picture's
/// slope is theirs.
const ROUNDED: f64 = 1.0 / 256.0;

const SIZE: [u32; 2] = [64, 64];

fn frame(mesh: &TetMesh, scene: &Scene, method: Method) -> Frame {
    let scene = Scene { method, ..scene.clone() };
    let plan = Plan::new(&scene, mesh, renderer().device()).unwrap_or_else(|e| panic!("{method:?}: {e}"));
    let cache = TableCache::new(1 << 28);
    let tables: Vec<_> =
        table_specs(&scene, mesh, &plan).iter().map(|spec| cache.get_or_build(spec).unwrap()).collect();
    renderer().render_with(&scene, &Model::new(mesh), &plan, &tables).unwrap_or_else(|e| panic!("{method:?}: {e}"))
}

fn spec() -> SurfaceSpec {
    let light = Light::new(Some([1.0, -2.0, 3.0]), [0.2, 0.7, 0.3], 12.0, 0.0).unwrap();
    SurfaceSpec { color: [0.8, 0.45, 0.2], ..SurfaceSpec::new("surface".into(), Some(light)) }
}

/// A square through a point, of half a side.
fn square(mesh: &TetMesh, middle: DVec3, normal: DVec3, half: f64) -> Surface {
    let (u, v) = normal.normalize().any_orthonormal_pair();
    let corner = |x: f64, y: f64| middle + half * (x * u + y * v);
    let points = [corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)];
    spec().on(mesh, &points, vec![[0, 1, 2], [0, 2, 3]]).unwrap()
}

/// An octahedron cut into many triangles and pushed out to a ball, closed; `open` leaves a part out.
fn ball(mesh: &TetMesh, middle: DVec3, radius: f64, open: bool) -> Surface {
    const N: i32 = 6;
    let mut points = Vec::new();
    for (x, y, z) in [-1.0, 1.0]
        .into_iter()
        .flat_map(|z| [[1.0, 1.0], [1.0, -1.0], [-1.0, 1.0], [-1.0, -1.0]].map(|[x, y]| (x, y, z)))
    {
        let at = |i: i32, j: i32| {
            let p = DVec3::new(f64::from(i) * x, f64::from(j) * y, f64::from(N - i - j) * z);
            middle + radius * p.normalize()
        };
        for i in 0..N {
            for j in 0..N - i {
                points.extend([at(i, j), at(i + 1, j), at(i, j + 1)]);
                if i + j + 1 < N {
                    points.extend([at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]);
                }
            }
        }
    }
    let count = points.len() as u32 / 3;
    let triangles = (0..if open { 7 * count / 8 } else { count }).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    spec().on(mesh, &points, triangles).unwrap()
}

/// A box of displaced points, and its field.
fn body() -> TetMesh {
    let mut parts = cuboid([4, 3, 3], Split::Six, [-DVec3::ONE, DVec3::ONE]);
    let mut random = Random::new(7);
    for p in &mut parts.points {
        *p += DVec3::new(random.between(-0.05, 0.05), random.between(-0.05, 0.05), random.between(-0.05, 0.05));
    }
    mesh_of(&parts, |p| (1.7 * p.x).sin() + p.y * p.z)
}

/// Surfaces in front, behind, across, inside, around; coplanar with faces; many triangles, open, of no area.
fn surfaces(mesh: &TetMesh) -> Vec<(&'static str, Vec<Surface>)> {
    let toward = DVec3::new(1.1, -1.6, 0.9).normalize();
    let on = |points: &[DVec3], triangles| spec().on(mesh, points, triangles).unwrap();
    let [low, high] = [-DVec3::ONE, DVec3::ONE];
    let line = on(&[low, DVec3::ZERO, high], vec![[0, 1, 2], [1, 1, 2]]);
    vec![
        ("in front", vec![square(mesh, 2.0 * toward, toward, 0.4)]),
        ("behind", vec![square(mesh, -2.5 * toward, toward + 0.3 * DVec3::Z, 0.9)]),
        ("across", vec![square(mesh, 0.1 * toward, DVec3::new(0.3, 0.2, 1.0), 1.4)]),
        (
            "crossing one another",
            vec![
                square(mesh, DVec3::ZERO, DVec3::new(1.0, -0.2, 0.1), 0.8),
                square(mesh, 0.2 * DVec3::X, DVec3::new(-0.2, -0.3, 1.0), 0.7),
                line,
            ],
        ),
        ("an open ball inside", vec![ball(mesh, DVec3::new(0.1, 0.0, -0.1), 0.6, true)]),
        ("a ball across the boundary", vec![ball(mesh, DVec3::new(0.7, -0.6, 0.5), 0.7, false)]),
    ]
}

fn cameras() -> [Camera; 4] {
    let (outside, inside) = (DVec3::new(2.2, -3.2, 1.8), DVec3::new(0.15, 0.85, 0.2));
    [
        perspective(outside, DVec3::ZERO, 42.0),
        orthographic(outside, DVec3::ZERO, 1.5),
        perspective(inside, DVec3::new(0.1, -1.0, 0.0), 90.0),
        orthographic(inside, DVec3::new(0.1, -1.0, 0.0), 1.1),
    ]
}

fn colored(mesh: &TetMesh, camera: Camera, surfaces: Vec<Surface>) -> Scene {
    let tf = transfer(
        &[[-2.0, 0.9, 0.1, 0.2], [-0.3, 0.2, 0.8, 0.3], [0.4, 0.1, 0.3, 1.0], [2.0, 1.0, 0.9, 0.2]],
        &[[-2.0, 1.0], [-0.8, 0.1], [-0.2, 0.7], [0.0, 2.0], [0.3, 0.2], [2.0, 1.5]],
    );
    Scene { surfaces, ..scene(mesh, tf, camera, SIZE) }
}

/// The truth, and how it changes around each pixel's centre.
struct Truth<'a> {
    mesh: &'a TetMesh,
    scene: &'a Scene,
    pixels: Vec<[f64; 4]>,
    slopes: OnceCell<Vec<f64>>,
}

fn truth<'a>(mesh: &'a TetMesh, scene: &'a Scene) -> Truth<'a> {
    Truth { mesh, scene, pixels: reference(mesh, scene), slopes: OnceCell::new() }
}

impl Truth<'_> {
    /// Largest change of each pixel's values over `BESIDE` pixels; infinite where they jump.
    fn slopes(&self) -> Vec<f64> {
        let around = [(-BESIDE, -BESIDE), (-BESIDE, BESIDE), (BESIDE, -BESIDE), (BESIDE, BESIDE)];
        let around = around.map(|(x, y)| reference_beside(self.mesh, self.scene, [x, y]));
        let change = |i: usize, a: &[[f64; 4]]| (0..4).map(|k| (a[i][k] - self.pixels[i][k]).abs()).fold(0.0, f64::max);
        let slope = |i: usize| around.iter().map(|a| change(i, a)).fold(0.0, f64::max);
        // Steeper than a hundred a pixel is no slope.
        let slopes = (0..self.pixels.len()).map(slope);
        slopes.map(|s| if s > 100.0 * BESIDE { f64::INFINITY } else { s }).collect()
    }

    /// Largest error of any pixel that is on no silhouette, less so many pixels of the picture's slope.
    fn error(&self, pixels: &[[f32; 4]], rounded: f64) -> f64 {
        let all = largest_error(pixels, &self.pixels);
        if all <= TOLERANCE {
            return all;
        }
        let slopes = self.slopes.get_or_init(|| self.slopes());
        let errors = pixels.iter().zip(&self.pixels).map(|(&pixel, &right)| pixel_error(pixel, right));
        let judged = errors.zip(slopes).filter(|(_, slope)| slope.is_finite());
        judged.map(|(error, slope)| error - slope * (rounded / BESIDE)).fold(0.0, f64::max)
    }
}

/// Every way to a picture in exact order that finds segments from planes or from offsets.
fn exact_methods() -> Vec<Method> {
    let gpu = Method { backend: Backend::Gpu, order: Order::Exact, ..Method::default() };
    vec![
        Method { backend: Backend::Cpu, order: Order::Exact, ..Method::default() },
        Method { backend: Backend::Cpu, order: Order::Pixel, ..Method::default() },
        Method { projection: CellProjection::Pt, ..gpu },
        Method { projection: CellProjection::Vicp, ..gpu },
        Method { projection: CellProjection::March, order: Order::None, ..gpu },
        Method { projection: CellProjection::Tiles, ..gpu },
    ]
}

#[test]
fn every_exact_way_sees_the_first_surface_through_what_is_before_it() {
    let mesh = body();
    // From so far away that a depth from the eye loses three digits.
    let far = perspective(1000.0 * DVec3::new(2.2, -3.2, 1.8), DVec3::ZERO, 0.042);
    for (what, surfaces) in surfaces(&mesh) {
        for camera in cameras().into_iter().chain([far]) {
            let scene = colored(&mesh, camera, surfaces.clone());
            let truth = truth(&mesh, &scene);
            for method in exact_methods() {
                let frame = frame(&mesh, &scene, method);
                let error = truth.error(frame.image.pixels(), 0.0);
                let name = format!(
                    "{what}, {:?}, {} {} {}",
                    camera.projection, method.backend, method.projection, method.order
                );
                println!("{name}: {error:.1e}");
                assert!(error <= TOLERANCE, "{name}: {error:.1e}");
            }
            let opaque = truth.pixels.iter().filter(|pixel| pixel[3] == 1.0).count();
            let inside = what != "in front" && what != "behind" || camera == cameras()[0] || camera == cameras()[1];
            assert!(!inside || opaque > 100, "{what}: {opaque} pixels");
        }
    }
}

#[test]
fn surfaces_in_the_planes_of_faces_hide_one_side_of_them() {
    let parts = cuboid([4, 3, 3], Split::Six, [-DVec3::ONE, DVec3::ONE]);
    let mesh = mesh_of(&parts, |p| (1.7 * p.x).sin() + p.y * p.z);
    // Between cells, and at the boundary: before all of the mesh or behind, from outside.
    for (middle, normal) in [
        (DVec3::ZERO, DVec3::X),
        (DVec3::X * 0.5, DVec3::X),
        (DVec3::Z, DVec3::Z),
        (DVec3::NEG_Y, DVec3::Y),
        (DVec3::Y, DVec3::Y),
    ] {
        for camera in cameras() {
            let scene = colored(&mesh, camera, vec![square(&mesh, middle, normal, 0.75)]);
            let truth = truth(&mesh, &scene);
            for method in exact_methods() {
                let error = truth.error(frame(&mesh, &scene, method).image.pixels(), 0.0);
                let name = format!("{middle}, {:?}, {} {}", camera.projection, method.backend, method.projection);
                assert!(error <= TOLERANCE, "{name}: {error:.1e}");
            }
        }
    }
}

#[test]
fn interpolated_ends_are_cut_as_well_as_they_are_known() {
    let mesh = body();
    let by = |projection, interpolation| {
        let gpu = Method { backend: Backend::Gpu, order: Order::Exact, ..Method::default() };
        Method { projection, interpolation, ..gpu }
    };
    let pt = CellProjection::Pt;
    for (what, surfaces) in surfaces(&mesh).into_iter().skip(2).step_by(2) {
        for camera in cameras() {
            let [with, without] = [surfaces.clone(), Vec::new()].map(|surfaces| colored(&mesh, camera, surfaces));
            let (truth, plain) = (truth(&mesh, &with), truth(&mesh, &without));
            let errors = |method, rounded| {
                let [a, b] = [&with, &without].map(|scene| frame(&mesh, scene, method).image);
                [truth.error(a.pixels(), rounded), plain.error(b.pixels(), rounded)]
            };
            let name = format!("{what}, {:?}", camera.projection);
            for method in [by(CellProjection::Balanced, Interpolation::Auto), by(pt, Interpolation::Perspective)] {
                let [error, plain] = errors(method, ROUNDED);
                println!("{name}, {} {}: {error:.1e}, {plain:.1e} without", method.projection, method.interpolation);
                // The ends' depths are off by what a vertex that lies beside its place makes of them.
                assert!(error <= plain + 2.0 * ROUNDED, "{name}, {}: {error:.1e}", method.projection);
            }
            let [error, plain] = errors(by(pt, Interpolation::ScreenLinear), 0.0);
            println!("{name}, screen-linear: {error:.1e}, {plain:.1e} without");
            assert!(error <= 2.0 * plain + 2.0 * ROUNDED, "{name}, screen-linear: {error:.1e}");
        }
    }
}

#[test]
fn one_cell_is_cut_the_same_by_every_projection() {
    let points = [[-1.0, -0.7, 0.1], [1.1, -0.6, -0.2], [0.1, 1.0, 0.0], [0.05, -0.1, 1.2]].map(DVec3::from);
    let parts = Parts { points: points.to_vec(), cells: vec![[0, 1, 2, 3]] };
    let cell = mesh_with(&parts, Field::cell("s", 1, vec![0.4]));
    let mesh = mesh_with(&parts, Field::point("s", 1, vec![-0.9, 0.9, -0.3, 0.7]));
    let middle = DVec3::new(0.05, 0.0, 0.3);
    let gpu = Method { backend: Backend::Gpu, order: Order::None, ..Method::default() };
    let thick = Method { interpolation: Interpolation::Perspective, ..gpu };
    for mesh in [&mesh, &cell] {
        for camera in [
            perspective(DVec3::new(0.2, -0.1, 5.0), middle, 32.0),
            orthographic(DVec3::new(3.0, 3.5, 1.0), middle, 1.4),
        ] {
            let surface = square(mesh, middle, DVec3::new(0.2, -0.3, 1.0), 0.8);
            let scene = colored(mesh, camera, vec![surface]);
            let truth = truth(mesh, &scene);
            for (projection, method) in CellProjection::ALL.iter().flat_map(|&p| [(p, gpu), (p, thick)]) {
                let method = Method { projection, ..method };
                if method.refusal().is_some() {
                    continue;
                }
                let error = truth.error(frame(mesh, &scene, method).image.pixels(), ROUNDED);
                println!("{:?}, {projection} {}: {error:.1e}", camera.projection, method.interpolation);
                assert!(
                    error <= TOLERANCE,
                    "{:?}, {projection} {}: {error:.1e}",
                    camera.projection,
                    method.interpolation
                );
            }
        }
    }
}

#[test]
fn every_integrator_and_classification_is_cut() {
    let mesh = body();
    let surface = || vec![square(&mesh, DVec3::ZERO, DVec3::new(0.3, 0.2, 1.0), 1.4)];
    let [with, without] = [surface(), Vec::new()].map(|surfaces| colored(&mesh, cameras()[0], surfaces));
    let (truth, plain) = (truth(&mesh, &with), truth(&mesh, &without));
    let gpu = Method { backend: Backend::Gpu, order: Order::Exact, ..Method::default() };
    let clipped = Method { classification: tetlux_scene::Classification::PostClip, ..gpu };
    let by_vertex = Method { classification: tetlux_scene::Classification::Vertex, ..gpu };
    // Those that are pre-integrated take long to tabulate, and segments as any other.
    let integrators = [Integrator::Average, Integrator::Psi, Integrator::Q, Integrator::Symmetric];
    let integrators = integrators.map(|integrator| Method { integrator, ..gpu });
    let targets = [Target::Rgba8, Target::Rgba16f].map(|target| Method { target, ..gpu });
    for method in integrators.into_iter().chain(targets).chain([clipped, by_vertex]) {
        let [a, b] = [&with, &without].map(|scene| frame(&mesh, scene, method).image);
        let [error, plain] = [truth.error(a.pixels(), 0.0), plain.error(b.pixels(), 0.0)];
        let name = format!("{} {} {}", method.integrator, method.classification, method.target);
        println!("{name}: {error:.1e}, {plain:.1e} without");
        // What is approximate is no worse for being cut.
        assert!(error <= 1.5 * plain + TOLERANCE, "{name}: {error:.1e}, {plain:.1e} without");
    }
}

#[test]
fn cells_without_an_order_are_cut_pixel_by_pixel() {
    let parts = three_cycle();
    let mesh = mesh_with(&parts, Field::cell("s", 1, vec![-0.5, 0.2, 1.0]));
    let camera = perspective(DVec3::splat(12.0), DVec3::splat(0.5), 14.0);
    for (shift, normal) in [(0.0, DVec3::ONE), (0.2, DVec3::new(0.3, 1.0, -0.4))] {
        let surface = square(&mesh, DVec3::splat(0.5 + shift), normal, 0.7);
        let scene = colored(&mesh, camera, vec![surface]);
        let truth = truth(&mesh, &scene);
        for method in exact_methods() {
            let error = truth.error(frame(&mesh, &scene, method).image.pixels(), 0.0);
            println!("{} {} {}: {error:.1e}", method.backend, method.projection, method.order);
            assert!(error <= TOLERANCE, "{} {}: {error:.1e}", method.backend, method.projection);
        }
    }
}

#[test]
fn lit_volumes_of_two_fields_are_cut() {
    let parts = cuboid([3; 3], Split::Six, [-DVec3::ONE, DVec3::ONE]);
    let fields = vec![
        Field::point("s", 1, parts.sample(|p| (1.7 * p.x).sin() + p.y * p.z)),
        Field::point("t", 1, parts.sample(|p| p.z + 0.5 * p.x)),
    ];
    let mesh = TetMesh::assemble(&parts.points, &parts.cells, fields).unwrap();
    let surface = ball(&mesh, DVec3::new(0.1, 0.0, -0.1), 0.8, false);
    let mut scene = colored(&mesh, cameras()[0], vec![surface]);
    let light = Light::new(None, [0.3, 0.7, 0.2], 20.0, 0.0).unwrap();
    scene.lighting = Some(Lighting { light, gradients: mesh.vertex_gradients(&scene.scalar) });
    let two = Classification::TwoFields(transfer(
        &[[-2.0, 0.9, 0.1, 0.2], [0.4, 0.1, 0.3, 1.0], [2.0, 1.0, 0.9, 0.2]],
        &[[-1.0, 1.0], [0.0, 2.0], [0.6, 0.2]],
    ));
    for second in [None, Some(mesh.scalar("t", Component::Magnitude).unwrap())] {
        if second.is_some() {
            (scene.second, scene.classification) = (second, two.clone());
        }
        let truth = truth(&mesh, &scene);
        for order in [Order::Exact, Order::Pixel] {
            let method = Method { order, max_error: 1e-3, ..Method::default() };
            let error = truth.error(frame(&mesh, &scene, method).image.pixels(), 0.0);
            println!("two fields: {}, {order}: {error:.1e}", scene.second.is_some());
            assert!(error <= 1e-3, "{order}: {error:.1e}");
        }
    }
}

#[test]
fn a_planted_difference_is_found() {
    let mesh = body();
    let scene = colored(&mesh, cameras()[0], vec![square(&mesh, DVec3::ZERO, DVec3::Z, 0.8)]);
    let truth = truth(&mesh, &scene);
    let right = frame(&mesh, &scene, exact_methods()[0]).image;
    assert!(truth.error(right.pixels(), 0.0) <= TOLERANCE);
    // A surface a hundredth away, one of another colour, none at all.
    let moved = square(&mesh, 0.01 * DVec3::Z, DVec3::Z, 0.8);
    let dark = SurfaceSpec { color: [0.79, 0.45, 0.2], ..spec() };
    let dark = dark.on(
        &mesh,
        &scene.surfaces[0].points().iter().map(|p| p.as_dvec3() + mesh.origin()).collect::<Vec<_>>(),
        scene.surfaces[0].triangles().to_vec(),
    );
    for surfaces in [vec![moved], vec![dark.unwrap()], Vec::new()] {
        let other = Scene { surfaces, ..scene.clone() };
        let error = truth.error(frame(&mesh, &other, exact_methods()[0]).image.pixels(), 0.0);
        assert!(error > 5.0 * TOLERANCE, "{error:.1e}");
    }
    let mut pixels = right.pixels().to_vec();
    pixels[32 * 64 + 32][1] += 2e-4;
    assert!((truth.error(&pixels, 0.0) - 2e-4).abs() < 2e-5);
}

#[test]
fn where_a_surface_is_hidden_or_hides_nothing_is_lost() {
    let mesh = body();
    let toward = DVec3::new(1.1, -1.6, 0.9).normalize();
    // A volume that is opaque before the surface, and one of which next to nothing is before it.
    for (opacity, place) in [(60.0, -0.9), (60.0, 0.95), (0.01, 0.0)] {
        let tf = tetlux_tests::white(&[[0.0, opacity]]);
        let mut surface = spec();
        // Bright: what is hidden behind pixels that count as opaque counts for more.
        surface.color = [40.0, 1.0, 0.0];
        let points = square(&mesh, place * toward, toward, 1.0);
        let points: Vec<DVec3> = points.points().iter().map(|p| p.as_dvec3() + mesh.origin()).collect();
        let surface = surface.on(&mesh, &points, vec![[0, 1, 2], [0, 2, 3]]).unwrap();
        let scene = Scene { surfaces: vec![surface], ..scene(&mesh, tf, cameras()[0], SIZE) };
        let truth = truth(&mesh, &scene);
        for method in exact_methods() {
            let error = truth.error(frame(&mesh, &scene, method).image.pixels(), 0.0);
            // Single precision of values up to 40, and an alpha that is rounded near 1.
            assert!(error <= 40.0 * TOLERANCE, "{opacity}, {} {}: {error:.1e}", method.backend, method.projection);
        }
    }
}

#[test]
fn without_surfaces_nothing_of_them_is_made() {
    let mesh = body();
    let [with, without] = [vec![square(&mesh, DVec3::ZERO, DVec3::Z, 0.8)], Vec::new()]
        .map(|surfaces| colored(&mesh, cameras()[0], surfaces));
    for method in exact_methods().into_iter().filter(|method| method.backend == Backend::Gpu) {
        let [with, without] = [&with, &without].map(|scene| frame(&mesh, scene, method));
        let depths = u64::from(SIZE[0] * SIZE[1] * 4);
        assert_eq!(with.resources.textures, without.resources.textures + 1);
        assert_eq!(with.resources.bytes, without.resources.bytes + depths);
        assert_eq!(with.resources.pipelines, without.resources.pipelines);
        let drawn = |frame: &Frame| frame.stages.iter().any(|stage| stage.name == "surfaces");
        assert!(drawn(&with) && !drawn(&without));
    }
}
