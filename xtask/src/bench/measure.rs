//! Frames timed, each way of drawing in its turn.

use std::sync::Arc;

use anyhow::Result;
use glam::DQuat;
use serde::Serialize;
use tetlux_render::{Frame, Model, Renderer, Stage, Stages};
use tetlux_scene::{Method, Plan, Scene};
use tetlux_tables::Table;

use crate::input::Input;
use crate::report::StageReport;
use crate::{progress, tables};

/// A way to draw a scene: its name, and the method as a change of the scene's.
pub(crate) type Way = (&'static str, fn(&mut Method));

/// The turn of the eye round the focal point from frame to frame, in degrees: too little to change what there is to do,
/// enough that nothing is kept from the last view.
pub(crate) const TURN: f64 = 1e-3;

/// Processor seconds; what takes longer is timed once.
pub(crate) const LONG: f64 = 10.0;

/// The name of the stage that is a whole frame.
const FRAME: &str = "frame";

/// A scene, and what is kept of it from frame to frame.
pub(crate) struct Course<'a> {
    input: &'a Input,
    renderer: &'a Renderer,
    model: Model<'a>,
    /// The input's, but for what a way changes.
    pub(crate) scene: Scene,
    frames: u32,
}

/// A way that has drawn the scene once, and what its later frames took.
pub(crate) struct Runner {
    pub(crate) name: &'static str,
    method: Method,
    tables: Vec<Arc<Table>>,
    samples: Vec<Vec<Stage>>,
}

/// What a frame takes: medians over several. All but the first of a way, so that neither what is found of the mesh nor
/// what is compiled counts.
#[derive(Serialize, Clone)]
pub(crate) struct Cost {
    pub(crate) frames: usize,
    pub(crate) wall_seconds: f64,
    /// User and system, all threads.
    pub(crate) cpu_seconds: Option<f64>,
    pub(crate) stages: Vec<StageReport>,
}

impl<'a> Course<'a> {
    pub(crate) fn new(input: &'a Input, renderer: &'a Renderer) -> Course<'a> {
        Course { input, renderer, model: Model::new(&input.mesh), scene: input.scene.clone(), frames: 0 }
    }

    /// Draws once from the scene's own camera, which is not timed.
    pub(crate) fn start(&mut self, (name, change): Way) -> Result<(Runner, Plan, Frame)> {
        let mut method = self.input.scene.method;
        change(&mut method);
        self.scene.method = method;
        self.scene.camera = self.input.scene.camera;
        let plan = Plan::new(&self.scene, &self.input.mesh, self.renderer.device())?;
        let tables = tables::load_or_build(self.input, &plan, &mut Vec::new())?;
        let draw = || self.renderer.render_with(&self.scene, &self.model, &plan, &tables);
        let frame = progress::during(name, draw)?;
        Ok((Runner { name, method, tables, samples: Vec::new() }, plan, frame))
    }

    /// Draws and times a frame, from planning to the picture, the eye turned a little further.
    pub(crate) fn run(&mut self, runner: &mut Runner) -> Result<()> {
        self.frames += 1;
        let Course { input, renderer, model, scene, frames } = self;
        scene.method = runner.method;
        scene.camera = input.scene.camera;
        let camera = &mut scene.camera;
        let turn = DQuat::from_axis_angle(camera.view_up.normalize(), (TURN * f64::from(*frames)).to_radians());
        camera.position = camera.focal_point + turn * (camera.position - camera.focal_point);
        let (mut whole, mut plans) = (Stages::default(), Stages::default());
        let frame = progress::during(runner.name, || {
            whole.run(FRAME, || -> Result<Frame> {
                let plan = plans.run("plan", || Plan::new(scene, &input.mesh, renderer.device()))?;
                Ok(renderer.render_with(scene, model, &plan, &runner.tables)?)
            })
        })?;
        runner.samples.push([whole.into_vec(), plans.into_vec(), frame.stages].concat());
        Ok(())
    }

    /// Times frames of each way in turn, A B A B.
    pub(crate) fn run_in_turn(&mut self, runners: &mut [Runner], runs: usize) -> Result<()> {
        for round in 0..runs {
            for runner in runners.iter_mut().filter(|runner| round == 0 || !runner.is_long()) {
                self.run(runner)?;
            }
        }
        Ok(())
    }

    /// What ways cost that are timed in turn, and the first frame of each.
    pub(crate) fn costs(&mut self, ways: impl IntoIterator<Item = Way>, runs: usize) -> Result<Vec<(Cost, Frame)>> {
        let mut runners = Vec::new();
        let mut frames = Vec::new();
        for way in ways {
            let (runner, _, frame) = self.start(way)?;
            runners.push(runner);
            frames.push(frame);
        }
        self.run_in_turn(&mut runners, runs)?;
        Ok(runners.iter().map(Runner::cost).zip(frames).collect())
    }
}

impl Runner {
    pub(crate) fn is_long(&self) -> bool {
        let whole = self.samples.first().and_then(|sample| sample.first());
        whole.is_some_and(|whole| whole.cpu.unwrap_or(whole.wall) > LONG)
    }

    pub(crate) fn cost(&self) -> Cost {
        // Frames of one way have the same stages.
        let names = self.samples.first().into_iter().flatten().map(|stage| stage.name);
        let mut stages: Vec<StageReport> = names
            .map(|name| {
                let of_name = || self.samples.iter().flatten().filter(|stage| stage.name == name);
                let cpu: Option<Vec<f64>> = of_name().map(|stage| stage.cpu).collect();
                StageReport {
                    name,
                    wall_seconds: median(of_name().map(|stage| stage.wall).collect()),
                    cpu_seconds: cpu.map(median),
                }
            })
            .collect();
        let whole = if stages.is_empty() { None } else { Some(stages.remove(0)) };
        Cost {
            frames: self.samples.len(),
            wall_seconds: whole.as_ref().map_or(0.0, |w| w.wall_seconds),
            cpu_seconds: whole.and_then(|w| w.cpu_seconds),
            stages,
        }
    }
}

impl Cost {
    /// Processor seconds, or wall seconds where the system does not tell.
    pub(crate) fn seconds(&self) -> f64 {
        self.cpu_seconds.unwrap_or(self.wall_seconds)
    }

    /// Processor seconds of a stage; 0 if it was not run.
    pub(crate) fn stage(&self, name: &str) -> f64 {
        let found = self.stages.iter().find(|stage| stage.name == name);
        found.map_or(0.0, |stage| stage.cpu_seconds.unwrap_or(stage.wall_seconds))
    }
}

/// The middle value, or the mean of the two in the middle; 0 of none.
pub(crate) fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    match (values.len(), values.len() / 2) {
        (0, _) => 0.0,
        (n, half) if n.is_multiple_of(2) => 0.5 * (values[half - 1] + values[half]),
        (_, half) => values[half],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::methods::PEAK;

    #[test]
    fn the_median_is_in_the_middle() {
        assert_eq!([vec![], vec![3.0], vec![9.0, 1.0], vec![5.0, 1.0, 9.0]].map(median), [0.0, 3.0, 5.0, 5.0]);
    }

    #[test]
    fn stages_are_told_by_their_medians_and_make_up_most_of_a_frame() {
        let input = PEAK.input("peak", "", 24).unwrap();
        let renderer = Renderer::new();
        let mut course = Course::new(&input, &renderer);
        let cpu: Way = ("cpu", |m| m.backend = tetlux_scene::Backend::Cpu);
        let (cost, frame) = course.costs([cpu], 3).unwrap().remove(0);
        assert!(frame.image.pixels().iter().any(|p| p[3] > 0.1));
        assert_eq!(cost.frames, 3);
        let names: Vec<_> = cost.stages.iter().map(|stage| stage.name).collect();
        assert!(names.contains(&"plan") && names.contains(&"order") && names.contains(&"draw"), "{names:?}");
        assert!(!names.contains(&FRAME));
        // The eye moves: no frame takes the last one's order for its own.
        assert!(course.scene.camera.position.distance(input.scene.camera.position) > 0.0);
    }
}
