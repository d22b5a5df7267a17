use errorfunctions::RealErrorFunctions;
use proptest::prelude::*;

use super::*;
use crate::accuracy::{Random, relative_error};
use crate::quadrature::gauss;

#[test]
fn stated_errors_hold() {
    let (mut worst_erf, mut worst_erfc) = (0.0_f64, 0.0_f64);
    for k in -9000..=9000 {
        let x = k as f32 / 1000.0;
        worst_erf = worst_erf.max(relative_error(f64::from(erf(x)), RealErrorFunctions::erf(f64::from(x))));
        worst_erfc = worst_erfc.max(relative_error(f64::from(erfc(x)), RealErrorFunctions::erfc(f64::from(x))));
    }
    println!("erf {worst_erf:.1e}, erfc {worst_erfc:.1e}");
    assert!(worst_erf < 4e-7, "erf {worst_erf:e}");
    assert!(worst_erfc < 1.2e-5, "erfc {worst_erfc:e}");
}

/// The mean by quadrature in f64, of positive terms.
fn mean(t0: f64, t1: f64) -> f64 {
    let parts = ((t1 - t0) * t0.abs().max(t1.abs()).max(1.0)).ceil().max(1.0) as usize;
    let at = |k: usize| t0 + (t1 - t0) * k as f64 / parts as f64;
    (0..parts).map(|k| gauss(at(k), at(k + 1), |t| [(-t * t).exp() / (t1 - t0)])[0]).sum()
}

#[test]
fn the_mean_keeps_its_digits_wherever_it_has_any() {
    let mut random = Random::new(7);
    let mut worst = 0.0_f64;
    for _ in 0..20_000 {
        let t0 = (16.0 * random.unit() - 8.0) as f32;
        let t1 = t0 + random.decades(-6.0, 1.0);
        if t1 > t0 {
            let exact = mean(f64::from(t0), f64::from(t1));
            if exact > 1e-30 {
                worst = worst.max(relative_error(f64::from(gaussian_mean(t0, t1)), exact));
            }
        }
    }
    println!("mean {worst:.1e}");
    // exp(-t^2) of a rounded t^2 of up to 64.
    assert!(worst < 1.2e-5, "{worst:e}");
}

proptest! {
    #[test]
    fn nothing_but_a_share_comes_out(t0 in -1e9_f32..1e9, span in 0.0_f32..1e9) {
        let mean = gaussian_mean(t0, t0 + span);
        prop_assert!((0.0..=1.0 + 1e-6).contains(&mean), "{mean}");
        prop_assert!((-1.0..=1.0).contains(&erf(t0)) && (0.0..=2.0).contains(&erfc(t0)));
    }
}
