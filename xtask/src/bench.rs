//! `cargo xtask bench`

mod budgets;
mod data;
mod front;
mod kraus;
mod measure;
mod moreland;
mod page;
mod paper;
mod patience;
mod peer;
mod race;
mod scaling;
mod skips;
mod song;
pub(crate) mod table;
mod targets;

use std::cell::RefCell;
use std::path::{Path, PathBuf};
use std::time::Instant;

use anyhow::{Result, bail};
use serde::Serialize;
use tetlux_image::write_atomically;
use tetlux_render::Renderer;

use crate::calibration::Calibration;
use crate::input::{Input, SceneArgs, parse_size};
use crate::machine::Machine;
use crate::methods::{GRADED, PEAK};
use crate::report::{create_folder, write_json};
use data::Data;
use paper::{PAPERS, Paper};
use patience::Patience;
use race::Race;
use scaling::Scaling;
use table::Table;
use targets::Target;

pub(crate) const EXAMPLES: &str = "\
Examples:
  cargo xtask bench
  cargo xtask bench scene.toml mesh.vtu --size 400x400
  cargo xtask bench --data nasa --peer vtk --python venv/bin/python
  cargo xtask bench --paper moreland-2 --paper kraus-1 --data nasa
  cargo xtask bench --write-docs --data nasa --peer vtk
  cargo xtask bench --quick

A bench races scenes (every way of drawing, time against error), then measures how time and memory grow with cells and pixels,
what each skip of the plan saves and what an error budget buys, and judges the targets. Scenes that are named are raced alone,
--paper NAME gives papers' tables alone, and --write-docs all of it: about a quarter of an hour on two cores without a graphics
card. A machine that does nothing else gives the best figures. --peer vtk needs VTK for Python: pip install vtk.";

#[derive(clap::Args)]
pub(crate) struct Args {
    /// Scene files or meshes to race; none: the built-in scene, a graded mesh, a peak within cells, and those of --data
    #[arg(value_name = "SCENE | MESH")]
    scenes: Vec<PathBuf>,
    /// Folder with the NASA data sets: bluntfin_tets.vtu and post_tets.vtu, or the PLOT3D files bluntfinxyz.bin,
    /// bluntfinq.bin, postxyz.bin and postq.bin
    #[arg(long, value_name = "FOLDER")]
    data: Option<PathBuf>,
    /// Race another program's renderers too: vtk
    #[arg(long, value_name = "NAME", value_parser = ["vtk"])]
    peer: Option<String>,
    /// The Python that runs the peer
    #[arg(long, value_name = "PROGRAM", default_value = "python3")]
    python: String,
    /// A paper's table with ours beside it, and no race: moreland-2 and the like (a name that is none lists them), or all;
    /// may be repeated
    #[arg(long, value_name = "NAME", conflicts_with_all = ["scenes", "peer"])]
    paper: Vec<String>,
    /// Picture size in pixels [default: 800x800; of papers theirs, or a quarter of each side on a software adapter]
    #[arg(long, value_name = "WxH", value_parser = parse_size)]
    size: Option<[u32; 2]>,
    /// Timed frames of each way, in turn with the others; what takes more than a processor second is timed by one, and what
    /// takes more than 6 is not asked for more
    #[arg(long, value_name = "N", default_value_t = 3, value_parser = clap::value_parser!(u16).range(1..=1000))]
    runs: u16,
    /// Small meshes and pictures, a frame each: whether it all works
    #[arg(long)]
    quick: bool,
    /// Folder for figures (JSON), report (Markdown) and plots (SVG)
    #[arg(long, short, value_name = "FOLDER", default_value = "target/bench")]
    output: PathBuf,
    /// Race, growth and all papers, written to docs/benchmarks.md and docs/benchmarks
    #[arg(long, conflicts_with_all = ["scenes", "paper"])]
    write_docs: bool,
}

/// What everything is measured with.
pub(crate) struct Bench<'a> {
    renderer: &'a Renderer,
    data: Data,
    runs: usize,
    quick: bool,
    size: Option<[u32; 2]>,
    calibration: Calibration,
    patience: RefCell<Patience>,
    begun: Instant,
}

/// Loads a scene and its mesh.
type Load<'a> = Box<dyn Fn() -> Result<Input> + 'a>;

/// Everything that was found.
#[derive(Serialize)]
pub(crate) struct Results {
    /// Small meshes and pictures.
    quick: bool,
    machine: Machine,
    races: Vec<Race>,
    scaling: Option<Scaling>,
    /// What each skip of the plan saves.
    skips: Option<Table>,
    /// What an error budget buys.
    budgets: Option<Table>,
    targets: Vec<Target>,
    papers: Vec<Table>,
}

/// Side of pictures in a quick run.
const QUICK_SIDE: u32 = 32;
const SIZE: [u32; 2] = [800; 2];

impl<'a> Bench<'a> {
    /// Without data, a frame of each way.
    fn new(renderer: &'a Renderer) -> Bench<'a> {
        Bench {
            renderer,
            data: Data::default(),
            runs: 1,
            quick: false,
            size: None,
            calibration: Calibration::default(),
            patience: RefCell::default(),
            begun: Instant::now(),
        }
    }

    /// Says what is measured next, and when.
    fn tell(&self, what: &str) {
        say!("{:>6.1} s  {what}", self.begun.elapsed().as_secs_f64());
    }

    /// What draws by wgpu.
    fn adapter(&self) -> String {
        self.renderer.device().map_or("no adapter".into(), |device| device.name.clone())
    }

    /// Whether there is an adapter that is not this processor.
    fn hardware(&self) -> bool {
        self.renderer.device().is_some_and(|device| !device.software)
    }

    /// The size of a paper's pictures: as published on hardware, a quarter of each side on a software adapter.
    fn paper_size(&self, published: [u32; 2]) -> [u32; 2] {
        match (self.size, self.quick) {
            (Some(size), _) => size,
            (None, true) => [QUICK_SIDE; 2],
            (None, false) if self.hardware() => published,
            (None, false) => published.map(|n| n / 4),
        }
    }

    /// Where and how ours were drawn.
    fn paper_note(&self, size: [u32; 2], published: [u32; 2]) -> String {
        format!(
            "Theirs {} x {} on a graphics card of 2004; ours {} x {} by wgpu on {}, exact order unless the method needs none; \
             \"here: the default\" is what the plan chooses for this machine.",
            published[0],
            published[1],
            size[0],
            size[1],
            self.adapter()
        )
    }

    /// What is raced: the scenes named, or else those that are known; each is loaded when its turn comes, so that memory is
    /// told of one at a time.
    fn inputs<'b>(&'b self, scenes: &'b [PathBuf]) -> Vec<Load<'b>> {
        let flags = || SceneArgs { size: self.size, ..SceneArgs::default() };
        if !scenes.is_empty() {
            return scenes.iter().map(|path| -> Load { Box::new(move || flags().load(Some(path))) }).collect();
        }
        let peak = |side: u32| -> Load { Box::new(move || PEAK.input("peak", "A peak within cells", side)) };
        if self.quick {
            return vec![peak(QUICK_SIDE)];
        }
        let side = self.size.unwrap_or(SIZE)[1];
        let mut inputs: Vec<Load> = vec![
            Box::new(move || flags().load(None)),
            Box::new(move || GRADED.input("graded", "Edges from 1e-5 to 1", side)),
            peak(side),
        ];
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes");
        for scene in ["bluntfin-smooth", "bluntfin-spiky", "post-smooth", "post-spiky"] {
            let stem = scene.split('-').next().unwrap_or(scene);
            if let Some(source) = self.data.find(stem) {
                let path = folder.join(scene).with_extension("toml");
                inputs.push(Box::new(move || source.flags(flags()).load(Some(&path))));
            }
        }
        inputs
    }
}

pub(crate) fn run(args: &Args) -> Result<()> {
    let all = ["all".to_owned()];
    let papers = papers(if args.write_docs { &all } else { &args.paper })?;
    let renderer = Renderer::new();
    let bench = Bench {
        data: Data::new(args.data.as_deref())?,
        runs: if args.quick { 1 } else { usize::from(args.runs) },
        quick: args.quick,
        size: args.size,
        ..Bench::new(&renderer)
    };
    let mut results = Results {
        quick: args.quick,
        machine: Machine::new(&renderer),
        races: Vec::new(),
        scaling: None,
        skips: None,
        budgets: None,
        targets: Vec::new(),
        papers: Vec::new(),
    };
    results.machine.rows().iter().for_each(|[name, value]| say!("{name:<18} {value}"));
    let racing = args.paper.is_empty();
    if racing {
        let python = args.peer.as_ref().map(|_| args.python.as_str());
        let inputs = bench.inputs(&args.scenes);
        for (number, load) in inputs.iter().enumerate() {
            let input = load()?;
            bench.tell(&format!("race {} of {}: {}", number + 1, inputs.len(), input.title));
            let race = race::race(&bench, &input, python, &args.output.join("peer"))?;
            print(&race);
            results.races.push(race);
        }
    }
    if racing && args.scenes.is_empty() {
        bench.tell("growth");
        let scaling = scaling::scaling(&bench)?;
        results.targets = targets::targets(&results.races, &scaling, bench.hardware());
        for Target { what, goal, found, verdict } in &results.targets {
            say!("{:<12} {what}: {found} (goal {goal})", verdict.words().trim_matches('*'));
        }
        results.scaling = Some(scaling);
        for (part, measure, into) in [
            ("what skipping saves", skips::skips as fn(&Bench) -> Result<Table>, &mut results.skips),
            ("what an error budget buys", budgets::budgets, &mut results.budgets),
        ] {
            bench.tell(part);
            let table = measure(&bench)?;
            say!("{}", table.text());
            *into = Some(table);
        }
    }
    for (name, measure) in papers {
        bench.tell(&format!("paper: {name}"));
        let table = measure(&bench)?;
        say!("{}", table.text());
        write_json(&args.output.join(format!("paper-{name}.json")), &table)?;
        results.papers.push(table);
    }
    let name = if racing { "benchmarks" } else { "papers" };
    let page =
        if args.write_docs { PathBuf::from("docs/benchmarks.md") } else { args.output.join(name).with_extension("md") };
    write_page(&results, &page)?;
    let json = args.output.join(name).with_extension("json");
    write_json(&json, &results)?;
    bench.tell(&format!("{}, {}", page.display(), json.display()));
    Ok(())
}

/// Writes the page, and its plots into the folder of its name.
fn write_page(results: &Results, path: &Path) -> Result<()> {
    let folder = path.with_extension("");
    let name = folder.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
    let page = page::page(results, &name);
    for (name, plot) in &page.plots {
        let path = folder.join(name);
        create_folder(&path)?;
        write_atomically(&path, |file| file.write_all(plot.as_bytes()))?;
    }
    create_folder(path)?;
    write_atomically(path, |file| file.write_all(page.markdown.as_bytes()))?;
    Ok(())
}

fn print(race: &Race) {
    let [width, height] = race.size;
    say!("{}: {} cells, {width} x {height}", race.name, race.cells);
    say!("  {:<38} {:>8} {:>8} {:>6} {:>10} {:>10}", "way", "max", "mean", "PSNR", "wall ms", "CPU ms");
    for race::Entry { name, cost, error, on_front, .. } in &race.entries {
        let cpu = cost.cpu_seconds.map_or("-".to_owned(), |s| format!("{:.1}", s * 1e3));
        let star = if *on_front { "*" } else { " " };
        let wall = cost.wall_seconds * 1e3;
        say!("{star} {name:<38} {:>8.1e} {:>8.1e} {:>6.1} {wall:>10.1} {cpu:>10}", error.max, error.mean, error.psnr);
    }
    race.refused.iter().for_each(|[name, why]| say!("  {name} did not take part: {why}"));
}

/// The papers by name.
fn papers(names: &[String]) -> Result<Vec<Paper>> {
    if let Some(unknown) = names.iter().find(|name| *name != "all" && PAPERS.iter().all(|(paper, _)| paper != name)) {
        let known: Vec<_> = PAPERS.iter().map(|(name, _)| *name).collect();
        bail!("--paper {unknown}: there is no such table; there are {}, and all", known.join(", "));
    }
    let asked = |name: &str| names.iter().any(|asked| asked == name || asked == "all");
    Ok(PAPERS.iter().copied().filter(|(name, _)| asked(name)).collect())
}
