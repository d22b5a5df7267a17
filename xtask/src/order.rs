//! `cargo xtask order`

mod along;
mod report;

use std::path::{Path, PathBuf};

use anyhow::{Result, bail};
use glam::DVec3;
use tetlux_image::{Encoding, write_png};
use tetlux_mesh::TetMesh;
use tetlux_optics::Classification;
use tetlux_order::verify::{Pairs, Ray, Verifier};
use tetlux_order::{Facts, Method, Order, Orderer, Sampling};
use tetlux_render::{Stages, sampling};
use tetlux_scene::{Camera, View};

use self::along::Along;
pub(crate) use self::report::FactsReport;
use self::report::{MethodReport, Report};
use crate::input::{Input, SceneArgs, is_scene};
use crate::progress;
use crate::report::{create_folder, write_json};

pub(crate) const EXAMPLES: &str = "\
Examples:
  cargo xtask order mesh.vtu
  cargo xtask order scenes/post-spiky.toml --mesh post_tets.vtu --camera 1 --view out/post.png
  cargo xtask order mesh.vtu --views 12 --rays 400000 --json order.json
  cargo xtask order --grid 70 --only exact --only centroid

The cells along each ray are clipped in f64 on their own and held against every order. An inversion is a pair of
cells, next to each other on a ray, of which the farther comes first. Overlaps are pairs of cells that share a part of
the ray: they have no order, and count for none.

The error of a method is that of its order alone: along the same rays, the same f64 colours of the same segments are
composited once by depth and once in its order (groups by depth), and the largest difference of any channel is told,
linear. The colours are a scene file's; for a mesh alone, eight narrow peaks over its field, since smooth functions
hide wrong orders.

Exit status: 0; 1 if exact or auto inverts a pair; 2 if something failed.";

#[derive(clap::Args)]
pub(crate) struct Args {
    /// Scene file (.toml), or a mesh; none: the built-in scene
    #[arg(value_name = "SCENE | MESH")]
    scene: Option<PathBuf>,
    #[command(flatten)]
    input: SceneArgs,
    /// Look from N places all round the mesh instead of from the scene's camera
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1000))]
    views: Option<u32>,
    /// Rays cast in each view, through the centres of pixels spread over the picture; fewer meet the mesh
    #[arg(long, value_name = "N", default_value_t = 100_000)]
    rays: usize,
    /// Cast rays beside the centres of pixels, for which no order is made: the exit status is 0 whatever they meet
    #[arg(long)]
    off_center: bool,
    /// Check every pair of cells on a ray, not only those next to each other
    #[arg(long)]
    all_pairs: bool,
    /// Judge this method alone; may be repeated [default: all]
    #[arg(long, value_name = "METHOD")]
    only: Vec<Method>,
    /// Write a picture of the first view for each method: the first cell of every pixel by its rank, from dark to
    /// light, and red where the order is wrong. The method's name is put before the extension
    #[arg(long, value_name = "FILE")]
    view: Option<PathBuf>,
    /// Write every figure as JSON
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
}

/// Whether the orders that claim to be right are.
pub(crate) fn run(args: &Args) -> Result<bool> {
    let input = load(args)?;
    let methods = if args.only.is_empty() { Method::ALL.to_vec() } else { args.only.clone() };
    let mesh = &input.mesh;
    let mut stages = Stages::default();
    let facts = progress::during("facts of the mesh", || stages.run("facts of the mesh", || Facts::new(mesh)));
    let verifier = progress::during("preparing to cast rays", || Verifier::new(mesh));
    let views = views(args, &input)?;
    let spiky = along::spiky(input.scene.scalar.range)?;
    // By two fields, or an image: the order is judged by narrow peaks over the first field.
    let transfer = input.scene.transfer().unwrap_or(&spiky);
    let along = Along::new(mesh, &input.scene, transfer, &verifier);

    let mut orderers: Vec<Orderer> = methods.iter().map(|_| Orderer::new()).collect();
    let mut reports: Vec<MethodReport> = methods.iter().map(|&method| MethodReport::new(method)).collect();
    let bar = progress::bar("views", views.len() as u32);
    let mut files = Vec::new();
    for (index, view) in views.iter().enumerate() {
        let sampling = sampling(view);
        let orders: Vec<&Order> = orderers
            .iter_mut()
            .zip(&methods)
            .map(|(orderer, &method)| orderer.order(mesh, &facts, &sampling, method))
            .collect();
        let beside = |k: usize| if args.off_center { beside(k) } else { [0.0; 2] };
        let pixels = spread(view.size, args.rays).enumerate();
        let rays: Vec<Ray> = pixels.map(|(k, pixel)| ray(&sampling, pixel, beside(k))).collect();
        let pairs = if args.all_pairs { Pairs::All } else { Pairs::Adjacent };
        let found = verifier.verify_all(&orders, &rays, pairs);
        // Where an order inverts nothing, it changes no colour.
        let mut inverted: Vec<usize> = found.iter().flat_map(|found| found.inverted.iter().copied()).collect();
        inverted.sort_unstable();
        inverted.dedup();
        let inverted: Vec<Ray> = inverted.into_iter().map(|ray| rays[ray]).collect();
        let errors = along.errors(&orders, &inverted);
        for (report, ((order, found), error)) in reports.iter_mut().zip(orders.iter().zip(&found).zip(&errors)) {
            report.add(order, found, error);
        }
        if let (0, Some(path)) = (index, &args.view) {
            files = pictures(path, &methods, &orders, mesh, &verifier, &sampling)?;
        }
        bar.inc(1);
    }
    bar.finish_and_clear();
    let report = Report::new(&input, &facts, &stages.into_vec(), views.len(), reports);
    report.print();
    files.iter().for_each(|file| say!("{file}"));
    if let Some(path) = &args.json {
        write_json(path, &report)?;
    }
    Ok(args.off_center || report.is_right())
}

fn load(args: &Args) -> Result<Input> {
    let mut input = args.input.load(args.scene.as_deref())?;
    let is_mesh = args.input.mesh.is_some() || args.scene.as_ref().is_some_and(|path| !is_scene(path));
    if args.input.grid.is_some() || (is_mesh && !args.scene.as_ref().is_some_and(|path| is_scene(path))) {
        let [low, high] = input.mesh.local_bounds();
        input.scene.classification = Classification::OneField(along::spiky(input.scene.scalar.range)?);
        input.scene.unit_distance = along::SPIKY_UNIT_DISTANCE * low.distance(high);
    }
    Ok(input)
}

/// The scene's view, or views evenly from all round the mesh.
fn views(args: &Args, input: &Input) -> Result<Vec<View>> {
    let scene = &input.scene;
    let Some(count) = args.views else { return Ok(vec![scene.camera.view(scene.size)?]) };
    // Directions on a spiral over the sphere, each with the same share of it (a Fibonacci lattice).
    let golden = std::f64::consts::PI * (3.0 - 5f64.sqrt());
    (0..count)
        .map(|i| {
            let z = 1.0 - (2.0 * f64::from(i) + 1.0) / f64::from(count);
            let (sin, cos) = (golden * f64::from(i)).sin_cos();
            let direction = DVec3::new(cos * (1.0 - z * z).sqrt(), sin * (1.0 - z * z).sqrt(), z);
            let up = if z.abs() < 0.9 { DVec3::Z } else { DVec3::Y };
            Ok(Camera::framing(input.mesh.bounds(), direction, up).view(scene.size)?)
        })
        .collect()
}

/// The ray of a pixel, some pixels beside its centre; a whole line if rays are parallel.
fn ray(sampling: &Sampling, [i, j]: [u32; 2], [x, y]: [f64; 2]) -> Ray {
    let (origin, direction) = sampling.ray(i, j);
    let aside = (sampling.right * x + sampling.down * y) * sampling.pixel;
    if sampling.orthographic {
        Ray { origin: origin + aside, direction, start: f64::MIN }
    } else {
        Ray { origin, direction: direction + aside, start: 0.0 }
    }
}

/// Places within a pixel, from its centre, that fill it evenly (Roberts' R2 sequence).
fn beside(k: usize) -> [f64; 2] {
    [0.754_877_666_246_692_7, 0.569_840_290_998_053_3].map(|step| (k as f64 * step).fract() - 0.5)
}

/// Different pixels, spread over the whole picture.
fn spread(size: [u32; 2], count: usize) -> impl Iterator<Item = [u32; 2]> {
    let total = u64::from(size[0]) * u64::from(size[1]);
    // A step near the golden section that shares no factor with the number of pixels visits each once.
    let mut step = ((total as f64 * 0.618_034) as u64).max(1);
    while gcd(step, total) != 1 {
        step += 1;
    }
    (0..total.min(count as u64)).map(move |k| {
        let pixel = (u128::from(k) * u128::from(step) % u128::from(total)) as u64;
        [(pixel % u64::from(size[0])) as u32, (pixel / u64::from(size[0])) as u32]
    })
}

fn gcd(a: u64, b: u64) -> u64 {
    if b == 0 { a } else { gcd(b, a % b) }
}

/// Writes a picture of every method's order.
fn pictures(
    path: &Path,
    methods: &[Method],
    orders: &[&Order],
    mesh: &TetMesh,
    verifier: &Verifier<'_>,
    sampling: &Sampling,
) -> Result<Vec<String>> {
    let Some(stem) = path.file_stem() else { bail!("{}: names no file to write", path.display()) };
    create_folder(path)?;
    let pixels = (0..sampling.size[1]).flat_map(|j| (0..sampling.size[0]).map(move |i| (i, j)));
    let rays: Vec<Ray> = pixels.map(|(i, j)| ray(sampling, [i, j], [0.0; 2])).collect();
    let found = verifier.verify_all(orders, &rays, Pairs::Adjacent);
    let first = along::first_cells(verifier, &rays);
    let mut files = Vec::new();
    for ((method, order), found) in methods.iter().zip(orders).zip(&found) {
        let image = along::picture(order, found, &first, mesh, sampling.size)?;
        let file = path.with_file_name(format!("{}-{method}.png", stem.to_string_lossy()));
        write_png(&image, &file, Encoding::Srgb)?;
        files.push(file.display().to_string());
    }
    Ok(files)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pixels_are_spread_and_none_comes_twice() {
        for size in [[1, 1], [8, 8], [640, 480], [7, 13], [800, 800]] {
            let total = (size[0] * size[1]) as usize;
            let mut all: Vec<[u32; 2]> = spread(size, usize::MAX).collect();
            assert!(all.iter().all(|p| p[0] < size[0] && p[1] < size[1]));
            all.sort_unstable();
            all.dedup();
            assert_eq!(all.len(), total);
            // A quarter of them has its quarter on the left, within a tenth.
            let some: Vec<[u32; 2]> = spread(size, total / 4).collect();
            let left = some.iter().filter(|p| p[0] < size[0] / 2).count();
            assert!(total < 1000 || left.abs_diff(some.len() / 2) < some.len() / 10, "{left} of {}", some.len());
        }
    }
}
