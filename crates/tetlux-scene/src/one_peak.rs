//! Where the published analytic integrals are beyond what they are derived for (Song et al. 2009, sections 4.3, 4.4, 6.3).

use rayon::prelude::*;
use tetlux_mesh::{Location, ScalarField, TetMesh};
use tetlux_optics::BivariateFunction;
use tetlux_optics::widget::{Rectangle, Shape};

use crate::Scene;

/// Warnings for the cells that hold more than one peak of a wave, and for those in which widgets overlap.
pub(crate) fn beyond_published(
    scene: &Scene,
    mesh: &TetMesh,
    cells: &[u32],
    function: &BivariateFunction,
) -> Vec<String> {
    let Some(second) = &scene.second else { return Vec::new() };
    let function = function.as_published();
    let found = cells.par_iter().map(|&cell| {
        let x = values(&scene.scalar, mesh, cell);
        let y = values(second, mesh, cell);
        let corners = [0, 1, 2, 3].map(|i| [x[i], y[i]]);
        (periods(&function, corners), overlap(&function, corners))
    });
    let (periods, overlaps): (Vec<Option<f64>>, Vec<bool>) = found.unzip();
    let over: Vec<f64> = periods.into_iter().flatten().collect();
    let mut warnings = Vec::new();
    if !over.is_empty() {
        let widest = over.iter().copied().fold(0.0, f64::max);
        warnings.push(format!(
            "{} of {} cells may hold more than one peak of a wave along a ray, up to {widest:.1} periods; the published \
             integrals have one, and what lies behind the second is left out: give waves of at most {:.2} of their \
             frequency, or use --integrator adaptive",
            over.len(),
            cells.len(),
            1.0 / widest.max(1.0)
        ));
    }
    let overlaps = overlaps.into_iter().filter(|&overlap| overlap).count();
    if overlaps > 0 {
        warnings.push(format!(
            "{overlaps} of {} cells may lie where widgets overlap; the published integrals have one at a time, and they \
             are drawn one behind the other: --integrator adaptive adds them up",
            cells.len()
        ));
    }
    warnings
}

fn values(scalar: &ScalarField, mesh: &TetMesh, cell: u32) -> [f64; 4] {
    match scalar.location {
        Location::Point => mesh.cells()[cell as usize].map(|v| scalar.values[v as usize]),
        Location::Cell => [scalar.values[cell as usize]; 4],
    }
}

fn around(values: [f64; 4]) -> [f64; 2] {
    [values.into_iter().fold(f64::INFINITY, f64::min), values.into_iter().fold(f64::NEG_INFINITY, f64::max)]
}

fn box_of(corners: [[f64; 2]; 4]) -> Rectangle {
    Rectangle { s: around(corners.map(|p| p[0])), g: around(corners.map(|p| p[1])) }
}

/// The periods over which the cell's rays may go of a wave that it meets, the most of any, if they may meet two peaks.
fn periods(function: &BivariateFunction, corners: [[f64; 2]; 4]) -> Option<f64> {
    let range = box_of(corners);
    let over = function.widgets.iter().filter(|widget| widget.is_visible_over(&range)).filter_map(|widget| {
        let Shape::Wave { frequency, offset, .. } = *widget.shape() else { return None };
        let [low, high] = around(corners.map(|p| frequency[0] * p[0] + frequency[1] * p[1] + offset));
        // Peaks lie at the half-integers.
        let peaks = (high - 0.5).ceil() - (low - 0.5).floor() - 1.0;
        (peaks > 1.0).then_some(high - low)
    });
    over.reduce(f64::max)
}

/// Whether two widgets' rectangles share a part of the cell's.
fn overlap(function: &BivariateFunction, corners: [[f64; 2]; 4]) -> bool {
    let range = box_of(corners);
    let whole = [f64::NEG_INFINITY, f64::INFINITY];
    let common = |one: [f64; 2], two: [f64; 2]| [one[0].max(two[0]), one[1].min(two[1])];
    let met: Vec<Rectangle> = function
        .widgets
        .iter()
        .filter(|widget| widget.is_visible_over(&range))
        .map(|widget| {
            let support = widget.support().copied().unwrap_or(Rectangle { s: whole, g: whole });
            Rectangle { s: common(support.s, range.s), g: common(support.g, range.g) }
        })
        .collect();
    let share = |a: &Rectangle, b: &Rectangle| {
        let [s, g] = [common(a.s, b.s), common(a.g, b.g)];
        s[0] <= s[1] && g[0] <= g[1]
    };
    met.iter().enumerate().any(|(i, one)| met[..i].iter().any(|two| share(one, two)))
}

#[cfg(test)]
mod tests {
    use tetlux_optics::widget::{WaveProfile, Widget};

    use super::*;

    fn wave(frequency: [f64; 2], support: Option<Rectangle>) -> Widget {
        let shape = Shape::Wave { profile: WaveProfile::AbsSine, frequency, offset: 0.0 };
        Widget::new(shape, support, 1.0, [1.0; 3]).unwrap()
    }

    /// A cell from `low` to `high` in x, between 0 and 1 in y.
    fn cell(low: f64, high: f64) -> [[f64; 2]; 4] {
        [[low, 0.0], [high, 1.0], [0.5 * (low + high), 0.3], [high, 0.0]]
    }

    #[test]
    fn two_peaks_within_a_cell_are_beyond_the_published_form() {
        let function = BivariateFunction { widgets: vec![wave([1.0, 0.0], None)] };
        // Peaks at 0.5, 1.5 and so on.
        for (low, high, expected) in [
            (0.1, 0.9, None),
            (0.6, 1.4, None),
            (0.6, 2.4, None),
            (0.4, 1.4, None),
            (0.4, 1.6, Some(1.2)),
            (-3.0, 3.0, Some(6.0)),
        ] {
            let found = periods(&function, cell(low, high));
            let close = |expected: f64| found.is_some_and(|found| (found - expected).abs() < 1e-12);
            assert!(expected.map_or(found.is_none(), close), "{low} to {high}: {found:?}");
        }
        let elsewhere = Rectangle { s: [9.0, 10.0], g: [0.0, 1.0] };
        let function = BivariateFunction { widgets: vec![wave([1.0, 0.0], Some(elsewhere))] };
        assert_eq!(periods(&function, cell(0.0, 5.0)), None, "a wave that the cell does not meet");
    }

    #[test]
    fn widgets_overlap_where_the_cell_sees_both_at_one_place() {
        let rectangle = |low, high| Rectangle { s: [low, high], g: [0.0, 1.0] };
        let two = |a, b| BivariateFunction { widgets: vec![wave([0.1, 0.0], Some(a)), wave([0.1, 0.0], Some(b))] };
        let apart = two(rectangle(0.0, 1.0), rectangle(2.0, 3.0));
        assert!(!overlap(&apart, cell(0.0, 3.0)), "met one after the other");
        let together = two(rectangle(0.0, 1.5), rectangle(1.0, 3.0));
        assert!(overlap(&together, cell(0.0, 3.0)) && !overlap(&together, cell(0.0, 0.9)));
    }
}
