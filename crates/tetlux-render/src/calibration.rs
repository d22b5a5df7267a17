//! What ways of drawing cost on an adapter, measured in a few small pictures.

use glam::DVec3;
use tetlux_mesh::procedural::{Split, cuboid};
use tetlux_mesh::{Component, Field, TetMesh};
use tetlux_optics::Classification;
use tetlux_optics::transfer::{ColorNode, OpacityNode, TransferFunction};
use tetlux_scene::{Backend, Camera, CellProjection, Cost, Costs, Method, Plan, Projection, Scene, Work};

use crate::{Model, RenderError, Renderer};

/// Cubes on an edge of the mesh, and pixels on a side of the picture: little of everything, more cells, more fragments.
const PICTURES: [(usize, u32); 3] = [(2, 64), (10, 64), (10, 256)];

/// Each is drawn so often after the first, which compiles and warms; the median counts.
const TIMES: usize = 3;

/// The stages whose time depends on the way of drawing: neither those that a mesh or a process passes once.
const COUNTED: [&str; 3] = ["order", "entries", "draw"];

impl Renderer {
    /// What the ways of drawing cost on the adapter: a second or two on a slow one.
    ///
    /// # Errors
    ///
    /// No adapter, or a driver that fails.
    pub fn costs(&self) -> Result<Costs, RenderError> {
        let cost = |projection| {
            let mut pictures = [(Work { cells: 0.0, fragments: 0.0 }, 0.0); 3];
            for (picture, (cubes, side)) in pictures.iter_mut().zip(PICTURES) {
                *picture = self.time(projection, cubes, side)?;
            }
            Ok::<_, RenderError>(Cost::measured(pictures))
        };
        Ok(Costs {
            pt: cost(CellProjection::Pt)?,
            tiles: cost(CellProjection::Tiles)?,
            march: cost(CellProjection::March)?,
        })
    }

    /// A picture's work and the median of its nanoseconds.
    fn time(&self, projection: CellProjection, cubes: usize, side: u32) -> Result<(Work, f64), RenderError> {
        let (mesh, scene) = sample(projection, cubes, side)?;
        let plan = Plan::new(&scene, &mesh, self.device()).map_err(sample_error)?;
        let model = Model::new(&mesh);
        let mut times = Vec::with_capacity(TIMES);
        for n in 0..=TIMES {
            let frame = self.render(&scene, &model, &plan)?;
            if n > 0 {
                let counted = frame.stages.iter().filter(|stage| COUNTED.contains(&stage.name));
                times.push(counted.map(|stage| 1e9 * stage.wall).sum::<f64>());
            }
        }
        times.sort_by(f64::total_cmp);
        Ok((Work::new(&mesh, &plan.view), times[TIMES / 2]))
    }
}

fn sample_error(error: impl std::fmt::Display) -> RenderError {
    RenderError::Sample(error.to_string())
}

/// A cube of fog in two colours, as thin as volumes are, that fills a picture.
pub(crate) fn sample(projection: CellProjection, cubes: usize, side: u32) -> Result<(TetMesh, Scene), RenderError> {
    let parts = cuboid([cubes; 3], Split::Six, [-DVec3::ONE, DVec3::ONE]);
    let field = Field::point("s", 1, parts.sample(|p| (3.0 * p.x).sin() + p.y * p.z));
    let mesh = TetMesh::assemble(&parts.points, &parts.cells, vec![field]).map_err(sample_error)?;
    let node =
        |i: u32| ColorNode { s: 0.5 * f64::from(i) - 2.0, rgb: [0.1 * f64::from(i), 0.5, 1.0 - 0.1 * f64::from(i)] };
    let opacity = |i: u32| OpacityNode { s: 0.5 * f64::from(i) - 2.0, opacity: 0.1 + 0.1 * f64::from(i % 3) };
    let transfer =
        TransferFunction::new((0..9).map(node).collect(), (0..9).map(opacity).collect()).map_err(sample_error)?;
    let scene = Scene {
        scalar: mesh.scalar("s", Component::Magnitude).map_err(sample_error)?,
        second: None,
        no_data: tetlux_optics::NoData::default(),
        classification: Classification::OneField(transfer),
        lighting: None,
        emphasis: None,
        surfaces: Vec::new(),
        unit_distance: 1.0,
        camera: Camera {
            position: DVec3::new(0.31, -7.0, 0.42),
            focal_point: DVec3::ZERO,
            view_up: DVec3::Z,
            projection: Projection::Perspective { view_angle: 18.0 },
            near: 0.0,
        },
        size: [side; 2],
        background: [0.0; 3],
        method: Method { backend: Backend::Gpu, projection, ..Method::default() },
    };
    Ok((mesh, scene))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_adapter_is_measured() {
        let renderer = Renderer::new();
        let Costs { pt, tiles, march } = renderer.costs().unwrap();
        for (way, cost) in [("pt", pt), ("tiles", tiles), ("march", march)] {
            let parts = [cost.picture, cost.cell, cost.fragment];
            assert!(parts.iter().all(|part| part.is_finite() && *part >= 0.0), "{way}: {cost:?}");
            // Nothing is free.
            assert!(cost.of(&Work { cells: 1e6, fragments: 1e7 }) > 0.0, "{way}: {cost:?}");
        }
    }
}
