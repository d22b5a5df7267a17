//! A plot of curves on two logarithmic axes, as SVG.

use std::fmt::Write;

/// A named sequence of points with positive coordinates.
pub(super) struct Curve {
    pub(super) name: String,
    pub(super) points: Vec<[f64; 2]>,
}

const WIDTH: f64 = 760.0;
const HEIGHT: f64 = 460.0;
/// Left, top, right and bottom of the area of the curves.
const AREA: [f64; 4] = [80.0, 20.0, 500.0, 400.0];
/// Told apart by people with any colour vision (Okabe and Ito).
const COLORS: [&str; 6] = ["#d55e00", "#0072b2", "#009e73", "#cc79a7", "#e69f00", "#56b4e9"];

/// The plot; the curves are named at their ends. Grid lines at decades in y and at the first curve's values in x.
pub(super) fn log_log(x_label: &str, y_label: &str, curves: &[Curve]) -> String {
    let bounds = |axis: usize| {
        let values = || curves.iter().flat_map(|curve| &curve.points).map(move |point| point[axis].log10());
        [values().fold(f64::INFINITY, f64::min), values().fold(f64::NEG_INFINITY, f64::max)]
    };
    let [x_low, x_high] = bounds(0);
    let [y_low, y_high] = [bounds(1)[0].floor(), bounds(1)[1].ceil()];
    let [left, top, right, bottom] = AREA;
    let x = |value: f64| left + (value.log10() - x_low) / (x_high - x_low) * (right - left);
    let y = |value: f64| bottom - (value.log10() - y_low) / (y_high - y_low) * (bottom - top);

    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH} {HEIGHT}\" font-family=\"sans-serif\" \
         font-size=\"13\">\n<rect width=\"{WIDTH}\" height=\"{HEIGHT}\" fill=\"white\"/>\n"
    );
    for decade in y_low as i32..=y_high as i32 {
        let at = y(10.0_f64.powi(decade));
        line(&mut svg, [left, at, right, at]);
        text(&mut svg, [left - 8.0, at + 4.0], "end", &format!("1e{decade}"), "black");
    }
    for point in curves.first().map_or(&[][..], |curve| &curve.points) {
        let at = x(point[0]);
        line(&mut svg, [at, top, at, bottom]);
        text(&mut svg, [at, bottom + 18.0], "middle", &point[0].to_string(), "black");
    }
    text(&mut svg, [0.5 * (left + right), bottom + 42.0], "middle", x_label, "black");
    let middle = 0.5 * (top + bottom);
    writeln!(
        svg,
        "<text transform=\"translate(20 {middle}) rotate(-90)\" text-anchor=\"middle\">{}</text>",
        escape(y_label)
    )
    .ok();
    let mut lowest_label = f64::INFINITY;
    // From the bottom up, so that names of curves that end close together are moved apart upwards.
    let mut order: Vec<usize> = (0..curves.len()).collect();
    let end = |index: usize| curves[index].points.last().map_or(bottom, |point| y(point[1]));
    order.sort_by(|&i, &j| end(j).total_cmp(&end(i)));
    for index in order {
        let color = COLORS[index % COLORS.len()];
        let points: Vec<String> =
            curves[index].points.iter().map(|point| format!("{:.1},{:.1}", x(point[0]), y(point[1]))).collect();
        writeln!(
            svg,
            "<polyline points=\"{}\" fill=\"none\" stroke=\"{color}\" stroke-width=\"2\"/>",
            points.join(" ")
        )
        .ok();
        lowest_label = end(index).min(lowest_label - 16.0);
        text(&mut svg, [right + 8.0, lowest_label + 4.0], "start", &curves[index].name, color);
    }
    svg += "</svg>\n";
    svg
}

fn line(svg: &mut String, [x0, y0, x1, y1]: [f64; 4]) {
    writeln!(svg, "<line x1=\"{x0:.1}\" y1=\"{y0:.1}\" x2=\"{x1:.1}\" y2=\"{y1:.1}\" stroke=\"#dddddd\"/>").ok();
}

fn text(svg: &mut String, [x, y]: [f64; 2], anchor: &str, words: &str, color: &str) {
    let words = escape(words);
    writeln!(svg, "<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"{anchor}\" fill=\"{color}\">{words}</text>").ok();
}

fn escape(words: &str) -> String {
    words.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_lie_where_their_logarithms_say() {
        let curve = Curve { name: "a < b".to_owned(), points: vec![[10.0, 1e-2], [100.0, 1e-3], [1000.0, 1e-4]] };
        let svg = log_log("x", "y", &[curve]);
        let [left, top, right, bottom] = AREA;
        let (x, y) = (0.5 * (left + right), 0.5 * (top + bottom));
        let expected = format!("points=\"{left:.1},{top:.1} {x:.1},{y:.1} {right:.1},{bottom:.1}\"");
        assert!(svg.contains(&expected), "{svg}");
        assert!(svg.contains("a &lt; b") && svg.contains("1e-3"));
    }
}
