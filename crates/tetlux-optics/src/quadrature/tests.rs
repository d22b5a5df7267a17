use super::*;
use crate::accuracy::relative_error;

#[test]
fn the_quadrature_is_exact_for_its_degree() {
    // Twenty nodes integrate u^k over [0, 1] exactly up to k = 39.
    for power in 0..40 {
        let [sum] = gauss(0.0, 1.0, |u| [u.powi(power)]);
        let exact = 1.0 / f64::from(power + 1);
        // Rounding of nodes, grown by the power.
        assert!(relative_error(sum, exact) < 1e-14, "u^{power}: {sum}");
    }
    let [sum] = gauss(0.0, 1.0, |u| [u.powi(60)]);
    assert!(relative_error(sum, 1.0 / 61.0) > 1e-14, "twenty nodes cannot have this");
}

#[test]
fn parts_cover_the_interval_in_order() {
    let mut parts = Vec::new();
    let whole = bisect(0.0, 1.0, &|from, to| to - from <= 0.1 + from, &mut |from, to| {
        parts.push([from, to]);
        true
    });
    assert!(whole && parts[0][0] == 0.0 && parts[parts.len() - 1][1] == 1.0 && parts.len() > 2);
    assert!(parts.windows(2).all(|pair| pair[0][1] == pair[1][0]));
    let mut seen = 0;
    let stopped = !bisect(0.0, 1.0, &|from, to| to - from <= 0.1, &mut |_, to| {
        seen += 1;
        to < 0.5
    });
    assert!(stopped && seen == 8);
    // What never fits ends where no number lies between.
    assert!(bisect(1.0, 1.0 + 4.0 * f64::EPSILON, &|_, _| false, &mut |_, _| true));
}
