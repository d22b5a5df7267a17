//! The error budget: what each choice may add to the error of a pixel, and what a budget buys.
//!
//! Errors are absolute, of the worst channel of a pixel, and add up. A choice's is either a bound that follows from the
//! scene, or measured; or there is none, and the choice is made only if it is asked for by name. All measured figures
//! stand in this file, with their source.

#[cfg(test)]
mod tests;

use tetlux_optics::widget::Rectangle;
use tetlux_optics::{Classification as Optics, Light, TransferFunction};

use crate::{
    Backend, CellProjection, Classification, Integrator, Interpolation, Method, Order, Scene, Skip, TablePrecision,
    Target,
};

/// Shares of the budget that the colour of a segment may take where it is found piece by piece, without light and with
/// it, and the light: the rest is for single precision and for what is hidden.
pub const COLOR_SHARE: f64 = 0.8;
/// See [`COLOR_SHARE`].
pub const COLOR_SHARE_LIT: f64 = 0.4;
/// See [`COLOR_SHARE`].
pub const LIGHT_SHARE: f64 = 0.4;

/// Above this budget light is left out where the budget allows it; up to it whatever is faint keeps all its digits.
const LOOSE: f64 = 1e-3;
/// Share of a loose budget that may lie behind pixels that count as opaque, and of any other.
const HIDDEN_SHARE: [f64; 2] = [0.1, 1e-3];
/// Share that all faint cells of a ray may take.
const FAINT_SHARE: f64 = 0.1;
/// Share that a wrong order may take, a simpler integral, or a luminance with fewer nodes: one after the other, each as
/// far as the budget still reaches.
const LARGEST_SHARE: f64 = 0.4;

/// Largest error of a pixel by single precision, where extinction changes little within a cell: of random scenes,
/// and of the scenes of docs/methods.md, doubled.
const ROUNDING_CPU: f64 = 5e-6;
/// The same on graphics adapters, whose rasterisers and exponentials round more.
const ROUNDING_GPU: f64 = 5e-5;
/// Scalars are good to so much of their range, by which peaks are moved: four units of the last place on the CPU, which
/// sets cells up in double precision, and forty on graphics adapters (narrow peaks of README's table, doubled).
const SCALAR_ROUNDING_CPU: f64 = 2.4e-7;
/// See [`SCALAR_ROUNDING_CPU`].
const SCALAR_ROUNDING_GPU: f64 = 2.4e-6;
/// Where rays enter and leave cells is good to so much of the mesh's diagonal: little, but of a sheet so thin that it is all
/// of its depth, seen aslant (of sheets 1 to 1e-6 of their width thin and of optical depth 1, doubled). On the CPU, which
/// counts the depths of a thin cell from its own face, that is so of rays alone that pass from cell to cell inside the
/// sheet, the fewer the thinner it is.
const LENGTH_ROUNDING_CPU: f64 = 1e-7;
/// See [`LENGTH_ROUNDING_CPU`].
const LENGTH_ROUNDING_GPU: f64 = 6e-8;
/// On the CPU, where lengths leave a larger error than this, the rays that it is of are so few, about one in a thousand,
/// that it is not stated of all.
const FEW_RAYS: f64 = 1e-4;

/// The figure of a choice.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Model {
    /// Times the largest luminance.
    OfLuminance(f64),
    /// Times the largest difference of luminance within a cell, on one piece of the transfer function.
    WithinCell(f64),
    /// Nothing bounds it; the largest error measured on the test bed.
    Measured(f64),
}

/// Errors of the integrals; docs/accuracy.md (the relative error of a weight is one of the luminance; that of the mean
/// depth q of the visible emission one of the difference), docs/methods.md where nothing bounds them.
fn of_integrator(integrator: Integrator, precision: TablePrecision) -> Model {
    match integrator {
        Integrator::Auto | Integrator::Direct => Model::OfLuminance(6.3e-6),
        Integrator::Symmetric => Model::OfLuminance(1.3e-5),
        // q is between 0 and 2/3, and 1/2 is taken for it.
        Integrator::Average => Model::WithinCell(0.5),
        // 4.7e-5 of w_b = alpha q where alpha is 1/2 and more, as much of q elsewhere; texels round the stored q.
        Integrator::Q => Model::WithinCell(match precision {
            TablePrecision::U8 => 1.5e-3,
            TablePrecision::F16 => 4e-4,
            TablePrecision::U16 | TablePrecision::F32 | TablePrecision::Auto => 1.2e-4,
        }),
        Integrator::Psi => Model::Measured(1.4e-2),
        Integrator::Linear => Model::Measured(5.5e1),
        Integrator::Preint => Model::Measured(6.4e-1),
        Integrator::PreintLog => Model::Measured(2.2e-1),
        Integrator::PreintQ => Model::Measured(2.5e-1),
        // Those of two fields: `state` knows them.
        Integrator::Adaptive | Integrator::Analytic | Integrator::Approximate => Model::Measured(1.0),
    }
}

/// The largest error that was measured of ways of finding a segment, of classification and of targets that nothing
/// bounds: docs/methods.md.
fn measured(scene: &Scene, method: &Method) -> [(&'static str, String, Option<f64>); 4] {
    let projection = match method.projection {
        CellProjection::Balanced => Some(2.2e-5),
        _ => None,
    };
    let interpolation = match (method.projection, method.interpolation) {
        (CellProjection::Balanced | CellProjection::March, _) | (_, Interpolation::Auto | Interpolation::Ray) => None,
        (_, Interpolation::Perspective) => Some(2e-5),
        (_, Interpolation::ScreenLinear) => Some(7e-2),
    };
    // An emphasis is given at the vertices: nothing is lost between them.
    let lost = method.classification == Classification::Vertex && scene.emphasis.is_none();
    let classification = lost.then_some(9.7e-1);
    let target = match method.target {
        Target::Auto | Target::Rgba32f => None,
        Target::Rgba16f => Some(5e-2),
        Target::Rgba8 => Some(9.1e-2),
        Target::Rgba8Dither => Some(1e-1),
    };
    [
        ("projection", method.projection.to_string(), projection),
        ("interpolation", method.interpolation.to_string(), interpolation),
        ("classification", method.classification.to_string(), classification),
        ("target", method.target.to_string(), target),
    ]
}

/// What one choice adds to the error of a pixel.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Term {
    /// What errs.
    pub what: &'static str,
    /// By how much at most; none where nothing bounds it.
    pub error: Option<f64>,
    /// Where the figure comes from.
    pub why: String,
    /// What to do where it is too much.
    #[serde(skip)]
    pub remedy: String,
}

/// The error that a picture is stated to have.
#[derive(Debug, Clone, PartialEq, Default, serde::Serialize)]
pub struct Stated {
    /// What adds to it.
    pub terms: Vec<Term>,
    /// What it does not cover, in words: single pixels that hang on the last digits of the scene.
    pub beyond: Option<String>,
}

impl Stated {
    /// The largest error of any pixel's colour or alpha; none where nothing bounds it.
    pub fn total(&self) -> Option<f64> {
        self.terms.iter().map(|term| term.error).sum()
    }

    fn add(&mut self, what: &'static str, error: f64, why: String, remedy: String) {
        self.terms.push(Term { what, error: Some(error), why, remedy });
    }

    /// A warning if a budget may not be kept: why, and what to do.
    pub fn shortfall(&self, budget: f64) -> Option<String> {
        let total = self.total();
        if total.is_some_and(|total| total <= budget) {
            return None;
        }
        let size = |term: &&Term| term.error.unwrap_or(f64::INFINITY);
        let worst = self.terms.iter().max_by(|a, b| size(a).total_cmp(&size(b)))?;
        let total = total.map_or("not bounded".to_string(), |total| format!("{total:.1e}"));
        Some(format!(
            "the error budget of {budget:.1e} may not be kept, the stated error is {total}: {}, {}; {}",
            worst.what, worst.why, worst.remedy
        ))
    }
}

impl std::fmt::Display for Stated {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self.total() {
            Some(total) => write!(f, "at most {total:.1e}:")?,
            None => write!(f, "not bounded:")?,
        }
        for (index, term) in self.terms.iter().enumerate() {
            let comma = if index == 0 { "" } else { "," };
            match term.error {
                Some(error) => write!(f, "{comma} {} {error:.1e}", term.what)?,
                None => write!(f, "{comma} {} {}", term.what, term.why)?,
            }
        }
        self.beyond.as_ref().map_or(Ok(()), |beyond| write!(f, "; {beyond}"))
    }
}

/// What of a scene and its mesh decides about errors.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Measures {
    /// Longest way through the mesh's bounding box, and the length of an edge of a cell if all were alike, over the
    /// scene's unit distance.
    pub(crate) extent: f64,
    pub(crate) edge: f64,
    /// Largest difference of the first scalar in a cell.
    pub(crate) widest: f64,
}

/// What a budget is spent on.
#[derive(Debug, Clone, Default)]
pub(crate) struct Spending {
    /// No order is needed: the error of any.
    pub(crate) order: Option<f64>,
    /// The mean of luminances will do: its error.
    pub(crate) average: Option<f64>,
    /// Cells of at most this opacity are left out.
    pub(crate) faint: f64,
    /// Error that may lie behind opaque pixels.
    pub(crate) hidden: f64,
    /// The transfer function with fewer nodes, and its error.
    pub(crate) transfer: Option<(TransferFunction, f64)>,
}

/// What a wrong order of cells makes of a pixel at most.
///
/// In any order the weights of a ray's segments add up to its alpha, and none is above the segment's own alpha: two
/// orders differ by no more than what is hidden, the segments' alphas less the ray's, and by no more than the ray's,
/// times the largest difference of two luminances.
fn of_wrong_order(depth: f64, spread: f64) -> f64 {
    let alpha = -(-depth).exp_m1();
    spread * alpha.min(depth - alpha)
}

/// The largest optical depth of any ray, and the largest difference of luminances.
fn depth_and_spread(scene: &Scene, measures: &Measures) -> (f64, f64) {
    match scene.transfer() {
        Some(transfer) if scene.lighting.is_none() => {
            let (opacity, spread) = (transfer.max_opacity(scene.scalar.range), transfer.luminance_spread());
            if scene.seen_without_data().is_empty() {
                return (opacity * measures.extent, spread);
            }
            // Whatever the data look like beside it.
            (opacity.max(scene.no_data.opacity()) * measures.extent, lit(scene))
        }
        // Whatever light makes of it.
        _ => (f64::INFINITY, if scene.single_luminance().is_some() { 0.0 } else { lit(scene) }),
    }
}

/// The largest opacity at any scalars within the fields' ranges.
fn densest(scene: &Scene) -> f64 {
    let (s, g) = (scene.scalar.range, scene.second.as_ref().map_or([0.0; 2], |second| second.range));
    match &scene.classification {
        Optics::OneField(transfer) => transfer.max_opacity(s),
        Optics::TwoFields(transfer) => transfer.max_opacity(g),
        Optics::Widgets(function) => function.max_opacity_over(&Rectangle { s, g }),
        Optics::Image(image) => image.max_opacity_over(&Rectangle { s, g }),
    }
}

/// The largest luminance, lit.
fn lit(scene: &Scene) -> f64 {
    let by = |light: &Light, plain: f64| {
        let [ambient, diffuse, specular] = light.shares();
        plain * (ambient + diffuse) + specular
    };
    let plain = scene.classification.brightest();
    let volume = scene.lighting.as_ref().map_or(plain, |lighting| by(&lighting.light, plain));
    let without = scene.seen_without_data().first().map_or([0.0; 3], |_| scene.no_data.luminance());
    let volume = without.into_iter().fold(volume, f64::max);
    let surfaces = scene.surfaces.iter().map(|s| by(s.light(), s.color().into_iter().fold(0.0, f64::max)));
    surfaces.fold(volume, f64::max)
}

/// The largest difference of luminance within a cell on one piece of a transfer function.
fn spread_within_cells(transfer: &TransferFunction, widest: f64) -> f64 {
    let spread = |piece: tetlux_optics::transfer::Piece| {
        let [low, high] = piece.luminance;
        let change = (0..3).map(|i| (high[i] - low[i]).abs()).fold(0.0, f64::max);
        change * (widest / (piece.s[1] - piece.s[0])).min(1.0)
    };
    transfer.pieces().into_iter().filter(|piece| piece.opacity != [0.0; 2]).map(spread).fold(0.0, f64::max)
}

/// What rounding of scalars does on the steepest pieces: in optical depth over an edge, and in luminance; and whether
/// there are steps.
fn steepness(transfer: &TransferFunction, range: [f64; 2], edge: f64) -> (f64, bool) {
    let width = range[1] - range[0];
    let mut steepest = 0.0f64;
    for piece in transfer.pieces() {
        let [low, high] = piece.luminance;
        let change = (0..3).map(|i| (high[i] - low[i]).abs()).fold(0.0, f64::max);
        let seen = f64::from(u8::from(piece.opacity != [0.0; 2]));
        let rise = (piece.opacity[1] - piece.opacity[0]).abs() * edge + change * seen;
        steepest = steepest.max(rise * width / (piece.s[1] - piece.s[0]));
    }
    let inside = |s: f64| (range[0]..=range[1]).contains(&s);
    let steps = transfer.opacity_nodes().windows(2).any(|w| w[0].s == w[1].s && inside(w[0].s))
        || transfer
            .color_nodes()
            .windows(2)
            .any(|w| w[0].s == w[1].s && inside(w[0].s) && transfer.opacity(w[0].s) > 0.0);
    (if width > 0.0 { steepest } else { 0.0 }, steps)
}

/// Error by single precision of a back end.
pub(crate) fn of_rounding(backend: Backend) -> f64 {
    if backend == Backend::Gpu { ROUNDING_GPU } else { ROUNDING_CPU }
}

/// What a scene's budget buys beside exactness.
pub(crate) fn spend(scene: &Scene, measures: &Measures, backend: Backend) -> Spending {
    let budget = scene.method.max_error;
    let off = scene.method.no_skip;
    let brightest = lit(scene).max(1.0);
    let [loose, tight] = HIDDEN_SHARE;
    let hidden = budget * if budget > LOOSE { loose } else { tight };
    let mut spending =
        Spending { hidden: if off.contains(Skip::Opaque) { 0.0 } else { hidden }, ..Spending::default() };
    let plain = scene.lighting.is_none() && scene.emphasis.is_none();
    let Some(transfer) = scene.transfer().filter(|_| plain) else { return spending };
    // With all that is certain.
    let mut left = budget - of_rounding(backend) - hidden;
    if budget > LOOSE && !off.contains(Skip::Faint) && measures.extent > 0.0 {
        spending.faint = FAINT_SHARE * budget / (brightest * measures.extent);
        left -= FAINT_SHARE * budget;
    }
    let mut afford = |error: f64| {
        let affordable = error <= left.min(LARGEST_SHARE * budget);
        if affordable {
            left -= error;
        }
        affordable.then_some(error)
    };
    if scene.method.order == Order::Auto && !off.contains(Skip::Order) {
        let (depth, spread) = depth_and_spread(scene, measures);
        let error = of_wrong_order(depth, spread);
        // Of a volume that is hardly seen it must be as small a share of what is seen.
        if error <= LARGEST_SHARE * budget * -(-depth).exp_m1() {
            spending.order = afford(error);
        }
    }
    if scene.method.integrator == Integrator::Auto && scene.method.classification == Classification::Auto {
        spending.average = afford(0.5 * spread_within_cells(transfer, measures.widest));
    }
    if !off.contains(Skip::Cuts) && scene.method.classification != Classification::Vertex {
        let tolerance = LARGEST_SHARE * budget;
        let simple = transfer.with_fewer_colors(tolerance);
        let [before, after] = [transfer, &simple].map(|t| t.control_points().len());
        // Every piece counts only where there are many.
        if 2 * after <= before
            && let Some(error) = afford(tolerance)
        {
            spending.transfer = Some((simple, error));
        }
    }
    spending
}

/// The error that a picture by a method, all of it decided, is stated to have; `faint` cells were left out or none were.
pub(crate) fn state(scene: &Scene, measures: &Measures, method: &Method, spent: &Spending, faint: bool) -> Stated {
    let mut stated = Stated::default();
    let budget = scene.method.max_error;
    let brightest = lit(scene).max(1.0);
    let gpu = method.backend == Backend::Gpu;
    let lengths = densest(scene) * measures.extent * if gpu { LENGTH_ROUNDING_GPU } else { LENGTH_ROUNDING_CPU };
    let mut rounding = (of_rounding(method.backend) + lengths.min(if gpu { 1.0 } else { FEW_RAYS })) * brightest;
    let mut beyond = Vec::new();
    if !gpu && lengths > FEW_RAYS {
        let most = lengths.min(1.0) * brightest;
        beyond.push(format!(
            "rays that pass from one cell to the next inside a thin, dense sheet, about one pixel in 1 000, may be off by up \
             to {most:.1e}"
        ));
    }
    let wider = || "ask for no less with --max-error".to_string();
    if let Optics::OneField(transfer) = &scene.classification {
        let (steepest, steps) = steepness(transfer, scene.scalar.range, measures.edge);
        rounding += steepest * if gpu { SCALAR_ROUNDING_GPU } else { SCALAR_ROUNDING_CPU };
        if steps {
            beyond.push(
                "rays that run along a step of the transfer function, about one pixel in 50 000, may be off by more: give \
                 steps a width"
                    .into(),
            );
        }
    }
    stated.beyond = (!beyond.is_empty()).then(|| beyond.join("; "));
    let other = if method.backend == Backend::Gpu { "use --backend cpu, which rounds less, or " } else { "" };
    stated.add("rounding", rounding, "by single precision".into(), format!("{other}{}", wider()));
    if spent.hidden > 0.0 {
        stated.add("hidden", spent.hidden, "behind opaque pixels".into(), wider());
    }
    if faint {
        stated.add("faint", FAINT_SHARE * budget, "cells left out".into(), "--no-skip faint".into());
    }
    match &scene.classification {
        Optics::OneField(_) if scene.lighting.is_none() => of_integral(&mut stated, scene, measures, method, brightest),
        classification => {
            let color = if scene.lighting.is_some() { COLOR_SHARE_LIT } else { COLOR_SHARE };
            if method.integrator.is_published_bivariate() {
                stated.terms.push(Term {
                    what: "integrator",
                    error: None,
                    why: format!("{}: its model of light is another, emission as a density", method.integrator),
                    remedy: format!("leave out --integrator {}", method.integrator),
                });
            } else if !matches!(classification, Optics::OneField(_)) {
                stated.add("colour", color * budget, "pieces are as short as the budget asks".into(), wider());
            }
            if scene.lighting.is_some() {
                stated.add("light", LIGHT_SHARE * budget, "pieces are as short as the budget asks".into(), wider());
            }
        }
    }
    let (depth, spread) = depth_and_spread(scene, measures);
    let asked = match method.order {
        Order::Exact | Order::Pixel => 0.0,
        Order::None if method.projection == CellProjection::March && method.backend == Backend::Gpu => 0.0,
        _ => of_wrong_order(depth, spread),
    };
    if asked > 0.0 {
        let why = format!("{} may swap any cells of optical depth {depth:.1e}", method.order);
        stated.add("order", asked, why, "use --order exact".into());
    }
    if let Some((_, error)) = &spent.transfer {
        stated.add("nodes", *error, "the luminance has fewer nodes".into(), "--no-skip cuts".into());
    }
    for (axis, name, error) in measured(scene, method) {
        // Of these the CPU has the classification alone.
        if let Some(error) = error
            && (method.backend == Backend::Gpu || axis == "classification")
        {
            let why = format!("{name}: nothing bounds it, up to {error:.1e} on the test bed");
            let remedy = format!("leave out --{axis} {name}");
            stated.terms.push(Term { what: axis, error: None, why, remedy });
        }
    }
    stated
}

/// The error of the integral inside the cells.
fn of_integral(stated: &mut Stated, scene: &Scene, measures: &Measures, method: &Method, brightest: f64) {
    let remedy = format!("leave out --integrator {}", method.integrator);
    let within = scene.transfer().map_or(0.0, |transfer| match method.classification {
        Classification::Vertex => transfer.luminance_spread(),
        _ => spread_within_cells(transfer, measures.widest),
    });
    match of_integrator(method.integrator, method.table_precision) {
        Model::OfLuminance(share) => {
            let why = format!("{} in single precision", method.integrator);
            stated.add("integrator", share * brightest, why, "ask for no less with --max-error".into());
        }
        Model::WithinCell(share) => {
            let why = format!("{}, {share:.1e} of a difference of {within:.1e} within a cell", method.integrator);
            stated.add("integrator", share * within, why, remedy);
        }
        Model::Measured(error) => stated.terms.push(Term {
            what: "integrator",
            error: None,
            why: format!("{}: nothing bounds it, up to {error:.1e} on the test bed", method.integrator),
            remedy,
        }),
    }
}
