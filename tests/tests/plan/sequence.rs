//! Frames in sequence are what they are alone.

use glam::DVec3;
use tetlux_mesh::procedural::{Split, cuboid};
use tetlux_render::{Model, RenderError, Renderer, frames};
use tetlux_scene::{Backend, Method, Planner, Scene};
use tetlux_tests::{mesh_of, perspective, scene, transfer};

use super::{planned, same_bits};

#[test]
fn every_frame_of_an_orbit_is_the_one_rendered_alone() {
    let count = 6;
    let mesh = mesh_of(&cuboid([5, 4, 3], Split::Five, [DVec3::splat(-1.0), DVec3::ONE]), |p| p.x + p.y * p.z);
    let function = transfer(&[[-1.0, 0.1, 0.5, 0.9], [1.0, 0.9, 0.4, 0.1]], &[[-1.0, 0.0], [1.0, 3.0]]);
    let camera = perspective(DVec3::new(3.0, -2.0, 1.0), DVec3::ZERO, 40.0);
    for backend in [Backend::Cpu, Backend::Gpu] {
        let still = Scene {
            method: Method { backend, ..Method::default() },
            ..scene(&mesh, function.clone(), camera, [48, 32])
        };
        let at = |number: usize| Scene { camera: camera.turned(360.0 * number as f64 / count as f64), ..still.clone() };
        let (renderer, planner, model) = (Renderer::new(), Planner::new(&mesh), Model::new(&mesh));
        let mut pictures = Vec::new();
        let make = |number: usize| -> Result<_, RenderError> {
            let scene = at(number);
            let plan = planner.plan(&scene, renderer.device()).unwrap();
            renderer.render(&scene, &model, &plan)
        };
        frames(0..count, make, |number, frame| {
            assert_eq!(number, pictures.len());
            pictures.push(frame.image);
            Ok(())
        })
        .unwrap();
        assert_eq!(pictures.len(), count);
        for (number, picture) in pictures.iter().enumerate() {
            assert!(same_bits(picture, &planned(&mesh, &at(number)).1.image), "frame {number} on {backend}");
        }
        assert!(!same_bits(&pictures[0], &pictures[1]), "the eye moves");
    }
}

#[test]
fn a_planner_used_again_plans_as_a_new_one_does() {
    let mesh = mesh_of(&cuboid([6, 5, 4], Split::Six, [DVec3::splat(-1.0), DVec3::ONE]), |p| p.x + p.y * p.z);
    let camera = perspective(DVec3::new(1.5, -1.2, 0.8), DVec3::ZERO, 35.0);
    let colors = [[-1.0, 0.1, 0.5, 0.9], [1.0, 0.9, 0.4, 0.1]];
    let upper = scene(&mesh, transfer(&colors, &[[0.3, 0.0], [1.0, 3.0]]), camera, [48, 32]);
    let lower = scene(&mesh, transfer(&colors, &[[-1.0, 3.0], [-0.3, 0.0]]), camera, [48, 32]);
    let mut warped = upper.clone();
    warped.scalar.values.iter_mut().step_by(3).for_each(|s| *s = -*s);
    let turned = Scene { camera: camera.turned(70.0), ..upper.clone() };
    let planner = Planner::new(&mesh);
    let mut seen = std::collections::HashSet::new();
    for scene in [&upper, &lower, &turned, &warped, &upper, &upper] {
        let (again, new) = (planner.plan(scene, None).unwrap(), tetlux_scene::Plan::new(scene, &mesh, None).unwrap());
        assert_eq!((&again.cells, again.skips, &again.lines), (&new.cells, new.skips, &new.lines));
        seen.insert(again.cells);
    }
    assert_eq!(seen.len(), 4, "each of them draws other cells");
}
