//! A scene by every way of drawing it, and by a peer: time against error.

use std::path::Path;

use anyhow::{Result, bail};
use serde::Serialize;
use tetlux_image::{Image, Metrics, compare};
use tetlux_render::{Instructions, Renderer, Resources};
use tetlux_scene::{Backend, CellProjection, Integrator, Interpolation, Order, Plan, TablePrecision, Target};

use super::Bench;
use super::front::front;
use super::measure::{Cost, Course, Runner, TURN, Way};
use super::patience::ONCE;
use super::peer::{About, Peer, Rival, Took, VTK, read_ppm, write_job};
use crate::input::Input;
use crate::report::median;
use crate::{memory, progress, truth};

/// What the plan chooses comes first: targets are for it.
pub(crate) const DEFAULT: &str = "default";

/// The processor by narrower vectors than the best, where those are AVX-512.
pub(crate) const AVX2: Way = ("CPU, AVX2", |m| m.backend = Backend::Cpu);

const WAYS: &[Way] = &[
    (DEFAULT, |_| ()),
    ("CPU", |m| m.backend = Backend::Cpu),
    ("CPU, order pixel", |m| (m.backend, m.order) = (Backend::Cpu, Order::Pixel)),
    ("CPU, order centroid", |m| (m.backend, m.order) = (Backend::Cpu, Order::Centroid)),
    ("CPU, average", |m| (m.backend, m.integrator) = (Backend::Cpu, Integrator::Average)),
    ("wgpu, march", |m| (m.backend, m.projection) = (Backend::Gpu, CellProjection::March)),
    ("wgpu, tiles", |m| (m.backend, m.projection) = (Backend::Gpu, CellProjection::Tiles)),
    ("wgpu, pt", |m| (m.backend, m.projection) = (Backend::Gpu, CellProjection::Pt)),
    ("wgpu, balanced", |m| (m.backend, m.projection) = (Backend::Gpu, CellProjection::Balanced)),
    ("wgpu, pt, order centroid, rgba16f", |m| {
        (m.backend, m.order, m.target) = (Backend::Gpu, Order::Centroid, Target::Rgba16f);
    }),
    ("wgpu, pt as in 2004", |m| {
        (m.backend, m.projection, m.interpolation) = (Backend::Gpu, CellProjection::Pt, Interpolation::ScreenLinear);
        (m.integrator, m.table_precision, m.target) = (Integrator::Preint, TablePrecision::U8, Target::Rgba8);
        m.order = Order::Centroid;
    }),
];

/// As many as a quick run takes.
const QUICK_WAYS: usize = 8;

/// What was found of a scene.
#[derive(Serialize)]
pub(crate) struct Race {
    pub(crate) name: String,
    pub(crate) title: String,
    pub(crate) cells: usize,
    pub(crate) points: usize,
    pub(crate) size: [u32; 2],
    pub(crate) entries: Vec<Entry>,
    /// What a new transfer function takes of the default, the eye at rest.
    pub(crate) new_function: Option<Cost>,
    /// Names, and why they did not take part.
    pub(crate) refused: Vec<[String; 2]>,
    pub(crate) peer: Option<About>,
}

/// A way, what it takes and how wrong it is.
#[derive(Serialize)]
pub(crate) struct Entry {
    pub(crate) name: String,
    /// What it is, in full.
    pub(crate) method: String,
    pub(crate) cost: Cost,
    pub(crate) error: Metrics,
    pub(crate) cells_drawn: Option<usize>,
    /// Of buffers and textures.
    pub(crate) device_bytes: Option<u64>,
    /// Most that was resident of the process while it drew its first frame.
    pub(crate) peak_bytes: Option<u64>,
    /// Nothing is both faster, in processor seconds, and of less error.
    pub(crate) on_front: bool,
    /// The peer's name of it.
    pub(crate) rival: Option<&'static str>,
}

impl Race {
    pub(crate) fn entry(&self, name: &str) -> Option<&Entry> {
        self.entries.iter().find(|entry| entry.name == name)
    }

    pub(crate) fn rival(&self, name: &str) -> Option<&Entry> {
        self.entries.iter().find(|entry| entry.rival == Some(name))
    }
}

/// One of our ways, its first picture judged.
struct Started {
    runner: Runner,
    method: String,
    backend: Backend,
    resources: Resources,
    error: Metrics,
    peak_bytes: Option<u64>,
}

/// Draws and judges; `python` runs the peer, if it is to take part.
pub(crate) fn race(bench: &Bench, input: &Input, python: Option<&str>, folder: &Path) -> Result<Race> {
    let view = input.scene.camera.view(input.scene.size)?;
    let budget = input.scene.method.max_error;
    let truth = truth::image(input, &view, [0.0; 2])?;
    let mut refused = Vec::new();
    let mut course = Course::new(input, bench);
    let mut ours: Vec<Started> = Vec::new();
    let start = |course: &mut Course, way: Way| -> Result<Started> {
        if let Some(why) = course.refusal(way)? {
            bail!(why);
        }
        memory::forget_peak();
        let (runner, plan, frame) = course.start(way)?;
        let peak_bytes = memory::peak();
        let error = compare(&truth, &frame.image, budget)?;
        let (method, resources) = (in_full(&plan), frame.resources);
        Ok(Started { runner, method, backend: plan.backend, resources, error, peak_bytes })
    };
    let ways = if bench.quick { &WAYS[..QUICK_WAYS] } else { WAYS };
    for &way in ways {
        match start(&mut course, way) {
            // What the default is may come again by its own name.
            Ok(started) if ours.iter().any(|known| known.method == started.method) => {}
            Ok(started) => ours.push(started),
            Err(error) => refused.push([way.0.to_owned(), error.to_string()]),
        }
    }
    let narrow = Instructions::all().into_iter().skip(1).find(|set| set.name() == "AVX2");
    let narrow = narrow.map(|set| Renderer::new().with_instructions(set));
    let mut narrow_course = narrow.as_ref().map(|renderer| Course::by(input, bench, renderer));
    let mut narrow = None;
    match narrow_course.as_mut().map(|course| start(course, AVX2)) {
        Some(Ok(started)) => narrow = Some(Started { method: format!("{}, by AVX2 alone", started.method), ..started }),
        Some(Err(error)) => refused.push([AVX2.0.to_owned(), error.to_string()]),
        None => {}
    }
    let mut theirs = None;
    if let Some(python) = python {
        let folder = folder.join(&input.name);
        match write_job(&folder, input) {
            Ok(job) => theirs = Some(Rivals::start(Peer::start(python, &job)?, &folder, input, &truth, &mut refused)?),
            Err(error) => refused.push(["the peer".to_owned(), error.to_string()]),
        }
    }
    for round in 0..bench.runs {
        for Started { runner, .. } in ours.iter_mut().filter(|ours| !ours.runner.is_slow()) {
            course.run(runner)?;
        }
        if let (Some(Started { runner, .. }), Some(course)) = (&mut narrow, &mut narrow_course)
            && !runner.is_slow()
        {
            course.run(runner)?;
        }
        if let Some(theirs) = &mut theirs {
            theirs.run(round)?;
        }
    }
    let default = ours.iter().find(|ours| ours.runner.name == DEFAULT && !ours.runner.is_slow());
    let new_function = default.map(|default| course.new_function(&default.runner, bench.runs)).transpose()?.flatten();
    let ours =
        ours.into_iter().chain(narrow).map(|Started { runner, method, backend, resources, error, peak_bytes }| Entry {
            name: runner.name.to_owned(),
            method,
            cost: runner.cost(),
            error,
            cells_drawn: Some(resources.cells),
            device_bytes: (backend == Backend::Gpu).then_some(resources.bytes),
            peak_bytes,
            on_front: false,
            rival: None,
        });
    let mut entries: Vec<Entry> = ours.collect();
    let peer = theirs.as_ref().map(|theirs| theirs.peer.about.clone());
    entries.extend(theirs.into_iter().flat_map(Rivals::entries));
    let points: Vec<[f64; 2]> = entries.iter().map(|entry| [entry.cost.seconds(), entry.error.max]).collect();
    entries.iter_mut().zip(front(&points)).for_each(|(entry, on_front)| entry.on_front = on_front);
    Ok(Race {
        name: input.name.clone(),
        title: input.title.clone(),
        cells: input.mesh.cells().len(),
        points: input.mesh.points().len(),
        size: input.scene.size,
        entries,
        new_function,
        refused,
        peer,
    })
}

/// Every choice of a plan.
fn in_full(plan: &Plan) -> String {
    let mut words = vec![plan.backend.to_string(), format!("order {}", plan.order)];
    if plan.backend == Backend::Gpu {
        words.extend([plan.projection.to_string(), plan.interpolation.to_string()]);
    }
    words.push(plan.integrator.to_string());
    if plan.backend == Backend::Gpu {
        words.push(plan.classification.to_string());
        words.extend(plan.integrator.uses_table().then(|| plan.table_precision.to_string()));
        words.push(plan.target.to_string());
    }
    words.join(", ")
}

/// The peer and what its renderers took.
struct Rivals {
    peer: Peer,
    started: Vec<(&'static Rival, Metrics, u64, Vec<Took>)>,
    frames: u32,
}

impl Rivals {
    fn start(
        mut peer: Peer,
        folder: &Path,
        input: &Input,
        truth: &Image,
        refused: &mut Vec<[String; 2]>,
    ) -> Result<Rivals> {
        let view = input.scene.camera.view(input.scene.size)?;
        let mut started = Vec::new();
        let mut truths: Vec<([f64; 2], Image)> = vec![([0.0; 2], colors(truth))];
        for rival in VTK {
            if input.mesh.cells().len() > rival.most_cells {
                refused
                    .push([rival.title.to_owned(), format!("takes minutes on more than {} cells", rival.most_cells)]);
                continue;
            }
            let picture = folder.join(rival.name).with_extension("ppm");
            let took = progress::during(rival.title, || peer.frame(rival, 0.0, Some(&picture)))?;
            // Each is judged along the rays that it casts.
            if !truths.iter().any(|(at, _)| *at == rival.at) {
                truths.push((rival.at, colors(&truth::image(input, &view, rival.at)?)));
            }
            let truth = truths.iter().find(|(at, _)| *at == rival.at).map_or(truth, |(_, truth)| truth);
            let error = compare(truth, &read_ppm(&picture)?, input.scene.method.max_error)?;
            started.push((rival, error, took.peak_bytes, Vec::new()));
        }
        Ok(Rivals { peer, started, frames: 0 })
    }

    fn run(&mut self, round: usize) -> Result<()> {
        for (rival, _, _, samples) in &mut self.started {
            if round > 0 && samples.first().is_some_and(|took| took.cpu_seconds > ONCE) {
                continue;
            }
            self.frames += 1;
            let turn = TURN * f64::from(self.frames);
            samples.push(progress::during(rival.title, || self.peer.frame(rival, turn, None))?);
        }
        Ok(())
    }

    fn entries(self) -> impl Iterator<Item = Entry> {
        self.started.into_iter().map(|(rival, error, peak, samples)| Entry {
            name: rival.title.to_owned(),
            method: "8 bits a channel, no alpha".to_owned(),
            cost: Cost {
                frames: samples.len(),
                wall_seconds: median(samples.iter().map(|took| took.wall_seconds).collect()),
                cpu_seconds: Some(median(samples.iter().map(|took| took.cpu_seconds).collect())),
                stages: Vec::new(),
            },
            error,
            cells_drawn: None,
            device_bytes: None,
            peak_bytes: Some(peak),
            on_front: false,
            rival: Some(rival.name),
        })
    }
}

/// Without alpha, which pictures over black do not tell.
fn colors(image: &Image) -> Image {
    let mut image = image.clone();
    image.pixels_mut().iter_mut().for_each(|pixel| pixel[3] = 0.0);
    image
}

#[cfg(test)]
mod tests {
    use tetlux_scene::Method;

    use super::*;

    #[test]
    fn every_way_has_a_name_of_its_own_and_can_be() {
        for (i, (name, change)) in WAYS.iter().chain([&AVX2]).enumerate() {
            assert!(WAYS[..i].iter().all(|(other, _)| other != name), "{name}");
            let mut method = Method::default();
            change(&mut method);
            assert_eq!(method.refusal(), None, "{name}");
        }
        assert_eq!(WAYS[0].0, DEFAULT);
    }
}
