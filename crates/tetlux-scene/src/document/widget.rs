//! The tables `[[widget]]`.

use serde::Deserialize;
use tetlux_optics::widget::{Rectangle, Shape, WaveProfile, Widget, WidgetError};
use toml::Spanned;

use super::Source;
use crate::SceneError;

/// A shape by name.
#[derive(Clone, Copy, Deserialize, PartialEq)]
#[serde(rename_all = "kebab-case")]
enum ShapeName {
    Uniform,
    Gaussian,
    Triangle,
    Sine,
    SineSquared,
}

/// The axis along which peaks are counted.
#[derive(Clone, Copy, Deserialize)]
#[serde(rename_all = "kebab-case")]
enum Along {
    X,
    Y,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct WidgetTable {
    shape: ShapeName,
    color: Spanned<[f64; 3]>,
    max_opacity: Spanned<f64>,
    /// The rectangle outside which there is nothing of the widget.
    x: Option<Spanned<[f64; 2]>>,
    y: Option<Spanned<[f64; 2]>>,
    center: Option<Spanned<[f64; 2]>>,
    sigma: Option<Spanned<[f64; 2]>>,
    /// Periods a unit of x and of y.
    frequency: Option<Spanned<[f64; 2]>>,
    offset: Option<Spanned<f64>>,
    /// Instead of a frequency: peaks between the ends of x (or y), counted along that axis.
    peaks: Option<Spanned<f64>>,
    along: Option<Spanned<Along>>,
}

impl Source<'_> {
    pub(super) fn widget(&self, table: &Spanned<WidgetTable>) -> Result<Widget, SceneError> {
        let t = table.get_ref();
        let wave = |profile| self.wave(table, profile);
        let shape = match t.shape {
            ShapeName::Uniform => Shape::Uniform,
            ShapeName::Gaussian => {
                let (Some(center), Some(sigma)) = (&t.center, &t.sigma) else {
                    return Err(self.value(
                        table,
                        "widget",
                        "a gaussian needs center = [x, y] and sigma = [x, y]".into(),
                    ));
                };
                Shape::Gaussian { center: *center.get_ref(), sigma: *sigma.get_ref() }
            }
            ShapeName::Triangle => wave(WaveProfile::Triangle)?,
            ShapeName::Sine => wave(WaveProfile::AbsSine)?,
            ShapeName::SineSquared => wave(WaveProfile::SineSquared)?,
        };
        self.refuse_foreign_keys(t)?;
        let whole = [f64::NEG_INFINITY, f64::INFINITY];
        let range = |ends: &Option<Spanned<[f64; 2]>>| ends.as_ref().map_or(whole, |e| *e.get_ref());
        let support = (t.x.is_some() || t.y.is_some()).then(|| Rectangle { s: range(&t.x), g: range(&t.y) });
        Widget::new(shape, support, *t.max_opacity.get_ref(), *t.color.get_ref()).map_err(|error| {
            let message = error.to_string();
            let pair = |value: &Option<Spanned<[f64; 2]>>, key| match value {
                Some(value) => self.value(value, key, message.clone()),
                None => self.value(table, key, message.clone()),
            };
            match error {
                WidgetError::NotFinite { field: "center", .. } => pair(&t.center, "center"),
                WidgetError::NotPositive { .. } => pair(&t.sigma, "sigma"),
                WidgetError::NotFinite { field: "frequency", .. } | WidgetError::NoDirection => {
                    pair(&t.frequency, "frequency")
                }
                WidgetError::NotFinite { .. } => match &t.offset {
                    Some(offset) => self.value(offset, "offset", message.clone()),
                    None => self.value(table, "offset", message.clone()),
                },
                WidgetError::EmptyRange { field: "support s", .. } => pair(&t.x, "x"),
                WidgetError::EmptyRange { .. } => pair(&t.y, "y"),
                WidgetError::Negative { field: "color", .. } => self.value(&t.color, "color", message.clone()),
                WidgetError::Negative { .. } => self.value(&t.max_opacity, "max_opacity", message.clone()),
            }
        })
    }

    /// Straight bands: by frequency and offset, or by the number of peaks between the ends of an axis.
    fn wave(&self, table: &Spanned<WidgetTable>, profile: WaveProfile) -> Result<Shape, SceneError> {
        let t = table.get_ref();
        match (&t.frequency, &t.peaks) {
            (Some(frequency), None) => Ok(Shape::Wave {
                profile,
                frequency: *frequency.get_ref(),
                offset: t.offset.as_ref().map_or(0.0, |o| *o.get_ref()),
            }),
            (None, Some(peaks)) => {
                let (axis, key, ends) = match t.along.as_ref().map(|a| *a.get_ref()) {
                    Some(Along::Y) => (1, "y", &t.y),
                    Some(Along::X) | None => (0, "x", &t.x),
                };
                let Some(ends) = ends else {
                    let message = "needs the ends between which the peaks are counted: x = [low, high], or along = \"y\" \
                                   and y = [low, high]";
                    return Err(self.value(peaks, "peaks", message.into()));
                };
                let [low, high] = *ends.get_ref();
                if !(low < high && low.is_finite() && high.is_finite()) {
                    return Err(self.value(ends, key, format!("[{low}, {high}] must ascend and be finite")));
                }
                let count = *peaks.get_ref();
                if !(count > 0.0 && count.is_finite()) {
                    return Err(self.value(peaks, "peaks", format!("{count} must be positive and finite")));
                }
                let mut frequency = [0.0; 2];
                frequency[axis] = count / (high - low);
                let offset = -low * frequency[axis] + t.offset.as_ref().map_or(0.0, |o| *o.get_ref());
                Ok(Shape::Wave { profile, frequency, offset })
            }
            (Some(_), Some(peaks)) => {
                Err(self.value(peaks, "peaks", "is given and a frequency too: keep one of them".into()))
            }
            (None, None) => {
                let message = "a wave needs frequency = [x, y], or peaks = N and the ends x = [low, high]";
                Err(self.value(table, "widget", message.into()))
            }
        }
    }

    /// A key that the widget's shape has no use for is a mistake.
    fn refuse_foreign_keys(&self, t: &WidgetTable) -> Result<(), SceneError> {
        let gaussian = t.shape == ShapeName::Gaussian;
        let wave = matches!(t.shape, ShapeName::Triangle | ShapeName::Sine | ShapeName::SineSquared);
        let foreign = |key: &str| format!("is for {key}: leave it out, or choose another shape");
        if let Some(center) = t.center.as_ref().filter(|_| !gaussian) {
            return Err(self.value(center, "center", foreign("gaussians")));
        }
        if let Some(sigma) = t.sigma.as_ref().filter(|_| !gaussian) {
            return Err(self.value(sigma, "sigma", foreign("gaussians")));
        }
        if let Some(frequency) = t.frequency.as_ref().filter(|_| !wave) {
            return Err(self.value(frequency, "frequency", foreign("waves")));
        }
        if let Some(offset) = t.offset.as_ref().filter(|_| !wave) {
            return Err(self.value(offset, "offset", foreign("waves")));
        }
        if let Some(peaks) = t.peaks.as_ref().filter(|_| !wave) {
            return Err(self.value(peaks, "peaks", foreign("waves")));
        }
        if let Some(along) = t.along.as_ref().filter(|_| t.peaks.is_none()) {
            return Err(self.value(along, "along", "counts peaks: give peaks too, or leave it out".into()));
        }
        Ok(())
    }
}
