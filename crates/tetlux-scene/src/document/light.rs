//! The table `[light]`.

use serde::Deserialize;
use tetlux_optics::light::{Light, LightError};
use toml::Spanned;

use super::Source;
use crate::SceneError;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct LightTable {
    direction: Option<Spanned<[f64; 3]>>,
    ambient: Option<Spanned<f64>>,
    diffuse: Option<Spanned<f64>>,
    specular: Option<Spanned<f64>>,
    shininess: Option<Spanned<f64>>,
    silhouette: Option<Spanned<f64>>,
}

impl Source<'_> {
    /// The light of a surface, which has no silhouette.
    pub(super) fn light_of_surface(&self, table: &Spanned<LightTable>) -> Result<Light, SceneError> {
        if let Some(silhouette) = &table.get_ref().silhouette {
            let message = "makes a volume transparent, and a surface is opaque: leave it out";
            return Err(self.value(silhouette, "silhouette", message.into()));
        }
        self.light(table)
    }

    pub(super) fn light(&self, table: &Spanned<LightTable>) -> Result<Light, SceneError> {
        let t = table.get_ref();
        let or = |value: &Option<Spanned<f64>>, default: f64| value.as_ref().map_or(default, |v| *v.get_ref());
        // A silhouette alone leaves the luminance as it is.
        let lit = [&t.ambient, &t.diffuse, &t.specular, &t.shininess].iter().any(|v| v.is_some())
            || t.direction.is_some()
            || t.silhouette.is_none();
        let standard = Light::default();
        let defaults = if lit { standard.shares() } else { [1.0, 0.0, 0.0] };
        let shares = [or(&t.ambient, defaults[0]), or(&t.diffuse, defaults[1]), or(&t.specular, defaults[2])];
        let direction = t.direction.as_ref().map(|d| *d.get_ref());
        Light::new(direction, shares, or(&t.shininess, standard.shininess()), or(&t.silhouette, 0.0)).map_err(|error| {
            let at = |value: &Option<Spanned<f64>>, key| match value {
                Some(value) => self.value(value, key, error.to_string()),
                None => self.value(table, key, error.to_string()),
            };
            match error {
                LightError::Direction(_) => match &t.direction {
                    Some(direction) => self.value(direction, "direction", error.to_string()),
                    None => self.value(table, "direction", error.to_string()),
                },
                LightError::Negative { field: "ambient", .. } => at(&t.ambient, "ambient"),
                LightError::Negative { field: "diffuse", .. } => at(&t.diffuse, "diffuse"),
                LightError::Negative { field: "specular", .. } => at(&t.specular, "specular"),
                LightError::Negative { field: "shininess", .. } => at(&t.shininess, "shininess"),
                LightError::Negative { .. } => at(&t.silhouette, "silhouette"),
            }
        })
    }
}
