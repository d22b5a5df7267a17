//! Frames timed, each way of drawing in its turn.

use std::sync::Arc;

use anyhow::Result;
use glam::DQuat;
use serde::Serialize;
use tetlux_optics::Classification;
use tetlux_optics::transfer::{ColorNode, OpacityNode, TransferFunction};
use tetlux_render::{Frame, Model, Renderer, Stage, Stages};
use tetlux_scene::{Backend, Device, Method, Plan, Planner, Scene, Work};
use tetlux_tables::Table;

use super::Bench;
use super::patience::ONCE;
use crate::input::Input;
use crate::report::{StageReport, median};
use crate::{progress, tables};

/// A way to draw a scene: its name, and the method as a change of the scene's.
pub(crate) type Way = (&'static str, fn(&mut Method));

/// The turn of the eye round the focal point from frame to frame, in degrees: too little to change what there is to do,
/// enough that nothing is kept from the last view.
pub(crate) const TURN: f64 = 1e-3;

/// The name of the stage that is a whole frame.
const FRAME: &str = "frame";

/// Stages that take cells or pixels, whatever the function: what was found before them is drawn.
const DRAWING: [&str; 3] = ["set up", "bin", "draw"];

/// A scene, and what is kept of it from frame to frame.
pub(crate) struct Course<'a> {
    bench: &'a Bench<'a>,
    input: &'a Input,
    renderer: &'a Renderer,
    model: Model<'a>,
    planner: Planner<'a>,
    /// The input's, but for what a way changes.
    pub(crate) scene: Scene,
    frames: u32,
}

/// A way that has drawn the scene once, and what its later frames took.
pub(crate) struct Runner {
    pub(crate) name: &'static str,
    method: Method,
    /// With what it takes, where the plan follows that: the choice is the one that `render` makes.
    device: Option<Device>,
    tables: Vec<Arc<Table>>,
    samples: Vec<Vec<Stage>>,
}

/// What a frame takes: medians over several. All but the first of a way, so that neither what is found of the mesh nor
/// what is compiled counts; of what takes a software adapter long the first alone.
#[derive(Serialize, Clone)]
pub(crate) struct Cost {
    pub(crate) frames: usize,
    pub(crate) wall_seconds: f64,
    /// User and system, all threads.
    pub(crate) cpu_seconds: Option<f64>,
    pub(crate) stages: Vec<StageReport>,
}

impl<'a> Course<'a> {
    pub(crate) fn new(input: &'a Input, bench: &'a Bench) -> Course<'a> {
        Course::by(input, bench, bench.renderer)
    }

    /// By another renderer than the bench's.
    pub(crate) fn by(input: &'a Input, bench: &'a Bench, renderer: &'a Renderer) -> Course<'a> {
        let (model, planner) = (Model::new(&input.mesh), Planner::new(&input.mesh));
        Course { bench, input, renderer, model, planner, scene: input.scene.clone(), frames: 0 }
    }

    /// How much there is to draw.
    fn work(&self) -> Result<Work> {
        Ok(Work::new(&self.input.mesh, &self.scene.camera.view(self.scene.size)?))
    }

    /// Why a way is not to be asked, if so: it took long for less. A quick run asks all: its pictures are small, and what
    /// it tells does not depend on the machine's speed.
    pub(crate) fn refusal(&self, (name, _): Way) -> Result<Option<String>> {
        if self.bench.quick {
            return Ok(None);
        }
        Ok(self.bench.patience.borrow().refusal(name, &self.work()?))
    }

    /// Draws once from the scene's own camera, which is timed only if it takes a software adapter long.
    pub(crate) fn start(&mut self, (name, change): Way) -> Result<(Runner, Plan, Frame)> {
        let mut method = self.input.scene.method;
        change(&mut method);
        self.scene.method = method;
        self.scene.camera = self.input.scene.camera;
        let device = self.bench.calibration.device(&self.scene, &self.input.mesh, self.renderer)?;
        let mut runner = Runner { name, method, device, tables: Vec::new(), samples: Vec::new() };
        let plan = self.planner.plan(&self.scene, runner.device.as_ref())?;
        runner.tables = tables::load_or_build(self.input, &plan, &mut Vec::new())?;
        let (frame, sample) = self.frame(&runner)?;
        let seconds = sample.first().map_or(0.0, taken);
        self.bench.patience.borrow_mut().note(name, &self.work()?, seconds, &self.input.title);
        // What the processor finds of a mesh in its first frame, and what a graphics card's driver compiles, is not a frame's.
        let by_software = plan.backend == Backend::Gpu && runner.device.as_ref().is_some_and(|device| device.software);
        if seconds > ONCE && by_software {
            runner.samples.push(sample);
        }
        Ok((runner, plan, frame))
    }

    /// Draws and times a frame, from planning to the picture, the eye turned a little further.
    pub(crate) fn run(&mut self, runner: &mut Runner) -> Result<()> {
        self.frames += 1;
        let Course { input, scene, frames, .. } = self;
        scene.method = runner.method;
        scene.camera = input.scene.camera;
        let camera = &mut scene.camera;
        let turn = DQuat::from_axis_angle(camera.view_up.normalize(), (TURN * f64::from(*frames)).to_radians());
        camera.position = camera.focal_point + turn * (camera.position - camera.focal_point);
        let (_, sample) = self.frame(runner)?;
        runner.samples.push(sample);
        Ok(())
    }

    /// A frame of the scene as it is, and its stages: the whole, the plan, and those of the picture.
    fn frame(&self, runner: &Runner) -> Result<(Frame, Vec<Stage>)> {
        let Course { renderer, model, planner, scene, .. } = self;
        let (mut whole, mut plans) = (Stages::default(), Stages::default());
        let frame = progress::during(runner.name, || {
            whole.run(FRAME, || -> Result<Frame> {
                let plan = plans.run("plan", || planner.plan(scene, runner.device.as_ref()))?;
                Ok(renderer.render_with(scene, model, &plan, &runner.tables)?)
            })
        })?;
        let sample = [whole.into_vec(), plans.into_vec(), frame.stages.clone()].concat();
        Ok((frame, sample))
    }

    /// What a new transfer function takes of a way on a mesh that is loaded: frames of the view that was drawn last, the eye at
    /// rest, by the scene's function and by its mirror image in turn. None where the scene has no such function.
    pub(crate) fn new_function(&mut self, runner: &Runner, runs: usize) -> Result<Option<Cost>> {
        let Classification::OneField(own) = &self.input.scene.classification else { return Ok(None) };
        let functions = [mirrored(own, self.scene.scalar.range)?, own.clone()];
        let Runner { name, method, device, tables, .. } = runner;
        let (device, tables) = (device.clone(), tables.clone());
        let mut retouched = Runner { name, method: *method, device, tables, samples: Vec::new() };
        self.scene.method = *method;
        for _ in 0..runs.max(1) {
            for function in &functions {
                self.scene.classification = Classification::OneField(function.clone());
                let (_, sample) = self.frame(&retouched)?;
                retouched.samples.push(sample);
            }
        }
        // The eye moved before the first.
        retouched.samples.remove(0);
        Ok(Some(retouched.cost()))
    }

    /// Times frames of each way in turn, A B A B.
    pub(crate) fn run_in_turn(&mut self, runners: &mut [Runner], runs: usize) -> Result<()> {
        for _ in 0..runs {
            for runner in runners.iter_mut().filter(|runner| !runner.is_slow()) {
                self.run(runner)?;
            }
        }
        Ok(())
    }

    /// What ways cost that are timed in turn, and the first frame of each; or why one is not measured.
    pub(crate) fn costs(&mut self, ways: impl IntoIterator<Item = Way>, runs: usize) -> Result<Vec<Measured>> {
        let mut runners = Vec::new();
        let mut frames = Vec::new();
        for way in ways {
            frames.push(match self.refusal(way)? {
                Some(why) => Err(why),
                None => {
                    let (runner, _, frame) = self.start(way)?;
                    runners.push(runner);
                    Ok(frame)
                }
            });
        }
        self.run_in_turn(&mut runners, runs)?;
        let mut costs = runners.iter().map(Runner::cost);
        let with_cost = |frame: Result<Frame, String>| match frame {
            Ok(frame) => costs.next().map(|cost| (cost, frame)).ok_or_else(String::new),
            Err(why) => Err(why),
        };
        Ok(frames.into_iter().map(with_cost).collect())
    }
}

/// A transfer function turned round in a range.
fn mirrored(function: &TransferFunction, [low, high]: [f64; 2]) -> Result<TransferFunction> {
    let at = |s: f64| low + (high - s);
    let colors = function.color_nodes().iter().rev().map(|node| ColorNode { s: at(node.s), ..*node });
    let opacities = function.opacity_nodes().iter().rev().map(|node| OpacityNode { s: at(node.s), ..*node });
    Ok(TransferFunction::new(colors.collect(), opacities.collect())?)
}

/// What a way costs and its first frame, or why it was not measured.
pub(crate) type Measured = Result<(Cost, Frame), String>;

/// Processor seconds, or those of the clock where the system does not tell.
fn taken(stage: &Stage) -> f64 {
    stage.cpu.unwrap_or(stage.wall)
}

impl Runner {
    /// Whether one frame is enough.
    pub(crate) fn is_slow(&self) -> bool {
        self.samples.first().and_then(|sample| sample.first()).is_some_and(|whole| taken(whole) > ONCE)
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

    /// Processor seconds of what comes before the first cell is set up or the device draws.
    pub(crate) fn before_drawing(&self) -> f64 {
        let before = self.stages.iter().filter(|stage| !DRAWING.contains(&stage.name));
        before.map(|stage| self.stage(stage.name)).sum()
    }

    /// Processor seconds of a stage; 0 if it was not run.
    pub(crate) fn stage(&self, name: &str) -> f64 {
        let found = self.stages.iter().find(|stage| stage.name == name);
        found.map_or(0.0, |stage| stage.cpu_seconds.unwrap_or(stage.wall_seconds))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::methods::PEAK;

    #[test]
    fn stages_are_told_by_their_medians_and_make_up_most_of_a_frame() {
        let input = PEAK.input("peak", "", 24).unwrap();
        let renderer = Renderer::new();
        let bench = Bench::new(&renderer);
        let mut course = Course::new(&input, &bench);
        let cpu: Way = ("cpu", |m| m.backend = tetlux_scene::Backend::Cpu);
        let (cost, frame) = course.costs([cpu], 3).unwrap().remove(0).unwrap();
        assert!(frame.image.pixels().iter().any(|p| p[3] > 0.1));
        assert_eq!(cost.frames, 3);
        let names: Vec<_> = cost.stages.iter().map(|stage| stage.name).collect();
        assert!(names.contains(&"plan") && names.contains(&"order") && names.contains(&"draw"), "{names:?}");
        assert!(!names.contains(&FRAME));
        // The eye moves: no frame takes the last one's order for its own.
        let camera = course.scene.camera;
        assert!(camera.position.distance(input.scene.camera.position) > 0.0);
        // For a new function it rests, and the function is the scene's again.
        let (runner, ..) = course.start(cpu).unwrap();
        let new = course.new_function(&runner, 2).unwrap().unwrap();
        assert_eq!((new.frames, course.scene.camera), (3, input.scene.camera));
        assert!(new.stages.iter().any(|stage| stage.name == "plan"));
        let (Classification::OneField(own), Classification::OneField(now)) =
            (&input.scene.classification, &course.scene.classification)
        else {
            panic!("the scene has a transfer function");
        };
        assert_eq!(own, now);
        let mirror = mirrored(own, [-1.0, 3.0]).unwrap();
        assert_eq!((own.opacity(0.5), own.luminance(0.5)), (mirror.opacity(1.5), mirror.luminance(1.5)));
        assert_ne!(own.opacity(0.5), mirror.opacity(0.5));
    }
}
