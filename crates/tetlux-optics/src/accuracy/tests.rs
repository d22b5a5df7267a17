use super::*;
use crate::segment_f32::weights_direct;

#[test]
fn the_measure_sees_a_planted_difference() {
    let set = &SETS[4];
    let good = measure(set, 100, weights_direct);
    assert!(good.relative <= 1e-5 && good.absolute <= 2e-6 && good.not_finite == 0.0);
    for index in 0..3 {
        for wrong in [1.0 + 3e-5, f32::NAN, f32::INFINITY, 0.0] {
            let seen = std::cell::Cell::new(0);
            let bad = measure(set, 100, |a, b| {
                let mut result = weights_direct(a, b);
                // One of the hundred is wrong.
                seen.set(seen.get() + 1);
                if seen.get() == 50 {
                    result[index] *= wrong;
                }
                result
            });
            assert!(bad.relative > 1e-5, "{wrong}: {bad:?}");
            assert!(wrong.is_finite() || (bad.absolute.is_infinite() && (bad.not_finite - 0.01).abs() < 1e-9));
        }
    }
}

#[test]
fn sets_are_repeatable_and_keep_their_names_promise() {
    for set in &SETS {
        let points: Vec<_> = set.points(1000).collect();
        assert!(points.iter().copied().eq(set.points(1000)) && points.len() == 1000);
        assert!(points.iter().all(|&(a, b)| a >= 0.0 && b >= 0.0 && a + b > 0.0 && (a + b).is_finite()));
    }
    assert!(SETS[2].points(100).all(|(a, b)| a == b));
    assert!(SETS[5].points(100).all(|(a, b)| a > 9e3 * b && b > 0.0));
}

#[test]
fn not_a_number_is_the_largest_error() {
    assert_eq!(relative_error(1.0, 1.0), 0.0);
    assert_eq!(relative_error(1.5, 1.0), 0.5);
    assert_eq!(relative_error(0.0, 0.0), 0.0);
    assert_eq!(relative_error(f64::NAN, 1.0), f64::INFINITY);
    assert_eq!(relative_error(1.0, f64::NAN), f64::INFINITY);
    assert_eq!(relative_error(1.0, 0.0), f64::INFINITY);
}
