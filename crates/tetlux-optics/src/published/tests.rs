use super::*;
use crate::accuracy::{SETS, relative_error};
use crate::segment::weights;

#[test]
fn it_is_the_same_value_where_nothing_cancels() {
    for (a, b) in [(5.0, 1.0), (1.0, 5.0), (20.0, 0.5), (3.0, 3.0), (0.0, 8.0), (8.0, 0.0)] {
        let (published, exact) = (linear_published(a, b), weights(a, b));
        for (value, expected) in
            [(published.alpha, exact.alpha), (published.back, exact.back), (published.front, exact.front)]
        {
            assert!(relative_error(value, expected) < 1e-12, "{a} {b}: {published:?} {exact:?}");
        }
    }
    assert_eq!(linear_published(0.0, 0.0), Weights { alpha: 0.0, back: 0.0, front: 0.0 });
}

#[test]
fn it_fails_where_it_must() {
    // exp(p^2) overflows from p = b / sqrt(2 (a - b)) = 26.7 on, while erf t - erf p is 0.
    assert!(linear_published(1001.0, 1000.0).back.is_nan());
    // erfi overflows likewise, and both are infinite.
    assert!(linear_published(1000.0, 1001.0).back.is_nan());
    // psi - zeta of a thin segment: 1e-17 is below the rounding of 1.
    assert!(relative_error(linear_published(2e-17, 1e-17).back, weights(2e-17, 1e-17).back) >= 1.0);
    // Half of all nearly equal inputs at least have no finite weights.
    let points: Vec<_> = SETS[1].points(2000).collect();
    let wrong = points.iter().filter(|&&(a, b)| {
        let (a, b) = (f64::from(a), f64::from(b));
        let error = relative_error(linear_published(a, b).back, weights(a, b).back);
        error > 1e-3
    });
    assert!(wrong.count() > points.len() / 2);
}
