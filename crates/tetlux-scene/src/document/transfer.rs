//! The table `[transfer]`.

use std::path::PathBuf;

use serde::Deserialize;
use tetlux_optics::NoData;
use tetlux_optics::transfer::{ColorNode, NodeKind, OpacityNode, TransferFunction, TransferFunctionError};
use tetlux_optics::widget::BivariateFunction;
use toml::Spanned;

use super::Source;
use super::widget::WidgetTable;
use crate::SceneError;
use crate::file::{FieldSpec, NodeRange, TransferSource, UnitDistance};

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Transfer {
    color: Option<Vec<Spanned<[f64; 4]>>>,
    opacity: Option<Vec<Spanned<[f64; 2]>>>,
    /// In place of opacity: a mean optical depth.
    even_opacity: Option<Spanned<f64>>,
    preset: Option<PathBuf>,
    preset_name: Option<String>,
    range: Option<Spanned<[f64; 2]>>,
    #[serde(default)]
    fit_to_field: bool,
    unit_distance: Option<Spanned<f64>>,
    relative_unit_distance: Option<Spanned<f64>>,
    /// Opacity by another field than colour.
    opacity_field: Option<Spanned<String>>,
    opacity_component: Option<Spanned<usize>>,
    /// The second axis of widgets and images; none: the magnitude of the first field's gradient.
    second_field: Option<Spanned<String>>,
    second_component: Option<Spanned<usize>>,
    /// A picture of the function.
    image: Option<PathBuf>,
    image_range: Option<Spanned<[[f64; 2]; 2]>>,
    max_opacity: Option<Spanned<f64>>,
    /// Cells without data.
    nan_color: Option<Spanned<[f64; 3]>>,
    nan_opacity: Option<Spanned<f64>>,
}

impl Source<'_> {
    pub(super) fn unit_distance(&self, transfer: &Transfer) -> Result<UnitDistance, SceneError> {
        let length = self.positive(transfer.unit_distance.as_ref(), "unit_distance")?;
        let share = self.positive(transfer.relative_unit_distance.as_ref(), "relative_unit_distance")?;
        match (length, share, &transfer.unit_distance) {
            (Some(_), Some(_), Some(at)) => {
                Err(self.value(at, "unit_distance", "is given relatively too: keep one of them".into()))
            }
            (Some(length), ..) => Ok(UnitDistance::Length(length)),
            (None, Some(share), _) => Ok(UnitDistance::OfDiagonal(share)),
            (None, None, _) => Ok(UnitDistance::MeanEdge),
        }
    }

    /// The colour of cells without data, if it is given.
    pub(super) fn nan_color(&self, transfer: &Transfer) -> Result<Option<[f64; 3]>, SceneError> {
        let check = |at: &Spanned<[f64; 3]>| match NoData::new(*at.get_ref(), 0.0) {
            Ok(look) => Ok(look.luminance()),
            Err(error) => Err(self.value(at, "nan_color", error.to_string())),
        };
        transfer.nan_color.as_ref().map(check).transpose()
    }

    /// Their opacity, if it is given.
    pub(super) fn nan_opacity(&self, transfer: &Transfer) -> Result<Option<f64>, SceneError> {
        let check = |at: &Spanned<f64>| match NoData::new(NoData::LUMINANCE, *at.get_ref()) {
            Ok(look) => Ok(look.opacity()),
            Err(error) => Err(self.value(at, "nan_opacity", error.to_string())),
        };
        transfer.nan_opacity.as_ref().map(check).transpose()
    }

    pub(super) fn range(&self, transfer: &Spanned<Transfer>) -> Result<NodeRange, SceneError> {
        let t = transfer.get_ref();
        let Some(range) = &t.range else {
            return Ok(if t.fit_to_field || t.preset.is_some() { NodeRange::Field } else { NodeRange::AsGiven });
        };
        if let Some(field) = &t.opacity_field {
            let message = "with an opacity_field there are two ranges: give the nodes in the fields' units, or \
                           fit_to_field = true";
            return Err(self.value(field, "opacity_field", message.into()));
        }
        if t.fit_to_field {
            return Err(self.value(range, "range", "is given and fit_to_field too: keep one of them".into()));
        }
        let [lo, hi] = *range.get_ref();
        if lo < hi && lo.is_finite() && hi.is_finite() {
            Ok(NodeRange::Given([lo, hi]))
        } else {
            Err(self.value(range, "range", format!("[{lo}, {hi}] must ascend and be finite")))
        }
    }

    pub(super) fn transfer(
        &self,
        transfer: &Spanned<Transfer>,
        widgets: &[Spanned<WidgetTable>],
        beside: impl Fn(PathBuf) -> PathBuf,
    ) -> Result<TransferSource, SceneError> {
        let refuse = |message: &str| Err(self.value(transfer, "transfer", message.into()));
        let t = transfer.get_ref();
        let one_field = t.preset.is_some() || t.color.is_some() || t.opacity.is_some() || t.even_opacity.is_some();
        if usize::from(one_field) + usize::from(t.image.is_some()) + usize::from(!widgets.is_empty()) > 1 {
            return refuse("has more than one of nodes (or a preset), an image and widgets: keep one of them");
        }
        if !widgets.is_empty() {
            return self.widgets(transfer, widgets);
        }
        if let Some(image) = &t.image {
            return self.image(t, beside(image.clone()));
        }
        if let Some(range) = &t.image_range {
            return Err(self.value(range, "image_range", "is given without an image".into()));
        }
        if let Some(opacity) = &t.max_opacity {
            return Err(self.value(opacity, "max_opacity", "is for images: opacity nodes have their own".into()));
        }
        let even = self.positive(t.even_opacity.as_ref(), "even_opacity")?;
        if let Some(at) = t.even_opacity.as_ref().filter(|_| t.opacity.is_some() || t.preset.is_some()) {
            return Err(self.value(
                at,
                "even_opacity",
                "is given and opacity or a preset too: keep one of them".into(),
            ));
        }
        match (&t.preset, &t.color, &t.opacity) {
            (Some(preset), None, None) => {
                Ok(TransferSource::Preset { path: beside(preset.clone()), name: t.preset_name.clone() })
            }
            (Some(_), ..) => refuse("has a preset and nodes: keep one of them"),
            (None, Some(color), opacity) if opacity.is_some() || even.is_some() => {
                if t.preset_name.is_some() {
                    return refuse("has a preset_name without a preset");
                }
                let nodes = TransferFunction::new(
                    color.iter().map(|n| *n.get_ref()).map(|[s, r, g, b]| ColorNode { s, rgb: [r, g, b] }).collect(),
                    match opacity {
                        Some(nodes) => {
                            nodes.iter().map(|n| *n.get_ref()).map(|[s, opacity]| OpacityNode { s, opacity }).collect()
                        }
                        None => {
                            let first = color.first().map_or(0.0, |n| n.get_ref()[0]);
                            vec![OpacityNode { s: first, opacity: 0.0 }]
                        }
                    },
                );
                let source = |nodes| match even {
                    Some(depth) => TransferSource::Even { color: nodes, depth },
                    None => TransferSource::Nodes(nodes),
                };
                nodes.map(source).map_err(|error| {
                    use TransferFunctionError::{Crowded, Empty, Order, Position, Value};
                    let (kind, index) = match error {
                        Position { kind, index, .. }
                        | Order { kind, index, .. }
                        | Crowded { kind, index, .. }
                        | Value { kind, index, .. } => (kind, index),
                        Empty { .. } => return self.value(transfer, "transfer", error.to_string()),
                    };
                    match kind {
                        NodeKind::Color => self.value(&color[index], "color", error.to_string()),
                        NodeKind::Opacity => match opacity {
                            Some(nodes) => self.value(&nodes[index], "opacity", error.to_string()),
                            None => self.value(transfer, "transfer", error.to_string()),
                        },
                    }
                })
            }
            (None, ..) => refuse(
                "needs color = [[scalar, red, green, blue], ...] and opacity = [[scalar, opacity], ...] \
                 (or even_opacity = 1.0), or preset = \"file.json\", or [[widget]] tables, or image = \"file.exr\"",
            ),
        }
    }

    /// The second field, if the scene names one.
    pub(super) fn second(
        &self,
        transfer: &Spanned<Transfer>,
        widgets: &[Spanned<WidgetTable>],
    ) -> Result<Option<FieldSpec>, SceneError> {
        let t = transfer.get_ref();
        let bivariate = !widgets.is_empty() || t.image.is_some();
        if bivariate && let Some(field) = &t.opacity_field {
            let message = "is for transfer functions of one field: widgets and images take second_field";
            return Err(self.value(field, "opacity_field", message.into()));
        }
        if !bivariate && let Some(field) = &t.second_field {
            let message = "is the second axis of widgets or of an image, and there are none: for a transfer function \
                           give opacity_field";
            return Err(self.value(field, "second_field", message.into()));
        }
        for (component, field, key) in [
            (&t.opacity_component, &t.opacity_field, "opacity_component"),
            (&t.second_component, &t.second_field, "second_component"),
        ] {
            if let (Some(component), None) = (component, field) {
                return Err(self.value(component, key, "is given without its field".into()));
            }
        }
        let (field, component) = match &t.opacity_field {
            Some(_) => (&t.opacity_field, &t.opacity_component),
            None => (&t.second_field, &t.second_component),
        };
        Ok(field.as_ref().map(|name| FieldSpec {
            name: name.get_ref().clone(),
            component: component.as_ref().map(|c| *c.get_ref()),
        }))
    }

    fn widgets(
        &self,
        transfer: &Spanned<Transfer>,
        widgets: &[Spanned<WidgetTable>],
    ) -> Result<TransferSource, SceneError> {
        let t = transfer.get_ref();
        if let Some(range) = &t.range {
            let message = "is for transfer functions of one field: give widgets in the fields' units, or \
                           fit_to_field = true and all from 0 to 1";
            return Err(self.value(range, "range", message.into()));
        }
        if let Some(opacity) = &t.max_opacity {
            return Err(self.value(opacity, "max_opacity", "is for images: each widget has its own".into()));
        }
        let widgets = widgets.iter().map(|widget| self.widget(widget)).collect::<Result<_, _>>()?;
        Ok(TransferSource::Widgets(BivariateFunction { widgets }))
    }

    fn image(&self, t: &Transfer, path: PathBuf) -> Result<TransferSource, SceneError> {
        if let Some(range) = &t.range {
            return Err(self.value(range, "range", "is for transfer functions of one field: give image_range".into()));
        }
        if let Some(spanned) = t.image_range.as_ref().filter(|_| t.fit_to_field) {
            let message = "is given and fit_to_field too: keep one of them";
            return Err(self.value(spanned, "image_range", message.into()));
        }
        if let Some(spanned) = &t.image_range
            && let Some([low, high]) =
                spanned.get_ref().iter().find(|[low, high]| !(low < high && low.is_finite() && high.is_finite()))
        {
            return Err(self.value(spanned, "image_range", format!("[{low}, {high}] must ascend and be finite")));
        }
        let max_opacity = self.positive(t.max_opacity.as_ref(), "max_opacity")?.unwrap_or(1.0);
        Ok(TransferSource::Image { path, range: t.image_range.as_ref().map(|r| *r.get_ref()), max_opacity })
    }
}
