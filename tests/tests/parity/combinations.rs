//! Every combination of methods: each renders on the real driver within the error of its class, or is refused with a reason
//! that names what is at odds.

use std::time::Instant;

use tetlux_scene::{
    Backend, CellProjection, Classification, Integrator, Interpolation, Method, Order, Plan, Scene, TablePrecision,
    Target,
};
use tetlux_tests::{largest_error, reference, renderer};

use crate::methods::{GPU, all, block, cache, frame, integrators};

/// What is exact: single precision, and the table of q.
const EXACT: f64 = 1e-4;

/// Finite, and no more: the closed form as published divides by what may be nothing.
const UNSTABLE: f64 = 1e3;

/// The most that the choices of a method may lose together on the test's scene, of colours up to 1: what is published of
/// each, or loosely what a pixel has to lose.
fn loss(method: &Method) -> f64 {
    let integrator = match method.integrator {
        Integrator::Auto | Integrator::Direct | Integrator::Symmetric | Integrator::Q => 0.0,
        // A table of 512 x 512; the opacity is exact.
        Integrator::Psi => 1e-3,
        Integrator::Linear => UNSTABLE,
        // Half of the opacity of a cell, of which neighbours take most back.
        Integrator::Average => 0.2,
        // Between nodes of the table the function's kinks are lost; 6 % of the thickness in the second.
        Integrator::Preint | Integrator::PreintLog | Integrator::PreintQ => 0.2,
        Integrator::Adaptive | Integrator::Analytic | Integrator::Approximate => unreachable!("for two fields"),
    };
    let classification = match method.classification {
        Classification::Auto | Classification::PostExact | Classification::PostClip => 0.0,
        // What lies between the scalars of two vertices.
        Classification::Vertex => 0.5,
    };
    let interpolation = match method.interpolation {
        Interpolation::Auto | Interpolation::Ray | Interpolation::Perspective => 0.0,
        Interpolation::ScreenLinear => 0.2,
    };
    let precision = match (method.integrator.uses_table(), method.table_precision) {
        (false, _) | (_, TablePrecision::Auto | TablePrecision::F32) => 0.0,
        // Half a step, or 2^-11 of a half, in each of up to 20 cells.
        (_, TablePrecision::U8) => 20.0 / 510.0,
        (_, TablePrecision::U16) => 20.0 / 131_070.0,
        (_, TablePrecision::F16) => 20.0 / 2048.0,
    };
    let target = match method.target {
        Target::Auto | Target::Rgba32f => 0.0,
        Target::Rgba16f => 20.0 / 2048.0,
        Target::Rgba8 => 20.0 / 510.0,
        // Alpha is rounded at random: a whole step.
        Target::Rgba8Dither => 20.0 / 255.0,
    };
    let order = match method.order {
        // Two are right on any mesh, and two on convex ones, such as the test's.
        Order::Auto | Order::Exact | Order::Pixel | Order::Mpvo | Order::Mpvonc => 0.0,
        Order::Centroid | Order::Power => 0.3,
        Order::None => 0.5,
    };
    let order = if method.projection == CellProjection::March { 0.0 } else { order };
    EXACT + integrator + classification + interpolation + precision + target + order
}

/// Every combination of what decides about pipelines.
fn pipelines() -> Vec<Method> {
    let mut methods = Vec::new();
    for projection in all(CellProjection::ALL) {
        for &interpolation in Interpolation::ALL {
            for integrator in integrators() {
                for classification in all(Classification::ALL) {
                    let order = if projection == CellProjection::March { Order::Auto } else { Order::Exact };
                    methods.push(Method { order, projection, interpolation, integrator, classification, ..GPU });
                }
            }
        }
    }
    // What `auto` stands for is drawn by its name, where it has one that is not refused.
    let named = |method: &Method| {
        method.interpolation != Interpolation::Auto
            || matches!(method.projection, CellProjection::March | CellProjection::Balanced)
    };
    methods.into_iter().filter(|method| named(method) && method.refusal().is_none()).collect()
}

/// Whether a combination is drawn here. Pipelines take a software driver long, half a second each: of the two geometries
/// that differ from others in a function which knows no integrator, one that is pre-integrated and one in every
/// classification stand for all. That all compose, and bind what they name, is a test of the renderer.
fn is_drawn(method: &Method) -> bool {
    let few = method.projection == CellProjection::Gator || method.interpolation == Interpolation::ScreenLinear;
    !few || matches!(method.integrator, Integrator::Direct | Integrator::Preint)
}

#[test]
fn every_combination_that_is_allowed_renders_within_the_error_of_its_class() {
    let start = Instant::now();
    let (mesh, scene) = block();
    let truth = reference(&mesh, &scene);
    let cache = cache();
    let pipelines = pipelines();
    assert!(pipelines.len() > 100, "{}", pipelines.len());
    let mut methods = Vec::new();
    for &method in pipelines.iter().filter(|method| is_drawn(method)) {
        // The format of a table decides about no pipeline: all of them.
        let precisions =
            if method.integrator.uses_table() { all(TablePrecision::ALL) } else { vec![TablePrecision::Auto] };
        methods.extend(precisions.into_iter().map(|table_precision| Method { table_precision, ..method }));
        // The target's module follows after all others and knows none of them, and the order is that of the cells, before
        // any shader: with one integrator and classification.
        let marched = method.projection == CellProjection::March;
        if !marched && (method.integrator, method.classification) == (GPU.integrator, GPU.classification) {
            let others = all(Target::ALL).into_iter().filter(|target| *target != method.target);
            methods
                .extend(others.map(|target| Method { target, ..method }).filter(|method| method.refusal().is_none()));
            let others = all(Order::ALL).into_iter().filter(|order| *order != method.order);
            methods.extend(others.map(|order| Method { order, ..method }).filter(|method| method.refusal().is_none()));
        }
    }
    for integrator in [Integrator::Direct, Integrator::Average] {
        let method = Method { backend: Backend::Cpu, integrator, ..Method::default() };
        methods.extend(all(Order::ALL).into_iter().map(|order| Method { order, ..method }));
    }
    let mut worst = 0.0f64;
    for &method in &methods {
        assert_eq!(method.refusal(), None, "{method:?}");
        let error = largest_error(frame(&mesh, &scene, method, &cache).image.pixels(), &truth);
        // Also where a value is not finite.
        assert!(error <= loss(&method), "{method:?}: {error:.1e}, and not {:.1e}", loss(&method));
        if loss(&method) == EXACT {
            worst = worst.max(error);
        }
    }
    let seconds = start.elapsed().as_secs_f64();
    println!("{} allowed, {} pictures, {seconds:.1} s; exact ones {worst:.1e}", pipelines.len(), methods.len());
    // Planted: what is drawn by another method than it is said to be is seen.
    let average = frame(&mesh, &scene, Method { integrator: Integrator::Average, ..GPU }, &cache).image;
    assert!(largest_error(average.pixels(), &truth) > 10.0 * EXACT);
}

/// Names of what is chosen, of an axis and of a value alone.
fn names(method: &Method) -> Vec<String> {
    let mut names = vec![
        method.backend.to_string(),
        method.order.to_string(),
        method.projection.to_string(),
        method.interpolation.to_string(),
        method.integrator.to_string(),
        method.classification.to_string(),
        method.table_precision.to_string(),
        method.target.to_string(),
    ];
    names.retain(|name| name != "auto");
    names
}

#[test]
fn every_combination_is_planned_or_refused_with_a_reason_that_names_what_is_at_odds() {
    let (mesh, scene) = block();
    let (mut planned, mut refused) = (0, 0);
    let mut product = vec![Method::default()];
    fn by<T: Copy>(product: Vec<Method>, values: &[T], set: impl Fn(&mut Method, T)) -> Vec<Method> {
        let mut wider = Vec::with_capacity(product.len() * values.len());
        for method in product {
            wider.extend(values.iter().map(|&value| {
                let mut method = method;
                set(&mut method, value);
                method
            }));
        }
        wider
    }
    product = by(product, Backend::ALL, |m, v| m.backend = v);
    product = by(product, Order::ALL, |m, v| m.order = v);
    product = by(product, CellProjection::ALL, |m, v| m.projection = v);
    product = by(product, Interpolation::ALL, |m, v| m.interpolation = v);
    let of_one_field = [vec![Integrator::Auto], integrators()].concat();
    product = by(product, &of_one_field, |m, v| m.integrator = v);
    product = by(product, Classification::ALL, |m, v| m.classification = v);
    product = by(product, TablePrecision::ALL, |m, v| m.table_precision = v);
    product = by(product, Target::ALL, |m, v| m.target = v);
    for (i, &method) in product.iter().enumerate() {
        let reason = method.refusal();
        // To plan takes longer than to refuse: one in a stride that no axis' length divides.
        let judged = i % 41 == 0;
        if let Some(reason) = &reason {
            refused += 1;
            let named = names(&method).iter().filter(|name| reason.contains(name.as_str())).count();
            assert!(reason.len() > 30 && named > 0, "{method:?}: {reason}");
        }
        if judged {
            let scene = Scene { method, ..scene.clone() };
            let plan = Plan::new(&scene, &mesh, renderer().device());
            assert_eq!(plan.is_err(), reason.is_some(), "{method:?}: {:?}", plan.err().map(|e| e.to_string()));
            planned += usize::from(reason.is_none());
        }
    }
    println!("{} combinations, {refused} refused; {planned} planned", product.len());
    assert!(refused > product.len() / 4 && planned > 500);
}

#[test]
fn projections_agree_with_one_another() {
    let (mesh, scene) = block();
    let cache = cache();
    for integrator in [Integrator::Direct, Integrator::Q, Integrator::PreintQ] {
        let pictures: Vec<_> = all(CellProjection::ALL)
            .into_iter()
            .map(|projection| {
                let march = projection == CellProjection::March;
                let order = if march { Order::Auto } else { Order::Exact };
                Method { order, projection, interpolation: Interpolation::Auto, integrator, ..GPU }
            })
            .filter(|method| method.refusal().is_none())
            .map(|method| (method.projection, frame(&mesh, &scene, method, &cache).image))
            .collect();
        for (projection, picture) in &pictures[1..] {
            let truth: Vec<[f64; 4]> = pictures[0].1.pixels().iter().map(|p| p.map(f64::from)).collect();
            let apart = largest_error(picture.pixels(), &truth);
            assert!(apart <= EXACT, "{integrator}: {projection} is {apart:.1e} from {}", pictures[0].0);
        }
    }
}
