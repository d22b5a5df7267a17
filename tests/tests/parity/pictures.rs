//! One picture, many ways: the same up to rounding across back ends, the same to the bit on one.

use glam::DVec3;
use tetlux_image::Image;
use tetlux_mesh::TetMesh;
use tetlux_mesh::procedural::{Split, cuboid};
use tetlux_scene::Scene;
use tetlux_tests::{Random, Way, mesh_of, orthographic, perspective, render, scene, transfer};

/// Arithmetic is the same in both, but drivers fuse and reorder it, and where a ray grazes a face a peak of slope 160
/// turns a unit of the last place into a hundred.
const TOLERANCE: f32 = 5e-5;

/// A displaced grid, in color, from outside and inside, both projections.
fn scenes() -> Vec<(TetMesh, Scene)> {
    let mut random = Random::new(5);
    let mut parts = cuboid([6, 5, 4], Split::Six, [-DVec3::ONE, DVec3::ONE]);
    for p in &mut parts.points {
        *p += DVec3::new(random.between(-0.04, 0.04), random.between(-0.04, 0.04), random.between(-0.04, 0.04));
    }
    let mesh = mesh_of(&parts, |p| (2.0 * p.x).sin() + p.y * p.z);
    let tf = transfer(
        &[[-1.0, 0.9, 0.1, 0.2], [0.0, 0.2, 0.8, 0.3], [0.0, 0.1, 0.3, 1.0], [1.5, 1.0, 0.9, 0.2]],
        &[[-1.0, 1.0], [-0.5, 0.1], [0.2, 0.0], [0.25, 8.0], [0.3, 0.0], [0.9, 0.5], [0.9, 2.0]],
    );
    let outside = DVec3::new(2.5, -3.0, 1.8);
    [
        perspective(outside, DVec3::ZERO, 35.0),
        orthographic(outside, DVec3::ZERO, 1.6),
        perspective(DVec3::new(0.2, 0.1, -0.3), DVec3::X, 90.0),
        orthographic(DVec3::new(0.2, 0.1, -0.3), DVec3::X, 1.2),
    ]
    .into_iter()
    .map(|camera| (mesh.clone(), scene(&mesh, tf.clone(), camera, [160, 120])))
    .collect()
}

fn largest_difference(a: &Image, b: &Image) -> f32 {
    let values = a.pixels().iter().flatten().zip(b.pixels().iter().flatten());
    values.map(|(x, y)| if x.is_finite() && y.is_finite() { (x - y).abs() } else { f32::INFINITY }).fold(0.0, f32::max)
}

#[test]
fn both_back_ends_make_one_picture() {
    for (mesh, scene) in scenes() {
        let (gpu, cpu) = (render(&mesh, &scene, Way::GpuCentroid), render(&mesh, &scene, Way::CpuCentroid));
        let difference = largest_difference(&gpu, &cpu);
        println!("{:?}: {difference:.1e}", scene.camera.projection);
        assert!(difference <= TOLERANCE, "{:?}: {difference:.1e}", scene.camera.projection);
        assert!(cpu.pixels().iter().filter(|p| p[3] > 0.1).count() > 2000, "the mesh is seen");
        // The order matters here: the comparison is of more than sums.
        let unordered = render(&mesh, &scene, Way::GpuNone);
        assert!(largest_difference(&unordered, &cpu) > 100.0 * TOLERANCE);
    }
}

#[test]
fn a_picture_is_the_same_every_time() {
    for (mesh, scene) in scenes() {
        for way in Way::ALL {
            let first = render(&mesh, &scene, way);
            assert_eq!(first, render(&mesh, &scene, way), "{way:?}");
            for threads in [1, 2, 3] {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
                let again = pool.install(|| render(&mesh, &scene, way));
                assert_eq!(first, again, "{way:?} on {threads} threads");
            }
        }
    }
}
