//! Frames in sequence: round the scene, or through time.

use std::path::{Path, PathBuf};
use std::time::Instant;

use anyhow::{Context, Result, bail};
use serde::Serialize;
use tetlux_render::{Frame, Model, Renderer, Stages, frames};
use tetlux_scene::{Plan, Planner, Scene};

use crate::calibration::Calibration;
use crate::input::{Input, SceneArgs};
use crate::report::{Report, StageReport, stages_of, write_json};
use crate::{progress, render, tables};

#[derive(clap::Args, Default)]
#[command(next_help_heading = "Frames in sequence (the output is numbered: out-0001.png, ...)")]
pub(crate) struct SequenceArgs {
    /// Turn once round the focal point, about view up, in N frames
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    orbit: Option<u32>,
    /// Every time step of the mesh file (Exodus II, Gmsh, VTK XML); colours and camera are those of the first
    #[arg(long, conflicts_with = "orbit")]
    times: bool,
    /// A mesh file for every frame, such as step-*.vtu; colours and camera are those of the first
    #[arg(long, value_name = "FILE", num_args = 1.., conflicts_with_all = ["orbit", "times", "mesh"])]
    series: Vec<PathBuf>,
    /// Of the sequence only the frame of this number, from 1
    #[arg(long, value_name = "K", value_parser = clap::value_parser!(u32).range(1..))]
    frame: Option<u32>,
}

/// What changes from frame to frame.
enum Course {
    Orbit(u32),
    Times(PathBuf, usize),
    Series(Vec<PathBuf>),
}

impl SequenceArgs {
    pub(crate) fn is_asked(&self) -> bool {
        self.orbit.is_some() || self.times || !self.series.is_empty() || self.frame.is_some()
    }
}

impl Course {
    fn len(&self) -> usize {
        match self {
            Course::Orbit(count) => *count as usize,
            Course::Times(_, count) => *count,
            Course::Series(files) => files.len(),
        }
    }

    /// The arguments that load a frame's mesh; none where all frames have one.
    fn args(&self, args: &SceneArgs, number: usize) -> Option<SceneArgs> {
        let mut args = args.clone();
        match self {
            Course::Orbit(_) => return None,
            Course::Times(..) => args.file.time = Some(number),
            Course::Series(files) => args.mesh = Some(files[number].clone()),
        }
        args.file.quiet = true;
        Some(args)
    }
}

/// What is told of one frame.
#[derive(Serialize)]
struct Entry {
    /// From 1.
    frame: usize,
    /// Degrees from the scene's camera.
    #[serde(skip_serializing_if = "Option::is_none")]
    turned: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    mesh: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    time_step: Option<usize>,
    cells_drawn: usize,
    order_reused: bool,
    mesh_reused: bool,
    stated_error: Option<f64>,
    warnings: Vec<String>,
    /// From the start of the sequence.
    done_seconds: f64,
    /// Processor time is that of the process: of both frames that are made at a time.
    stages: Vec<StageReport>,
    files: Vec<String>,
}

#[derive(Serialize)]
struct Sequence<'a> {
    #[serde(flatten)]
    first: Report<'a>,
    frames_per_second: f64,
    frames: Vec<Entry>,
}

/// A scene and, where it is another than the first frame's, its mesh.
struct Moment {
    scene: Scene,
    mesh: Option<Input>,
}

/// What all frames share.
struct Shared<'a> {
    args: &'a SceneArgs,
    scene: Option<&'a Path>,
    course: &'a Course,
    input: &'a Input,
    renderer: Renderer,
    calibration: Calibration,
    planner: Planner<'a>,
    model: Model<'a>,
    begun: Instant,
    png: PathBuf,
}

/// Renders a sequence.
pub(crate) fn run(
    sequence: &SequenceArgs,
    args: &SceneArgs,
    scene: Option<&Path>,
    output: Option<&Path>,
    json: Option<&Path>,
) -> Result<()> {
    let (course, input) = course(sequence, args, scene)?;
    let numbers = match sequence.frame.map(|k| k as usize) {
        None => 0..course.len(),
        Some(k) if k <= course.len() => k - 1..k,
        Some(k) => bail!("--frame {k}: the sequence has {} frames", course.len()),
    };
    let renderer = Renderer::new();
    let adapter = renderer.device().map(|d| d.name.clone());
    let planner = Planner::new(&input.mesh);
    let calibration = Calibration::default();
    let device = calibration.device(&input.scene, &input.mesh, &renderer)?;
    let plan = planner.plan(&input.scene, device.as_ref())?;
    let report = Report::new(&input, &plan, adapter.as_deref(), &[]);
    report.print_plan(&plan);
    let png = output.map_or_else(|| PathBuf::from("out").join(&input.name).with_extension("png"), Path::to_path_buf);
    let model = input.model(&plan);
    let begun = Instant::now();
    let course = &course;
    let shared = Shared { args, scene, course, input: &input, renderer, calibration, planner, model, begun, png };

    let bar = progress::bar("frames", numbers.len() as u32);
    let mut entries: Vec<Entry> = Vec::new();
    let mut told = plan.warnings.clone();
    let made = frames(
        numbers.clone(),
        |number| make(&shared, number).with_context(|| format!("frame {}", number + 1)),
        |_, entry: Entry| {
            for warning in &entry.warnings {
                if !told.contains(warning) {
                    bar.suspend(|| say!("warning: frame {}: {warning}", entry.frame));
                    told.push(warning.clone());
                }
            }
            entries.push(entry);
            bar.set_message(format!("{:.1} frames a second", entries.len() as f64 / begun.elapsed().as_secs_f64()));
            bar.inc(1);
            Ok(())
        },
    );
    bar.finish_and_clear();
    let seconds = begun.elapsed().as_secs_f64();
    input.keep(&shared.model);
    let frames_per_second = entries.len() as f64 / seconds;
    if let (Some(first), Some(last)) = (entries.first(), entries.last()) {
        say!("{} to {}", first.files[0], last.files[0]);
    }
    say!("{} of {} frames in {seconds:.2} s: {frames_per_second:.2} a second", entries.len(), numbers.len());
    if let Some(path) = json {
        write_json(path, &Sequence { first: report, frames_per_second, frames: entries })?;
    }
    made
}

/// What is asked for, and the first frame's scene.
fn course(sequence: &SequenceArgs, args: &SceneArgs, scene: Option<&Path>) -> Result<(Course, Input)> {
    if let Some(count) = sequence.orbit {
        return Ok((Course::Orbit(count), args.load(scene)?));
    }
    if let Some(first) = sequence.series.first() {
        let course = Course::Series(sequence.series.clone());
        return Ok((course, SceneArgs { mesh: Some(first.clone()), ..args.clone() }.load(scene)?));
    }
    if !sequence.times {
        bail!("--frame is of a sequence: give --orbit N, --times or --series FILES");
    }
    if args.file.time.is_some() {
        bail!("--times renders every time step: leave out --time");
    }
    let Some(path) = args.mesh_path(scene)? else {
        bail!("--times is for a mesh file with several time steps: name one");
    };
    let count = args.file.time_steps(&path)?;
    let mut first = args.clone();
    first.file.time = Some(0);
    Ok((Course::Times(path, count), first.load(scene)?))
}

/// Makes one frame and writes it: nothing of it depends on other frames.
fn make(shared: &Shared, number: usize) -> Result<Entry> {
    let Shared { input, course, .. } = shared;
    let Moment { scene, mesh } = moment(shared, number)?;
    let (plan, frame) = match &mesh {
        None => picture(shared, input, &scene, &shared.planner, &shared.model)?,
        Some(other) => {
            let (planner, model) = (Planner::new(&other.mesh), Model::new(&other.mesh));
            picture(shared, other, &scene, &planner, &model)?
        }
    };
    let name = shared.png.file_stem().unwrap_or_default().to_string_lossy();
    let png = shared.png.with_file_name(format!("{name}-{:04}.png", number + 1));
    let files = render::write_picture(input, &frame.image, &png)?;
    Ok(Entry {
        frame: number + 1,
        turned: matches!(course, Course::Orbit(_)).then(|| angle(course, number)),
        mesh: match course {
            Course::Orbit(_) => None,
            Course::Times(path, _) => Some(path.display().to_string()),
            Course::Series(files) => Some(files[number].display().to_string()),
        },
        time_step: matches!(course, Course::Times(..)).then_some(number),
        cells_drawn: plan.cells.len(),
        order_reused: frame.order.reused,
        mesh_reused: frame.mesh_reused,
        stated_error: plan.stated.total(),
        warnings: plan.warnings.into_iter().chain(frame.warnings).collect(),
        done_seconds: shared.begun.elapsed().as_secs_f64(),
        stages: stages_of(&frame.stages),
        files,
    })
}

fn angle(course: &Course, number: usize) -> f64 {
    360.0 * number as f64 / course.len() as f64
}

/// The scene of a frame. Of a further time step only the data are its own; where its cells are those of the first frame,
/// the mesh is the first frame's too.
fn moment(shared: &Shared, number: usize) -> Result<Moment> {
    let Shared { args, course, input, .. } = shared;
    let mut scene = input.scene.clone();
    let Some(args) = course.args(args, number) else {
        scene.camera = scene.camera.turned(angle(course, number));
        return Ok(Moment { scene, mesh: None });
    };
    if number == 0 {
        return Ok(Moment { scene, mesh: None });
    }
    let step = args.load(shared.scene)?;
    scene.scalar = step.scene.scalar.clone();
    scene.second = step.scene.second.clone();
    scene.lighting = step.scene.lighting.clone();
    let same = step.mesh.origin() == input.mesh.origin()
        && step.mesh.points() == input.mesh.points()
        && step.mesh.cells() == input.mesh.cells();
    Ok(Moment { scene, mesh: (!same).then_some(step) })
}

fn picture(shared: &Shared, input: &Input, scene: &Scene, planner: &Planner, model: &Model) -> Result<(Plan, Frame)> {
    let mut stages = Stages::default();
    let device = shared.calibration.device(scene, &input.mesh, &shared.renderer)?;
    let mut plan = stages.run("plan", || planner.plan(scene, device.as_ref()))?;
    let loaded = stages.run("tables", || tables::load(input, &plan));
    let loaded = tables::or_directly(loaded, input.integrator_forced, &mut plan)?;
    let mut frame = shared.renderer.render_with(scene, model, &plan, &loaded)?;
    let mut all = stages.into_vec();
    all.append(&mut frame.stages);
    frame.stages = all;
    Ok((plan, frame))
}
