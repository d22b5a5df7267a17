use super::*;
use crate::accuracy::relative_error;

/// A few dozen roundings.
const TOLERANCE: f64 = 1e-13;

fn worst(span: Span, expected: Span) -> f64 {
    let pairs = [
        (span.width, expected.width),
        (span.depth, expected.depth),
        (span.alpha, expected.alpha),
        (span.visible, expected.visible),
        (span.back, expected.back),
        (span.front, expected.front),
    ];
    pairs.into_iter().map(|(value, expected)| relative_error(value, expected)).fold(0.0, f64::max)
}

#[test]
fn parts_of_a_linear_ramp_compose_to_the_whole() {
    for (a, b) in [(1e-9, 3e-9), (2.0, 0.5), (0.0, 30.0), (500.0, 1.0), (1e5, 1e4)] {
        // At a quarter of the way the extinction is (3 b + a) / 4; all numbers are exact.
        let cut = 0.75 * b + 0.25 * a;
        let parts = Span::linear(0.25, 0.25 * cut, 0.25 * b).then(Span::linear(0.75, 0.75 * a, 0.75 * cut));
        assert!(worst(parts, Span::linear(1.0, a, b)) < TOLERANCE, "{a} {b}: {parts:?}");
    }
}

#[test]
fn quadrature_and_closed_form_agree_on_ramps() {
    for (a, b) in
        [(0.0, 0.0), (1e-9, 3e-9), (2.0, 0.5), (0.0, 30.0), (500.0, 1.0), (1e5, 1e4), (1e12, 0.0), (0.0, 1e12)]
    {
        let rate = |x: f64| b * (1.0 - x) + a * x;
        let depth = |x0: f64, x1: f64| (x1 - x0) * rate(0.5 * (x0 + x1));
        let summed = Span::by_quadrature(0.5, rate, depth, |_, _| true);
        assert!(worst(summed, Span::linear(0.5, a, b)) < TOLERANCE, "{a} {b}: {summed:?}");
    }
}

#[test]
fn repeating_is_composing() {
    let part = Span::linear(0.125, 0.3, 0.1).then(Span::linear(0.125, 0.1, 0.7));
    let four = part.then(part).then(part).then(part);
    assert!(worst(part.repeated(4), four) < TOLERANCE);
    assert!(worst(part.repeated(5), four.then(part)) < TOLERANCE);
    assert_eq!(part.repeated(0), Span::empty(0.0));
    // A million thin parts of constant extinction are one.
    let thin = Span::linear(1e-6, 3e-6, 3e-6).repeated(1_000_000);
    // Width and depth of a part are rounded.
    assert!(worst(thin, Span::linear(1.0, 3.0, 3.0)) < 1e-13, "{thin:?}");
}

#[test]
fn the_comparison_sees_a_planted_difference() {
    let good = Span::linear(1.0, 3.0, 2.0);
    for index in 0..6 {
        let mut bad = good;
        let fields = [&mut bad.width, &mut bad.depth, &mut bad.alpha, &mut bad.visible, &mut bad.back, &mut bad.front];
        *fields.into_iter().nth(index).unwrap() *= 1.0 + 1e-12;
        assert!(worst(bad, good) > TOLERANCE);
    }
}
