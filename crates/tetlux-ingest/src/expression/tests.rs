use proptest::prelude::*;

use super::*;

fn at(text: &str, point: [f64; 3]) -> f64 {
    Expression::parse(text).unwrap().value(point.into())
}

#[test]
fn operators_bind_as_in_mathematics() {
    for (text, value) in [
        ("1 - 2 - 3", -4.0),
        ("2 + 3*4", 14.0),
        ("(2 + 3)*4", 20.0),
        ("12/3/2", 2.0),
        ("2^3^2", 512.0),
        ("-2^2", -4.0),
        ("2^-1", 0.5),
        ("2*-3", -6.0),
        ("--3", 3.0),
        ("+3 - +2", 1.0),
        ("1e2 + 1.5E-1 + .5 + 2.", 102.65),
        ("2*pi", std::f64::consts::TAU),
    ] {
        assert_eq!(at(text, [0.0; 3]), value, "{text}");
    }
}

#[test]
fn names_are_coordinates_and_functions() {
    let p = [0.5, -2.0, 3.0];
    for (text, value) in [
        ("x+10*y+100*z", 280.5),
        ("sin(x)", 0.5f64.sin()),
        ("cos(x)", 0.5f64.cos()),
        ("tan(x)", 0.5f64.tan()),
        ("exp(x)", 0.5f64.exp()),
        ("log(z)", 3f64.ln()),
        ("sqrt(z)", 3f64.sqrt()),
        ("abs(y)", 2.0),
        ("min(x, max(y, z))", 0.5),
        ("pow(y, 3)", -8.0),
    ] {
        assert_eq!(at(text, p), value, "{text}");
    }
    assert!(at("log(y)", p).is_nan());
    let formula = Expression::parse("x*y").unwrap();
    assert_eq!(formula.values(&[DVec3::new(1.0, 2.0, 0.0), DVec3::new(3.0, 4.0, 0.0)]), [2.0, 12.0]);
}

#[test]
fn errors_name_the_column() {
    for (text, column, part) in [
        ("", 1, "the end"),
        ("x +", 4, "the end"),
        ("x + * y", 5, "\"*\""),
        ("(x", 3, "\")\""),
        ("x)", 2, "\")\""),
        ("sinus(x)", 1, "sinus"),
        ("sin x", 5, "\"(\""),
        ("min(x)", 6, "\",\""),
        ("sin(x, y)", 6, "\")\""),
        ("2 x", 3, "operator"),
        ("é", 1, "é"),
        ("x é", 3, "é"),
        ("1e", 2, "\"e\""),
        (".", 1, "number"),
    ] {
        let error = Expression::parse(text).unwrap_err();
        assert_eq!(error.column, column, "{error}");
        assert!(error.to_string().contains(part), "{error}");
    }
}

#[test]
fn nesting_is_bounded_and_length_is_not() {
    for text in ["(".repeat(100_000), "-".repeat(100_000) + "x", "2^".repeat(100_000) + "x", "sin(".repeat(100_000)] {
        assert!(Expression::parse(&text).unwrap_err().expected.contains("nest"));
    }
    let nested = format!("{}x{}", "(".repeat(60), ")".repeat(60));
    assert_eq!(at(&nested, [7.0, 0.0, 0.0]), 7.0);
    assert_eq!(at(&("1+".repeat(100_000) + "1"), [0.0; 3]), 100_001.0);
}

proptest! {
    #![proptest_config(crate::damage::config())]

    #[test]
    fn no_text_panics(text in "[-+*/^(),. 0-9a-z\u{e9}]{0,40}") {
        if let Ok(formula) = Expression::parse(&text) {
            formula.value(DVec3::ONE);
        }
    }

    #[test]
    fn sums_of_products_are_those_of_rust(a in -9.0..9.0, b in -9.0..9.0, c in 0.1..9.0) {
        prop_assert_eq!(at("x*y - x/z + -y*(x - z)", [a, b, c]), a * b - a / c + -b * (a - c));
    }
}
