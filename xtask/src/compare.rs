//! `cargo xtask compare`

use std::path::{Path, PathBuf};

use anyhow::{Result, bail};
use serde::Serialize;
use tetlux_image::{Encoding, Image, Metrics, compare, difference_picture, read_exr, write_png};
use tetlux_render::Renderer;
use tetlux_scene::{Backend, Order, Plan};

use crate::input::{Input, SceneArgs, stem};
use crate::report::{OrderingFaults, Report, create_folder, print_metrics, write_json};
use crate::{progress, render, truth};

pub(crate) const EXAMPLES: &str = "\
Examples:
  cargo xtask compare
  cargo xtask compare scenes/bluntfin-spiky.toml --mesh bluntfin_tets.vtu --order centroid --json error.json
  cargo xtask compare mesh.vtu --field pressure --surface body.obj
  cargo xtask compare yesterday.exr today.exr --max-error 1e-5

Exit status: 0 within the error budget, 1 past it, 2 if something failed.";

#[derive(clap::Args)]
pub(crate) struct Args {
    /// A scene file or a mesh (none: the built-in scene), or two EXR files
    #[arg(num_args = 0..=2, value_name = "SCENE | MESH | A.exr B.exr")]
    what: Vec<PathBuf>,
    #[command(flatten)]
    input: SceneArgs,
    /// Folder for the pictures
    #[arg(long, short, value_name = "FOLDER", default_value = "out")]
    output: PathBuf,
    /// Write every figure as JSON
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
}

/// Largest error on the scale of difference pictures.
const TOP_OF_SCALE: f64 = 0.1;

/// Whether the error is within the budget.
pub(crate) fn run(args: &Args) -> Result<bool> {
    let is_exr = |path: &PathBuf| path.extension().is_some_and(|e| e.eq_ignore_ascii_case("exr"));
    match &args.what[..] {
        [a, b] if is_exr(a) && is_exr(b) => compare_files(args, a, b),
        [_, _] => bail!("two files to compare must both be EXR; a scene is compared alone"),
        [one] if is_exr(one) => bail!("{}: an EXR file is compared with another: name two", one.display()),
        [] => compare_scene(args, None),
        [scene, ..] => compare_scene(args, Some(scene)),
    }
}

fn compare_files(args: &Args, a: &Path, b: &Path) -> Result<bool> {
    #[derive(Serialize)]
    struct Files<'a> {
        files: [String; 2],
        max_error: f64,
        error: &'a Metrics,
    }
    let budget = args.input.max_error.unwrap_or(tetlux_scene::Method::default().max_error);
    let (first, second) = (read_exr(a)?, read_exr(b)?);
    let metrics = compare(&first, &second, budget)?;
    print_metrics(&metrics, budget);
    say!("{}", write_difference(&first, &second, &args.output.join(format!("{}-difference.png", stem(b))))?);
    if let Some(path) = &args.json {
        let files = [a, b].map(|p| p.display().to_string());
        write_json(path, &Files { files, max_error: budget, error: &metrics })?;
    }
    Ok(verdict(&metrics, budget))
}

fn compare_scene(args: &Args, scene: Option<&Path>) -> Result<bool> {
    let input = args.input.load(scene)?;
    let budget = input.scene.method.max_error;
    let renderer = Renderer::new();
    let adapter = renderer.device().map(|d| d.name.clone());
    let (plan, frame) = render::render(&input, &renderer, |plan| {
        Report::new(&input, plan, adapter.as_deref(), &[]).print_plan(plan);
    })?;
    let mut stages = tetlux_render::Stages::default();
    let reference = stages.run("reference", || truth::image(&input, &plan.view, [0.0; 2]))?;
    let metrics = compare(&reference, &frame.image, budget)?;

    let mut all = frame.stages.clone();
    all.extend(stages.into_vec());
    let mut report = Report::new(&input, &plan, adapter.as_deref(), &all);
    report.resources = (plan.backend == Backend::Gpu).then(|| frame.resources.into());
    report.add(&frame);
    report.adaptive = frame.spent.map(Into::into);
    report.print_stages();
    print_metrics(&metrics, budget);
    let stated = plan.stated.total();
    match stated {
        Some(stated) => say!("  stated {stated:.3e}, of which {:.0} % are measured", 100.0 * metrics.max / stated),
        None => say!("  stated: not bounded"),
    }
    let path = |suffix: &str| args.output.join(format!("{}{suffix}.png", input.name));
    report.files = render::write_picture(&input, &frame.image, &path(""))?;
    report.files.extend(render::write_picture(&input, &reference, &path("-reference"))?);
    report.files.push(write_difference(&reference, &frame.image, &path("-difference"))?);
    if metrics.over > 0 && !matches!(plan.order, Order::Pixel | Order::None) {
        let (faults, picture) = ordering_faults(&input, &renderer, &plan, &frame.image, &reference)?;
        say!(
            "of {} pixels over the budget, {} come right when their cells are sorted along the ray (then max {:.3e})",
            faults.pixels_over,
            faults.mended_by_sorting,
            faults.max_after_sorting
        );
        write_png(&picture, &path("-order-faults"), Encoding::Srgb)?;
        report.files.push(path("-order-faults").display().to_string());
        report.ordering_faults = Some(faults);
    }
    say!("{}", report.files.join("\n"));
    let mut within = verdict(&metrics, budget);
    if let Some(stated) = stated.filter(|&stated| metrics.max > stated) {
        // What the statement leaves out by its own words is no fault of it.
        within &= plan.stated.beyond.is_some();
        say!(
            "PAST the stated error of {stated:.1e}{}",
            plan.stated.beyond.as_ref().map_or(String::new(), |b| format!(": {b}"))
        );
    }
    report.error = Some(metrics);
    if let Some(path) = &args.json {
        report.write(path)?;
    }
    Ok(within)
}

fn verdict(metrics: &Metrics, budget: f64) -> bool {
    let within = metrics.over == 0 && metrics.non_finite == 0;
    say!("{} the error budget of {budget:.1e}", if within { "within" } else { "PAST" });
    within
}

fn write_difference(a: &Image, b: &Image, path: &Path) -> Result<String> {
    create_folder(path)?;
    write_png(&difference_picture(a, b, TOP_OF_SCALE)?.over([0.0; 3]), path, Encoding::Srgb)?;
    Ok(path.display().to_string())
}

/// Which pixels are over the budget because of the order of their cells, and a picture of them: red where sorting the
/// cells along the ray mends the pixel, yellow where it does not.
fn ordering_faults(
    input: &Input,
    renderer: &Renderer,
    plan: &Plan,
    image: &Image,
    reference: &Image,
) -> Result<(OrderingFaults, Image)> {
    let sorted_plan = Plan { backend: Backend::Cpu, order: Order::Pixel, ..plan.clone() };
    let sorted = progress::during("sorting every pixel", || {
        renderer.render(&input.scene, &input.model(&sorted_plan), &sorted_plan)
    })?;
    let budget = input.scene.method.max_error;
    let error =
        |a: &[f32; 4], b: &[f32; 4]| (0..4).map(|i| (f64::from(a[i]) - f64::from(b[i])).abs()).fold(0.0, f64::max);
    let mut faults = OrderingFaults {
        pixels_over: 0,
        mended_by_sorting: 0,
        max_after_sorting: compare(reference, &sorted.image, budget)?.max,
    };
    let pixels =
        reference.pixels().iter().zip(image.pixels()).zip(sorted.image.pixels()).map(|((truth, ours), sorted)| {
            // What is not at fault shows faintly.
            let dim = (0.2 * (truth[0] + truth[1] + truth[2]) / 3.0).min(0.2);
            if error(truth, ours) <= budget {
                return [dim, dim, dim, 1.0];
            }
            faults.pixels_over += 1;
            if error(truth, sorted) <= budget {
                faults.mended_by_sorting += 1;
                [1.0, 0.05, 0.05, 1.0]
            } else {
                [1.0, 0.9, 0.0, 1.0]
            }
        });
    let picture = Image::from_pixels(image.width(), image.height(), pixels.collect())?;
    Ok((faults, picture))
}
