use super::*;
use crate::accuracy::Random;
use crate::emission;
use crate::widget::{BivariateFunction, Shape};
use crate::widget_f32::widgets;
use crate::widget_integral::{RaySegment, bivariate_segment};

#[test]
fn density_weights_are_those_of_f64() {
    let mut random = Random::new(4);
    let mut worst = 0.0_f64;
    for _ in 0..5000 {
        let (a, b) = (random.decades(-6.0, 4.0), random.decades(-6.0, 4.0));
        let exact = emission::density_weights(f64::from(a), f64::from(b));
        let [m_b, m_f] = density_weights(a, b).map(f64::from);
        worst = worst.max((m_b - exact.back).abs()).max((m_f - exact.front).abs());
    }
    println!("largest error {worst:.1e}");
    assert!(worst < 1e-5, "{worst:e}");
}

#[test]
fn more_pieces_come_closer_and_few_oversee_a_peak() {
    let bell = Shape::Gaussian { center: [0.5; 2], sigma: [0.03; 2] };
    let bell = crate::widget::Widget::new(bell, None, 20.0, [1.0, 0.5, 0.0]).unwrap();
    let function = BivariateFunction { widgets: vec![bell] };
    let device = widgets(&function, [[0.0, 1.0]; 2], 1.0);
    for convention in [EmissionConvention::EmissionAbsorption, EmissionConvention::EmissionDensity] {
        let ray = RaySegment { front: [0.0; 2], back: [1.0; 2], length: 1.0 };
        let exact = bivariate_segment(&function, 1.0, &ray, 4000, convention);
        let error = |count| {
            let got = integrate(|p| classify_widgets(&device, p), [0.0; 2], [1.0; 2], 1.0, count, convention);
            (f64::from(got[3]) - exact.alpha).abs()
        };
        // Three pieces sample at 1/3 and 2/3, eight sigma away: nothing is seen.
        assert!((error(3) - exact.alpha).abs() < 1e-6);
        assert!(error(10) > error(40) && error(40) > error(400));
        assert!(error(400) < 1e-4);
    }
}
