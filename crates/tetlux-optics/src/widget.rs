//! Bivariate transfer functions: widgets over two scalars (s, g), for example a value and its gradient's magnitude.
//!
//! A widget has one colour and an opacity that varies over the plane; several together add their extinctions, and the
//! light they emit is the extinction-weighted sum of their colours (Song et al. 2009, who treat one at a time).
//!
//! ```
//! use tetlux_optics::widget::{BivariateFunction, Shape, Widget};
//!
//! let shock = Widget::new(Shape::Gaussian { center: [0.5, 0.8], sigma: [0.1, 0.05] }, None, 30.0, [1.0, 0.6, 0.1])?;
//! assert_eq!(shock.opacity([0.5, 0.8]), 30.0);
//! let function = BivariateFunction { widgets: vec![shock] };
//! assert_eq!(function.single_color(), Some([1.0, 0.6, 0.1]));
//! # Ok::<(), tetlux_optics::widget::WidgetError>(())
//! ```

use std::f64::consts::PI;

#[cfg(test)]
mod tests;

/// Where a Gaussian falls below this share of its peak nothing of it is taken to be visible.
pub const GAUSSIAN_TAIL: f64 = 1e-12;

/// That many sigma from its centre: sqrt(-2 ln GAUSSIAN_TAIL).
const GAUSSIAN_REACH: f64 = 7.433_844_377_6;

/// That many sigma from its centre a Gaussian ends as [`BivariateFunction::as_published`]: at 1.1 % of its peak.
const PUBLISHED_REACH: f64 = 3.0;

/// A rectangle of the (s, g) plane, ends included. Ends may be infinite.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rectangle {
    /// Lower and upper end of the first scalar.
    pub s: [f64; 2],
    /// Lower and upper end of the second scalar.
    pub g: [f64; 2],
}

impl Rectangle {
    /// Whether the point (s, g) lies in the rectangle or on its edge; never for NaN.
    pub fn contains(&self, point: [f64; 2]) -> bool {
        let inside = |value: f64, [low, high]: [f64; 2]| low <= value && value <= high;
        inside(point[0], self.s) && inside(point[1], self.g)
    }

    /// Whether two rectangles share a point; never for NaN. Without branches: it is asked for every cell of a mesh.
    fn meets(&self, other: &Self) -> bool {
        let overlap = |one: [f64; 2], two: [f64; 2]| (one[0] <= two[1]) & (two[0] <= one[1]);
        overlap(self.s, other.s) & overlap(self.g, other.g)
    }
}

/// How a wave rises and falls within its period of 1. All are 0 at integer phases and 1 at half-integer ones.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WaveProfile {
    /// 1 - |2 frac(p) - 1|.
    Triangle,
    /// |sin(pi p)|.
    AbsSine,
    /// sin^2(pi p), smooth also at its zeros.
    SineSquared,
}

/// How a widget's opacity varies over the plane, as a share of the largest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shape {
    /// The same everywhere; with a support, a rectangle.
    Uniform,
    /// exp(-(s - s_0)^2 / (2 sigma_s^2) - (g - g_0)^2 / (2 sigma_g^2)).
    Gaussian {
        /// (s_0, g_0), finite.
        center: [f64; 2],
        /// (sigma_s, sigma_g), above 0 and finite.
        sigma: [f64; 2],
    },
    /// Straight bands: a function of the phase p = f_s s + f_g g + offset, (f_s, f_g) the frequency.
    Wave {
        /// The function.
        profile: WaveProfile,
        /// Periods per unit of s and of g, finite and not both 0.
        frequency: [f64; 2],
        /// The phase at the origin, finite.
        offset: f64,
    },
}

/// Why numbers make no widget.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum WidgetError {
    /// A number that must be finite.
    #[error("widget {field}: {value} must be finite")]
    NotFinite {
        /// The field, as in the scene file.
        field: &'static str,
        /// Its value.
        value: f64,
    },
    /// A number that must be finite and at least 0.
    #[error("widget {field}: {value} must be finite and at least 0")]
    Negative {
        /// The field.
        field: &'static str,
        /// Its value.
        value: f64,
    },
    /// A width that must be finite and above 0.
    #[error("widget {field}: {value} must be finite and above 0")]
    NotPositive {
        /// The field.
        field: &'static str,
        /// Its value.
        value: f64,
    },
    /// A range without inside.
    #[error("widget {field}: the lower end {low} must be below the upper end {high}")]
    EmptyRange {
        /// The field.
        field: &'static str,
        /// Its lower end.
        low: f64,
        /// Its upper end.
        high: f64,
    },
    /// A wave without direction.
    #[error("widget frequency: [0, 0] is no direction; give periods per unit of s or of g, or use a uniform widget")]
    NoDirection,
}

/// One colour over the (s, g) plane, its opacity a shape within an optional rectangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Widget {
    shape: Shape,
    support: Option<Rectangle>,
    max_opacity: f64,
    color: [f64; 3],
    /// Outside there is nothing to be seen.
    footprint: Rectangle,
}

impl Widget {
    /// A widget of the given `shape` inside `support` (everywhere, if there is none) and nothing outside.
    ///
    /// `max_opacity` is the shape's largest extinction times the unit distance, at least 0, may exceed 1; `color` is
    /// linear RGB luminance, each at least 0.
    ///
    /// # Errors
    ///
    /// Names the field and the value that break the rules of [`Shape`], [`Rectangle`] (lower end below the upper end)
    /// or these.
    pub fn new(
        shape: Shape,
        support: Option<Rectangle>,
        max_opacity: f64,
        color: [f64; 3],
    ) -> Result<Self, WidgetError> {
        match shape {
            Shape::Uniform => {}
            Shape::Gaussian { center, sigma } => {
                finite("center", center)?;
                if let Some(value) = sigma.into_iter().find(|&value| !(value > 0.0 && value.is_finite())) {
                    return Err(WidgetError::NotPositive { field: "sigma", value });
                }
            }
            Shape::Wave { frequency, offset, .. } => {
                finite("frequency", frequency)?;
                finite("offset", [offset])?;
                if frequency == [0.0; 2] {
                    return Err(WidgetError::NoDirection);
                }
            }
        }
        if let Some(rectangle) = support {
            for (field, [low, high]) in [("support s", rectangle.s), ("support g", rectangle.g)] {
                // NaN is below nothing; an infinite range has to have an inside too.
                if !(low < high && low < f64::INFINITY && high > f64::NEG_INFINITY) {
                    return Err(WidgetError::EmptyRange { field, low, high });
                }
            }
        }
        not_negative("max_opacity", [max_opacity])?;
        not_negative("color", color)?;
        Ok(Self::build(shape, support, max_opacity, color))
    }

    fn build(shape: Shape, support: Option<Rectangle>, max_opacity: f64, color: [f64; 3]) -> Self {
        let whole = [f64::NEG_INFINITY, f64::INFINITY];
        let mut footprint = support.unwrap_or(Rectangle { s: whole, g: whole });
        if let Shape::Gaussian { center, sigma } = shape {
            for (axis, range) in [&mut footprint.s, &mut footprint.g].into_iter().enumerate() {
                let reach = GAUSSIAN_REACH * sigma[axis];
                *range = [range[0].max(center[axis] - reach), range[1].min(center[axis] + reach)];
            }
        }
        if max_opacity == 0.0 {
            footprint.s = [f64::INFINITY, f64::NEG_INFINITY];
        }
        Self { shape, support, max_opacity, color, footprint }
    }

    /// How the opacity varies.
    pub fn shape(&self) -> &Shape {
        &self.shape
    }

    /// Where the widget is; everywhere if none.
    pub fn support(&self) -> Option<&Rectangle> {
        self.support.as_ref()
    }

    /// The shape's largest opacity.
    pub fn max_opacity(&self) -> f64 {
        self.max_opacity
    }

    /// Linear RGB luminance.
    pub fn color(&self) -> [f64; 3] {
        self.color
    }

    /// The widget in other units of s and g: what was at p comes to `origin` + p `scale`, both finite, `scale` above 0.
    pub fn mapped(&self, origin: [f64; 2], scale: [f64; 2]) -> Self {
        let place = |p: [f64; 2]| [0, 1].map(|axis| origin[axis] + p[axis] * scale[axis]);
        let shape = match self.shape {
            Shape::Uniform => Shape::Uniform,
            Shape::Gaussian { center, sigma } => {
                Shape::Gaussian { center: place(center), sigma: [0, 1].map(|axis| sigma[axis] * scale[axis]) }
            }
            Shape::Wave { profile, frequency, offset } => {
                let frequency = [0, 1].map(|axis| frequency[axis] / scale[axis]);
                let offset = offset - frequency[0] * origin[0] - frequency[1] * origin[1];
                Shape::Wave { profile, frequency, offset }
            }
        };
        let support = self.support.map(|rectangle| {
            let [low, high] = [[rectangle.s[0], rectangle.g[0]], [rectangle.s[1], rectangle.g[1]]].map(place);
            Rectangle { s: [low[0], high[0]], g: [low[1], high[1]] }
        });
        Self::build(shape, support, self.max_opacity, self.color)
    }

    /// The same without a support.
    pub(crate) fn unbounded(self) -> Self {
        Self::build(self.shape, None, self.max_opacity, self.color)
    }

    /// Whether the point (s, g) lies in the support.
    pub fn contains(&self, point: [f64; 2]) -> bool {
        self.support.is_none_or(|rectangle| rectangle.contains(point))
    }

    /// Opacity (extinction times the unit distance) at (s, g); 0 outside the support.
    pub fn opacity(&self, point: [f64; 2]) -> f64 {
        if !self.contains(point) {
            return 0.0;
        }
        let share = match self.shape {
            Shape::Uniform => 1.0,
            Shape::Gaussian { center, sigma } => {
                let [x, y] = gaussian_coordinates(center, sigma, point);
                (-(x * x + y * y)).exp()
            }
            Shape::Wave { profile, frequency, offset } => {
                wave_share(profile, zero_distance(phase(frequency, offset, point)))
            }
        };
        self.max_opacity * share
    }

    /// The rectangle outside which nothing of the widget is seen, or, of a Gaussian, less than [`GAUSSIAN_TAIL`] of its
    /// peak. Of a widget without opacity its ends descend: nothing lies inside.
    pub fn footprint(&self) -> &Rectangle {
        &self.footprint
    }

    /// Whether anything of the widget may be seen where s and g stay in a rectangle, for culling: no means that the
    /// opacity is 0 there or, of a Gaussian, below [`GAUSSIAN_TAIL`] of its peak. A comparison with the rectangle around
    /// the widget (Song et al. 2009, section 3.1).
    pub fn is_visible_over(&self, range: &Rectangle) -> bool {
        self.footprint.meets(range)
    }

    /// The largest opacity over a rectangle, for culling; exact but for a rectangle that a support cuts, where it is a
    /// bound.
    pub fn max_opacity_over(&self, range: &Rectangle) -> f64 {
        if self.support.is_some_and(|rectangle| !rectangle.meets(range)) {
            return 0.0;
        }
        let share = match self.shape {
            Shape::Uniform => 1.0,
            Shape::Gaussian { center, sigma } => {
                let nearest = [center[0].max(range.s[0]).min(range.s[1]), center[1].max(range.g[0]).min(range.g[1])];
                let [x, y] = gaussian_coordinates(center, sigma, nearest);
                (-(x * x + y * y)).exp()
            }
            Shape::Wave { profile, frequency, offset } => {
                let corners = [[0, 0], [0, 1], [1, 0], [1, 1]]
                    .map(|[i, j]: [usize; 2]| phase(frequency, offset, [range.s[i], range.g[j]]));
                let low = corners.into_iter().fold(f64::INFINITY, f64::min);
                let high = corners.into_iter().fold(f64::NEG_INFINITY, f64::max);
                // The first peak at or above the lowest phase, with room for the rounding of phases.
                let peak = (low - 0.5).ceil() + 0.5;
                let rounding = 4.0 * f64::EPSILON * low.abs().max(high.abs());
                if peak <= high + rounding || !(high - low).is_finite() {
                    1.0
                } else {
                    [low, high].map(|phase| wave_share(profile, zero_distance(phase))).into_iter().fold(0.0, f64::max)
                }
            }
        };
        self.max_opacity * share
    }
}

/// Widgets whose extinctions add.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BivariateFunction {
    /// The widgets, in any order.
    pub widgets: Vec<Widget>,
}

impl BivariateFunction {
    /// Opacity at (s, g): the sum of the widgets'.
    pub fn opacity(&self, point: [f64; 2]) -> f64 {
        self.widgets.iter().map(|widget| widget.opacity(point)).sum()
    }

    /// Linear RGB luminance at (s, g): the widgets' colours weighted by their extinctions; black where there is none.
    pub fn luminance(&self, point: [f64; 2]) -> [f64; 3] {
        let mut sum = [0.0; 3];
        let total = self.opacity(point);
        for widget in &self.widgets {
            let share = if total > 0.0 { widget.opacity(point) / total } else { 0.0 };
            for channel in 0..3 {
                sum[channel] += share * widget.color[channel];
            }
        }
        sum
    }

    /// A bound of the opacity over a rectangle, for culling; 0 only where there is nothing.
    pub fn max_opacity_over(&self, range: &Rectangle) -> f64 {
        self.widgets.iter().map(|widget| widget.max_opacity_over(range)).sum()
    }

    /// The function in other units of s and g: see [`Widget::mapped`].
    pub fn mapped(&self, origin: [f64; 2], scale: [f64; 2]) -> Self {
        Self { widgets: self.widgets.iter().map(|widget| widget.mapped(origin, scale)).collect() }
    }

    /// The function with each widget limited to a rectangle, as the published convention needs it, in which a widget's
    /// colour is emitted wherever it is, whatever its opacity: a Gaussian, which ends nowhere, to 3 sigma around its centre.
    /// Waves and uniform widgets are their rectangles.
    pub fn as_published(&self) -> Self {
        let limited = |widget: &Widget| {
            let Shape::Gaussian { center, sigma } = widget.shape else { return Some(*widget) };
            let whole = [f64::NEG_INFINITY, f64::INFINITY];
            let Rectangle { s, g } = widget.support.unwrap_or(Rectangle { s: whole, g: whole });
            let within = |axis: usize, [low, high]: [f64; 2]| {
                let reach = PUBLISHED_REACH * sigma[axis];
                [low.max(center[axis] - reach), high.min(center[axis] + reach)]
            };
            let support = Rectangle { s: within(0, s), g: within(1, g) };
            let inside = support.s[0] < support.s[1] && support.g[0] < support.g[1];
            inside.then(|| Widget::build(widget.shape, Some(support), widget.max_opacity, widget.color))
        };
        Self { widgets: self.widgets.iter().filter_map(limited).collect() }
    }

    /// Whether any widget may be seen over a rectangle: see [`Widget::is_visible_over`].
    pub fn is_visible_over(&self, range: &Rectangle) -> bool {
        // All of them: for the few widgets there are a comparison is cheaper than a branch that goes either way.
        self.widgets.iter().fold(false, |seen, widget| seen | widget.is_visible_over(range))
    }

    /// The colour that all visible widgets share: then the order of segments along a ray does not matter. Black if
    /// none is visible.
    pub fn single_color(&self) -> Option<[f64; 3]> {
        let mut colors = self.widgets.iter().filter(|widget| widget.max_opacity > 0.0).map(Widget::color);
        let first = colors.next().unwrap_or([0.0; 3]);
        colors.all(|color| color == first).then_some(first)
    }
}

/// (s - s_0, g - g_0) / (sqrt 2 sigma).
pub(crate) fn gaussian_coordinates(center: [f64; 2], sigma: [f64; 2], point: [f64; 2]) -> [f64; 2] {
    std::array::from_fn(|axis| (point[axis] - center[axis]) / (std::f64::consts::SQRT_2 * sigma[axis]))
}

/// A wave's phase at (s, g).
pub(crate) fn phase(frequency: [f64; 2], offset: f64, point: [f64; 2]) -> f64 {
    frequency[0] * point[0] + frequency[1] * point[1] + offset
}

/// Distance of a phase from the nearest integer, in [0, 1/2]; exact.
pub(crate) fn zero_distance(phase: f64) -> f64 {
    (phase - phase.round()).abs()
}

/// A wave's opacity at distance r in [0, 1/2] from a zero, as a share of the largest.
pub(crate) fn wave_share(profile: WaveProfile, r: f64) -> f64 {
    match profile {
        WaveProfile::Triangle => 2.0 * r,
        WaveProfile::AbsSine => (PI * r).sin(),
        WaveProfile::SineSquared => (PI * r).sin().powi(2),
    }
}

fn finite<const N: usize>(field: &'static str, values: [f64; N]) -> Result<(), WidgetError> {
    match values.into_iter().find(|value| !value.is_finite()) {
        Some(value) => Err(WidgetError::NotFinite { field, value }),
        None => Ok(()),
    }
}

fn not_negative<const N: usize>(field: &'static str, values: [f64; N]) -> Result<(), WidgetError> {
    match values.into_iter().find(|&value| !(value >= 0.0 && value.is_finite())) {
        Some(value) => Err(WidgetError::Negative { field, value }),
        None => Ok(()),
    }
}
