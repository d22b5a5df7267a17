//! Factors by their definitions, on fields whose boundaries and contours are known.

use super::*;

/// Roundings of a few functions of numbers of the order of one.
const ROUNDING: f64 = 1e-12;

const SCALES: Scales = Scales { gradient: 2.0, second: 1.0, diagonal: 10.0 };

fn steep(range: Option<[f64; 2]>, power: f64) -> Emphasis {
    Emphasis { gradient: Some(Steepness { range, power }), ..Emphasis::default() }
}

fn boundary(sigma: Option<f64>, width: Option<f64>, threshold: f64) -> Emphasis {
    Emphasis { boundary: Some(Boundary { sigma, width, threshold }), ..Emphasis::default() }
}

fn at(value: f64, gradient: f64, second: f64) -> Derivatives {
    Derivatives { value, gradient, second }
}

/// A step from 0 to 1 at 0, blurred: value, first and second derivative at a place.
fn blurred(x: f64, sigma: f64) -> Derivatives {
    let density = (-0.5 * (x / sigma).powi(2)).exp() / (sigma * std::f64::consts::TAU.sqrt());
    // The value does not matter here.
    at(0.5, density, -x / (sigma * sigma) * density)
}

#[test]
fn steep_places_by_their_share_of_the_range() {
    let whole = steep(None, 1.0).fit(&SCALES).unwrap();
    assert_eq!([0.0, 0.5, 1.0, 2.0, 3.0].map(|g| whole.factor(&at(0.0, g, 0.0))), [0.0, 0.25, 0.5, 1.0, 1.0]);
    let part = steep(Some([0.5, 1.5]), 2.0).fit(&SCALES).unwrap();
    assert_eq!([0.5, 1.0, 1.5].map(|g| part.factor(&at(0.0, g, 0.0))), [0.0, 0.25, 1.0]);
    // Of a field without gradients nothing is left.
    let flat = steep(None, 1.0).fit(&Scales::default()).unwrap();
    assert_eq!(flat.factor(&at(0.0, 0.0, 0.0)), 0.0);
}

#[test]
fn a_contour_by_the_distance_from_it() {
    let contour = Emphasis { contour: Some(Contour { value: 3.0, width: 0.5 }), ..Emphasis::default() };
    let contour = contour.fit(&SCALES).unwrap();
    // s = 2 x: half a unit of s is a quarter of a unit of length.
    for (s, expected) in [(3.0, 1.0), (2.5, 0.5), (3.5, 0.5), (4.0, 0.0), (9.0, 0.0)] {
        assert_eq!(contour.factor(&at(s, 2.0, 0.0)), expected, "{s}");
    }
    assert_eq!([3.0, 3.1].map(|s| contour.factor(&at(s, 0.0, 0.0))), [1.0, 0.0], "a field that does not change");
}

#[test]
fn the_distance_to_a_blurred_step_is_exact_anywhere_on_it() {
    let sigma = 0.7;
    // As the field's own derivatives say it: the second is the largest at sigma from the middle.
    let scales =
        Scales { gradient: blurred(0.0, sigma).gradient, second: blurred(sigma, sigma).second.abs(), diagonal: 10.0 };
    for given in [None, Some(sigma)] {
        let fitted = boundary(given, Some(2.0), 0.0).fit(&scales).unwrap();
        for x in [-2.5, -2.0, -1.0, -0.1, 0.0, 0.3, 1.9, 3.0] {
            let expected = (1.0 - f64::abs(x) / 2.0).max(0.0);
            let found = fitted.factor(&blurred(x, sigma));
            assert!((found - expected).abs() < ROUNDING, "{found} for {expected} at {x}");
        }
    }
    // The width is sigma unless another is given.
    let fitted = boundary(None, None, 0.0).fit(&scales).unwrap();
    assert!((fitted.factor(&blurred(0.5 * sigma, sigma)) - 0.5).abs() < ROUNDING);
}

#[test]
fn what_is_flatter_than_the_threshold_is_no_boundary() {
    let fitted = boundary(Some(1.0), Some(1.0), 0.25).fit(&SCALES).unwrap();
    // A quarter of 2; the position is found from what is above.
    assert_eq!([0.4, 0.5].map(|g| fitted.factor(&at(0.0, g, 0.0))), [0.0, 0.0]);
    assert_eq!(fitted.factor(&at(0.0, 1.5, 0.5)), 0.5);
    assert_eq!(fitted.factor(&at(0.0, 1.5, 0.0)), 1.0);
}

#[test]
fn silhouettes_by_the_angle_with_the_view() {
    let fitted = Emphasis { silhouette: Some(2.0), ..Emphasis::default() }.fit(&SCALES).unwrap();
    let factor = |gradient| fitted.silhouette_factor(gradient, [0.0, 0.0, 1.0]);
    assert_eq!(factor([0.0, 0.0, -3.0]), 0.0);
    assert_eq!(factor([1e-200, 0.0, 0.0]), 1.0);
    assert!((factor([3.0, 0.0, 4.0]) - 0.04).abs() < ROUNDING);
    assert_eq!(factor([0.0; 3]), 1.0, "no gradient, no surface");
    assert_eq!(factor([f64::NAN, 0.0, 0.0]), 1.0);
}

#[test]
fn factors_multiply() {
    let both = Emphasis { contour: Some(Contour { value: 0.0, width: 2.0 }), ..steep(Some([0.0, 4.0]), 1.0) };
    assert_eq!(both.fit(&SCALES).unwrap().factor(&at(1.0, 1.0, 0.0)), 0.25 * 0.5);
    assert_eq!(Emphasis::default().fit(&SCALES).unwrap().factor(&at(1.0, 1.0, 0.0)), 1.0);
}

#[test]
fn every_factor_is_finite_and_at_most_1() {
    let values = [0.0, 1.0, -1.0, 1e-310, 1e308, -1e308, f64::INFINITY, f64::NEG_INFINITY, f64::NAN];
    let scales = [0.0, 1e-310, 1.0, 1e308, f64::INFINITY, f64::NAN];
    let all = Emphasis {
        contour: Some(Contour { value: 1e308, width: 1e-300 }),
        silhouette: Some(3.0),
        boundary: Some(Boundary { sigma: None, width: None, threshold: 0.01 }),
        ..steep(None, 0.5)
    };
    for gradient in scales {
        for second in scales {
            for part in [all, steep(None, 0.0), boundary(None, None, 0.5), boundary(Some(1e300), Some(1e-300), 0.0)] {
                let fitted = part.fit(&Scales { gradient, second, diagonal: 1.0 }).unwrap();
                for value in values {
                    for slope in values {
                        for bend in values {
                            let factor = fitted.factor(&at(value, slope, bend));
                            assert!((0.0..=1.0).contains(&factor), "{fitted:?} {value} {slope} {bend}: {factor}");
                        }
                    }
                }
            }
        }
    }
}

#[test]
fn impossible_numbers_are_named() {
    let contour = |value, width| Emphasis { contour: Some(Contour { value, width }), ..Emphasis::default() };
    let silhouette = |power| Emphasis { silhouette: Some(power), ..Emphasis::default() };
    for (emphasis, member, key) in [
        (steep(Some([-1.0, 1.0]), 1.0), "gradient", "range"),
        (steep(Some([1.0, 1.0]), 1.0), "gradient", "range"),
        (steep(Some([0.0, f64::INFINITY]), 1.0), "gradient", "range"),
        (steep(None, f64::NAN), "gradient", "power"),
        (contour(f64::NAN, 1.0), "contour", "value"),
        (contour(0.0, 0.0), "contour", "width"),
        (boundary(Some(0.0), None, 0.0), "boundary", "sigma"),
        (boundary(None, Some(-1.0), 0.0), "boundary", "width"),
        (boundary(None, None, 1.0), "boundary", "threshold"),
        (silhouette(-1.0), "silhouette", "power"),
    ] {
        let error = emphasis.check().unwrap_err();
        assert_eq!((error.member, error.key), (member, key), "{error}");
        assert_eq!(emphasis.fit(&SCALES).unwrap_err().key, key);
    }
}

#[test]
fn what_is_emphasised_is_said() {
    let all = Emphasis {
        contour: Some(Contour { value: 0.5, width: 0.25 }),
        boundary: Some(Boundary { sigma: Some(0.5), width: None, threshold: 0.0 }),
        silhouette: Some(2.0),
        ..steep(None, 1.0)
    };
    let said = all.fit(&SCALES).unwrap().to_string();
    assert!(
        ["gradient from 0", "to 2", "contour 0.5", "sigma 5.000e-1", "power 2"].iter().all(|w| said.contains(w)),
        "{said}"
    );
}
