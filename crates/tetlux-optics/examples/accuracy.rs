//! The measured errors of every method for the weights of a segment, as Markdown tables.
#![expect(clippy::print_stdout, reason = "an example shows its result")]

use tetlux_optics::accuracy::{Measured, POINTS, SETS, measure};
use tetlux_optics::published::linear_published as published_f64;
use tetlux_optics::published_f32::linear_published;
use tetlux_optics::segment_f32::{weights_average, weights_direct};
use tetlux_optics::symmetric_f32::weights_symmetric;

#[path = "../tests/reference/cases.rs"]
mod cases;

type Method = fn(f32, f32) -> [f32; 3];

/// Each method of the shaders, by its name there, and the published form in f64, rounded at the end.
const METHODS: [(&str, Method); 5] = [
    ("weights_direct", weights_direct),
    ("weights_symmetric", weights_symmetric),
    ("weights_average", weights_average),
    ("linear_published", linear_published),
    ("linear_published in f64", |a, b| {
        let weights = published_f64(f64::from(a), f64::from(b));
        [weights.alpha, weights.back, weights.front].map(|weight| weight as f32)
    }),
];

fn main() {
    let rows = cases::compare().0;
    println!("### f64 against 50-digit reference values\n");
    println!("| file | quantity | max relative error | max absolute error |\n|---|---|---|---|");
    for row in rows {
        println!("| {} | {} | {:.1e} | {:.1e} |", row.file, row.quantity, row.relative, row.absolute);
    }
    println!("\n### f32 against f64, {POINTS} points a set\n");
    println!("Largest error of alpha, w_b and w_f; \"not finite\" is the share of inputs without finite weights.\n");
    println!("| method | set | max relative error | max absolute error | not finite |\n|---|---|---|---|---|");
    for (name, method) in METHODS {
        for set in &SETS {
            let Measured { relative, absolute, not_finite } = measure(set, POINTS, method);
            let share = 100.0 * not_finite;
            println!("| {name} | {} | {relative:.1e} | {absolute:.1e} | {share:.0} % |", set.name);
        }
    }
}
