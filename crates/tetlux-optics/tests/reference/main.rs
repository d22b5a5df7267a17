//! The f64 integrals against reference values of 50 digits.
#![expect(clippy::print_stdout, reason = "a test says which data is absent")]

mod cases;

use cases::{Rows, compare};
use serde_json::Value;

/// Relative error that every f64 quantity keeps. A transmittance exp(-X) has at least the rounding of X, and values as
/// small as exp(-745) occur: 745 * 1.1e-16 = 8e-14, to which a few operations on X add as much again.
const TOLERANCE: f64 = 1e-12;

fn holds(rows: &Rows) -> bool {
    rows.0.iter().all(|row| row.relative <= TOLERANCE)
}

#[test]
fn every_quantity_agrees_with_the_reference() {
    let rows = compare();
    for row in &rows.0 {
        println!("{} {}: {:.2e}", row.file, row.quantity, row.relative);
    }
    let files: std::collections::BTreeSet<_> = rows.0.iter().map(|row| row.file).collect();
    assert_eq!(files.len(), 7);
    assert!(holds(&rows), "{:#?}", rows.0.iter().filter(|row| row.relative > TOLERANCE).collect::<Vec<_>>());
}

#[test]
fn the_comparison_sees_a_planted_difference() {
    for wrong in [1.0 + 2.0 * TOLERANCE, -1.0, f64::NAN, f64::INFINITY] {
        let mut rows = Rows::default();
        rows.see("file", "w", 1.0, 1.0, &Value::Null);
        assert!(holds(&rows) && rows.0[0].absolute == 0.0);
        rows.see("file", "w", wrong, 1.0, &Value::Null);
        rows.see("file", "w", 1.0, 1.0, &Value::Null);
        assert!(!holds(&rows) && rows.0.len() == 1 && rows.0[0].absolute > TOLERANCE, "{wrong}");
    }
}

#[test]
fn waves_of_every_profile_occur_with_one_peak_and_with_several() {
    let mut found = std::collections::BTreeSet::new();
    for text in [include_str!("../fixtures/widget_triangle.json"), include_str!("../fixtures/widget_sine.json")] {
        let file: Value = serde_json::from_str(text).expect("an extract is JSON");
        for case in file["cases"].as_array().into_iter().flatten() {
            let [front, back] = ["phase_f", "phase_b"].map(|end| case[end].as_f64().expect("a phase"));
            // Peaks lie at the half-integers.
            let peaks = (front.max(back) - 0.5).ceil() - (front.min(back) - 0.5).floor() - 1.0;
            found.insert((case["profile"].as_str().expect("a profile").to_owned(), peaks > 1.0));
        }
    }
    let all = ["abs_sine", "sine_squared", "triangle"].map(String::from);
    let expected = all.into_iter().flat_map(|profile| [(profile.clone(), false), (profile, true)]);
    assert_eq!(found, expected.collect());
}
