//! What is done for a scene, and what is not, and why: decided before anything runs.

mod skips;
#[cfg(test)]
mod tests;

use std::sync::Arc;

use tetlux_mesh::{ScalarField, TetMesh};
use tetlux_optics::Classification::Widgets;
use tetlux_optics::TransferFunction;

use crate::budget::{of_rounding, spend, state};
use crate::file::gradient_name;
use crate::integral::{choose_integrator, integral_of};
use crate::look;
use crate::one_peak::beyond_published;
use crate::reason::{of_classification, of_interpolation, of_projection, of_table_precision, of_target};
use crate::{
    Backend, CellProjection, Classification, Costs, Integrator, Interpolation, Method, Order, Planner, Scene,
    SceneError, Skip, SkipLine, SkipSet, Skips, Stated, TablePrecision, Target, View, Work,
};

/// What a plan needs to know of a graphics adapter.
#[derive(Debug, Clone, PartialEq)]
pub struct Device {
    /// The adapter's name.
    pub name: String,
    /// Its driver's name and version.
    pub driver: String,
    /// It runs on the processor.
    pub software: bool,
    /// It blends into 32-bit floating-point targets.
    pub blends_f32: bool,
    /// It has textures of 16-bit normalised integers.
    pub norm16: bool,
    /// What the ways of drawing cost there, where that has been measured.
    pub costs: Option<Costs>,
}

/// The decisions for one picture of one mesh.
#[derive(Debug, Clone)]
pub struct Plan {
    /// `Gpu` or `Cpu`.
    pub backend: Backend,
    /// Any but `Auto`.
    pub order: Order,
    /// How cells become fragments. This and the other axes are never `Auto`; they apply to the graphics back end.
    pub projection: CellProjection,
    /// How a fragment comes by its segment.
    pub interpolation: Interpolation,
    /// The integral inside a cell.
    pub integrator: Integrator,
    /// Where scalars become luminance and extinction.
    pub classification: Classification,
    /// The format of tables, where the integral has one.
    pub table_precision: TablePrecision,
    /// Equal pieces a segment of [`Integrator::Approximate`].
    pub pieces: u32,
    /// The format of the picture while it is composited.
    pub target: Target,
    /// The camera resolved.
    pub view: View,
    /// Luminance (linear RGB) and opacity at every point, as seen by this view, where the scene has an emphasis: they are
    /// linear in each cell, and nothing else is classified.
    pub colors: Option<Arc<[[f64; 4]]>>,
    /// The cells to draw, in mesh order.
    pub cells: Vec<u32>,
    /// The cells that are not drawn.
    pub skips: Skips,
    /// The transfer function with fewer nodes, where the error budget allows that.
    pub transfer: Option<TransferFunction>,
    /// Error of a pixel that may lie behind others that count as opaque; 0 if none do.
    pub hidden: f64,
    /// All that is not done, and why, or why it must be.
    pub lines: Vec<SkipLine>,
    /// What is done though it need not be.
    pub kept: SkipSet,
    /// The error that the picture is stated to have.
    pub stated: Stated,
    /// Each decision and its reason.
    pub reasons: Vec<(&'static str, String)>,
    /// What may spoil the picture.
    pub warnings: Vec<String>,
}

impl Plan {
    /// Decides for a scene on a mesh; `device` is the adapter there is, if any.
    ///
    /// # Errors
    ///
    /// A camera that sees nothing, or a combination of backend, order and device that cannot be.
    pub fn new(scene: &Scene, mesh: &TetMesh, device: Option<&Device>) -> Result<Plan, SceneError> {
        Planner::new(mesh).plan(scene, device)
    }

    pub(crate) fn with(planner: &Planner, scene: &Scene, device: Option<&Device>) -> Result<Plan, SceneError> {
        let view = scene.camera.view(scene.size)?;
        let mut warnings = Vec::new();
        let method = method_of(scene)?;
        if let Some(reason) = method.refusal() {
            return Err(SceneError::Method(reason));
        }
        if let Some(reason) = look::refusal(scene) {
            return Err(SceneError::Method(reason));
        }
        let integrator = choose_integrator(scene)?;
        if integrator.is_pre_integrated() && !scene.seen_without_data().is_empty() {
            return Err(SceneError::Method(format!(
                "integrator \"{integrator}\" looks up the transfer function, which cells without data are beyond: use direct, \
                 or nan_opacity = 0"
            )));
        }
        let (backend, backend_reason) = match method.classification {
            Classification::Vertex if scene.lighting.is_some() => choose_cpu(&method)?,
            _ => choose_backend(&method, device)?,
        };
        let (first, second) = planner.ranges(scene);
        let measures = planner.measures(scene, &first);
        let spent = spend(scene, &measures, backend);
        let work = (!look::is_asked(scene)).then(|| Work::new(planner.mesh(), &view));
        let (projection, projection_reason) = choose_projection(&method, backend, device, work.as_ref());
        let (order, order_reason) = choose_order(scene, integrator, projection, spent.order);
        let (target, target_reason) = choose_target(method.target, projection, device);
        let (table_precision, fallback) = choose_table_precision(method.table_precision, device);
        let integrator = if spent.average.is_some() { Integrator::Average } else { integrator };
        let decided = Method { backend, order, projection, integrator, table_precision, target, ..method.decided() };
        let tables = integrator.uses_table();
        warnings.extend(fallback.filter(|_| tables));
        warnings.extend(doubts_of(order).map(String::from));
        if backend == Backend::Gpu && target != Target::Rgba32f {
            warnings.push(format!("target {target}: {}", of_target(target)));
        }
        let kept = scene.method.no_skip;
        let colors = scene.emphasis.as_ref().map(|emphasis| emphasis.seen(planner.mesh(), &view));
        let (cells, skips) =
            planner.cells(scene, &view, (&first, second.as_ref()), colors.as_deref(), spent.faint, kept);
        let stated = state(scene, &measures, &decided, &spent, skips.faint > 0);
        warnings.extend(stated.shortfall(scene.method.max_error));
        if skips.no_data > 0 {
            warnings.push(format!("{} cells have vertices without a finite value and are left out", skips.no_data));
        }
        let pieces = scene.method.pieces.unwrap_or(Method::PUBLISHED_PIECES);
        if let (Integrator::Analytic, Widgets(function)) = (integrator, &scene.classification) {
            warnings.extend(beyond_published(scene, planner.mesh(), &cells, function));
        }
        let mut reasons =
            vec![("backend", format!("{backend}: {backend_reason}")), ("order", format!("{order}: {order_reason}"))];
        if backend == Backend::Gpu {
            let why = projection_reason.map_or(String::new(), |reason| format!("; {reason}"));
            reasons.push(("projection", says(decided.projection, of_projection) + &why));
            if !matches!(projection, CellProjection::Balanced | CellProjection::March) {
                reasons.push(("interpolation", says(decided.interpolation, of_interpolation)));
            }
        }
        reasons.push(("integrator", integral_of(scene, integrator, pieces)));
        if tables {
            reasons.push(("table", says(table_precision, of_table_precision)));
        }
        if backend == Backend::Gpu || decided.classification == Classification::Vertex {
            let why = |c| {
                if colors.is_some() { "luminance and extinction linear in each cell" } else { of_classification(c) }
            };
            reasons.push(("classification", format!("{}: {}", decided.classification, why(decided.classification))));
        }
        reasons.extend(scene.emphasis.as_ref().map(|emphasis| ("emphasis", emphasis.emphasis().to_string())));
        if backend == Backend::Gpu {
            reasons.push(("target", format!("{target}: {target_reason}")));
        }
        reasons.push(("gradients", of_gradients(scene).into()));
        reasons.extend(of_no_data(scene).map(|what| ("no data", what)));
        reasons.extend(of_surfaces(scene).map(|what| ("surfaces", what)));
        reasons.push((
            "cells",
            format!(
                "{} of {} drawn; {} transparent, {} faint, {} outside the view, {} flat, {} without data are skipped",
                cells.len(),
                planner.mesh().cells().len(),
                skips.transparent,
                skips.faint,
                skips.outside,
                skips.flat,
                skips.no_data
            ),
        ));
        reasons.push(("error", format!("{stated} (budget {:.1e})", scene.method.max_error)));
        let lines = skips::lines(scene, planner.mesh(), &decided, &spent, &skips);
        let Method { projection, interpolation, classification, .. } = decided;
        Ok(Plan {
            backend,
            order,
            projection,
            interpolation,
            integrator,
            classification,
            table_precision,
            pieces,
            target,
            view,
            colors,
            cells,
            skips,
            transfer: spent.transfer.map(|(transfer, _)| transfer),
            hidden: spent.hidden,
            lines,
            kept,
            stated,
            reasons,
            warnings,
        })
    }

    /// Whether something may be left undone: it is not asked to be done all the same.
    pub fn may_skip(&self, skip: Skip) -> bool {
        !self.kept.contains(skip)
    }
}

impl Plan {
    /// Whether a plan would follow what the device's ways of drawing cost ([`Device::costs`]), if that were known: a graphics
    /// adapter is to draw more than a little of one field without light, and no way of drawing is asked for.
    ///
    /// # Errors
    ///
    /// As [`Plan::new`].
    pub fn follows_costs(scene: &Scene, mesh: &TetMesh, device: Option<&Device>) -> Result<bool, SceneError> {
        let method = method_of(scene)?;
        if look::is_asked(scene) || !method.follows_costs() {
            return Ok(false);
        }
        let (backend, _) = choose_backend(&method, device)?;
        let view = scene.camera.view(scene.size)?;
        Ok(backend == Backend::Gpu && !Work::new(mesh, &view).is_small())
    }
}

/// The method that a scene asks for: with an emphasis it is classified at the vertices.
fn method_of(scene: &Scene) -> Result<Method, SceneError> {
    if scene.emphasis.is_none() {
        return Ok(scene.method);
    }
    if scene.classification.is_bivariate() {
        return Err(SceneError::Method(
            "an emphasis is for one field with a transfer function: leave one of them out".into(),
        ));
    }
    match scene.method.classification {
        Classification::Auto | Classification::Vertex => {
            Ok(Method { classification: Classification::Vertex, ..scene.method })
        }
        other => Err(SceneError::Method(format!(
            "an emphasis is made of derivatives at the vertices, and classification \"{other}\" looks between them: use vertex, \
             or leave out [emphasis]"
        ))),
    }
}

/// A choice and its reason.
pub(crate) fn says<T: Copy + std::fmt::Display>(choice: T, reason: fn(T) -> &'static str) -> String {
    format!("{choice}: {}", reason(choice))
}

impl std::fmt::Display for Plan {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        for (what, why) in &self.reasons {
            writeln!(f, "  {what:<14} {why}")?;
        }
        Ok(())
    }
}

/// What gradients are computed for, or that they are not.
fn of_gradients(scene: &Scene) -> &'static str {
    let of_scalar = |second: &ScalarField| second.name == gradient_name(&scene.scalar);
    if scene.emphasis.is_some() {
        return match scene.lighting {
            Some(_) => {
                "computed: the emphasis takes them and the second derivatives along them, and light takes them for normals"
            }
            None => "computed: the emphasis takes them and the second derivatives along them",
        };
    }
    match (scene.lighting.is_some(), scene.second.as_ref().is_some_and(of_scalar)) {
        (true, true) => "computed: their magnitude is the second scalar, and light takes them for normals",
        (true, false) => "computed: light takes them for normals",
        (false, true) => "computed: their magnitude is the second scalar",
        (false, false) => "skipped: nothing asks for them",
    }
}

/// The back end of light on what is classified at the vertices.
fn choose_cpu(method: &Method) -> Result<(Backend, String), SceneError> {
    const WHAT: &str = "light with classification \"vertex\"";
    if method.backend == Backend::Gpu {
        return Err(SceneError::Method(format!(
            "{WHAT} is drawn by the CPU back end alone: use --backend cpu, or use post-exact"
        )));
    }
    if let Some(other) = method.gpu_only() {
        return Err(SceneError::Method(format!(
            "{WHAT} is drawn by the CPU back end alone, and {other} is a method of graphics adapters: leave that out"
        )));
    }
    let why = if method.backend == Backend::Cpu { "as asked".into() } else { format!("{WHAT} needs it") };
    Ok((Backend::Cpu, why))
}

/// What cells without data look like, if any are seen.
fn of_no_data(scene: &Scene) -> Option<String> {
    let of: Vec<String> =
        scene.seen_without_data().iter().map(|scalar| format!("{} of \"{}\"", scalar.missing, scalar.name)).collect();
    let ([r, g, b], opacity) = (scene.no_data.luminance(), scene.no_data.opacity());
    let values = of.join(", ");
    (!of.is_empty()).then(|| {
        format!("values that are not finite ({values}): their cells have opacity {opacity} and colour {r} {g} {b}")
    })
}

/// What opaque surfaces there are, if any.
fn of_surfaces(scene: &Scene) -> Option<String> {
    let triangles: usize = scene.surfaces.iter().map(|surface| surface.triangles().len()).sum();
    let count = scene.surfaces.len();
    (count > 0).then(|| format!("{count} of {triangles} triangles: the first that a ray meets ends the volume"))
}

fn choose_backend(method: &Method, device: Option<&Device>) -> Result<(Backend, String), SceneError> {
    // Marches and tiles blend nothing, and other formats every device blends.
    let marches = method.marches() || method.projection == CellProjection::Tiles;
    let blends = |d: &Device| d.blends_f32 || marches || method.target != Target::Rgba32f;
    let cannot_blend = |d: &Device| {
        SceneError::Method(format!(
            "{} cannot blend 32-bit floating-point targets: use --projection tiles or march, --backend cpu, or --target rgba16f, \
             which is off by up to 5e-2",
            d.name
        ))
    };
    let gpu_only = method.gpu_only();
    match (method.backend, device) {
        (Backend::Cpu, _) => Ok((Backend::Cpu, "as asked".into())),
        (Backend::Auto, _) if method.order == Order::Pixel => Ok((Backend::Cpu, "order pixel needs it".into())),
        (Backend::Gpu, Some(d)) if blends(d) => Ok((Backend::Gpu, format!("as asked, on {}", d.name))),
        (Backend::Gpu, Some(d)) => Err(cannot_blend(d)),
        (Backend::Gpu, None) => {
            Err(SceneError::Method("there is no graphics adapter: use --backend cpu, or install a driver".into()))
        }
        (Backend::Auto, None) => match gpu_only {
            Some(what) => Err(SceneError::Method(format!("{what} needs a graphics adapter, and there is none"))),
            None => Ok((Backend::Cpu, "there is no graphics adapter".into())),
        },
        (Backend::Auto, Some(d)) => match gpu_only {
            Some(_) if !blends(d) => Err(cannot_blend(d)),
            Some(what) => Ok((Backend::Gpu, format!("{what} needs it; on {}", d.name))),
            None if d.software => {
                Ok((Backend::Cpu, format!("{} is this processor too, and the direct way is exact and faster", d.name)))
            }
            None if method.max_error < of_rounding(Backend::Gpu) => Ok((
                Backend::Cpu,
                format!("it rounds less than {} does, as an error of {:.1e} asks for", d.name, method.max_error),
            )),
            None if !d.blends_f32 && !marches => {
                Ok((Backend::Cpu, format!("{} cannot blend 32-bit floating-point targets", d.name)))
            }
            None => Ok((Backend::Gpu, d.name.clone())),
        },
    }
}

/// What may be wrong in a picture of that order.
fn doubts_of(order: Order) -> Option<&'static str> {
    match order {
        Order::Auto | Order::Exact | Order::Pixel | Order::None => None,
        Order::Centroid => Some(
            "centroid order is not exact: where the transfer function has narrow peaks, pixels may be wrong by far \
             more than the budget (`compare` shows them; --order exact mends them)",
        ),
        Order::Power => {
            Some("power order is right on Delaunay meshes alone, and elsewhere worse than centroid: --order exact")
        }
        Order::Mpvo => Some("mpvo order is right on convex meshes alone: --order exact on others"),
        Order::Mpvonc => Some("mpvonc order is a guess where the mesh is not convex: --order exact is right there too"),
    }
}

/// What the device was measured to do fastest, or else the march where single precision cannot be blended, unless another is
/// asked for; and why it is that and no other. `work` is that of one field without light, of which costs are known.
fn choose_projection(
    method: &Method,
    backend: Backend,
    device: Option<&Device>,
    work: Option<&Work>,
) -> (CellProjection, Option<String>) {
    if method.projection != CellProjection::Auto {
        return (method.projection, None);
    }
    let device = device.filter(|_| backend == Backend::Gpu);
    let measured = device.and_then(|d| Some((d, d.costs.as_ref()?))).zip(work.filter(|work| !work.is_small()));
    if let Some((projection, why)) = measured.and_then(|((d, costs), work)| costs.choose(method, work, d.blends_f32)) {
        return (projection, Some(why));
    }
    match device {
        Some(d) if !d.blends_f32 && method.marches() => {
            (CellProjection::March, Some(format!("{} blends no 32-bit floats", d.name)))
        }
        _ => (CellProjection::Pt, None),
    }
}

/// The best that the adapter can blend, unless one is asked for.
fn choose_target(asked: Target, projection: CellProjection, device: Option<&Device>) -> (Target, String) {
    if matches!(projection, CellProjection::March | CellProjection::Tiles) {
        return (Target::Rgba32f, "composited in registers".into());
    }
    let target = match asked {
        Target::Auto if device.is_some_and(|d| !d.blends_f32) => Target::Rgba16f,
        Target::Auto => Target::Rgba32f,
        asked => asked,
    };
    let why =
        if target == Target::Rgba16f && asked == Target::Auto { "the adapter blends no 32-bit floats; " } else { "" };
    (target, format!("{why}{}", of_target(target)))
}

/// The format of tables, and a warning if it is not what is asked for.
fn choose_table_precision(asked: TablePrecision, device: Option<&Device>) -> (TablePrecision, Option<String>) {
    match (asked, device) {
        (TablePrecision::Auto, _) => (TablePrecision::F32, None),
        (TablePrecision::U16, Some(d)) if !d.norm16 => (
            TablePrecision::F32,
            Some(format!("{} has no textures of 16-bit integers: tables are in single precision instead", d.name)),
        ),
        (asked, _) => (asked, None),
    }
}

fn choose_order(
    scene: &Scene,
    integrator: Integrator,
    projection: CellProjection,
    affordable: Option<f64>,
) -> (Order, String) {
    if projection == CellProjection::March {
        return (Order::None, "the march finds the next cell itself".into());
    }
    // What absorbs little may glow as much as what absorbs a lot, where emission is a density: order matters then.
    let one_luminance = scene.single_luminance().is_some()
        && !integrator.is_published_bivariate()
        && !scene.method.no_skip.contains(Skip::Order);
    match (scene.method.order, affordable) {
        (Order::Auto, _) if one_luminance => {
            (Order::None, "there is one luminance throughout, so the order does not matter".into())
        }
        (Order::Auto, Some(error)) => {
            (Order::None, format!("the volume is so thin that no order changes a pixel by more than {error:.1e}"))
        }
        (Order::Auto, None) => (Order::Exact, "right along every ray of the picture, on every mesh".into()),
        (asked, _) => (asked, "as asked".into()),
    }
}
