//! Endurance: frames of changing camera, transfer function, method, size and back end, in one process with one renderer.

use std::fmt::Write;

use anyhow::{Context, Result};
use tetlux_image::Image;
use tetlux_render::{Model, Renderer};
use tetlux_scene::{
    Backend, CellProjection, Classification, Integrator, Interpolation, Method, Order, Plan, Scene, SceneFile,
    TablePrecision, Target,
};

use super::Stress;
use super::section::Section;
use crate::input::{Input, SceneArgs, wing};
use crate::{memory, progress, tables};

/// Frames, and how many of them differ, in full and in short: after so many all begins anew.
const FRAMES: [usize; 2] = [1_000, 300];
const DIFFERENT: [usize; 2] = [100, 20];

/// Tetrahedra of the mesh.
const CELLS: usize = 4_000;

/// Bytes that the memory of the process may rise by over the frames that are judged: what the allocator's own disorder makes. A
/// picture lost every frame would make seven times as much in full, twice as much in short.
const RISE: f64 = 4.0 * 1024.0 * 1024.0;

/// What may be changed of a scene: how it is drawn.
type Way = (&'static str, fn(&mut Method));

/// Those of graphics adapters first; the rest are for the processor too.
const WAYS: [Way; 13] = [
    ("pt", |m| m.projection = CellProjection::Pt),
    ("march", |m| m.projection = CellProjection::March),
    ("tiles", |m| m.projection = CellProjection::Tiles),
    ("vicp", |m| m.projection = CellProjection::Vicp),
    ("balanced", |m| m.projection = CellProjection::Balanced),
    ("gator", |m| (m.projection, m.target) = (CellProjection::Gator, Target::Rgba16f)),
    ("screen-linear", |m| (m.interpolation, m.target) = (Interpolation::ScreenLinear, Target::Rgba8)),
    ("q", |m| (m.integrator, m.table_precision) = (Integrator::Q, TablePrecision::U8)),
    ("post-clip", |m| (m.classification, m.order) = (Classification::PostClip, Order::Mpvonc)),
    ("vertex", |m| (m.classification, m.order) = (Classification::Vertex, Order::Centroid)),
    ("cpu", |m| m.backend = Backend::Cpu),
    ("cpu, pixel", |m| (m.backend, m.order) = (Backend::Cpu, Order::Pixel)),
    ("auto", |m| m.backend = Backend::Auto),
];
const OF_ADAPTERS: usize = 10;

/// Scenes of one field, of two, with light, and emphasised; they are drawn by what draws each of them.
const SCENES: [(&str, &str); 4] = [
    ("wing", include_str!("../../../scenes/wing.toml")),
    ("wing-lit", include_str!("../../../scenes/wing-lit.toml")),
    ("wing-widgets", include_str!("../../../scenes/wing-widgets.toml")),
    ("wing-silhouette", include_str!("../../../scenes/wing-silhouette.toml")),
];

const SIZES: [[u32; 2]; 5] = [[64, 48], [96, 72], [33, 57], [80, 80], [128, 40]];

/// What is said of a frame.
struct Drawn {
    image: Image,
    device_bytes: u64,
}

/// A mesh and its scenes, and with what they are drawn.
struct Endurance<'a> {
    renderer: &'a Renderer,
    model: Model<'a>,
    inputs: &'a [Input],
    ways: &'a [Way],
}

pub(crate) fn run(stress: &Stress) -> Result<Section> {
    let [frames, different] = [FRAMES, DIFFERENT].map(|counts| counts[usize::from(stress.short)]);
    let mesh = wing(CELLS)?;
    let load = |&(name, text): &(&str, &str)| {
        SceneArgs::default().bind(name.into(), SceneFile::parse(name, text)?, mesh.clone())
    };
    let inputs = SCENES.iter().map(load).collect::<Result<Vec<_>>>()?;
    let has_adapter = stress.renderer.device().is_some();
    let ways = if has_adapter { &WAYS[..] } else { &WAYS[OF_ADAPTERS..] };
    let endurance = Endurance { renderer: stress.renderer, model: Model::new(&mesh), inputs: &inputs, ways };

    let bar = progress::bar("endurance", frames as u32);
    let (mut first, mut resident, mut failures): (Vec<Drawn>, Vec<f64>, _) = (Vec::new(), Vec::new(), Vec::new());
    let (mut non_finite, mut other_pictures, mut other_bytes) = (0, 0, 0);
    for number in 0..frames {
        let drawn = endurance.frame(number % different).with_context(|| format!("frame {number}"))?;
        non_finite += drawn.image.pixels().iter().filter(|pixel| pixel.iter().any(|v| !v.is_finite())).count();
        match first.get(number % different) {
            Some(before) => {
                other_pictures += usize::from(before.image != drawn.image);
                other_bytes += usize::from(before.device_bytes != drawn.device_bytes);
            }
            None => first.push(drawn),
        }
        resident.extend(memory::resident().map(|bytes| bytes as f64));
        bar.inc(1);
    }
    bar.finish_and_clear();

    let warm = warm(frames, different);
    let risen = rise(resident.get(warm..).unwrap_or_default());
    for (failed, what) in [
        (non_finite > 0, format!("{non_finite} pixels are not finite")),
        (other_pictures > 0, format!("{other_pictures} pictures are not what they were the first time")),
        (other_bytes > 0, format!("{other_bytes} frames took another number of bytes of the device")),
        (risen > RISE, format!("the memory rose by {:.1} MiB", mebibytes(risen))),
    ] {
        if failed {
            failures.push(what);
        }
    }
    let mut markdown = format!(
        "{frames} frames, {different} different ones again and again: {} ways of drawing ({}), {} scenes of one field and two, \
         lit and emphasised, {} sizes, a camera and a transfer function of its own each. Every later frame, the last ones too, \
         must be the first of its kind bit for bit, and take as many bytes of the device. The resident memory of the process \
         must be flat: by the least of either half from frame {warm} on, it may rise by {:.0} MiB.\n\n\
         | | |\n|---|---|\n| frames | {frames} |\n| pixels that are not finite | {non_finite} |\n\
         | frames that are not the first of their kind, bit for bit | {other_pictures} |\n\
         | frames that took other bytes of the device | {other_bytes} |\n",
        ways.len(),
        ways.iter().map(|(name, _)| *name).collect::<Vec<_>>().join("; "),
        SCENES.len(),
        SIZES.len(),
        mebibytes(RISE),
    );
    // Writing to a string does not fail.
    let _ = match resident.last() {
        None => writeln!(markdown, "| resident memory | the system does not tell |"),
        Some(_) => writeln!(
            markdown,
            "| rise of the resident memory over the last {} frames | {:+.2} MiB |\n\n{}",
            frames - warm,
            mebibytes(risen),
            table(&resident)
        ),
    };
    let figures = serde_json::json!({
        "frames": frames, "different": different, "non_finite_pixels": non_finite, "other_pictures": other_pictures,
        "other_device_bytes": other_bytes, "resident_bytes": resident, "rise_bytes": risen,
    });
    Ok(Section { title: "Endurance", markdown, figures, failures })
}

impl Endurance<'_> {
    /// Draws the frame of a number: whatever was drawn before, it is the same.
    fn frame(&self, number: usize) -> Result<Drawn> {
        // What draws two fields or light is chosen by the plan; every fourth frame is of one of these scenes.
        let (way, input) = match number % 4 {
            3 => (None, &self.inputs[1 + number / 4 % (self.inputs.len() - 1)]),
            _ => (Some(self.ways[(number - number / 4) % self.ways.len()]), &self.inputs[0]),
        };
        let scene = self.scene(&input.scene, way, number);
        let plan = Plan::new(&scene, &input.mesh, self.renderer.device())?;
        let tables = tables::load_or_build(input, &plan, &mut Vec::new())?;
        let frame = self.renderer.render_with(&scene, &self.model, &plan, &tables)?;
        Ok(Drawn { image: frame.image, device_bytes: frame.resources.bytes })
    }

    fn scene(&self, scene: &Scene, way: Option<Way>, number: usize) -> Scene {
        let mut scene = scene.clone();
        scene.size = SIZES[number % SIZES.len()];
        scene.camera = scene.camera.turned(137.5 * number as f64);
        // Other extinctions, so that pixels saturate in some frames and cells are left out in others.
        scene.unit_distance *= [1.0, 0.2, 30.0, 4.0][number % 7 % 4];
        let adapter = self.renderer.device().is_some() && number % 8 != 3;
        scene.method.backend = if adapter { Backend::Gpu } else { Backend::Cpu };
        if let Some((_, change)) = way {
            change(&mut scene.method);
        }
        scene
    }
}

/// After how many frames the memory is judged: a third of them, for the first of each kind compile and keep what later ones use;
/// and as many more as let either half of the rest be whole rounds of the different ones, so that like is compared with like.
fn warm(frames: usize, different: usize) -> usize {
    frames - (frames - frames / 3) / (2 * different) * (2 * different)
}

/// By how much values rise over all of them: twice what lies between the least of either half, so that what is taken for a
/// while and given back does not count.
fn rise(values: &[f64]) -> f64 {
    let least = |values: &[f64]| values.iter().copied().reduce(f64::min);
    let (first, second) = values.split_at(values.len() / 2);
    least(first).zip(least(second)).map_or(0.0, |(first, second)| 2.0 * (second - first))
}

fn mebibytes(bytes: f64) -> f64 {
    bytes / (1024.0 * 1024.0)
}

/// The resident memory at some of the frames.
fn table(resident: &[f64]) -> String {
    let frames: Vec<usize> = (0..=9).map(|tenth| (resident.len() * tenth / 9).clamp(1, resident.len())).collect();
    let row = |cells: Vec<String>| format!("| {} |\n", cells.join(" | "));
    let names = frames.iter().map(usize::to_string);
    let values = frames.iter().map(|&frame| format!("{:.1}", mebibytes(resident[frame - 1])));
    row(["after frame".to_owned()].into_iter().chain(names).collect())
        + &"|---".repeat(frames.len() + 1)
        + "|\n"
        + &row(["resident, MiB".to_owned()].into_iter().chain(values).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn either_half_that_is_judged_holds_every_frame_alike() {
        for (frames, different) in FRAMES.into_iter().zip(DIFFERENT) {
            let judged = frames - warm(frames, different);
            assert!(judged > 0 && judged.is_multiple_of(2 * different) && 3 * judged >= frames, "{judged} of {frames}");
        }
        // What a kind of frame takes more than another is no rise, and what every frame keeps is one: a picture of 64 x 48.
        let [frames, different] = [FRAMES[1], DIFFERENT[1]];
        let resident = |kept: usize| -> Vec<f64> {
            (0..frames).map(|i| (3e8 as usize + i % different * (8 << 20) + i * kept) as f64).collect()
        };
        assert_eq!(rise(&resident(0)[warm(frames, different)..]), 0.0);
        assert!(rise(&resident(64 * 48 * 16)[warm(frames, different)..]) > 2.0 * RISE);
    }

    #[test]
    fn a_leak_is_seen_and_noise_is_not() {
        // Half a mebibyte to and fro, without a trend.
        let noise: Vec<f64> = (0..600).map(|i| 3e8 + 5e5 * f64::from(i * 7 % 13 - 6) / 6.0).collect();
        assert!(rise(&noise).abs() < 0.1 * RISE, "{}", rise(&noise));
        // A picture of 64 x 48 a frame.
        let leak: Vec<f64> = noise.iter().enumerate().map(|(i, v)| v + (i * 64 * 48 * 16) as f64).collect();
        assert!(rise(&leak) > 5.0 * RISE, "{}", rise(&leak));
        // What is given back is no leak.
        let mut bump = noise.clone();
        bump[400..440].iter_mut().for_each(|v| *v += 1e8);
        assert!(rise(&bump).abs() < 0.1 * RISE, "{}", rise(&bump));
        let straight: Vec<f64> = (0..11).map(|i| 2.0 + 3.0 * f64::from(i)).collect();
        assert_eq!((rise(&straight), rise(&[5.0]), rise(&[])), (30.0, 0.0, 0.0));
    }
}
