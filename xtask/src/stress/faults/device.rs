//! A graphics device that is lost, or asked for more than it has.

use std::process::Command;
use std::time::Instant;

use anyhow::{Context, Result, bail, ensure};
use tetlux_image::Image;
use tetlux_render::{Frame, Model, RenderError, Renderer};
use tetlux_scene::{Backend, CellProjection, Plan, Scene};

use super::super::Stress;
use super::Row;
use super::program::{Program, run, succeeded};
use crate::input::{Input, SceneArgs};
use crate::memory;

/// Ways of drawing: those that share nothing on the device.
const WAYS: [CellProjection; 3] = [CellProjection::Pt, CellProjection::March, CellProjection::Tiles];

/// Times that the device is lost while each way draws.
const LOSSES: [usize; 2] = [20, 2];

/// A picture of two gigabytes, within what devices take for a side.
const LARGE: [u32; 2] = [12_000, 10_000];

/// What a process may take beside what it has, while it asks for that picture.
const SPARE: u64 = 1 << 30;

/// Cubes a side of the mesh.
const GRID: u32 = 12;

struct Scenery<'a> {
    renderer: &'a Renderer,
    input: Input,
}

impl Scenery<'_> {
    fn scene(&self, projection: CellProjection, size: [u32; 2]) -> Scene {
        let mut scene = self.input.scene.clone();
        scene.size = size;
        (scene.method.backend, scene.method.projection) = (Backend::Gpu, projection);
        scene
    }

    fn render(&self, scene: &Scene, model: &Model) -> Result<Result<Frame, RenderError>> {
        let plan = Plan::new(scene, &self.input.mesh, self.renderer.device())?;
        Ok(self.renderer.render(scene, model, &plan))
    }
}

pub(super) fn rows(stress: &Stress) -> Result<Vec<Row>> {
    if stress.renderer.device().is_none() {
        let outcome = "not tried: there is no adapter".into();
        return Ok(vec![Row { outcome, ..Row::new("the device is lost while it draws") }]);
    }
    let input = SceneArgs { grid: Some(GRID), ..SceneArgs::default() }.load(None)?;
    let scenery = Scenery { renderer: stress.renderer, input };
    Ok(vec![lost(&scenery, LOSSES[usize::from(stress.short)])?, too_large(&scenery)?, no_memory()?])
}

/// The device goes at a moment between the beginning of a picture and a little after its end.
fn lost(scenery: &Scenery, losses: usize) -> Result<Row> {
    let mut row = Row::new("the device is lost while it draws");
    let (mut errors, mut pictures) = (0, 0);
    for projection in WAYS {
        let scene = scenery.scene(projection, [160, 120]);
        let model = Model::new(&scenery.input.mesh);
        let draw = || scenery.render(&scene, &model);
        let expected = draw()??.image;
        let start = Instant::now();
        draw()??;
        let takes = start.elapsed();
        for loss in 0..losses {
            let moment = takes.mul_f64(1.2 * (loss as f64 + 0.5) / losses as f64);
            let drawn = std::thread::scope(|scope| {
                let drawing = scope.spawn(draw);
                std::thread::sleep(moment);
                scenery.renderer.lose_device();
                drawing.join()
            });
            let held = match drawn {
                Ok(drawn) => match drawn? {
                    Ok(frame) => {
                        pictures += 1;
                        same(&frame.image, &expected)
                    }
                    Err(RenderError::Lost { .. }) => {
                        errors += 1;
                        Ok(())
                    }
                    Err(error) => Err(format!("another error than its loss: {error}")),
                },
                Err(_) => Err("a panic".into()),
            };
            // Whatever came of that picture, the next is told of the loss at most, and the one after it is right.
            let again = match draw()? {
                Err(RenderError::Lost { .. }) => draw()?,
                drawn => drawn,
            };
            let again = again.map_err(|error| format!("not opened anew: {error}"));
            let held = held.and(again.and_then(|frame| same(&frame.image, &expected)));
            row.add(held.map_err(|failure| format!("{projection}, {loss}: {failure}")));
        }
    }
    row.outcome = format!(
        "{errors} errors that say so, {pictures} pictures already drawn; the next picture on the device opened anew is the \
         same bit for bit each time"
    );
    Ok(row)
}

fn same(image: &Image, expected: &Image) -> Result<(), String> {
    if image == expected { Ok(()) } else { Err("another picture".into()) }
}

/// More pixels a side than the device takes.
fn too_large(scenery: &Scenery) -> Result<Row> {
    let mut row = Row::new("a picture over the device's limits");
    let model = Model::new(&scenery.input.mesh);
    for projection in WAYS {
        let small = scenery.scene(projection, [64, 48]);
        let before = scenery.render(&small, &model)??.image;
        let large = scenery.scene(projection, [tetlux_image::MAX_SIDE, 64]);
        let held = match scenery.render(&large, &model)? {
            Err(error @ RenderError::Limit { .. }) if error.to_string().contains("the picture") => Ok(()),
            Err(error) => Err(format!("another error than the limit: {error}")),
            Ok(_) => Err("it was drawn".into()),
        };
        row.add(held.and(same(&scenery.render(&small, &model)??.image, &before)));
    }
    row.outcome = "an error that names the limit and the way out; the renderer then draws as before".into();
    Ok(row)
}

/// The memory that is left is less than a picture takes; so it is on the device, where that is the processor. In a process
/// of its own: some drivers do not ask whether they were given what they write to, and their end is one failure, not all's.
fn no_memory() -> Result<Row> {
    let mut row = Row::new(NO_MEMORY);
    let output = run(Program::new()?.command(&["stress-no-memory"])).map_err(anyhow::Error::msg)?;
    let said = String::from_utf8_lossy(&output.stdout).trim().to_owned();
    // What was not tried is said, and does not count.
    if said != HELD && output.status.success() {
        return Ok(Row { outcome: said, ..row });
    }
    row.add(succeeded(&output));
    row.outcome = HELD.into();
    Ok(row)
}

const NO_MEMORY: &str = "no memory for a picture on the device";
const HELD: &str = "an error that says so; the renderer then draws as before";

/// Asks for a picture of more memory than is left to this process, and says what came of it.
pub(crate) fn run_without_memory() -> Result<()> {
    let renderer = Renderer::new();
    let scenery =
        Scenery { renderer: &renderer, input: SceneArgs { grid: Some(GRID), ..SceneArgs::default() }.load(None)? };
    let model = Model::new(&scenery.input.mesh);
    let small = scenery.scene(CellProjection::Pt, [64, 48]);
    let before = scenery.render(&small, &model)??.image;
    let software = renderer.device().is_some_and(|device| device.software);
    let Some(taken) = memory::address_space().filter(|_| software) else {
        say!("not tried: the device has memory of its own");
        return Ok(());
    };
    if !limit_address_space(&(taken + SPARE).to_string()) {
        say!("not tried: the system has no prlimit");
        return Ok(());
    }
    let drawn = scenery.render(&scenery.scene(CellProjection::Pt, LARGE), &model);
    ensure!(limit_address_space("unlimited"), "the limit of memory cannot be lifted again");
    match drawn? {
        Err(RenderError::OutOfMemory { .. } | RenderError::Lost { .. }) => {}
        Err(error) => bail!("another error than of memory: {error}"),
        Ok(_) => bail!("it was drawn"),
    }
    let again = scenery.render(&small, &model)?.context("the next picture")?;
    same(&again.image, &before).map_err(anyhow::Error::msg)?;
    say!("{HELD}");
    Ok(())
}

/// Limits what this process may take, its soft limit alone; false if the system cannot.
fn limit_address_space(bytes: &str) -> bool {
    let args = [format!("--pid={}", std::process::id()), format!("--as={bytes}:")];
    Command::new("prlimit").args(args).status().context("prlimit").is_ok_and(|status| status.success())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn another_picture_is_told_from_the_same() {
        let image = Image::new(2, 2).unwrap();
        let mut other = image.clone();
        other.pixels_mut()[3][1] = f32::MIN_POSITIVE;
        assert!(same(&image, &image.clone()).is_ok() && same(&image, &other).is_err());
    }
}
