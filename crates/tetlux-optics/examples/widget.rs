//! What one ray segment through two widgets, a Gaussian and a banded wave, emits and lets through.
#![expect(clippy::print_stdout, reason = "an example shows its result")]

use tetlux_optics::emission::EmissionConvention;
use tetlux_optics::widget::{BivariateFunction, Rectangle, Shape, WaveProfile, Widget, WidgetError};
use tetlux_optics::widget_integral::{RaySegment, bivariate_segment, widget_integral};

fn main() -> Result<(), WidgetError> {
    let core = Widget::new(Shape::Gaussian { center: [0.6, 0.3], sigma: [0.1, 0.2] }, None, 8.0, [1.0, 0.7, 0.2])?;
    let wave = Shape::Wave { profile: WaveProfile::SineSquared, frequency: [12.0, 0.0], offset: 0.0 };
    let low_gradient = Rectangle { s: [0.0, 1.0], g: [0.0, 0.5] };
    let bands = Widget::new(wave, Some(low_gradient), 1.5, [0.1, 0.3, 0.9])?;

    // The value rises from 0.2 to 0.9 from front to back, the gradient falls, over two world units.
    let ray = RaySegment { front: [0.2, 0.8], back: [0.9, 0.1], length: 2.0 };
    for (name, widget) in [("gaussian", &core), ("bands", &bands)] {
        let exact = widget_integral(widget, 1.0, &ray);
        println!(
            "{name}: optical depth {:.6}, alpha {:.6}, w_b {:.6}, w_f {:.6}",
            exact.optical_depth, exact.alpha, exact.back, exact.front
        );
    }

    let function = BivariateFunction { widgets: vec![core, bands] };
    for pieces in [4, 16, 64, 256] {
        let both = bivariate_segment(&function, 1.0, &ray, pieces, EmissionConvention::EmissionAbsorption);
        println!("both, {pieces:3} pieces: alpha {:.6}, colour {:.6?}", both.alpha, both.color);
    }
    Ok(())
}
