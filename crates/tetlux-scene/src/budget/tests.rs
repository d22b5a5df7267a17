use tetlux_optics::transfer::{ColorNode, OpacityNode};

use super::*;

/// Grey of these values at the scalars 0, 1, 2 ..., under an opacity that falls from 1 at 0 to nothing at the last but one.
fn grey(values: &[f64]) -> TransferFunction {
    let color = values.iter().enumerate().map(|(s, &v)| ColorNode { s: s as f64, rgb: [v; 3] });
    let last = values.len() as f64 - 1.0;
    let opacity = [(0.0, 1.0), (last - 1.0, 0.0), (last, 0.0)].map(|(s, opacity)| OpacityNode { s, opacity });
    TransferFunction::new(color.collect(), opacity.to_vec()).unwrap()
}

/// Two segments of depth x, one bright and one dark, in either order: the colours are 1 - e^-x and e^-x (1 - e^-x).
#[test]
fn a_swap_of_two_cells_is_within_the_bound_of_a_wrong_order() {
    for x in [1e-3, 0.05, 0.5, 2.0, 9.0] {
        let alpha = 1.0 - f64::exp(-x);
        let swapped = alpha - f64::exp(-x) * alpha;
        let bound = of_wrong_order(2.0 * x, 1.0);
        assert!(swapped <= bound, "{x}: {swapped:.2e} is more than {bound:.2e}");
        // For thin ones the bound is x^2 / 2 of twice the depth: twice what two cells can do.
        assert!(x > 0.1 || bound < 2.1 * swapped, "{x}: {bound:.2e} for {swapped:.2e}");
        assert_eq!(of_wrong_order(2.0 * x, 0.5), 0.5 * bound);
    }
    assert_eq!(of_wrong_order(f64::INFINITY, 0.25), 0.25);
    assert_eq!(of_wrong_order(1.0, 0.0), 0.0);
}

#[test]
fn the_spread_within_cells_is_that_of_what_is_seen_and_no_more_than_a_piece() {
    // The last piece, from 0 to 1, is not seen.
    let function = grey(&[0.0, 0.2, 0.5, 0.0, 1.0]);
    assert!((spread_within_cells(&function, 0.5) - 0.25).abs() < 1e-15, "half of the steepest");
    assert_eq!(spread_within_cells(&function, 10.0), 0.5);
    assert_eq!(spread_within_cells(&function, 0.0), 0.0);
}

#[test]
fn the_largest_term_is_blamed_and_its_remedy_told() {
    let mut stated = Stated::default();
    stated.add("rounding", 1e-5, "by single precision".into(), "wait".into());
    stated.add("order", 2e-3, "none may swap".into(), "use --order exact".into());
    assert_eq!(stated.total(), Some(1e-5 + 2e-3));
    assert_eq!(stated.shortfall(1e-2), None);
    let warning = stated.shortfall(1e-3).unwrap();
    assert!(warning.contains("1.0e-3") && warning.contains("order") && warning.contains("--order exact"), "{warning}");
    stated.terms.push(Term { what: "target", error: None, why: "rgba8".into(), remedy: "leave it out".into() });
    assert_eq!(stated.total(), None);
    assert!(stated.shortfall(1.0).unwrap().contains("leave it out"));
    assert!(stated.to_string().starts_with("not bounded:"), "{stated}");
}

#[test]
fn steps_where_something_is_seen_are_told() {
    let node = |s, opacity| OpacityNode { s, opacity };
    let color = |s, v| ColorNode { s, rgb: [v; 3] };
    let steps = |colors: &[ColorNode], opacities: &[OpacityNode]| {
        steepness(&TransferFunction::new(colors.to_vec(), opacities.to_vec()).unwrap(), [0.0, 1.0], 1.0).1
    };
    let plain = [color(0.0, 0.0), color(1.0, 1.0)];
    assert!(!steps(&plain, &[node(0.0, 0.0), node(1.0, 1.0)]));
    assert!(steps(&plain, &[node(0.5, 0.0), node(0.5, 1.0)]));
    assert!(!steps(&plain, &[node(1.5, 0.0), node(1.5, 1.0)]), "no data has it");
    let jump = [color(0.5, 0.0), color(0.5, 1.0)];
    assert!(steps(&jump, &[node(0.0, 1.0)]));
    assert!(!steps(&jump, &[node(0.0, 1.0), node(0.25, 0.0)]), "nothing is seen there");
}
