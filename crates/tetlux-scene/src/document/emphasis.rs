//! The table `[emphasis]`.

use serde::Deserialize;
use tetlux_optics::emphasis::{Boundary, Contour, Emphasis, Steepness};
use toml::Spanned;

use super::Source;
use crate::SceneError;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct EmphasisTable {
    gradient: Option<Spanned<SteepnessTable>>,
    contour: Option<Spanned<ContourTable>>,
    boundary: Option<Spanned<BoundaryTable>>,
    silhouette: Option<Spanned<SilhouetteTable>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct SteepnessTable {
    range: Option<[f64; 2]>,
    power: Option<f64>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ContourTable {
    value: f64,
    width: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct BoundaryTable {
    sigma: Option<f64>,
    width: Option<f64>,
    threshold: Option<f64>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct SilhouetteTable {
    power: Option<f64>,
}

/// Share of the largest gradient up to which nothing is a boundary: a Gaussian's blur has it at three sigma.
const THRESHOLD: f64 = 0.01;

impl Source<'_> {
    pub(super) fn emphasis(&self, table: &Spanned<EmphasisTable>) -> Result<Emphasis, SceneError> {
        let t = table.get_ref();
        let emphasis = Emphasis {
            gradient: t.gradient.as_ref().map(|g| {
                let SteepnessTable { range, power } = *g.get_ref();
                Steepness { range, power: power.unwrap_or(1.0) }
            }),
            contour: t.contour.as_ref().map(|c| {
                let ContourTable { value, width } = *c.get_ref();
                Contour { value, width }
            }),
            boundary: t.boundary.as_ref().map(|b| {
                let BoundaryTable { sigma, width, threshold } = *b.get_ref();
                Boundary { sigma, width, threshold: threshold.unwrap_or(THRESHOLD) }
            }),
            silhouette: t.silhouette.as_ref().map(|s| s.get_ref().power.unwrap_or(1.0)),
        };
        if emphasis == Emphasis::default() {
            let say = "names nothing to emphasise: give gradient, contour, boundary or silhouette, such as \
                       silhouette = { power = 2.0 }";
            return Err(self.value(table, "emphasis", say.into()));
        }
        emphasis.check().map(|()| emphasis).map_err(|error| {
            let message = error.to_string();
            match (error.member, &t.gradient, &t.contour, &t.boundary, &t.silhouette) {
                ("gradient", Some(at), ..) => self.value(at, "emphasis", message),
                ("contour", _, Some(at), ..) => self.value(at, "emphasis", message),
                ("boundary", _, _, Some(at), _) => self.value(at, "emphasis", message),
                ("silhouette", .., Some(at)) => self.value(at, "emphasis", message),
                _ => self.value(table, "emphasis", message),
            }
        })
    }
}
