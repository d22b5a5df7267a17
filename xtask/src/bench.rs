//! `cargo xtask bench`

mod data;
mod kraus;
mod measure;
mod memory;
mod moreland;
mod paper;
mod table;

use std::path::PathBuf;

use anyhow::{Result, bail};
use tetlux_render::Renderer;

use crate::input::parse_size;
use crate::report::write_json;
use data::Data;
use paper::{PAPERS, Paper};

pub(crate) const EXAMPLES: &str = "\
Examples:
  cargo xtask bench --paper moreland-2 --data nasa
  cargo xtask bench --paper all --quick";

#[derive(clap::Args)]
pub(crate) struct Args {
    /// A paper's table with ours beside it, by name, or all of them
    #[arg(long, value_name = "NAME")]
    paper: Vec<String>,
    /// Folder with the NASA data sets (bluntfin_tets.vtu, or bluntfinxyz.bin and bluntfinq.bin, and the like)
    #[arg(long, value_name = "FOLDER")]
    data: Option<PathBuf>,
    /// Picture size in pixels
    #[arg(long, value_name = "WxH", value_parser = parse_size)]
    size: Option<[u32; 2]>,
    /// Timed frames of each method, in turn with the others
    #[arg(long, value_name = "N", default_value_t = 3, value_parser = clap::value_parser!(u16).range(1..=1000))]
    runs: u16,
    /// Small meshes and pictures, a frame each: whether it all works, in seconds
    #[arg(long)]
    quick: bool,
    /// Folder for the figures as JSON
    #[arg(long, short, value_name = "FOLDER", default_value = "target/bench")]
    output: PathBuf,
}

/// What everything is measured with.
pub(crate) struct Bench<'a> {
    renderer: &'a Renderer,
    data: Data,
    runs: usize,
    quick: bool,
    size: Option<[u32; 2]>,
}

/// Side of pictures in a quick run.
const QUICK_SIDE: u32 = 32;

impl Bench<'_> {
    /// What draws by wgpu.
    fn adapter(&self) -> String {
        self.renderer.device().map_or("the processor".into(), |device| device.name.clone())
    }

    /// The size of a paper's pictures: as published on hardware, a quarter of each side on a software adapter.
    fn paper_size(&self, published: [u32; 2]) -> [u32; 2] {
        let software = self.renderer.device().is_none_or(|device| device.software);
        match (self.size, self.quick) {
            (Some(size), _) => size,
            (None, true) => [QUICK_SIDE; 2],
            (None, false) if software => published.map(|n| n / 4),
            (None, false) => published,
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
}

pub(crate) fn run(args: &Args) -> Result<()> {
    let papers = papers(&args.paper)?;
    let renderer = Renderer::new();
    let bench = Bench {
        renderer: &renderer,
        data: Data::new(args.data.as_deref())?,
        runs: if args.quick { 1 } else { usize::from(args.runs) },
        quick: args.quick,
        size: args.size,
    };
    for (name, measure) in papers {
        let table = measure(&bench)?;
        say!("{}", table.text());
        let json = args.output.join(format!("paper-{name}.json"));
        write_json(&json, &table)?;
        say!("{}", json.display());
    }
    Ok(())
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
