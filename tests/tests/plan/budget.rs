//! The stated error is never below the measured one, and a loose budget is spent.

use glam::DVec3;
use tetlux_mesh::TetMesh;
use tetlux_optics::TransferFunction;
use tetlux_scene::{Backend, Integrator, Method, Order, Plan, Scene};
use tetlux_tests::{
    FIELD, Random, largest_error, mesh_with, orthographic, perspective, pixel_error, random_field, random_parts,
    reference, renderer, scene, transfer,
};

use super::planned;

const CASES: u64 = 50;

/// A displaced grid with a smooth field.
fn random_mesh(random: &mut Random) -> TetMesh {
    let parts = random_parts(random, 2);
    let field = random_field(random, &parts);
    mesh_with(&parts, field)
}

/// Without steps: ramps and peaks of a twentieth of the range and more, few colours or a fine scale of them.
fn random_transfer(random: &mut Random, [low, high]: [f64; 2]) -> TransferFunction {
    let place = |u: f64| low + (high - low) * u;
    let fine = random.below(3) == 0;
    let count = if fine { 65 } else { 2 + random.below(4) };
    let contrast = [1.0, 0.1, 0.01][random.below(3)];
    let colors: Vec<[f64; 4]> = (0..count)
        .map(|k| {
            let t = k as f64 / (count - 1) as f64;
            let rgb = match fine {
                true => [t * t, (3.0 * t).sin().abs(), 1.0 - 0.5 * t],
                false => [0; 3].map(|_| random.between(0.0, 1.0)),
            };
            [
                place(t),
                0.5 + contrast * (rgb[0] - 0.5),
                0.5 + contrast * (rgb[1] - 0.5),
                0.5 + contrast * (rgb[2] - 0.5),
            ]
        })
        .collect();
    let nodes = 3 + random.below(6);
    let height = [0.05, 1.0, 20.0][random.below(3)];
    let heights: Vec<[f64; 2]> = (0..nodes)
        .map(|k| {
            let tiny = random.below(3) == 0;
            let opacity = if tiny { random.between(0.0, 1e-3) } else { random.between(0.0, height) };
            [place((k as f64 + random.between(0.0, 0.5)) / nodes as f64), opacity]
        })
        .collect();
    transfer(&colors, &heights)
}

fn random_scene(seed: u64) -> (TetMesh, Scene) {
    let mut random = Random::new(seed);
    let mesh = random_mesh(&mut random);
    let range = mesh.scalar(FIELD, Default::default()).unwrap().range;
    let function = random_transfer(&mut random, range);
    let mut direction = || DVec3::new(random.between(-1.0, 1.0), random.between(-1.0, 1.0), random.between(-1.0, 1.0));
    let (toward, focus) = (direction(), direction() * 0.3);
    let position = focus + toward.normalize_or(DVec3::X) * random.between(0.5, 6.0);
    let camera = match random.below(2) {
        0 => perspective(position, focus, random.between(20.0, 90.0)),
        _ => orthographic(position, focus, random.between(0.8, 2.5)),
    };
    let mut scene = scene(&mesh, function, camera, [48, 48]);
    scene.unit_distance = random.between(0.3, 3.0);
    scene.method.max_error = 10f64.powf(random.between(-5.0, -1.0));
    (mesh, scene)
}

#[test]
fn measured_errors_stay_below_stated_ones_at_every_budget() {
    let (mut kept, mut spent, mut closest) = (0, 0, 0.0f64);
    for seed in 0..CASES {
        let (mesh, base) = random_scene(seed);
        let truth = reference(&mesh, &base);
        // The default of the device there is, then the other.
        for backend in [Backend::Cpu, Backend::Gpu] {
            let scene = Scene { method: Method { backend, ..base.method }, ..base.clone() };
            let (plan, frame) = planned(&mesh, &scene);
            let budget = scene.method.max_error;
            let stated = plan.stated.total().expect("what the plan chooses is bounded");
            let measured = largest_error(frame.image.pixels(), &truth);
            println!(
                "{seed} {backend}: budget {budget:.1e}, stated {stated:.1e}, measured {measured:.1e}: {} {} {} of {} cells",
                plan.order,
                plan.integrator,
                plan.cells.len(),
                mesh.cells().len()
            );
            assert!(
                measured <= stated,
                "seed {seed} on {backend}, budget {budget:.1e}: {measured:.1e} > {}",
                plan.stated
            );
            assert!(plan.stated.beyond.is_none());
            let warned = plan.warnings.iter().any(|w| w.contains("error budget"));
            assert_eq!(warned, stated > budget, "seed {seed}: {:?}", plan.warnings);
            kept += usize::from(!warned);
            let saved = plan.integrator == Integrator::Average || plan.transfer.is_some() || plan.skips.faint > 0;
            spent += usize::from(saved || (plan.order == Order::None && scene.single_luminance().is_none()));
            closest = closest.max(measured / stated);
        }
    }
    println!("{kept} budgets kept, {spent} spent, measured up to {closest:.2} of stated");
    assert!(kept > 70, "{kept} of 100 budgets can be kept");
    assert!(spent > 25, "{spent} of 100 budgets are spent");
}

/// Of a volume that is hardly seen an order left out would change the colour by more than an absolute error shows.
#[test]
fn a_thin_volume_errs_by_the_budget_of_what_is_seen_of_it() {
    let mesh = random_mesh(&mut Random::new(5));
    let camera = perspective(DVec3::new(4.0, -5.0, 3.0), DVec3::ZERO, 40.0);
    for opacity in [1e-4, 1e-3, 1e-2] {
        let two_colors = transfer(&[[-0.5, 1.0, 0.0, 0.2], [0.5, 0.0, 1.0, 1.0]], &[[0.0, opacity]]);
        let mut scene = scene(&mesh, two_colors, camera, [48, 48]);
        scene.method.backend = Backend::Cpu;
        let (_, frame) = planned(&mesh, &scene);
        let pixels = frame.image.pixels().iter().zip(reference(&mesh, &scene));
        let relative = |(&found, right): (&[f32; 4], [f64; 4])| pixel_error(found, right) / right[3].max(opacity);
        let worst = pixels.map(relative).fold(0.0, f64::max);
        assert!(worst <= scene.method.max_error, "opacity {opacity:e}: {worst:.1e} of what is seen");
    }
}

/// Order and integral judged where they are the most of the error: bounds, not luck.
#[test]
fn choices_that_err_are_stated_and_warned_of() {
    for seed in 0..8 {
        let (mesh, base) = random_scene(seed);
        let truth = reference(&mesh, &base);
        for (order, integrator) in [(Order::None, Integrator::Direct), (Order::Exact, Integrator::Average)] {
            let method = Method { backend: Backend::Cpu, order, integrator, max_error: 1e-5, ..base.method };
            let scene = Scene { method, ..base.clone() };
            let (plan, frame) = planned(&mesh, &scene);
            let (stated, measured) = (plan.stated.total().unwrap(), largest_error(frame.image.pixels(), &truth));
            assert!(measured <= stated, "seed {seed}, {order}, {integrator}: {measured:.1e} > {}", plan.stated);
            if measured > 1e-4 {
                let warning = plan.warnings.iter().find(|w| w.contains("error budget")).unwrap();
                let remedy = if order == Order::None { "--order exact" } else { "--integrator average" };
                assert!(warning.contains(remedy), "{warning}");
            }
        }
    }
}

#[test]
fn what_nothing_bounds_is_said_to_be_so() {
    let (mesh, base) = random_scene(1);
    let method = Method { backend: Backend::Gpu, integrator: Integrator::Linear, ..Method::default() };
    let plan = Plan::new(&Scene { method, ..base }, &mesh, renderer().device()).unwrap();
    assert_eq!(plan.stated.total(), None);
    let warning = plan.warnings.iter().find(|w| w.contains("error budget")).unwrap();
    assert!(warning.contains("not bounded") && warning.contains("leave out --integrator linear"), "{warning}");
}
