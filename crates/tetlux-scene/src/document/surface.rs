//! The tables `[[surface]]`.

use std::path::PathBuf;

use glam::DVec3;
use serde::Deserialize;
use tetlux_optics::Light;
use toml::Spanned;

use super::Source;
use super::light::LightTable;
use crate::{SceneError, SurfaceSpec};

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SurfaceTable {
    path: PathBuf,
    color: Option<Spanned<[f64; 3]>>,
    /// None: the scene's.
    light: Option<Spanned<LightTable>>,
    scale: Option<Spanned<f64>>,
    translate: Option<Spanned<[f64; 3]>>,
}

impl Source<'_> {
    /// A surface in a scene of this light.
    pub(super) fn surface(
        &self,
        table: &Spanned<SurfaceTable>,
        light: Option<Light>,
        beside: impl Fn(PathBuf) -> PathBuf,
    ) -> Result<SurfaceSpec, SceneError> {
        let t = table.get_ref();
        let mut surface = SurfaceSpec::new(beside(t.path.clone()), light);
        if let Some(color) = &t.color {
            surface.color = *color.get_ref();
            if surface.color.iter().any(|c| !(*c >= 0.0 && c.is_finite())) {
                let message = format!("{:?} must be finite and at least 0", surface.color);
                return Err(self.value(color, "color", message));
            }
        }
        if let Some(light) = &t.light {
            surface.light = self.light_of_surface(light)?;
        }
        surface.scale = self.positive(t.scale.as_ref(), "scale")?.unwrap_or(surface.scale);
        if let Some(translate) = &t.translate {
            surface.translate = DVec3::from(*translate.get_ref());
            if !surface.translate.is_finite() {
                let message = format!("{:?} must be finite", translate.get_ref());
                return Err(self.value(translate, "translate", message));
            }
        }
        Ok(surface)
    }
}
