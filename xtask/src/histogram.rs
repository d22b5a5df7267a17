//! `cargo xtask histogram`

use std::path::PathBuf;

use anyhow::Result;
use serde::Serialize;
use tetlux_image::{Encoding, write_atomically, write_png};
use tetlux_scene::{FrequencyLimits, Histogram, frequency_limits, gradient_magnitude};

use crate::input::SceneArgs;
use crate::progress;
use crate::report::{create_folder, write_json};

pub(crate) const EXAMPLES: &str = "\
Examples:
  cargo xtask histogram scenes/wing-widgets.toml
  cargo xtask histogram mesh.vtu --field density --bins 200x150 --output out/density.png";

#[derive(clap::Args)]
pub(crate) struct Args {
    /// Scene file (.toml), or a mesh; none: the built-in scene
    #[arg(value_name = "SCENE | MESH")]
    scene: Option<PathBuf>,
    #[command(flatten)]
    input: SceneArgs,
    /// Bins along x and y
    #[arg(long, value_name = "WxH", default_value = "400x300", value_parser = crate::input::parse_size)]
    bins: [u32; 2],
    /// What x spans, such as 0,1.5 [default: its field's range]
    #[arg(long, value_name = "LOW,HIGH", value_parser = parse_range, allow_hyphen_values = true)]
    x_range: Option<[f64; 2]>,
    /// What y spans [default: its field's range, which few steep cells may stretch far]
    #[arg(long, value_name = "LOW,HIGH", value_parser = parse_range, allow_hyphen_values = true)]
    y_range: Option<[f64; 2]>,
    /// PNG to write, a pixel a bin; an SVG with axes goes beside it [default: out/SCENE-histogram.png]
    #[arg(long, short, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Write every figure as JSON
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
}

#[derive(Serialize)]
struct Figures {
    fields: [String; 2],
    ranges: [[f64; 2]; 2],
    bins: [usize; 2],
    volume: f64,
    volume_without_data: f64,
    volume_outside: f64,
    /// Bands per unit of each field: for every cell, 99 of 100, half.
    frequencies: [Option<[f64; 3]>; 2],
    files: [String; 2],
}

pub(crate) fn run(args: &Args) -> Result<()> {
    let input = args.input.load(args.scene.as_deref())?;
    let (mesh, scene) = (&input.mesh, &input.scene);
    let second = match &scene.second {
        Some(second) => second.clone(),
        // One field is shown over its gradient, as the widgets' default axis is.
        None => {
            progress::during("gradients", || gradient_magnitude(&scene.scalar, &mesh.vertex_gradients(&scene.scalar)))
        }
    };
    let scalars = [&scene.scalar, &second];
    let (given, bins) = ([args.x_range, args.y_range], args.bins.map(|n| n as usize));
    let histogram = progress::during("counting", || Histogram::new(mesh, scalars, given, bins))?;
    let png = args.output.clone().unwrap_or_else(|| PathBuf::from("out").join(format!("{}-histogram.png", input.name)));
    create_folder(&png)?;
    write_png(&histogram.picture(&scene.classification)?, &png, Encoding::Srgb)?;
    let svg = png.with_extension("svg");
    let names = scalars.map(|scalar| scalar.name.as_str());
    let plot = histogram.plot(&std::fs::read(&png)?, &scene.classification, names);
    write_atomically(&svg, |file| file.write_all(plot.as_bytes()))?;

    let limits = scalars.map(|scalar| frequency_limits(&mesh.scalar_ranges(scalar)));
    for (axis, (scalar, limits)) in ["x", "y"].into_iter().zip(scalars.into_iter().zip(&limits)) {
        let [low, high] = scalar.range;
        say!("{axis:<16} {}: {low} to {high}", scalar.name);
        print_limits(limits.as_ref(), high - low);
    }
    if histogram.without_data > 0.0 {
        say!("{:<16} a volume of {:.4e}", "without data", histogram.without_data);
    }
    if histogram.outside > 0.0 {
        say!("{:<16} a volume of {:.4e}", "outside", histogram.outside);
    }
    let files = [png.display().to_string(), svg.display().to_string()];
    say!("{}", files.join("\n"));
    if let Some(path) = &args.json {
        let figures = Figures {
            fields: names.map(str::to_string),
            ranges: histogram.range,
            bins: histogram.bins,
            volume: histogram.volumes.iter().sum(),
            volume_without_data: histogram.without_data,
            volume_outside: histogram.outside,
            frequencies: limits.map(|limits| limits.map(|l| [l.all, l.most, l.half])),
            files,
        };
        write_json(path, &figures)?;
    }
    Ok(())
}

fn parse_range(text: &str) -> Result<[f64; 2], String> {
    let ends = text.split_once(',').and_then(|(low, high)| Some([low.trim().parse().ok()?, high.trim().parse().ok()?]));
    ends.ok_or_else(|| format!("\"{text}\" is not a range such as 0,1.5"))
}

/// How many bands over its range a field bears under the published form of waves, which takes one a cell.
pub(crate) fn print_limits(limits: Option<&FrequencyLimits>, width: f64) {
    match limits {
        Some(FrequencyLimits { all, most, half }) => say!(
            "{:<16} one a cell up to {:.3} over the range ({all:.4e} a unit); for 99% of the cells {:.3}, for half {:.3}",
            "bands",
            all * width,
            most * width,
            half * width
        ),
        None => say!("{:<16} any number: the field is constant in every cell", "bands"),
    }
}
