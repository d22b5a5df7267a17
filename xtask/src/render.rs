//! `cargo xtask render`

use std::path::{Path, PathBuf};

use anyhow::{Result, bail};
use tetlux_image::{Encoding, Image, write_exr, write_png};
use tetlux_render::{Frame, Renderer, Stages};
use tetlux_scene::{Backend, Plan};

use crate::calibration::Calibration;
use crate::input::{Input, SceneArgs};
use crate::report::{Report, create_folder};
use crate::sequence::{self, SequenceArgs};
use crate::{explain, progress, tables};

pub(crate) const EXAMPLES: &str = "\
Examples:
  cargo xtask render
  cargo xtask render mesh.vtu --field pressure
  cargo xtask render scenes/bluntfin-smooth.toml --mesh bluntfin_tets.vtu
  cargo xtask render scenes/bluntfin-smooth.toml --mesh bluntfinxyz.bin --solution bluntfinq.bin --field Density
  cargo xtask render --backend gpu --projection tiles --size 1600x900
  cargo xtask render scenes/wing-silhouette.toml --projection march
  cargo xtask render mesh.vtu --field pressure --surface body.stl
  cargo xtask render scenes/wing-gaussian.toml --integrator approximate --pieces 20
  cargo xtask render --explain
  cargo xtask render mesh.vtu --orbit 120 --max-error 1e-2 --output turn/mesh.png
  cargo xtask render run.e --field pressure --times
  cargo xtask render scene.toml --series step-*.vtu --json series.json
  cargo xtask render --backend gpu --integrator psi --table-precision u16 --interpolation perspective
  cargo xtask render scene.toml --size 1600x900 --backend cpu --order pixel --output pictures/fin.png --json fin.json";

#[derive(clap::Args)]
pub(crate) struct Args {
    /// Scene file (.toml), or a mesh to show with the default scene; none: the built-in scene
    #[arg(value_name = "SCENE | MESH")]
    scene: Option<PathBuf>,
    #[command(flatten)]
    input: SceneArgs,
    /// PNG to write; the EXR goes beside it [default: out/SCENE.png]
    #[arg(long, short, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Write every figure as JSON
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// Say what is skipped and why, and render without each to measure what it saves
    #[arg(long)]
    explain: bool,
    #[command(flatten)]
    sequence: SequenceArgs,
}

pub(crate) fn run(args: &Args) -> Result<()> {
    if args.sequence.is_asked() {
        if args.explain {
            bail!("--explain is for one picture: leave out what asks for a sequence");
        }
        let (output, json) = (args.output.as_deref(), args.json.as_deref());
        return sequence::run(&args.sequence, &args.input, args.scene.as_deref(), output, json);
    }
    let input = args.input.load(args.scene.as_deref())?;
    let renderer = Renderer::new();
    let adapter = renderer.device().map(|d| d.name.clone());
    let (plan, frame) = render(&input, &renderer, |plan| {
        let report = Report::new(&input, plan, adapter.as_deref(), &[]);
        report.print_plan(plan);
        if args.explain {
            explain::print(&report.skips);
        }
    })?;
    let mut report = Report::new(&input, &plan, adapter.as_deref(), &frame.stages);
    report.resources = (plan.backend == Backend::Gpu).then(|| frame.resources.into());
    report.add(&frame);
    report.adaptive = frame.spent.map(Into::into);
    report.print_stages();
    explain::resolve(&mut report.skips, &frame);
    if args.explain {
        explain::measure(&input, &mut report.skips)?;
    }
    let png = args.output.clone().unwrap_or_else(|| PathBuf::from("out").join(&input.name).with_extension("png"));
    report.files = write_picture(&input, &frame.image, &png)?;
    say!("{}", report.files.join("\n"));
    if let Some(path) = &args.json {
        report.write(path)?;
    }
    Ok(())
}

/// Plans and renders; `announce` is told the plan before anything is drawn.
pub(crate) fn render(input: &Input, renderer: &Renderer, announce: impl FnOnce(&Plan)) -> Result<(Plan, Frame)> {
    let mut stages = Stages::default();
    let device = Calibration::default().device(&input.scene, &input.mesh, renderer)?;
    let mut plan = stages.run("plan", || Plan::new(&input.scene, &input.mesh, device.as_ref()))?;
    let tables = stages.run("tables", || tables::load(input, &plan));
    let tables = tables::or_directly(tables, input.integrator_forced, &mut plan)?;
    announce(&plan);
    let model = input.model(&plan);
    let render = || renderer.render_with(&input.scene, &model, &plan, &tables);
    let mut frame = progress::during("rendering", render)?;
    input.keep(&model);
    let mut all = stages.into_vec();
    all.append(&mut frame.stages);
    frame.stages = all;
    Ok((plan, frame))
}

/// Writes the PNG over the background and the EXR without it; gives the names of the files.
pub(crate) fn write_picture(input: &Input, image: &Image, png: &Path) -> Result<Vec<String>> {
    create_folder(png)?;
    let exr = png.with_extension("exr");
    let encoding = if input.display_space { Encoding::Display } else { Encoding::Srgb };
    write_exr(image, &exr, None)?;
    write_png(&image.over(input.scene.background), png, encoding)?;
    Ok(vec![png.display().to_string(), exr.display().to_string()])
}
