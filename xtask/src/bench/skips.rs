//! What each skip of the plan saves, on a scene that it applies to.

use anyhow::Result;
use tetlux_optics::Classification;
use tetlux_optics::transfer::{ColorNode, OpacityNode, TransferFunction};
use tetlux_scene::{Backend, Method, Plan, Projection, Scene, Skip};

use super::Bench;
use super::scaling::{BOX, built_in};
use super::table::{Cell, Table};
use crate::explain::{Without, savings};
use crate::input::{Input, wing};
use crate::testbed::meshes::{Setting, cube};

/// The mesh, and what of it is looked at.
#[derive(Clone, Copy, PartialEq, Eq)]
enum On {
    /// The built-in scene.
    BuiltIn,
    /// The same on a smaller mesh and in a smaller picture, by wgpu.
    Adapter,
    /// A box, all of which is seen.
    Box,
}

/// A skip, and the scene: a change of one of those.
struct Case {
    skip: Skip,
    scene: &'static str,
    on: On,
    change: fn(&mut Scene),
}

const CASES: [Case; 14] = [
    Case { skip: Skip::Transparent, scene: "built-in", on: On::BuiltIn, change: |_| () },
    Case { skip: Skip::Faint, scene: "box, half of it haze, error budget 0.1", on: On::Box, change: half_haze },
    Case { skip: Skip::Outside, scene: "built-in, from nearby", on: On::BuiltIn, change: nearby },
    Case {
        skip: Skip::Opaque,
        scene: "built-in, 50 times as dense",
        on: On::BuiltIn,
        change: |scene| scene.unit_distance /= 50.0,
    },
    Case { skip: Skip::Order, scene: "box of one luminance", on: On::Box, change: of_one_luminance },
    Case { skip: Skip::LastOrder, scene: "box, its second picture", on: On::Box, change: |_| () },
    Case { skip: Skip::Gaps, scene: "box", on: On::Box, change: |_| () },
    Case { skip: Skip::Components, scene: "box", on: On::Box, change: |_| () },
    Case { skip: Skip::Cuts, scene: "built-in", on: On::BuiltIn, change: |_| () },
    Case { skip: Skip::Weights, scene: "box of three luminances", on: On::Box, change: in_steps },
    Case { skip: Skip::Gradients, scene: "built-in", on: On::BuiltIn, change: |_| () },
    Case { skip: Skip::Tables, scene: "built-in", on: On::BuiltIn, change: |_| () },
    Case { skip: Skip::Pipelines, scene: "built-in, wgpu", on: On::Adapter, change: |_| () },
    Case { skip: Skip::Uploads, scene: "built-in, wgpu, its second picture", on: On::Adapter, change: |_| () },
];

/// A third of the view angle: half of the mesh and more is beside the picture.
fn nearby(scene: &mut Scene) {
    if let Projection::Perspective { view_angle } = &mut scene.camera.projection {
        *view_angle /= 3.0;
    }
}

/// Gives the transfer function these colours.
pub(super) fn colored(scene: &mut Scene, color: Vec<ColorNode>) {
    if let Some(transfer) = scene.transfer()
        && let Ok(transfer) = TransferFunction::new(color, transfer.opacity_nodes().to_vec())
    {
        scene.classification = Classification::OneField(transfer);
    }
}

/// Haze that the budget spares below 0, dense above.
fn half_haze(scene: &mut Scene) {
    scene.method.max_error = 0.1;
    let opacity = [[-2.0, 2e-4], [0.0, 2e-4], [0.2, 20.0], [2.0, 30.0]].map(|[s, opacity]| OpacityNode { s, opacity });
    if let Some(transfer) = scene.transfer()
        && let Ok(transfer) = TransferFunction::new(transfer.color_nodes().to_vec(), opacity.to_vec())
    {
        scene.classification = Classification::OneField(transfer);
    }
}

fn of_one_luminance(scene: &mut Scene) {
    colored(scene, vec![ColorNode { s: 0.0, rgb: [1.0, 0.8, 0.5] }]);
}

/// One luminance up to a third of the range, another up to two thirds, a third beyond.
fn in_steps(scene: &mut Scene) {
    let [low, high] = scene.scalar.range;
    let places = [0.0, 1.0, 1.0, 2.0, 2.0, 3.0].map(|third| low + (high - low) * third / 3.0);
    let colors = [[0.1, 0.2, 0.9], [0.2, 0.9, 0.4], [1.0, 0.5, 0.1]];
    let nodes = places.into_iter().enumerate().map(|(i, s)| ColorNode { s, rgb: colors[i / 2] });
    colored(scene, nodes.collect());
}

impl Case {
    fn input(&self, bench: &Bench) -> Result<Input> {
        let (cells, size) = match (self.on, bench.quick) {
            (On::BuiltIn, false) => (100_000, [400; 2]),
            (On::Adapter, false) => (20_000, [100; 2]),
            _ => (6_000, [48; 2]),
        };
        let mut input = match self.on {
            On::Box if bench.quick => Setting { mesh: cube::<8>, ..BOX }.input("box", "", size[0])?,
            On::Box => Setting { mesh: cube::<25>, ..BOX }.input("box", "", 400)?,
            _ => built_in(wing(cells)?, size)?,
        };
        let backend = if self.on == On::Adapter { Backend::Gpu } else { Backend::Cpu };
        input.scene.method = Method { backend, ..input.scene.method };
        (self.change)(&mut input.scene);
        Ok(input)
    }
}

/// A table of all of them.
pub(crate) fn skips(bench: &Bench) -> Result<Table> {
    let mut rows = Vec::new();
    for case in &CASES {
        let input = case.input(bench)?;
        let device = bench.calibration.device(&input.scene, &input.mesh, bench.renderer)?;
        let plan = Plan::new(&input.scene, &input.mesh, device.as_ref())?;
        let saving = savings(&input, &plan).into_iter().find(|saving| saving.line.skip == case.skip);
        let (cells, bytes) = saving.map_or((0, 0), |saving| (saving.line.cells, saving.bytes));
        let Without { cpu_seconds: [with, without], difference } =
            Without::measure(&input, case.skip, bench.runs, &bench.calibration)?;
        let counted = |count: f64| if count > 0.0 { Cell::from(count) } else { Cell::Unknown };
        let times = [without[0], with[0], without[1], with[1]].map(|seconds| Cell::from(1e3 * seconds));
        let mut row = vec![
            Cell::from(format!("`{}`", case.skip)),
            case.scene.into(),
            input.mesh.cells().len().into(),
            counted(cells as f64),
            counted(bytes as f64),
        ];
        row.extend(times);
        row.push(difference.into());
        rows.push(row);
    }
    let head = [
        "skip",
        "scene",
        "cells",
        "cells spared",
        "bytes spared",
        "first picture without it, CPU ms",
        "with it",
        "next picture without it",
        "with it",
        "largest change of a pixel",
    ];
    Ok(Table {
        name: "skips",
        title: "What skipping saves".into(),
        notes: vec![
            "[The plan](plan.md) says what each leaves undone, and when. Each is measured alone: the picture without it does all \
             else as the plan has it. The next picture is of the same view."
                .into(),
            "Bytes are of what would be made for what is skipped: of cells their records, of the order its list, of gradients \
             and tables themselves, of uploads the mesh."
                .into(),
        ],
        head: head.map(String::from).into(),
        rows,
    })
}

#[cfg(test)]
mod tests {
    use tetlux_render::Renderer;
    use tetlux_scene::Fate;

    use super::*;

    #[test]
    fn every_skip_is_measured_on_a_scene_that_it_applies_to() {
        assert_eq!(CASES.each_ref().map(|case| case.skip), *Skip::ALL);
        let renderer = Renderer::new();
        let bench = Bench { quick: true, ..Bench::new(&renderer) };
        for case in &CASES {
            let input = case.input(&bench).unwrap();
            let plan = Plan::new(&input.scene, &input.mesh, renderer.device()).unwrap();
            let line = plan.lines.iter().find(|line| line.skip == case.skip).unwrap();
            assert!(matches!(line.fate, Fate::Skipped | Fate::Later), "{}: {line:?}", case.skip);
            let of_cells = matches!(case.skip, Skip::Transparent | Skip::Faint | Skip::Outside);
            assert_eq!(line.cells > 0, of_cells, "{}: {line:?}", case.skip);
        }
    }
}
