//! Drawing opaque surfaces: processor time of the stage, for few large triangles and for a million small ones.

use std::time::Duration;

use criterion::{Criterion, criterion_group, criterion_main};
use glam::DVec3;
use tetlux_benches::{cube_mesh, scene};
use tetlux_mesh::TetMesh;
use tetlux_render::{Model, Renderer};
use tetlux_scene::{Backend, Method, Plan, Surface, SurfaceSpec};

/// A ball of 2 n^2 triangles.
fn ball(mesh: &TetMesh, n: u32) -> Surface {
    let at = |i: u32, j: u32| {
        let (sin, cos) = (std::f64::consts::TAU * f64::from(i) / f64::from(n)).sin_cos();
        let (across, up) = (std::f64::consts::PI * f64::from(j) / f64::from(n)).sin_cos();
        DVec3::new(across * cos, across * sin, up)
    };
    let points: Vec<DVec3> = (0..=n).flat_map(|j| (0..=n).map(move |i| at(i, j))).collect();
    let name = |i: u32, j: u32| j * (n + 1) + i;
    let squares = (0..n).flat_map(|j| (0..n).map(move |i| (i, j)));
    let triangles = squares.flat_map(|(i, j)| {
        let [a, b, c, d] = [name(i, j), name(i + 1, j), name(i + 1, j + 1), name(i, j + 1)];
        [[a, b, c], [a, c, d]]
    });
    let ball = SurfaceSpec::new("ball".into(), None).on(mesh, &points, triangles.collect());
    ball.unwrap_or_else(|e| panic!("{e}"))
}

fn surfaces(c: &mut Criterion) {
    let mesh = cube_mesh(4);
    let (renderer, model) = (Renderer::new(), Model::new(&mesh));
    let mut group = c.benchmark_group("surfaces");
    group.sample_size(10).warm_up_time(Duration::from_millis(500)).measurement_time(Duration::from_secs(2));
    for n in [4, 700] {
        let mut scene = scene(&mesh, true, Method { backend: Backend::Cpu, ..Method::default() });
        scene.size = [800, 800];
        scene.surfaces = vec![ball(&mesh, n)];
        let plan = Plan::new(&scene, &mesh, None).unwrap_or_else(|e| panic!("{e}"));
        group.bench_function(format!("{} triangles", 2 * n * n), |b| {
            b.iter_custom(|runs| {
                let frames = (0..runs).map(|_| renderer.render(&scene, &model, &plan));
                let seconds = frames.map(|frame| {
                    let frame = frame.unwrap_or_else(|e| panic!("{e}"));
                    let found = frame.stages.iter().find(|stage| stage.name == "surfaces");
                    found.map_or(0.0, |stage| stage.cpu.unwrap_or(stage.wall))
                });
                Duration::from_secs_f64(seconds.sum())
            });
        });
    }
    group.finish();
}

criterion_group!(benches, surfaces);
criterion_main!(benches);
