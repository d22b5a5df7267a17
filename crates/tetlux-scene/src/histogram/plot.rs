//! A histogram with axes, as SVG.

use std::fmt::Write;

use tetlux_optics::Classification;
use tetlux_optics::widget::Shape;

use super::Histogram;

/// Size of the picture and the margins left and below, in SVG units.
const SIZE: [f64; 2] = [480.0, 360.0];
const LEFT: f64 = 90.0;
const TOP: f64 = 16.0;
const BELOW: f64 = 56.0;

impl Histogram {
    /// The picture (as PNG bytes) with axes named by the fields, and the outlines of widgets: their rectangles, and
    /// Gaussians at one and two sigma.
    pub fn plot(&self, png: &[u8], classification: &Classification, names: [&str; 2]) -> String {
        let [width, height] = SIZE;
        let mut svg = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {} {}\" font-family=\"sans-serif\" \
             font-size=\"13\">\n<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n\
             <clipPath id=\"inside\"><rect x=\"{LEFT}\" y=\"{TOP}\" width=\"{width}\" height=\"{height}\"/></clipPath>\n\
             <image x=\"{LEFT}\" y=\"{TOP}\" width=\"{width}\" height=\"{height}\" preserveAspectRatio=\"none\" \
             href=\"data:image/png;base64,{}\"/>\n",
            LEFT + width + 24.0,
            TOP + height + BELOW,
            base64(png)
        );
        // Writing to a string cannot fail.
        for k in 0..=4 {
            let share = f64::from(k) / 4.0;
            let [x, y] = [0, 1].map(|axis| {
                let [low, high] = self.range[axis];
                number(low + (high - low) * share)
            });
            let (at_x, at_y) = (LEFT + width * share, TOP + height * (1.0 - share));
            writeln!(svg, "<text x=\"{at_x:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{x}</text>", TOP + height + 18.0)
                .ok();
            writeln!(svg, "<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">{y}</text>", LEFT - 6.0, at_y + 4.0).ok();
        }
        let [x_name, y_name] = names.map(|name| name.replace('&', "&amp;").replace('<', "&lt;"));
        let (middle, bottom) = (LEFT + 0.5 * width, TOP + height + 42.0);
        writeln!(svg, "<text x=\"{middle:.1}\" y=\"{bottom:.1}\" text-anchor=\"middle\">{x_name}</text>").ok();
        let turn = TOP + 0.5 * height;
        writeln!(
            svg,
            "<text x=\"16\" y=\"{turn:.1}\" text-anchor=\"middle\" transform=\"rotate(-90 16 {turn:.1})\">{y_name}</text>"
        )
        .ok();
        if let Classification::Widgets(function) = classification {
            svg += "<g fill=\"none\" stroke=\"white\" clip-path=\"url(#inside)\">\n";
            for widget in &function.widgets {
                self.outline(&mut svg, widget);
            }
            svg += "</g>\n";
        }
        svg += "</svg>\n";
        svg
    }

    /// Place of a value along an axis in SVG units, held near the picture.
    fn place(&self, axis: usize, value: f64) -> f64 {
        let [low, high] = self.range[axis];
        let share = ((value - low) / (high - low)).clamp(-10.0, 10.0);
        if axis == 0 { LEFT + SIZE[0] * share } else { TOP + SIZE[1] * (1.0 - share) }
    }

    fn outline(&self, svg: &mut String, widget: &tetlux_optics::Widget) {
        if let Some(support) = widget.support() {
            let [left, right] = support.s.map(|value| self.place(0, value));
            let [bottom, top] = support.g.map(|value| self.place(1, value));
            let (width, height) = (right - left, bottom - top);
            writeln!(
                svg,
                "<rect x=\"{left:.1}\" y=\"{top:.1}\" width=\"{width:.1}\" height=\"{height:.1}\" stroke-dasharray=\"4 3\"/>"
            )
            .ok();
        }
        if let Shape::Gaussian { center, sigma } = *widget.shape() {
            let [x, y] = [0, 1].map(|axis| self.place(axis, center[axis]));
            for reach in [1.0, 2.0] {
                let [rx, ry] = [0, 1].map(|axis| {
                    let [low, high] = self.range[axis];
                    (SIZE[axis] * reach * sigma[axis] / (high - low)).min(1e4)
                });
                writeln!(svg, "<ellipse cx=\"{x:.1}\" cy=\"{y:.1}\" rx=\"{rx:.1}\" ry=\"{ry:.1}\"/>").ok();
            }
        }
    }
}

/// A value for an axis: four digits, or a power of ten.
fn number(value: f64) -> String {
    if value == 0.0 || (1e-3..1e5).contains(&value.abs()) {
        let text = format!("{value:.4}");
        text.trim_end_matches('0').trim_end_matches('.').to_string()
    } else {
        format!("{value:.2e}")
    }
}

/// RFC 4648.
fn base64(bytes: &[u8]) -> String {
    const LETTERS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for chunk in bytes.chunks(3) {
        let byte = |k: usize| u32::from(chunk.get(k).copied().unwrap_or(0));
        let bits = byte(0) << 16 | byte(1) << 8 | byte(2);
        for k in 0..4 {
            let letter = LETTERS[(bits >> (18 - 6 * k) & 63) as usize];
            text.push(if k <= chunk.len() { char::from(letter) } else { '=' });
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use tetlux_optics::widget::{BivariateFunction, Rectangle, Widget};

    use super::*;

    #[test]
    fn base64_is_that_of_the_standard() {
        // RFC 4648, section 10.
        for (text, expected) in [("", ""), ("f", "Zg=="), ("fo", "Zm8="), ("foo", "Zm9v"), ("foobar", "Zm9vYmFy")] {
            assert_eq!(base64(text.as_bytes()), expected);
        }
    }

    #[test]
    fn outlines_lie_where_the_widgets_do() {
        let histogram = Histogram {
            volumes: vec![1.0],
            bins: [1, 1],
            range: [[0.0, 2.0], [0.0, 1.0]],
            without_data: 0.0,
            outside: 0.0,
        };
        let gaussian = Shape::Gaussian { center: [1.0, 0.25], sigma: [0.5, 0.1] };
        let support = Rectangle { s: [0.0, 1.0], g: [0.5, f64::INFINITY] };
        let widgets = vec![
            Widget::new(gaussian, None, 1.0, [1.0; 3]).unwrap(),
            Widget::new(Shape::Uniform, Some(support), 1.0, [1.0; 3]).unwrap(),
        ];
        let function = Classification::Widgets(BivariateFunction { widgets });
        let svg = histogram.plot(b"png", &function, ["a < b", "c"]);
        // The middle of x, a quarter up: 16 + 360 x 3/4; one sigma is a quarter of 480.
        assert!(svg.contains("<ellipse cx=\"330.0\" cy=\"286.0\" rx=\"120.0\" ry=\"36.0\"/>"), "{svg}");
        assert!(svg.contains("<rect x=\"90.0\" y=\"-3224.0\" width=\"240.0\""), "{svg}");
        assert!(svg.contains("a &lt; b") && svg.contains(">0.5</text>") && svg.ends_with("</svg>\n"));
    }
}
