//! What a picture does without, and what each of that saves, measured.

use anyhow::Result;
use serde::Serialize;
use tetlux_image::{Image, compare};
use tetlux_render::{Frame, Renderer, Stage, bytes_saved};
use tetlux_scene::{Fate, Plan, Planner, Scene, Skip, SkipLine};

use crate::calibration::Calibration;
use crate::input::Input;
use crate::report::median;
use crate::{progress, tables};

/// A line of the plan, and what it saves.
#[derive(Serialize)]
pub(crate) struct Saving {
    #[serde(flatten)]
    pub(crate) line: SkipLine,
    /// Bytes of memory, as far as they are known before the picture.
    pub(crate) bytes: u64,
    /// Processor milliseconds of the first picture and of a further one, without it less with it.
    #[serde(skip_serializing_if = "Option::is_none")]
    cpu_ms: Option<[f64; 2]>,
    /// Largest change of a pixel.
    #[serde(skip_serializing_if = "Option::is_none")]
    difference: Option<f64>,
}

/// The lines of a plan.
pub(crate) fn savings(input: &Input, plan: &Plan) -> Vec<Saving> {
    let saving = |line: &SkipLine| Saving {
        bytes: bytes_saved(&input.scene, &input.mesh, plan, line),
        line: line.clone(),
        cpu_ms: None,
        difference: None,
    };
    plan.lines.iter().map(saving).collect()
}

/// Says what became of what only the picture could tell.
pub(crate) fn resolve(savings: &mut [Saving], frame: &Frame) {
    for Saving { line, bytes, .. } in savings.iter_mut().filter(|saving| saving.line.fate == Fate::Later) {
        let order = &frame.order;
        let (skipped, why) = match line.skip {
            Skip::LastOrder if order.reused => (true, "neither the eye nor the mesh has changed"),
            Skip::LastOrder => (false, "the first picture of this view; the next one of it is spared"),
            Skip::Gaps if !order.gap_pass => (true, "the mesh is convex"),
            Skip::Gaps => (false, "the mesh is not convex: rays may leave it and come back"),
            Skip::Components if !order.component_search => (true, "the search for the order met no cycle"),
            Skip::Components => (false, "cells occlude one another in cycles"),
            Skip::Uploads if frame.mesh_reused => (true, "the last picture showed the same field of it"),
            _ => (false, "the first picture of this field; the next one is spared"),
        };
        (line.fate, line.why) = (if skipped { Fate::Skipped } else { Fate::Done }, why.into());
        *bytes = if skipped { *bytes } else { 0 };
    }
}

fn number(n: u64) -> String {
    if n == 0 { "-".into() } else { n.to_string() }
}

pub(crate) fn print(savings: &[Saving]) {
    say!("{:<12} {:<8} {:>9} {:>10}  why", "skip", "", "cells", "bytes");
    for Saving { line, bytes, .. } in savings {
        let fate = line.fate.to_string();
        say!(
            "{:<12} {fate:<8} {:>9} {:>10}  {}",
            line.skip.to_string(),
            number(line.cells as u64),
            number(*bytes),
            line.why
        );
    }
}

/// Renders without each of what is skipped, in turn with the plan's own pictures, and prints what it saved.
pub(crate) fn measure(input: &Input, savings: &mut [Saving]) -> Result<()> {
    let calibration = Calibration::default();
    say!("measured by rendering without each: processor ms saved of the first picture, and of the next");
    say!("{:<12} {:>9} {:>10} {:>9} {:>9} {:>14}", "skip", "cells", "bytes", "first", "next", "pixels change");
    let skipped = |saving: &&mut Saving| matches!(saving.line.fate, Fate::Skipped) || is_kept_for_later(saving);
    for saving in savings.iter_mut().filter(skipped) {
        let skip = saving.line.skip;
        let Without { cpu_seconds: [with, without], difference } = Without::measure(input, skip, 1, &calibration)?;
        let ms = [0, 1].map(|i| 1e3 * (without[i] - with[i]));
        let (name, cells, bytes) = (skip.to_string(), number(saving.line.cells as u64), number(saving.bytes));
        say!("{name:<12} {cells:>9} {bytes:>10} {:>9.1} {:>9.1} {difference:>14.1e}", ms[0], ms[1]);
        (saving.cpu_ms, saving.difference) = (Some(ms), Some(difference));
    }
    Ok(())
}

/// What pictures take with a skip and without it.
pub(crate) struct Without {
    /// With it, and without: of the first picture and of the next, by all that is new; medians.
    pub(crate) cpu_seconds: [[f64; 2]; 2],
    /// Largest difference of a pixel.
    pub(crate) difference: f64,
}

impl Without {
    /// Renders with and without in turn, so many times.
    pub(crate) fn measure(input: &Input, skip: Skip, runs: usize, calibration: &Calibration) -> Result<Without> {
        let mut without = input.scene.clone();
        without.method.no_skip = without.method.no_skip.with(skip);
        let scenes = [&input.scene, &without];
        let mut seconds: [[Vec<f64>; 2]; 2] = Default::default();
        let mut pictures: [Option<Image>; 2] = [None, None];
        progress::during(&format!("measuring without {skip}"), || -> Result<()> {
            for _ in 0..runs {
                for (which, scene) in scenes.into_iter().enumerate() {
                    let (took, picture) = twice(input, scene, calibration)?;
                    (0..2).for_each(|i| seconds[which][i].push(took[i]));
                    pictures[which] = Some(picture);
                }
            }
            Ok(())
        })?;
        let difference = match &pictures {
            [Some(a), Some(b)] => compare(a, b, input.scene.method.max_error)?.max,
            _ => 0.0,
        };
        Ok(Without { cpu_seconds: seconds.map(|both| both.map(median)), difference })
    }
}

/// Whether it spares pictures after the first.
fn is_kept_for_later(saving: &Saving) -> bool {
    let of_next = matches!(saving.line.skip, Skip::LastOrder | Skip::Uploads);
    // Nothing is searched for in some orders.
    of_next && saving.line.why.contains("first picture")
}

/// Processor seconds of the first picture and of the next, by all that is new; and the picture.
fn twice(input: &Input, scene: &Scene, calibration: &Calibration) -> Result<([f64; 2], Image)> {
    let (renderer, planner) = (Renderer::new(), Planner::new(&input.mesh));
    let device = calibration.device(scene, &input.mesh, &renderer)?;
    let mut model = None;
    let mut picture = || -> Result<(f64, Image)> {
        let mut stages = tetlux_render::Stages::default();
        let plan = stages.run("plan", || planner.plan(scene, device.as_ref()))?;
        let tables = stages.run("tables", || tables::load(input, &plan))?;
        let model = model.get_or_insert_with(|| input.model(&plan));
        let frame = renderer.render_with(scene, model, &plan, &tables)?;
        let seconds = |stages: &[Stage]| stages.iter().map(|stage| stage.cpu.unwrap_or(stage.wall)).sum::<f64>();
        Ok((seconds(&stages.into_vec()) + seconds(&frame.stages), frame.image))
    };
    let (first, _) = picture()?;
    let (next, image) = picture()?;
    Ok(([first, next], image))
}
