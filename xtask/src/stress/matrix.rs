//! Every method on every case.

mod judge;
mod page;

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::time::Instant;

use anyhow::{Context, Result, bail};
use serde::Serialize;
use serde_json::json;
use tetlux_image::{Encoding, Image, write_png};
use tetlux_render::{Model, RenderError};
use tetlux_scene::{Backend, CellProjection, Integrator, Method, Order, Plan, Scene};
use tetlux_tables::Table;

use super::case::Case;
use super::section::Section;
use super::{Stress, geometry, optics};
use crate::input::Input;
use crate::methods::{ROWS, Row};
use crate::report::create_folder;
use crate::tables;
use judge::{Count, Truth, Verdict};

/// Of what every case is promised: the defaults on each back end, and their exact alternatives.
const OURS: [Row; 10] = [
    ("auto", |m| m.backend = Backend::Auto),
    ("gpu", |_| ()),
    ("`pt`", |m| m.projection = CellProjection::Pt),
    ("`tiles`", |m| m.projection = CellProjection::Tiles),
    ("`march`", |m| m.projection = CellProjection::March),
    ("`vicp`", |m| m.projection = CellProjection::Vicp),
    ("`symmetric`", |m| m.integrator = Integrator::Symmetric),
    ("`cpu`", |m| m.backend = Backend::Cpu),
    ("`cpu`, order `exact`", |m| (m.backend, m.order) = (Backend::Cpu, Order::Exact)),
    ("`cpu`, order `pixel`", |m| (m.backend, m.order) = (Backend::Cpu, Order::Pixel)),
];

/// The usual order, on the processor.
const CPU_CENTROID: Row = ("`cpu`, order `centroid`", |m| (m.backend, m.order) = (Backend::Cpu, Order::Centroid));

/// One published method of each kind, for the short form: compiling a method takes a driver longer than drawing it.
const FEW: [&str; 5] = ["`balanced`", "`vertex`", "`average`", "`rgba8`", "order `centroid`"];

/// Ours, then the published ones; in short a few of these.
fn methods(short: bool) -> Vec<&'static Row> {
    let is_ours = |name| name == "default" || OURS.iter().any(|(ours, _)| *ours == name);
    let is_wanted = |name| !is_ours(name) && (!short || FEW.contains(&name));
    let published = ROWS.iter().chain([&CPU_CENTROID]).filter(|(name, _)| is_wanted(*name));
    OURS.iter().chain(published).collect()
}

/// What became of a method on a case.
#[derive(Debug, Clone, Serialize)]
#[serde(rename_all = "snake_case")]
enum Outcome {
    Drawn(Verdict),
    /// Declined with a reason.
    Refused(String),
    /// Panicked, or the driver failed.
    Broke(String),
}

/// A row of the matrix.
#[derive(Serialize)]
struct Line {
    case: &'static str,
    what: &'static str,
    cells: usize,
    size: [u32; 2],
    /// None where there is no truth, for the camera sees nothing.
    pixels: Option<Count>,
    seconds: f64,
    /// In the order of [`methods`].
    outcomes: Vec<Outcome>,
}

pub(super) fn run(stress: &Stress) -> Result<Section> {
    let all = || geometry::CASES.iter().chain(optics::CASES);
    if let Some(unknown) = stress.cases.iter().find(|name| all().all(|case| case.name != **name)) {
        let names: Vec<_> = all().map(|case| case.name).collect();
        bail!("--case {unknown}: there is no such case; there are {}", names.join(", "));
    }
    let methods = methods(stress.short);
    let mut lines = Vec::new();
    for case in all().filter(|case| stress.cases.is_empty() || stress.cases.iter().any(|name| name == case.name)) {
        let line = line(case, stress, &methods).with_context(|| format!("case {}", case.name))?;
        say!("{}", page::said(&line, &methods));
        lines.push(line);
    }
    let failures = lines.iter().flat_map(|line| failures(line, &methods)).collect();
    let names: Vec<_> = methods.iter().map(|(name, _)| name.replace('`', "")).collect();
    Ok(Section {
        title: "Every method on every case",
        markdown: page::markdown(&lines, &methods),
        figures: json!({ "methods": names, "ours": OURS.len(), "cases": lines }),
        failures,
    })
}

/// Renders and judges a case by every method.
fn line(case: &Case, stress: &Stress, methods: &[&Row]) -> Result<Line> {
    let started = Instant::now();
    let input = (case.input)(stress.short)?;
    // A camera that sees nothing is for the methods to refuse.
    let view = input.scene.camera.view(input.scene.size).ok();
    let truth = view.map(|view| Truth::new(&input, &view)).transpose()?;
    if let Some(truth) = &truth {
        let png = stress.folder.join("cases").join(case.name).with_extension("png");
        create_folder(&png)?;
        write_png(&truth.image, &png, Encoding::Srgb)?;
    }
    let model = Model::new(&input.mesh);
    let mut made = Vec::new();
    let mut outcome = |(_, method): &&Row| {
        // A method that panics is a failure of its own, not of all that come after it.
        let drawn = catch_unwind(AssertUnwindSafe(|| draw(&input, stress, &model, *method, &mut made)));
        match (drawn, &truth) {
            (Ok(Ok(image)), Some(truth)) => Outcome::Drawn(truth.judge(&image)),
            (Ok(Ok(_)), None) => Outcome::Broke("drew a picture of a camera that sees nothing".into()),
            (Ok(Err(error)), _) if is_a_refusal(&error) => Outcome::Refused(error.to_string()),
            (Ok(Err(error)), _) => Outcome::Broke(error.to_string()),
            (Err(_), _) => Outcome::Broke("panicked".into()),
        }
    };
    let outcomes = methods.iter().map(&mut outcome).collect();
    Ok(Line {
        case: case.name,
        what: case.what,
        cells: input.mesh.cells().len(),
        size: input.scene.size,
        pixels: truth.as_ref().map(Truth::count),
        seconds: started.elapsed().as_secs_f64(),
        outcomes,
    })
}

/// A picture by a method, a change of the default on a graphics adapter.
fn draw(
    input: &Input,
    stress: &Stress,
    model: &Model,
    change: fn(&mut Method),
    made: &mut Vec<Arc<Table>>,
) -> Result<Image> {
    let mut method = Method { backend: Backend::Gpu, ..Method::default() };
    change(&mut method);
    let scene = Scene { method, ..input.scene.clone() };
    let plan = Plan::new(&scene, &input.mesh, stress.renderer.device())?;
    let tables = tables::load_or_build(input, &plan, made)?;
    Ok(stress.renderer.render_with(&scene, model, &plan, &tables)?.image)
}

/// Whether an error says that something cannot be, and not that something went wrong on the way.
fn is_a_refusal(error: &anyhow::Error) -> bool {
    use RenderError::{Device, Lost, OutOfMemory, Shader};
    !matches!(error.downcast_ref(), Some(Device { .. } | Lost { .. } | OutOfMemory { .. } | Shader(_)))
}

/// What was promised of a case and did not hold.
fn failures(line: &Line, methods: &[&Row]) -> Vec<String> {
    let mut failures = Vec::new();
    if let Some(Count { lit, judged, .. }) = line.pixels
        && 2 * judged < lit
    {
        failures.push(format!("{}: {judged} of {lit} pixels can be judged, which says too little", line.case));
    }
    for (i, ((name, _), outcome)) in methods.iter().zip(&line.outcomes).enumerate() {
        let ours = i < OURS.len();
        let why = match outcome {
            Outcome::Broke(why) => why.clone(),
            Outcome::Refused(why) if i == 0 && line.pixels.is_some() => format!("nothing draws it: {why}"),
            Outcome::Drawn(verdict) if verdict.not_finite > 0 || (ours && !verdict.is_clean()) => {
                let Verdict { max, thin, not_finite, coverage, .. } = verdict;
                let thin = thin.map_or(String::new(), |thin| format!(", {thin:.1e} relative where thin"));
                format!("off by {max:.1e}{thin}; {not_finite} pixels not finite, {coverage} coverage faults")
            }
            _ => continue,
        };
        failures.push(format!("{} by {name}: {why}", line.case));
    }
    failures
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cases_and_methods_have_names_of_their_own_and_methods_can_be() {
        let cases: Vec<_> = geometry::CASES.iter().chain(optics::CASES).map(|case| case.name).collect();
        for (i, name) in cases.iter().enumerate() {
            assert!(!cases[..i].contains(name), "{name}");
            assert!(name.chars().all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-'), "{name}");
        }
        let methods = methods(false);
        assert_eq!(super::methods(true).len(), OURS.len() + FEW.len());
        for (i, (name, change)) in methods.iter().enumerate() {
            assert!(methods[..i].iter().all(|(other, _)| other != name), "{name}");
            let mut method = Method { backend: Backend::Gpu, ..Method::default() };
            change(&mut method);
            assert_eq!(method.refusal(), None, "{name}");
        }
    }

    fn line(pixels: Option<Count>, outcomes: Vec<Outcome>) -> Line {
        Line { case: "c", what: "", cells: 1, size: [1; 2], pixels, seconds: 0.0, outcomes }
    }

    #[test]
    fn a_broken_promise_is_a_failure_and_a_published_fault_is_none() {
        let methods = methods(false);
        let good = Count { lit: 4, judged: 4, thin: 0 };
        let clean = || vec![Outcome::Drawn(Verdict::default()); methods.len()];
        let with = |i: usize, outcome: Outcome| {
            let mut outcomes = clean();
            outcomes[i] = outcome;
            failures(&line(Some(good), outcomes), &methods)
        };
        assert!(failures(&line(Some(good), clean()), &methods).is_empty());
        let [first, last, published] = [0, OURS.len() - 1, OURS.len()];
        let wrong = Outcome::Drawn(Verdict { max: 2e-4, ..Verdict::default() });
        let lost = Outcome::Drawn(Verdict { coverage: 1, ..Verdict::default() });
        let nan = Outcome::Drawn(Verdict { not_finite: 1, ..Verdict::default() });
        for ours in [first, last] {
            assert_eq!(with(ours, wrong.clone()).len(), 1);
            assert_eq!(with(ours, lost.clone()).len(), 1);
        }
        assert!(with(published, wrong).is_empty() && with(published, lost).is_empty());
        assert_eq!(with(published, nan).len(), 1, "no method makes a value that is none");
        assert_eq!(with(published, Outcome::Broke("panicked".into())).len(), 1);
        let refused = Outcome::Refused("too large".into());
        assert_eq!(with(first, refused.clone()).len(), 1, "what is chosen for the user draws");
        assert!(with(last, refused).is_empty());
        assert_eq!(failures(&line(Some(Count { judged: 1, ..good }), clean()), &methods).len(), 1);
    }
}
