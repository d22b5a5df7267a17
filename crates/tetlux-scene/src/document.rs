//! The scene file as TOML: keys, types, and the places of impossible values.

mod emphasis;
mod light;
mod surface;
mod transfer;
mod widget;

use std::ops::Range;
use std::path::{Path, PathBuf};

use glam::DVec3;
use serde::Deserialize;
use toml::Spanned;

use crate::file::CameraSpec;
use crate::{
    Backend, CellProjection, Classification, Integrator, Interpolation, Method, Order, Projection, SceneError,
    SceneFile, TablePrecision, Target,
};
use emphasis::EmphasisTable;
use light::LightTable;
use surface::SurfaceTable;
use transfer::Transfer;
use widget::WidgetTable;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Document {
    #[serde(default)]
    title: String,
    #[serde(default)]
    mesh: Mesh,
    #[serde(default)]
    field: Field,
    transfer: Spanned<Transfer>,
    #[serde(default)]
    widget: Vec<Spanned<WidgetTable>>,
    light: Option<Spanned<LightTable>>,
    emphasis: Option<Spanned<EmphasisTable>>,
    #[serde(default)]
    surface: Vec<Spanned<SurfaceTable>>,
    #[serde(default)]
    camera: Vec<Spanned<Camera>>,
    #[serde(default)]
    image: Image,
    #[serde(default)]
    method: MethodTable,
}

#[derive(Default, Deserialize)]
#[serde(deny_unknown_fields)]
struct Mesh {
    path: Option<PathBuf>,
    #[serde(default)]
    built_in: bool,
    solution: Option<PathBuf>,
    split: Option<Spanned<u32>>,
}

#[derive(Default, Deserialize)]
#[serde(deny_unknown_fields)]
struct Field {
    name: Option<String>,
    component: Option<usize>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Camera {
    position: Option<[f64; 3]>,
    focal_point: Option<[f64; 3]>,
    direction: Option<[f64; 3]>,
    view_up: Option<[f64; 3]>,
    view_angle: Option<Spanned<f64>>,
    parallel_scale: Option<Spanned<f64>>,
    near: Option<Spanned<f64>>,
}

#[derive(Default, Deserialize)]
#[serde(deny_unknown_fields)]
struct Image {
    size: Option<Spanned<[u32; 2]>>,
    background: Option<Spanned<[f32; 3]>>,
    #[serde(default)]
    display_space: bool,
}

#[derive(Default, Deserialize)]
#[serde(deny_unknown_fields)]
struct MethodTable {
    #[serde(default)]
    backend: Backend,
    #[serde(default)]
    order: Order,
    #[serde(default)]
    projection: CellProjection,
    #[serde(default)]
    interpolation: Interpolation,
    #[serde(default)]
    integrator: Integrator,
    #[serde(default)]
    classification: Classification,
    #[serde(default)]
    table_precision: TablePrecision,
    #[serde(default)]
    target: Target,
    pieces: Option<u32>,
    max_error: Option<Spanned<f64>>,
}

/// Largest width or height of a picture, in pixels.
pub(crate) const MAX_SIDE: u32 = 32768;

/// Reads the text of a scene file; `path` is where it came from.
pub(crate) fn parse(path: &Path, text: &str) -> Result<SceneFile, SceneError> {
    let source = Source { path, text };
    let document: Document = toml::from_str(text).map_err(|e| SceneError::Syntax {
        path: path.display().to_string(),
        line: line_of(text, &e.span().unwrap_or_default()),
        message: e.message().to_string(),
    })?;
    let beside = |file: PathBuf| path.parent().unwrap_or(Path::new("")).join(file);

    let Document { title, mesh, field, transfer, widget, light, emphasis, surface, camera, image, method } = document;
    if let Some(split) = &mesh.split
        && ![5, 6].contains(split.get_ref())
    {
        return Err(source.value(
            split,
            "split",
            format!("{} must be 5 or 6 tetrahedra a hexahedron", split.get_ref()),
        ));
    }
    let size = image.size.as_ref().map_or([800, 800], |s| *s.get_ref());
    if let Some(spanned) = &image.size
        && size.iter().any(|&n| n == 0 || n > MAX_SIDE)
    {
        return Err(source.value(spanned, "size", format!("{size:?} must be 1 to {MAX_SIDE} pixels each way")));
    }
    let background = image.background.as_ref().map_or([0.0; 3], |b| *b.get_ref());
    if let Some(spanned) = &image.background
        && background.iter().any(|c| !(*c >= 0.0 && c.is_finite()))
    {
        return Err(source.value(spanned, "background", format!("{background:?} must be finite and at least 0")));
    }
    let unit_distance = source.unit_distance(transfer.get_ref())?;
    let max_error = source.positive(method.max_error.as_ref(), "max_error")?;
    let light = light.map(|light| source.light(&light)).transpose()?;
    Ok(SceneFile {
        title,
        mesh: mesh.path.map(beside),
        built_in: mesh.built_in,
        solution: mesh.solution.map(beside),
        split: mesh.split.map(Spanned::into_inner),
        field: field.name,
        component: field.component,
        second: source.second(&transfer, &widget)?,
        range: source.range(&transfer)?,
        transfer: source.transfer(&transfer, &widget, beside)?,
        nan_color: source.nan_color(transfer.get_ref())?,
        nan_opacity: source.nan_opacity(transfer.get_ref())?,
        emphasis: emphasis.map(|emphasis| source.emphasis(&emphasis)).transpose()?,
        light,
        surfaces: surface.iter().map(|s| source.surface(s, light, beside)).collect::<Result<_, _>>()?,
        unit_distance,
        cameras: camera.into_iter().map(|c| source.camera(c)).collect::<Result<_, _>>()?,
        size,
        background,
        display_space: image.display_space,
        method: Method {
            backend: method.backend,
            order: method.order,
            projection: method.projection,
            interpolation: method.interpolation,
            integrator: method.integrator,
            classification: method.classification,
            table_precision: method.table_precision,
            target: method.target,
            pieces: method.pieces,
            max_error: max_error.unwrap_or(Method::default().max_error),
            no_skip: Method::default().no_skip,
        },
        name: path.display().to_string(),
    })
}

/// Where a value stands, for messages.
struct Source<'a> {
    path: &'a Path,
    text: &'a str,
}

impl Source<'_> {
    fn value<T>(&self, at: &Spanned<T>, key: &'static str, message: String) -> SceneError {
        let line = line_of(self.text, &at.span());
        SceneError::Value { path: self.path.display().to_string(), line, key, message }
    }

    fn positive(&self, value: Option<&Spanned<f64>>, key: &'static str) -> Result<Option<f64>, SceneError> {
        match value {
            Some(v) if !(*v.get_ref() > 0.0 && v.get_ref().is_finite()) => {
                Err(self.value(v, key, format!("{} must be positive and finite", v.get_ref())))
            }
            _ => Ok(value.map(|v| *v.get_ref())),
        }
    }

    fn camera(&self, camera: Spanned<Camera>) -> Result<CameraSpec, SceneError> {
        let c = camera.get_ref();
        if c.position.is_some() && c.direction.is_some() {
            return Err(self.value(&camera, "camera", "has a position and a direction: keep one of them".into()));
        }
        let view_angle = self.positive(c.view_angle.as_ref(), "view_angle")?;
        let parallel_scale = self.positive(c.parallel_scale.as_ref(), "parallel_scale")?;
        if let Some(angle) = &c.view_angle {
            if *angle.get_ref() >= 180.0 {
                return Err(self.value(angle, "view_angle", format!("{} must be below 180 degrees", angle.get_ref())));
            }
            if parallel_scale.is_some() {
                return Err(self.value(
                    angle,
                    "view_angle",
                    "is for perspective, parallel_scale for orthographic views: keep one of them".into(),
                ));
            }
        }
        if let Some(near) = &c.near
            && !(*near.get_ref() >= 0.0 && near.get_ref().is_finite())
        {
            return Err(self.value(near, "near", format!("{} must be finite and at least 0", near.get_ref())));
        }
        Ok(CameraSpec {
            position: c.position.map(DVec3::from),
            focal_point: c.focal_point.map(DVec3::from),
            direction: c.direction.map(DVec3::from),
            view_up: c.view_up.map_or(DVec3::Z, DVec3::from),
            projection: match (view_angle, parallel_scale) {
                (_, Some(parallel_scale)) => Some(Projection::Orthographic { parallel_scale }),
                (Some(view_angle), None) => Some(Projection::Perspective { view_angle }),
                (None, None) => None,
            },
            near: c.near.as_ref().map_or(0.0, |n| *n.get_ref()),
        })
    }
}

fn line_of(text: &str, span: &Range<usize>) -> usize {
    let start = span.start.min(text.len());
    1 + text.as_bytes()[..start].iter().filter(|&&b| b == b'\n').count()
}
