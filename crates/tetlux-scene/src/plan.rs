//! What is done for a scene, and what is not, and why: decided before anything runs.

use glam::DVec3;
use rayon::prelude::*;
use tetlux_mesh::TetMesh;
use tetlux_optics::widget::Rectangle;

use crate::{Backend, Integrator, Order, Scene, SceneError, View};

/// What a plan needs to know of a graphics adapter.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Device {
    /// The adapter's name.
    pub name: String,
    /// It runs on the processor.
    pub software: bool,
    /// It blends into 32-bit floating-point targets.
    pub blends_f32: bool,
}

/// Cells that are not drawn, by the first reason that holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Skips {
    /// A vertex has no finite value: nothing can be classified.
    pub no_data: usize,
    /// Opacity is zero on the cell's whole scalar range.
    pub transparent: usize,
    /// Zero volume: no ray is inside for any length.
    pub flat: usize,
    /// Outside the frustum, or behind the eye.
    pub outside: usize,
}

/// The decisions for one picture of one mesh.
#[derive(Debug, Clone)]
pub struct Plan {
    /// `Gpu` or `Cpu`.
    pub backend: Backend,
    /// Any but `Auto`.
    pub order: Order,
    /// The integral inside a cell.
    pub integrator: Integrator,
    /// The camera resolved.
    pub view: View,
    /// The cells to draw, in mesh order.
    pub cells: Vec<u32>,
    /// The cells that are not drawn.
    pub skips: Skips,
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
        let view = scene.camera.view(scene.size)?;
        drawable(scene)?;
        let mut warnings = Vec::new();
        let (backend, backend_reason) = choose_backend(scene.method.backend, device)?;
        let (order, order_reason) = choose_order(scene, backend)?;
        if order == Order::Centroid {
            warnings.push(
                "centroid order is not exact: where the transfer function has narrow peaks, pixels may be wrong \
                 by far more than the budget (`compare` shows them; --order pixel mends them)"
                    .into(),
            );
        }
        let (cells, skips) = visible_cells(scene, mesh, &view);
        if skips.no_data > 0 {
            warnings.push(format!("{} cells have vertices without a finite value and are left out", skips.no_data));
        }
        let method = match scene.method.integrator {
            Integrator::Direct => "linear luminance and extinction, split at the function's control points",
            Integrator::Average => "mean luminance and extinction between control points: colour is approximate",
        };
        let reasons = vec![
            ("backend", format!("{backend}: {backend_reason}")),
            ("order", format!("{order}: {order_reason}")),
            ("integrator", format!("{}: {method}", scene.method.integrator)),
            (
                "cells",
                format!(
                    "{} of {} drawn; {} transparent, {} outside the view, {} flat, {} without data are skipped",
                    cells.len(),
                    mesh.cells().len(),
                    skips.transparent,
                    skips.outside,
                    skips.flat,
                    skips.no_data
                ),
            ),
        ];
        Ok(Plan { backend, order, integrator: scene.method.integrator, view, cells, skips, reasons, warnings })
    }
}

impl std::fmt::Display for Plan {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        for (what, why) in &self.reasons {
            writeln!(f, "  {what:<10} {why}")?;
        }
        Ok(())
    }
}

/// What no renderer draws yet is refused.
fn drawable(scene: &Scene) -> Result<(), SceneError> {
    if scene.classification.is_bivariate() {
        return Err(SceneError::Method(
            "no back end draws classification by two fields yet: use one field with a transfer function".into(),
        ));
    }
    if scene.lighting.is_some() {
        return Err(SceneError::Method("no back end draws light yet: leave out [light]".into()));
    }
    Ok(())
}

fn choose_backend(wanted: Backend, device: Option<&Device>) -> Result<(Backend, String), SceneError> {
    match (wanted, device) {
        (Backend::Cpu, _) => Ok((Backend::Cpu, "as asked".into())),
        (Backend::Gpu, Some(d)) if d.blends_f32 => Ok((Backend::Gpu, format!("as asked, on {}", d.name))),
        (Backend::Gpu, Some(d)) => Err(SceneError::Method(format!(
            "{} cannot blend 32-bit floating-point targets, without which the picture's error is not bounded: \
             use --backend cpu",
            d.name
        ))),
        (Backend::Gpu, None) => {
            Err(SceneError::Method("there is no graphics adapter: use --backend cpu, or install a driver".into()))
        }
        (Backend::Auto, None) => Ok((Backend::Cpu, "there is no graphics adapter".into())),
        (Backend::Auto, Some(d)) if d.software => {
            Ok((Backend::Cpu, format!("{} is this processor too, and the direct way is exact and faster", d.name)))
        }
        (Backend::Auto, Some(d)) if !d.blends_f32 => {
            Ok((Backend::Cpu, format!("{} cannot blend 32-bit floating-point targets", d.name)))
        }
        (Backend::Auto, Some(d)) => Ok((Backend::Gpu, d.name.clone())),
    }
}

fn choose_order(scene: &Scene, backend: Backend) -> Result<(Order, String), SceneError> {
    let one_luminance = scene.single_luminance().is_some();
    match (scene.method.order, backend) {
        (Order::Pixel, Backend::Gpu) => Err(SceneError::Method(
            "order \"pixel\" sorts every pixel's segments, which only the CPU back end does: use --backend cpu, \
             or --order centroid"
                .into(),
        )),
        (Order::Auto, _) if one_luminance => {
            Ok((Order::None, "there is one luminance throughout, so the order does not matter".into()))
        }
        (Order::Auto, Backend::Cpu) => Ok((Order::Pixel, "exact where cells do not overlap".into())),
        (Order::Auto, _) => Ok((Order::Centroid, "the only one this back end has".into())),
        (asked, _) => Ok((asked, "as asked".into())),
    }
}

/// Why a cell is not drawn.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Fate {
    Drawn,
    NoData,
    Transparent,
    Flat,
    Outside,
}

fn visible_cells(scene: &Scene, mesh: &TetMesh, view: &View) -> (Vec<u32>, Skips) {
    let offset = mesh.origin() - view.eye;
    let eye_space: Vec<DVec3> = mesh.points().par_iter().map(|p| view.rotate(p.as_dvec3() + offset)).collect();
    let frustum = view.frustum();
    let ranges = mesh.scalar_ranges(&scene.scalar);
    let second = scene.second.as_ref().map(|second| mesh.scalar_ranges(second));
    let fates: Vec<Fate> = mesh
        .cells()
        .par_iter()
        .enumerate()
        .map(|(index, cell)| {
            let p = cell.map(|v| eye_space[v as usize]);
            let range = Rectangle { s: ranges[index], g: second.as_ref().map_or([0.0; 2], |second| second[index]) };
            if range.s[0].is_nan() || range.g[0].is_nan() {
                Fate::NoData
            } else if !scene.classification.is_visible_over(&range) {
                Fate::Transparent
            } else if frustum.iter().any(|&(n, c)| p.iter().all(|&q| n.dot(q) + c < 0.0)) {
                Fate::Outside
            } else if is_flat(mesh, cell) {
                Fate::Flat
            } else {
                Fate::Drawn
            }
        })
        .collect();
    let count = |fate| fates.iter().filter(|&&f| f == fate).count();
    let skips = Skips {
        no_data: count(Fate::NoData),
        transparent: count(Fate::Transparent),
        flat: count(Fate::Flat),
        outside: count(Fate::Outside),
    };
    let cells = (0..fates.len() as u32).filter(|&c| fates[c as usize] == Fate::Drawn).collect();
    (cells, skips)
}

fn is_flat(mesh: &TetMesh, cell: &[u32; 4]) -> bool {
    let p = cell.map(|v| mesh.points()[v as usize].as_dvec3());
    (p[1] - p[0]).cross(p[2] - p[0]).dot(p[3] - p[0]) == 0.0
}

#[cfg(test)]
mod tests {
    use tetlux_mesh::procedural::{self, Split};
    use tetlux_mesh::{Component, Field};
    use tetlux_optics::Classification;
    use tetlux_optics::transfer::{ColorNode, OpacityNode, TransferFunction};

    use super::*;
    use crate::{Camera, Method, Projection};

    /// Cubes side by side along x, six cells each, from 0 to `n`, with the scalar x; the last point's value is missing.
    fn row(n: usize) -> TetMesh {
        let parts = procedural::cuboid([n, 1, 1], Split::Six, [DVec3::ZERO, DVec3::new(n as f64, 1.0, 1.0)]);
        let mut x = parts.sample(|p| p.x);
        *x.last_mut().unwrap() = f64::NAN;
        // A flat cell between three of the first cube's corners and the middle of one of its edges.
        let mut parts = parts;
        parts.points.push(DVec3::new(0.5, 0.0, 0.0));
        x.push(0.5);
        let flat = [0, 1, (n + 1) as u32, parts.points.len() as u32 - 1];
        parts.cells.push(flat);
        TetMesh::assemble(&parts.points, &parts.cells, vec![Field::point("x", 1, x)]).unwrap()
    }

    fn scene(mesh: &TetMesh, color: &[[f64; 3]], method: Method) -> Scene {
        let node = |(i, &rgb): (usize, &[f64; 3])| ColorNode { s: i as f64, rgb };
        Scene {
            scalar: mesh.scalar("x", Component::Magnitude).unwrap(),
            second: None,
            // Transparent up to 2.
            classification: Classification::OneField(
                TransferFunction::new(
                    color.iter().enumerate().map(node).collect(),
                    vec![OpacityNode { s: 2.0, opacity: 0.0 }, OpacityNode { s: 3.0, opacity: 1.0 }],
                )
                .unwrap(),
            ),
            lighting: None,
            unit_distance: 1.0,
            camera: Camera {
                position: DVec3::new(4.5, -3.0, 0.5),
                focal_point: DVec3::new(4.5, 0.0, 0.5),
                view_up: DVec3::Z,
                projection: Projection::Orthographic { parallel_scale: 0.75 },
                near: 0.0,
            },
            size: [10, 10],
            background: [0.0; 3],
            method,
        }
    }

    const GREY: [f64; 3] = [0.5; 3];

    fn device(software: bool, blends_f32: bool) -> Device {
        Device { name: "adapter".into(), software, blends_f32 }
    }

    #[test]
    fn each_cell_is_skipped_for_its_reason() {
        let mesh = row(7);
        let plan = Plan::new(&scene(&mesh, &[GREY], Method::default()), &mesh, None).unwrap();
        // The view spans x from 3.75 to 5.25: the cubes 3 to 6 x in [3, 6] are seen, of which all have opacity.
        // Cubes 0 and 1 and the flat cell lie below scalar 2. In the last cube the far corner's six cells (each holds
        // the diagonal's end) have no data.
        let expected = Skips { no_data: 6, transparent: 2 * 6 + 1, flat: 0, outside: 6 };
        assert_eq!(plan.skips, expected);
        assert_eq!(plan.cells, (3 * 6..6 * 6).collect::<Vec<u32>>());
        assert_eq!(plan.warnings.len(), 1, "missing data are warned of: {:?}", plan.warnings);
    }

    #[test]
    fn flat_cells_are_skipped() {
        let mesh = row(2);
        let mut scene = scene(&mesh, &[GREY], Method::default());
        let fog =
            TransferFunction::new(vec![ColorNode { s: 0.0, rgb: GREY }], vec![OpacityNode { s: 0.0, opacity: 1.0 }]);
        scene.classification = Classification::OneField(fog.unwrap());
        scene.camera.projection = Projection::Orthographic { parallel_scale: 10.0 };
        let plan = Plan::new(&scene, &mesh, None).unwrap();
        assert_eq!((plan.skips.flat, plan.skips.outside), (1, 0));
        assert!(!plan.cells.contains(&12));
    }

    #[test]
    fn cells_behind_the_eye_are_outside() {
        let mesh = row(2);
        let mut scene = scene(&mesh, &[GREY], Method::default());
        (scene.camera.position, scene.camera.focal_point) = (DVec3::new(0.0, 5.0, 0.5), DVec3::new(0.0, 9.0, 0.5));
        scene.camera.projection = Projection::Perspective { view_angle: 30.0 };
        assert!(Plan::new(&scene, &mesh, None).unwrap().cells.is_empty());
    }

    #[test]
    fn backends_and_orders() {
        let mesh = row(4);
        let colors = [[0.1, 0.2, 0.3], [0.3, 0.2, 0.1], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        let (hardware, software, half) = (device(false, true), device(true, true), device(false, false));
        for (backend, order, device, expected) in [
            (Backend::Auto, Order::Auto, None, Some((Backend::Cpu, Order::Pixel))),
            (Backend::Auto, Order::Auto, Some(&hardware), Some((Backend::Gpu, Order::Centroid))),
            (Backend::Auto, Order::Auto, Some(&software), Some((Backend::Cpu, Order::Pixel))),
            (Backend::Auto, Order::Auto, Some(&half), Some((Backend::Cpu, Order::Pixel))),
            (Backend::Gpu, Order::Auto, Some(&software), Some((Backend::Gpu, Order::Centroid))),
            (Backend::Gpu, Order::Auto, Some(&half), None),
            (Backend::Gpu, Order::Auto, None, None),
            (Backend::Gpu, Order::Pixel, Some(&hardware), None),
            (Backend::Cpu, Order::Centroid, Some(&hardware), Some((Backend::Cpu, Order::Centroid))),
        ] {
            let method = Method { backend, order, ..Method::default() };
            let plan = Plan::new(&scene(&mesh, &colors, method), &mesh, device);
            assert_eq!(plan.ok().map(|p| (p.backend, p.order)), expected, "{backend} {order} {device:?}");
        }
    }

    #[test]
    fn one_luminance_needs_no_order() {
        let mesh = row(4);
        let plan = Plan::new(&scene(&mesh, &[GREY], Method::default()), &mesh, Some(&device(false, true))).unwrap();
        assert_eq!(plan.order, Order::None);
        assert!(plan.warnings.iter().all(|w| !w.contains("centroid")));
    }
}
