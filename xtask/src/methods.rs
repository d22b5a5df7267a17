//! `cargo xtask methods`

use std::fmt::Write;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};
use tetlux_image::{Image, write_atomically};
use tetlux_render::{Frame, Renderer};
use tetlux_scene::{
    Backend, CellProjection, Classification, Integrator, Interpolation, Method, Order, TablePrecision, Target,
};

use crate::input::{Input, SceneArgs, parse_size};
use crate::testbed::frame;
use crate::testbed::meshes::{Setting, cube, graded_cube, log_radius};
use crate::truth;

pub(crate) const EXAMPLES: &str = "\
Examples:
  cargo xtask methods
  cargo xtask methods --mesh bluntfin_tets.vtu --size 200x200 --markdown out/methods.md";

#[derive(clap::Args)]
pub(crate) struct Args {
    /// The Blunt Fin's mesh, to be seen with its two scenes; without it the built-in scene is taken
    #[arg(long, value_name = "FILE")]
    mesh: Option<PathBuf>,
    /// The page whose table is replaced
    #[arg(long, value_name = "FILE", default_value = "docs/methods.md")]
    markdown: PathBuf,
    /// Picture size in pixels
    #[arg(long, value_name = "WxH", default_value = "200x200", value_parser = parse_size)]
    size: [u32; 2],
    /// One method alone, by name; may be repeated
    #[arg(long, value_name = "NAME")]
    only: Vec<String>,
}

/// Between these lines of the page is the table.
const MARKERS: [&str; 2] = ["<!-- begin: cargo xtask methods -->", "<!-- end: cargo xtask methods -->"];

/// What rasterisers may move a ray by, in pixels. Where moving it so far changes the truth by more than `MOVED`, the
/// pixel's centre is on an edge of the picture, and which side is seen says nothing of the method.
const BESIDE: f64 = 1e-4;
const MOVED: f64 = 1e-4;

/// Name and what it changes of the default on a graphics adapter.
pub(crate) type Row = (&'static str, fn(&mut Method));

pub(crate) const ROWS: &[Row] = &[
    ("default", |_| ()),
    ("`gator`, `perspective`", |m| m.projection = CellProjection::Gator),
    ("`vicp`", |m| m.projection = CellProjection::Vicp),
    ("`balanced`", |m| m.projection = CellProjection::Balanced),
    ("`march`", |m| m.projection = CellProjection::March),
    ("`tiles`", |m| m.projection = CellProjection::Tiles),
    ("`perspective`", |m| m.interpolation = Interpolation::Perspective),
    ("`screen-linear`", |m| m.interpolation = Interpolation::ScreenLinear),
    ("`symmetric`", |m| m.integrator = Integrator::Symmetric),
    ("`q`", |m| m.integrator = Integrator::Q),
    ("`q`, `u16`", |m| (m.integrator, m.table_precision) = (Integrator::Q, TablePrecision::U16)),
    ("`q`, `f16`", |m| (m.integrator, m.table_precision) = (Integrator::Q, TablePrecision::F16)),
    ("`q`, `u8`", |m| (m.integrator, m.table_precision) = (Integrator::Q, TablePrecision::U8)),
    ("`psi`", |m| m.integrator = Integrator::Psi),
    ("`psi`, `u8`", |m| (m.integrator, m.table_precision) = (Integrator::Psi, TablePrecision::U8)),
    ("`linear`", |m| m.integrator = Integrator::Linear),
    ("`average`", |m| m.integrator = Integrator::Average),
    ("`preint`", |m| m.integrator = Integrator::Preint),
    ("`preint`, `u8`", |m| (m.integrator, m.table_precision) = (Integrator::Preint, TablePrecision::U8)),
    ("`preint-log`", |m| m.integrator = Integrator::PreintLog),
    ("`preint-q`", |m| m.integrator = Integrator::PreintQ),
    ("`vertex`", |m| m.classification = Classification::Vertex),
    ("`post-clip`", |m| m.classification = Classification::PostClip),
    ("`rgba16f`", |m| m.target = Target::Rgba16f),
    ("`rgba8`", |m| m.target = Target::Rgba8),
    ("`rgba8-dither`", |m| m.target = Target::Rgba8Dither),
    ("order `none`", |m| m.order = Order::None),
    ("order `centroid`", |m| m.order = Order::Centroid),
    ("order `power`", |m| m.order = Order::Power),
    ("order `mpvo`", |m| m.order = Order::Mpvo),
    ("order `mpvonc`", |m| m.order = Order::Mpvonc),
    ("`cpu`", |m| m.backend = Backend::Cpu),
    ("`cpu`, order `pixel`", |m| (m.backend, m.order) = (Backend::Cpu, Order::Pixel)),
];

/// A graded mesh of edges from 1e-5 to 1.
pub(crate) const GRADED: Setting = Setting {
    mesh: graded_cube,
    field: log_radius,
    color: &[[0.0, 1.0, 0.6, 0.1], [0.5, 1.0, 0.5, 0.1], [0.8, 0.2, 0.6, 1.0], [1.2, 0.2, 0.9, 0.6]],
    opacity: &[[0.0, 20.0], [0.5, 60.0], [0.7, 4.0], [0.9, 0.5], [1.2, 0.2]],
    unit_distance: 1.0,
    eye: [1.6, -2.9, 1.3],
    focus: [0.0, 0.0, 0.0],
    view_angle: 36.0,
};

/// A peak so narrow that it lies within cells.
pub(crate) const PEAK: Setting = Setting {
    mesh: cube::<12>,
    field: |p| p.length(),
    color: &[[0.0, 1.0, 0.7, 0.2], [0.75, 1.0, 0.45, 0.1], [0.85, 0.2, 0.4, 0.9], [1.8, 0.1, 0.2, 0.6]],
    opacity: &[[0.0, 0.1], [0.74, 0.1], [0.75, 60.0], [0.76, 0.1], [1.8, 0.05]],
    unit_distance: 1.0,
    eye: [2.2, -5.4, 1.7],
    focus: [0.0, 0.0, 0.0],
    view_angle: 24.0,
};

const BLUNTFIN: [&str; 2] = ["bluntfin-smooth.toml", "bluntfin-spiky.toml"];

pub(crate) fn run(args: &Args) -> Result<()> {
    let rows: Vec<&Row> = ROWS.iter().filter(|(name, _)| args.only.is_empty() || is_among(name, &args.only)).collect();
    if let Some(unknown) = args.only.iter().find(|name| !ROWS.iter().any(|(row, _)| bare(row) == **name)) {
        let names: Vec<_> = ROWS.iter().map(|(name, _)| bare(name)).collect();
        bail!("--only {unknown}: there is no such method; there are {}", names.join("; "));
    }
    // Found missing before minutes are spent.
    let page = std::fs::read_to_string(&args.markdown)
        .with_context(|| format!("{}: the page that is to hold the table cannot be read", args.markdown.display()))?;
    let _ = replaced(&page, "", &args.markdown)?;
    let renderer = Renderer::new();
    let mut columns = Vec::new();
    for mut input in inputs(args)? {
        columns.push(Column::measure(&mut input, &renderer, &rows)?);
    }
    let page = replaced(&page, &table(&rows, &columns, args.size), &args.markdown)?;
    write_atomically(&args.markdown, |file| file.write_all(page.as_bytes()))?;
    say!("{}", args.markdown.display());
    Ok(())
}

/// The name as it is typed.
fn bare(name: &str) -> String {
    name.replace('`', "")
}

fn is_among(name: &str, only: &[String]) -> bool {
    only.iter().any(|asked| *asked == bare(name))
}

fn inputs(args: &Args) -> Result<Vec<Input>> {
    let flags = || SceneArgs { mesh: args.mesh.clone(), size: Some(args.size), ..SceneArgs::default() };
    let scenes = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes");
    let mut inputs = match &args.mesh {
        Some(_) => BLUNTFIN.iter().map(|scene| flags().load(Some(&scenes.join(scene)))).collect::<Result<Vec<_>>>()?,
        None => vec![flags().load(None)?],
    };
    inputs.push(GRADED.input("graded", "edges from 1e-5 to 1", args.size[1])?);
    inputs.push(PEAK.input("peak", "a peak within cells", args.size[1])?);
    Ok(inputs)
}

/// What one scene makes of the methods.
struct Column {
    title: String,
    /// Pixels that are seen, and those among them at edges.
    pixels: [usize; 2],
    cells: Vec<Figures>,
}

struct Figures {
    max: f64,
    mean: f64,
    /// Pixels at edges that are off by more than `MOVED`.
    beside: usize,
    /// Processor seconds of the draw.
    seconds: Option<f64>,
}

impl Column {
    fn measure(input: &mut Input, renderer: &Renderer, rows: &[&Row]) -> Result<Column> {
        let view = input.scene.camera.view(input.scene.size)?;
        let truth = truth::image(input, &view, [0.0; 2])?;
        let mut edge = vec![false; truth.pixels().len()];
        for by in [[-BESIDE, 0.0], [BESIDE, 0.0], [0.0, -BESIDE], [0.0, BESIDE]] {
            let moved = truth::image(input, &view, by)?;
            let pairs = truth.pixels().iter().zip(moved.pixels());
            edge.iter_mut().zip(pairs).for_each(|(edge, (a, b))| *edge |= pixel_error(a, b) > MOVED);
        }
        say!("{} ({} cells)", input.title, input.mesh.cells().len());
        let mut cells = Vec::new();
        for (name, method) in rows {
            let found = figures(&frame(input, renderer, *method)?, &truth, &edge);
            say!(
                "  {:<24} {:>9.1e} {:>9.1e} {:>5} {:>8}",
                bare(name),
                found.max,
                found.mean,
                found.beside,
                milliseconds(found.seconds)
            );
            cells.push(found);
        }
        let at_edges = edge.iter().filter(|&&edge| edge).count();
        Ok(Column {
            title: input.title.clone(),
            pixels: [truth.pixels().iter().filter(|p| p[3] > 0.0).count(), at_edges],
            cells,
        })
    }
}

/// The error of a picture, edges apart.
fn figures(frame: &Frame, truth: &Image, edge: &[bool]) -> Figures {
    let seconds = frame.stages.iter().find(|stage| stage.name == "draw").and_then(|stage| stage.cpu);
    let mut figures = Figures { max: 0.0, mean: 0.0, beside: 0, seconds };
    let (mut sum, mut count) = (0.0, 0);
    for ((a, b), &edge) in frame.image.pixels().iter().zip(truth.pixels()).zip(edge) {
        let error = pixel_error(a, b);
        if edge {
            figures.beside += usize::from(error > MOVED);
        } else if error > 0.0 || b[3] > 0.0 {
            figures.max = figures.max.max(error);
            sum += error;
            count += 1;
        }
    }
    figures.mean = sum / f64::from(count.max(1));
    figures
}

/// Largest absolute difference of the channels; infinite where one is not finite.
fn pixel_error(a: &[f32; 4], b: &[f32; 4]) -> f64 {
    let error = |i: usize| (f64::from(a[i]) - f64::from(b[i])).abs();
    (0..4).map(error).map(|e| if e.is_finite() { e } else { f64::INFINITY }).fold(0.0, f64::max)
}

fn milliseconds(seconds: Option<f64>) -> String {
    seconds.map_or("-".into(), |s| format!("{:.0}", s * 1e3))
}

fn table(rows: &[&Row], columns: &[Column], [width, height]: [u32; 2]) -> String {
    let mut text = format!(
        "Against the f64 reference, {width} x {height}: largest error of a pixel's worst channel / mean / processor ms of \
         the draw. Pixels whose centre is within 1e-4 of a pixel of an edge in the truth are left out; how many of them \
         are off by more than 1e-4 follows as +n.\n\n"
    );
    // Writing to a string does not fail.
    let _ = writeln!(text, "| method |{}", columns.iter().map(|c| format!(" {} |", c.title)).collect::<String>());
    let _ = writeln!(text, "|---|{}", "---|".repeat(columns.len()));
    for (i, (name, _)) in rows.iter().enumerate() {
        let _ = write!(text, "| {name} |");
        for column in columns {
            let Figures { max, mean, beside, seconds } = &column.cells[i];
            let beside = if *beside > 0 { format!(" +{beside}") } else { String::new() };
            let _ = write!(text, " {max:.1e} / {mean:.1e} / {}{beside} |", milliseconds(*seconds));
        }
        text.push('\n');
    }
    let _ = write!(text, "| pixels seen, at edges |");
    for Column { pixels: [seen, at_edges], .. } in columns {
        let _ = write!(text, " {seen}, {at_edges} |");
    }
    text.push('\n');
    text
}

/// The page with another table between its markers.
fn replaced(page: &str, table: &str, path: &Path) -> Result<String> {
    let [begin, end] = MARKERS;
    let parts = page.split_once(begin).and_then(|(before, rest)| Some((before, rest.split_once(end)?.1)));
    let Some((before, after)) = parts else {
        bail!(
            "{}: the lines \"{begin}\" and \"{end}\" that the table goes between are not there: add them",
            path.display()
        );
    };
    Ok(format!("{before}{begin}\n{table}{end}{after}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_row_has_a_name_of_its_own_and_can_be() {
        for (i, (name, change)) in ROWS.iter().enumerate() {
            assert!(ROWS[..i].iter().all(|(other, _)| other != name), "{name}");
            let mut method = Method { backend: Backend::Gpu, ..Method::default() };
            change(&mut method);
            assert_eq!(method.refusal(), None, "{name}");
        }
    }

    #[test]
    fn planted_differences_are_found_and_edges_counted_apart() {
        let truth = Image::from_pixels(4, 1, vec![[0.5, 0.5, 0.5, 1.0]; 4]).unwrap();
        let mut image = truth.clone();
        image.pixels_mut()[1][2] += 0.25;
        image.pixels_mut()[3][0] += 0.5;
        let frame = Frame {
            mesh_reused: false,
            image,
            stages: Vec::new(),
            resources: Default::default(),
            order: Default::default(),
            warnings: Vec::new(),
            spent: None,
        };
        let apart = figures(&frame, &truth, &[false, false, true, true]);
        assert_eq!((apart.max, apart.mean, apart.beside), (0.25, 0.125, 1));
        let together = figures(&frame, &truth, &[false; 4]);
        assert_eq!((together.max, together.mean, together.beside), (0.5, 0.1875, 0));
    }

    #[test]
    fn only_the_table_is_replaced() {
        let [begin, end] = MARKERS;
        let page = format!("head\n{begin}\nold\n{end}\nfoot\n");
        let new = replaced(&page, "new\n", Path::new("page.md")).unwrap();
        assert_eq!(new, format!("head\n{begin}\nnew\n{end}\nfoot\n"));
        assert!(replaced("no table", "new", Path::new("page.md")).unwrap_err().to_string().contains("page.md"));
    }
}
