//! What must not change a picture, or only in a way that is known: properties that hold whatever the scene, judged
//! without the truth, over random meshes, transfer functions and cameras outside and inside.

#![allow(clippy::print_stdout, reason = "the figures that were measured")]

mod company;
mod energy;
mod looks;
mod numbering;
mod refining;
mod reversing;
mod scaling;
mod sequence;
mod turning;

use tetlux_image::Image;
use tetlux_tests::twins::{ALL, Agreement, Make, Twins};
use tetlux_tests::{Recipe, Way, reference, render};

/// Seeds of each property.
const SEEDS: u64 = 10;

/// Of a hundred thousand pixels so many may hang on the rounding of scalars and rays.
const EXCUSED: usize = 100;

/// Asserts that twins look the same by every way that is right.
fn assert_same(name: &str, make: Make, seeds: std::ops::Range<u64>) {
    assert_same_of(name, &Way::RIGHT, |seed| Recipe::random(seed, 32), make, seeds);
}

/// The same of other recipes, by some ways.
fn assert_same_of(name: &str, ways: &[Way], recipe: impl Fn(u64) -> Recipe, make: Make, seeds: std::ops::Range<u64>) {
    let [mut covered, mut excused] = [0; 2];
    let mut worst = vec![0.0f64; ways.len()];
    for seed in seeds {
        let twins = make(recipe(seed), seed);
        for (&way, worst) in ways.iter().zip(&mut worst) {
            let [first, second] = twins.pair.each_ref().map(|(mesh, scene)| render(mesh, scene, way));
            let compared = twins.compare(&first, &second);
            assert_eq!(compared.wrong, 0, "{name}, seed {seed}, {way:?}: {compared:?}");
            *worst = worst.max(compared.max);
            covered += compared.covered;
            excused += compared.excused;
        }
    }
    println!("{name}: {worst:?} over {covered} pixels; {excused} hang on rounding");
    assert!(covered > 0 && excused * 100_000 <= covered * EXCUSED, "{excused} of {covered} pixels");
}

#[test]
fn twins_are_twins() {
    for (name, make) in ALL {
        for seed in 0..3 {
            // The truth is the same too, if not in its last bits.
            let twins = Twins { agreement: Agreement::Rounding, ..make(Recipe::random(seed, 32), seed) };
            let [first, second] = twins.pair.each_ref().map(|(mesh, scene)| {
                let pixels = reference(mesh, scene).iter().map(|p| p.map(|c| c as f32)).collect();
                Image::from_pixels(scene.size[0], scene.size[1], pixels).unwrap_or_else(|e| panic!("{e}"))
            });
            let compared = twins.compare(&first, &second);
            assert_eq!(compared.wrong, 0, "{name}, seed {seed}: {compared:?}");
        }
    }
}
