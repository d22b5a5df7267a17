//! White luminance gives exactly alpha: what a medium absorbs is what it emits.
//!
//! A segment's colour is its luminances times the weights of its ends, which are alpha q and alpha (1 - q): in single
//! precision their sum is alpha but for two roundings. Where luminance is constant no plan asks for q: the weights are
//! halves of alpha, whose sum is alpha. Tiles on the processor multiply alpha by the luminance in the middle, and the
//! luminance's slope, 0, by the rest. Then not a bit is lost: colour and alpha are found by the same operations.

use std::sync::Arc;

use tetlux_image::Image;
use tetlux_optics::{Classification, Widget};
use tetlux_render::{Model, table_specs};
use tetlux_scene::{Backend, Integrator, Method, Order, Plan};
use tetlux_tables::{Table, TableCache};
use tetlux_tests::{Recipe, Way, render, renderer, white};

use crate::SEEDS;

/// A picture's alpha is a sum of some thirty segments' of up to a dozen parts each; each part and each sum is rounded
/// in colour and in alpha, by 6e-8 of what is there, and roundings do not all go one way.
const ROUNDING: f32 = 2e-6;

fn recipe(seed: u64) -> Recipe {
    let recipe = Recipe::random(seed, 32);
    let opacity: Vec<[f64; 2]> = recipe.transfer().opacity_nodes().iter().map(|n| [n.s, n.opacity]).collect();
    Recipe { classification: Classification::OneField(white(&opacity)), ..recipe }
}

/// The largest difference of a colour from alpha, as a share of it.
fn largest_share(image: &Image) -> f32 {
    let share = |&[r, g, b, a]: &[f32; 4]| {
        let off = [r, g, b].map(|c| (c - a).abs());
        if !(off[0] + off[1] + off[2]).is_finite() {
            f32::INFINITY
        } else if a > 0.0 {
            off[0].max(off[1]).max(off[2]) / a
        } else {
            off[0] + off[1] + off[2]
        }
    };
    image.pixels().iter().map(share).fold(0.0, f32::max)
}

#[test]
fn every_way() {
    for way in Way::ALL {
        for seed in 0..SEEDS {
            let (mesh, scene) = recipe(seed).made();
            let share = largest_share(&render(&mesh, &scene, way));
            assert_eq!(share, 0.0, "{way:?}, seed {seed}: the share of alpha that it is off by");
        }
    }
}

#[test]
fn every_integrator_that_is_ours() {
    let cache = TableCache::new(1 << 26);
    for (integrator, backend, bound) in [
        (Integrator::Average, Backend::Gpu, 0.0),
        (Integrator::Average, Backend::Cpu, 0.0),
        (Integrator::Direct, Backend::Gpu, ROUNDING),
        (Integrator::Symmetric, Backend::Gpu, ROUNDING),
        (Integrator::Q, Backend::Gpu, ROUNDING),
    ] {
        let mut worst = 0.0f32;
        for seed in 0..SEEDS {
            let (mesh, mut scene) = recipe(seed).made();
            scene.method = Method { backend, integrator, order: Order::Exact, ..Method::default() };
            let plan = Plan::new(&scene, &mesh, renderer().device()).unwrap_or_else(|e| panic!("{integrator}: {e}"));
            let build = |spec| cache.get_or_build(spec).unwrap_or_else(|e| panic!("{integrator}: {e}"));
            let tables: Vec<Arc<Table>> = table_specs(&scene, &mesh, &plan).iter().map(build).collect();
            let frame = renderer().render_with(&scene, &Model::new(&mesh), &plan, &tables);
            let frame = frame.unwrap_or_else(|e| panic!("{integrator}: {e}"));
            let share = largest_share(&frame.image);
            assert!(share <= bound, "{integrator} on {backend}, seed {seed}: off by {share:.1e} of alpha");
            worst = worst.max(share);
        }
        println!("{integrator} on {backend}: off by {worst:.1e} of alpha");
    }
}

/// By two fields, where segments are shaded one by one.
#[test]
fn two_fields() {
    let is_white = |classification: Classification| match classification {
        Classification::TwoFields(transfer) => {
            let opacity: Vec<[f64; 2]> = transfer.opacity_nodes().iter().map(|n| [n.s, n.opacity]).collect();
            Some(Classification::TwoFields(white(&opacity)))
        }
        Classification::Widgets(mut function) => {
            for widget in &mut function.widgets {
                let same = Widget::new(*widget.shape(), widget.support().copied(), widget.max_opacity(), [1.0; 3]);
                *widget = same.unwrap_or_else(|e| panic!("{e}"));
            }
            Some(Classification::Widgets(function))
        }
        _ => None,
    };
    for way in [Way::CpuExact, Way::CpuPixel, Way::GpuExact, Way::GpuMarch] {
        let mut worst = 0.0f32;
        for seed in 0..SEEDS {
            let recipe = Recipe::of_two_fields(seed, 24);
            let Some(classification) = is_white(recipe.classification.clone()) else { continue };
            let (mesh, scene) = Recipe { classification, ..recipe }.made();
            let share = largest_share(&render(&mesh, &scene, way));
            assert!(share <= ROUNDING, "{way:?}, seed {seed}: off by {share:.1e} of alpha");
            worst = worst.max(share);
        }
        println!("two fields, {way:?}: off by {worst:.1e} of alpha");
    }
}

#[test]
fn a_planted_loss_is_found() {
    let (mesh, scene) = recipe(0).made();
    let mut image = render(&mesh, &scene, Way::CpuExact);
    let Some(pixel) = image.pixels_mut().iter_mut().find(|pixel| pixel[3] > 0.0) else { panic!("nothing is seen") };
    pixel[1] = pixel[1].next_down();
    assert!(largest_share(&image) > 0.0);
    image.pixels_mut()[0][0] = f32::NAN;
    assert_eq!(largest_share(&image), f32::INFINITY);
}
