//! A plot on two logarithmic axes, as SVG.

use std::fmt::Write;

/// A named sequence of points. Those whose coordinates are not positive have no logarithm, and are left out.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    /// Stands beside the plot in the curve's colour.
    pub name: String,
    /// x and y.
    pub points: Vec<[f64; 2]>,
    /// What is drawn.
    pub style: Style,
}

/// What is drawn of a curve.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Style {
    /// A line from point to point.
    Line,
    /// A numbered mark at each point; the name has the number, too.
    Marks,
    /// A thin grey line behind all others; its name is not written.
    Faint,
}

/// Where the grid lines across x are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Grid {
    /// At the powers of ten; the plot begins and ends at one.
    Decades,
    /// At the values of the first curve, which are its labels; the plot spans them.
    FirstCurve,
}

const WIDTH: f64 = 760.0;
const HEIGHT: f64 = 460.0;
/// Left, top, right and bottom of the area of the curves.
const AREA: [f64; 4] = [80.0, 20.0, 500.0, 400.0];
/// Least distance of names, one below the other.
const NAME_HEIGHT: f64 = 16.0;
/// Told apart by people with any colour vision (Okabe and Ito).
const COLORS: [&str; 6] = ["#d55e00", "#0072b2", "#009e73", "#cc79a7", "#e69f00", "#56b4e9"];

/// The plot as SVG, 760 x 460. Lines are named at their ends, marks in a list; grid lines across y are at powers of ten.
pub fn log_log(labels: [&str; 2], grid: Grid, curves: &[Curve]) -> String {
    let curves: Vec<Curve> =
        curves.iter().map(|curve| Curve { points: positive(&curve.points), ..curve.clone() }).collect();
    let [x_range, y_range] = [0, 1].map(|axis| {
        let values = curves.iter().flat_map(|curve| &curve.points).map(|point| point[axis].log10());
        let [low, high] = values.fold([f64::INFINITY, f64::NEG_INFINITY], |[l, h], v| [f64::min(l, v), f64::max(h, v)]);
        let whole = axis == 1 || grid == Grid::Decades;
        range(if whole { [low.floor(), high.ceil()] } else { [low, high] })
    });
    let [left, top, right, bottom] = AREA;
    let x = |value: f64| left + (value.log10() - x_range[0]) / (x_range[1] - x_range[0]) * (right - left);
    let y = |value: f64| bottom - (value.log10() - y_range[0]) / (y_range[1] - y_range[0]) * (bottom - top);

    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH} {HEIGHT}\" font-family=\"sans-serif\" \
         font-size=\"13\">\n<rect width=\"{WIDTH}\" height=\"{HEIGHT}\" fill=\"white\"/>\n"
    );
    for decade in y_range[0] as i32..=y_range[1] as i32 {
        let at = y(10.0_f64.powi(decade));
        line(&mut svg, [left, at, right, at]);
        text(&mut svg, [left - 8.0, at + 4.0], "end", &format!("1e{decade}"), "black");
    }
    let columns: Vec<(f64, String)> = match grid {
        Grid::Decades => {
            (x_range[0] as i32..=x_range[1] as i32).map(|d| (10.0_f64.powi(d), format!("1e{d}"))).collect()
        }
        Grid::FirstCurve => {
            curves.iter().take(1).flat_map(|curve| &curve.points).map(|p| (p[0], p[0].to_string())).collect()
        }
    };
    for (value, label) in columns {
        let at = x(value);
        line(&mut svg, [at, top, at, bottom]);
        text(&mut svg, [at, bottom + 18.0], "middle", &label, "black");
    }
    text(&mut svg, [0.5 * (left + right), bottom + 42.0], "middle", labels[0], "black");
    let middle = 0.5 * (top + bottom);
    writeln!(
        svg,
        "<text transform=\"translate(20 {middle}) rotate(-90)\" text-anchor=\"middle\">{}</text>",
        escape(labels[1])
    )
    .ok();
    let path = |curve: &Curve| {
        let points = curve.points.iter().map(|point| format!("{:.1},{:.1}", x(point[0]), y(point[1])));
        points.collect::<Vec<_>>().join(" ")
    };
    for curve in curves.iter().filter(|curve| curve.style == Style::Faint) {
        writeln!(
            svg,
            "<polyline points=\"{}\" fill=\"none\" stroke=\"#888888\" stroke-dasharray=\"5 4\"/>",
            path(curve)
        )
        .ok();
    }
    let drawn: Vec<&Curve> = curves.iter().filter(|curve| curve.style != Style::Faint).collect();
    let end = |curve: &Curve| curve.points.last().map_or(bottom, |point| y(point[1]));
    let mut order: Vec<usize> = (0..drawn.len()).filter(|&i| drawn[i].style == Style::Line).collect();
    // From the bottom up, so that names of curves that end close together are moved apart upwards.
    order.sort_by(|&i, &j| end(drawn[j]).total_cmp(&end(drawn[i])));
    let mut lowest_label = f64::INFINITY;
    for index in order {
        let (curve, color) = (drawn[index], COLORS[index % COLORS.len()]);
        writeln!(svg, "<polyline points=\"{}\" fill=\"none\" stroke=\"{color}\" stroke-width=\"2\"/>", path(curve))
            .ok();
        lowest_label = end(curve).min(lowest_label - NAME_HEIGHT);
        text(&mut svg, [right + 8.0, lowest_label + 4.0], "start", &curve.name, color);
    }
    for (index, curve) in drawn.iter().enumerate().filter(|(_, curve)| curve.style == Style::Marks) {
        let (color, number) = (COLORS[index % COLORS.len()], index + 1);
        for point in &curve.points {
            let (at_x, at_y) = (x(point[0]), y(point[1]));
            writeln!(svg, "<circle cx=\"{at_x:.1}\" cy=\"{at_y:.1}\" r=\"8\" fill=\"white\" stroke=\"{color}\" stroke-width=\"2\"/>").ok();
            text(&mut svg, [at_x, at_y + 4.0], "middle", &number.to_string(), color);
        }
        let place = [right + 8.0, top + 10.0 + NAME_HEIGHT * index as f64];
        text(&mut svg, place, "start", &format!("{number}  {}", curve.name), color);
    }
    svg += "</svg>\n";
    svg
}

fn positive(points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    points.iter().copied().filter(|point| point.iter().all(|v| *v > 0.0 && v.is_finite())).collect()
}

/// A range that has a width; 1 to 10 where there is nothing to show.
fn range([low, high]: [f64; 2]) -> [f64; 2] {
    match (low.is_finite() && high.is_finite(), low < high) {
        (false, _) => [0.0, 1.0],
        (true, false) => [low - 0.5, high + 0.5],
        (true, true) => [low, high],
    }
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

    fn curve(name: &str, points: &[[f64; 2]], style: Style) -> Curve {
        Curve { name: name.to_owned(), points: points.to_vec(), style }
    }

    #[test]
    fn points_lie_where_their_logarithms_say() {
        let curve = curve("a < b", &[[10.0, 1e-2], [100.0, 1e-3], [1000.0, 1e-4]], Style::Line);
        let [left, top, right, bottom] = AREA;
        let (x, y) = (0.5 * (left + right), 0.5 * (top + bottom));
        let expected = format!("points=\"{left:.1},{top:.1} {x:.1},{y:.1} {right:.1},{bottom:.1}\"");
        for grid in [Grid::FirstCurve, Grid::Decades] {
            let svg = log_log(["x", "y"], grid, std::slice::from_ref(&curve));
            assert!(svg.contains(&expected), "{svg}");
            assert!(svg.contains("a &lt; b") && svg.contains("1e-3"));
        }
    }

    #[test]
    fn marks_are_numbered_as_their_names_are() {
        let [left, top, _, bottom] = AREA;
        // Three decades and one: the mark lies a third of the way up at the left.
        let curves = [
            curve("front", &[[1.0, 1e-3], [10.0, 1.0]], Style::Faint),
            curve("one", &[[1.0, 1e-2]], Style::Marks),
            curve("none", &[[0.0, 1.0], [1.0, f64::NAN]], Style::Marks),
        ];
        let svg = log_log(["x", "y"], Grid::Decades, &curves);
        let y = bottom - (bottom - top) / 3.0;
        assert!(svg.contains(&format!("<circle cx=\"{left:.1}\" cy=\"{y:.1}\"")), "{svg}");
        assert_eq!(svg.matches("<circle").count(), 1, "what is not positive has no place");
        assert!(svg.contains(">1  one<") && svg.contains(">2  none<") && !svg.contains("front"));
    }

    #[test]
    fn nothing_to_show_is_a_plot_too() {
        for points in [&[][..], &[[5.0, 0.1]]] {
            let svg = log_log(["x", "y"], Grid::FirstCurve, &[curve("a", points, Style::Marks)]);
            assert!(svg.ends_with("</svg>\n") && !svg.contains("NaN") && !svg.contains("inf"), "{svg}");
        }
    }
}
