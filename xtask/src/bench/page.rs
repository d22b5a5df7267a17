//! The report: Markdown, and plots beside it.

use std::fmt::Write;

use tetlux_image::{Curve, Grid, Style, log_log};

use super::Results;
use super::race::{Entry, Race};
use super::scaling::{Grown, Scaling};
use super::table::{markdown, number};
use super::targets::Target;

/// The page, and its plots by name; it links to them in a folder.
pub(crate) struct Page {
    pub(crate) markdown: String,
    pub(crate) plots: Vec<(String, String)>,
}

const HEAD: &str = "\
# Benchmarks

Every speed has its error beside it. `cargo xtask bench --write-docs` writes this page and its plots; with `--data FOLDER` it
takes the NASA data sets, and with `--peer vtk` VTK's renderers of unstructured meshes draw the same scenes in the same run, a
frame of each way in turn. Times are medians of whole frames, from planning to the picture, without reading the file and what
is found once a mesh; the eye moves a little from frame to frame, and rests where a new transfer function is timed. CPU is
user and system time of all threads: on a shared machine compare that, and ratios of one run. What takes more than a processor
second is told by one frame, on a software adapter its first, compiling included; what takes more than 6 is not asked for more
cells and pixels than those, and the page says so. What the plan chooses is what it chooses for `cargo xtask render`, by the same calibration of the adapter.
";

const QUICK: &str = "
**A quick run**: meshes and pictures are small, a frame of each. It shows that everything works; its figures say little.
";

pub(crate) fn page(results: &Results, folder: &str) -> Page {
    let mut page = Page { markdown: String::from(HEAD), plots: Vec::new() };
    if results.quick {
        page.markdown += QUICK;
    }
    let peer = results.races.iter().find_map(|race| race.peer.clone());
    let peer = peer.map(|about| [["VTK".to_owned(), about.version], ["OpenGL of VTK".to_owned(), about.opengl]]);
    let rows = results.machine.rows().into_iter().chain(peer.into_iter().flatten());
    page.section("Machine", &markdown(&["", ""], rows.map(Vec::from)));
    if !results.races.is_empty() {
        page.section("Time against error", RACES);
    }
    for race in &results.races {
        page.race(race, folder);
    }
    if !results.targets.is_empty() {
        page.section("Targets", &targets(&results.targets));
    }
    if let Some(scaling) = &results.scaling {
        page.scaling(scaling, folder);
    }
    for table in results.skips.iter().chain(&results.budgets) {
        page.section(&table.title, &table.body());
    }
    if !results.papers.is_empty() {
        page.section("The papers' tables", "`cargo xtask bench --paper NAME` prints them.\n");
        results.papers.iter().for_each(|table| page.markdown += &format!("\n{}", table.markdown()));
    }
    page
}

const RACES: &str = "\
Errors are against the f64 reference, linear, of a pixel's worst channel, over covered pixels; a peer's are of its colours
alone, along the rays that it casts, in its 8 bits (which end at 53 dB). What is marked with * is on the front: nothing is both
faster and of less largest error. `share of` is our processor time over the peer's. Peak is the most that was resident of the
process while it drew its first frame, device what buffers and textures took.
";

/// Milliseconds; stages that take less are not told.
const LEAST: f64 = 0.05;

impl Page {
    fn section(&mut self, title: &str, text: &str) {
        // Writing to a string does not fail.
        let _ = write!(self.markdown, "\n## {title}\n\n{text}");
    }

    fn plot(&mut self, folder: &str, name: &str, alt: &str, svg: String) {
        let _ = write!(self.markdown, "\n![{alt}]({folder}/{name}.svg)\n");
        self.plots.push((format!("{name}.svg"), svg));
    }

    fn race(&mut self, race: &Race, folder: &str) {
        let title = if race.title.is_empty() { &race.name } else { &race.title };
        let [width, height] = race.size;
        let _ = write!(
            self.markdown,
            "\n### {title}\n\n{} cells, {} points, {width} x {height}.\n",
            race.cells, race.points
        );
        self.plot(folder, &race.name, "largest error against time", race_plot(race));
        let rivals: Vec<&Entry> = race.entries.iter().filter(|entry| entry.rival.is_some()).collect();
        let head = ["way", "max", "p99.9", "mean", "PSNR dB", "wall ms", "CPU ms"].map(String::from).into_iter();
        let shares = rivals.iter().map(|rival| format!("share of {}", rival.name));
        let rest = ["peak MiB", "device MiB"].map(String::from);
        let head: Vec<String> = head.chain(shares).chain(rest).collect();
        let rows = race.entries.iter().map(|entry| {
            let Entry { name, cost, error, .. } = entry;
            let star = if entry.on_front { " *" } else { "" };
            let milliseconds = |seconds: f64| number(seconds * 1e3);
            let mib =
                |bytes: Option<u64>| bytes.map_or("-".into(), |b| number((b as f64 / f64::from(1 << 20)).round()));
            let mut row = vec![
                format!("{name}{star}"),
                format!("{:.1e}", error.max),
                format!("{:.1e}", error.p999),
                format!("{:.1e}", error.mean),
                format!("{:.1}", error.psnr),
                milliseconds(cost.wall_seconds),
                cost.cpu_seconds.map_or("-".into(), milliseconds),
            ];
            let of_rival = |rival: &&Entry| match entry.rival {
                Some(_) => "-".to_owned(),
                None => share(cost.seconds() / rival.cost.seconds()),
            };
            row.extend(rivals.iter().map(of_rival));
            row.extend([mib(entry.peak_bytes), mib(entry.device_bytes)]);
            row
        });
        let _ = write!(self.markdown, "\n{}", markdown(&head, rows));
        let stages = race.entries.iter().filter(|entry| !entry.cost.stages.is_empty()).map(|entry| {
            let stages = entry.cost.stages.iter().map(|stage| (stage.name, entry.cost.stage(stage.name) * 1e3));
            let stages =
                stages.filter(|(_, took)| *took >= LEAST).map(|(name, took)| format!("{name} {}", number(took)));
            vec![entry.name.clone(), entry.method.clone(), stages.collect::<Vec<_>>().join(", ")]
        });
        let _ = write!(self.markdown, "\n{}", markdown(&["way", "what it is", "stages, CPU ms"], stages));
        for [name, why] in &race.refused {
            let _ = write!(self.markdown, "\n{name} did not take part: {why}.\n");
        }
    }

    fn scaling(&mut self, scaling: &Scaling, folder: &str) {
        let cells = |point: &super::scaling::MeshPoint| point.cells as f64;
        self.section(
            "Growth",
            "The built-in scene on meshes of more and more cells, and in pictures of more and more pixels; ways by wgpu up to \
             what takes them a processor second.\n",
        );
        let curves = |points: &mut dyn Iterator<Item = (f64, &Vec<Grown>)>, value: fn(&Grown) -> Option<f64>| {
            let mut curves: Vec<Curve> = Vec::new();
            for (x, ways) in points {
                for way in ways {
                    let Some(y) = value(way) else { continue };
                    match curves.iter_mut().find(|curve| curve.name == way.name) {
                        Some(curve) => curve.points.push([x, y]),
                        None => curves.push(Curve { name: way.name.into(), points: vec![[x, y]], style: Style::Line }),
                    }
                }
            }
            curves
        };
        let seconds = |way: &Grown| Some(way.cost.seconds());
        let mib = 1.0 / f64::from(1 << 20);
        let mut in_cells = curves(&mut scaling.cells.iter().map(|point| (cells(point), &point.ways)), seconds);
        let ready = scaling.cells.iter().map(|point| [cells(point), point.assemble_cpu_seconds.unwrap_or(0.0)]);
        in_cells.push(Curve { name: "making the mesh ready".into(), points: ready.collect(), style: Style::Line });
        let in_pixels = |point: &super::scaling::PicturePoint| f64::from(point.side).powi(2);
        let in_pixels = curves(&mut scaling.pixels.iter().map(|point| (in_pixels(point), &point.ways)), seconds);
        let peak = |way: &Grown| way.peak_bytes.map(|bytes| bytes as f64 / f64::from(1 << 20));
        let mut memory = curves(&mut scaling.cells.iter().map(|point| (cells(point), &point.ways)), peak);
        memory.iter_mut().for_each(|curve| curve.name += ", peak of the process");
        let mesh = scaling.cells.iter().map(|point| [cells(point), point.mesh_bytes as f64 * mib]);
        memory.push(Curve { name: "the mesh".into(), points: mesh.collect(), style: Style::Line });
        for (name, alt, labels, curves) in [
            ("growth-cells", "time against cells", ["cells", "processor seconds a frame"], &in_cells),
            ("growth-pixels", "time against pixels", ["pixels", "processor seconds a frame"], &in_pixels),
            ("growth-memory", "memory against cells", ["cells", "MiB"], &memory),
        ] {
            self.plot(folder, name, alt, log_log(labels, Grid::Decades, curves));
        }
        let names: Vec<&str> = in_pixels.iter().map(|curve| curve.name.as_str()).collect();
        let of = |ways: &[Grown]| {
            let cost = |name: &str| ways.iter().find(|way| way.name == name);
            let cell = |way: Option<&Grown>| way.map_or("-".to_owned(), |way| number(way.cost.seconds() * 1e3));
            names.iter().map(|name| cell(cost(name))).collect::<Vec<_>>()
        };
        let head = |first: &[&str]| -> Vec<String> {
            let ways = names.iter().map(|name| format!("{name}, CPU ms"));
            first.iter().map(|name| (*name).to_owned()).chain(ways).collect()
        };
        // Bytes a cell of the device, of ways that take some.
        let on_device = |way: &Grown| way.device_bytes > 0;
        let all_ways = || scaling.cells.iter().flat_map(|point| &point.ways);
        let devices: Vec<&str> =
            names.iter().copied().filter(|name| all_ways().any(|way| way.name == *name && on_device(way))).collect();
        let rows = scaling.cells.iter().map(|point| {
            let a_cell = |bytes: f64| number((bytes / cells(point)).round());
            let ready =
                [point.cells.to_string(), number(point.assemble_wall_seconds * 1e3), a_cell(point.mesh_bytes as f64)];
            let device = devices.iter().map(|name| {
                let way = point.ways.iter().find(|way| way.name == *name && on_device(way));
                way.map_or("-".to_owned(), |way| a_cell(way.device_bytes as f64))
            });
            [ready.to_vec(), of(&point.ways), device.collect()].concat()
        });
        let mut titles = head(&["cells", "mesh ready, wall ms", "mesh, bytes a cell"]);
        titles.extend(devices.iter().map(|name| format!("{name}, device bytes a cell")));
        let table = markdown(&titles, rows);
        let _ = write!(self.markdown, "\n{table}");
        let rows = scaling.pixels.iter().map(|p| [vec![format!("{0} x {0}", p.side)], of(&p.ways)].concat());
        let table = markdown(&head(&["picture"]), rows);
        let _ = write!(self.markdown, "\n{table}");
    }
}

/// A share, as a fraction if it is one.
fn share(of: f64) -> String {
    if of <= 1.0 { format!("1/{}", number(1.0 / of)) } else { number(of) }
}

fn race_plot(race: &Race) -> String {
    let point = |entry: &Entry| [entry.cost.seconds(), entry.error.max];
    let mut front: Vec<[f64; 2]> = race.entries.iter().filter(|entry| entry.on_front).map(point).collect();
    front.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let mut curves = vec![Curve { name: "front".into(), points: front, style: Style::Faint }];
    let mark = |entry: &Entry| Curve { name: entry.name.clone(), points: vec![point(entry)], style: Style::Marks };
    curves.extend(race.entries.iter().map(mark));
    log_log(["processor seconds a frame", "largest error of a pixel"], Grid::Decades, &curves)
}

fn targets(all: &[Target]) -> String {
    let rows = all.iter().map(|target| {
        vec![target.what.clone(), target.goal.clone(), target.found.clone(), target.verdict.words().to_owned()]
    });
    markdown(&["what", "goal", "found", ""], rows)
}
