//! The report of what every table is worth, measured: Markdown and a plot.

use std::fmt::Write;

use tetlux_image::{Curve, Grid, Style, log_log};
use tetlux_optics::accuracy::{POINTS, SETS, measure as measure_f32};
use tetlux_optics::published_f32::linear_published;
use tetlux_optics::segment_f32::{weights_average, weights_direct};
use tetlux_optics::symmetric_f32::weights_symmetric;

use crate::lookup::sample_weights;
use crate::measure::{measure, measure_color_ratio, measure_widget};
use crate::precision::Precision;
use crate::spec::{Construction, Design, SpecError, TableKind, TableSpec, Thickness, TransferSpec};
use crate::table::{MeasuredError, Table};

/// Number of sections that [`report`] tells of.
pub const SECTIONS: u32 = 6;

/// Sizes along both axes in the comparison of parametrisations.
const SIZES: [u32; 5] = [64, 128, 256, 512, 1024];

/// Markdown text, and the SVG plot of its first table.
#[derive(Clone, Debug, PartialEq)]
pub struct AccuracyReport {
    /// Sections with tables; the plot is referred to by the name given to [`report`].
    pub markdown: String,
    /// Largest error of the blended colour against the number of nodes.
    pub plot: String,
}

/// A transfer function of nine nodes with a narrow peak, a stretch of no opacity and a step in colour, over [0, 1].
///
/// The unit distance is 1: the mean extinction over the range is 1.14, the largest 5.
pub fn nine_nodes(max_length: f64) -> TransferSpec {
    let color = [
        [0.0, 0.05, 0.1, 0.6],
        [0.3, 0.1, 0.7, 0.9],
        [0.55, 0.9, 0.9, 0.3],
        [0.55, 0.9, 0.4, 0.1],
        [1.0, 0.7, 0.05, 0.02],
    ];
    let opacity =
        [[0.0, 0.0], [0.1, 0.8], [0.2, 0.0], [0.35, 0.0], [0.4, 4.0], [0.45, 0.3], [0.7, 0.5], [0.9, 3.0], [1.0, 5.0]];
    TransferSpec { color: color.to_vec(), opacity: opacity.to_vec(), range: [0.0, 1.0], unit_distance: 1.0, max_length }
}

/// Measures everything; `plot_file` is the name under which the text refers to the plot, `done` is told each section.
///
/// # Errors
/// [`SpecError`] if one of the specifications is not valid: none is.
pub fn report(plot_file: &str, done: impl Fn(&str)) -> Result<AccuracyReport, SpecError> {
    let mut markdown = "# Accuracy\n\nMade by `cargo xtask build-tables --accuracy docs/accuracy.md`. Errors are \
        absolute unless called relative, of f32 arithmetic, against f64 integrals of relative error below 1e-12.\n\n"
        .to_owned();
    markdown += &single_precision()?;
    done("f32 functions");
    let (sizes, curves) = parametrisations(plot_file)?;
    markdown += &sizes;
    done("parametrisations");
    markdown += &precisions()?;
    done("precisions");
    markdown += &front_back()?;
    done("F and B");
    markdown += &widgets()?;
    done("widgets");
    markdown += &transfer_functions()?;
    done("transfer functions");
    let plot = log_log(["nodes along each axis", "largest error of w_b"], Grid::FirstCurve, &curves);
    Ok(AccuracyReport { markdown, plot })
}

fn spec(kind: TableKind, size: [u32; 3], precision: Precision) -> TableSpec {
    TableSpec { id: "accuracy".to_owned(), kind, size, precision }
}

fn error_of(kind: TableKind, size: [u32; 3], precision: Precision) -> Result<MeasuredError, SpecError> {
    measure(&Table::build(&spec(kind, size, precision))?)
}

/// A Markdown table.
fn table(head: &[&str], rows: &[Vec<String>]) -> String {
    let mut text = format!("| {} |\n|{}\n", head.join(" | "), "---|".repeat(head.len()));
    for row in rows {
        text += &format!("| {} |\n", row.join(" | "));
    }
    text.push('\n');
    text
}

fn scientific(value: f64) -> String {
    format!("{value:.2e}")
}

/// Gives (alpha, `w_b`, `w_f`) for (a, b).
type Method<'a> = &'a dyn Fn(f32, f32) -> [f32; 3];

/// The shader's functions without tables, and with the two best known, on the optics crate's sets of inputs.
fn single_precision() -> Result<String, SpecError> {
    let psi = Table::build(&spec(TableKind::Psi, [512, 512, 1], Precision::F32))?;
    let q = Table::build(&TableSpec::default_q())?;
    let methods: [(&str, Method<'_>); 6] = [
        ("direct", &weights_direct),
        ("symmetric", &weights_symmetric),
        ("linear as published", &linear_published),
        ("average", &weights_average),
        ("psi table, 512 x 512", &|a, b| sample_weights(&psi, a, b)),
        ("q table, 128 x 128", &|a, b| sample_weights(&q, a, b)),
    ];
    let names = methods.map(|(name, _)| name);
    let head: Vec<&str> = std::iter::once("inputs").chain(names).collect();
    let mut rows = Vec::new();
    for set in &SETS {
        let mut row = vec![set.name.to_owned()];
        for (_, method) in methods {
            let error = measure_f32(set, POINTS, method);
            row.push(format!("{} / {}", scientific(error.relative), scientific(error.absolute)));
        }
        rows.push(row);
    }
    Ok(format!(
        "## The shader's arithmetic\n\nLargest relative / absolute error of alpha, w_b and w_f in f32 over {POINTS} \
         points of each set. The relative error of a table is large where w_b is tiny.\n\n{}",
        table(&head, &rows)
    ))
}

fn parametrisations(plot_file: &str) -> Result<(String, Vec<Curve>), SpecError> {
    let kinds = [
        ("psi over x/(1+x) (Moreland and Angel)", TableKind::Psi),
        ("q, design Q", TableKind::Q { design: Design::Q }),
        ("q, design R", TableKind::Q { design: Design::R }),
        ("q, design R4", TableKind::Q { design: Design::R4 }),
    ];
    let mut rows = Vec::new();
    let mut curves = Vec::new();
    for (name, kind) in kinds {
        let errors = SIZES.map(|n| error_of(kind.clone(), [n, n, 1], Precision::F32));
        let errors = errors.into_iter().collect::<Result<Vec<_>, _>>()?;
        let row = |what: &str, value: &dyn Fn(&MeasuredError) -> f64| {
            let cells = errors.iter().map(|error| scientific(value(error)));
            std::iter::once(format!("{name}: {what}")).chain(cells).collect::<Vec<_>>()
        };
        rows.push(row("max", &|error| error.max));
        rows.push(row("mean", &|error| error.mean));
        let points = SIZES.iter().zip(&errors).map(|(&n, error)| [f64::from(n), error.max]);
        curves.push(Curve { name: name.to_owned(), points: points.collect(), style: Style::Line });
    }
    let mut text = "## Tables of linear segments: parametrisation\n\n\
        Error of w_b, which is the error of the blended colour for luminances in [0, 1], bilinear in f32 against f64, \
        for a and b from 0 and 1e-8 to 1e6 with bands around a = b and b = sqrt a.\n\n"
        .to_owned();
    text += &table(&["N x N, f32", "64", "128", "256", "512", "1024"], &rows);
    writeln!(text, "![Largest error against size]({plot_file})\n").ok();
    Ok((text, curves))
}

fn precisions() -> Result<String, SpecError> {
    let q = |design: Design| TableKind::Q { design };
    let kinds = [
        ("psi", TableKind::Psi, 512),
        ("q, design Q", q(Design::Q), 128),
        ("q, design Q", q(Design::Q), 512),
        ("q, design R", q(Design::R), 128),
        ("q, design R", q(Design::R), 512),
    ];
    let mut rows = Vec::new();
    for (name, kind, n) in kinds {
        let mut row = vec![format!("{name}, {n} x {n}")];
        for precision in Precision::ALL {
            row.push(scientific(error_of(kind.clone(), [n, n, 1], precision)?.max));
        }
        rows.push(row);
    }
    Ok("## Precision of the texels\n\nLargest error of w_b. Integers are scaled to the range of the values.\n\n"
        .to_owned()
        + &table(&["table", "u8", "u16", "f16", "f32"], &rows))
}

fn front_back() -> Result<String, SpecError> {
    let mut rows = Vec::new();
    for (depth, n) in [(10.0, 64), (10.0, 128), (100.0, 64), (100.0, 128)] {
        let kind = TableKind::FrontBack { max_extinction: depth, max_length: 1.0 };
        let built = Table::build(&spec(kind, [n, n, n], Precision::F16))?;
        rows.push(front_back_row(&format!("F, B (Song et al.), {n}^3, f16, largest depth {depth}"), &built)?);
    }
    let built = Table::build(&spec(TableKind::QPair, [128, 128, 1], Precision::F32))?;
    rows.push(front_back_row("q, q_e, 128^2, f32, any depth", &built)?);
    Ok("## Emission not multiplied by extinction: F and B\n\nThe weights of front and back emission of a segment.\n\n"
        .to_owned()
        + &table(&["table", "MB", "max error", "mean error", "of"], &rows))
}

fn front_back_row(name: &str, built: &Table) -> Result<Vec<String>, SpecError> {
    let error = measure(built)?;
    let megabytes = format!("{:.2}", built.bytes() as f64 / 1e6);
    Ok(vec![name.to_owned(), megabytes, scientific(error.max), scientific(error.mean), error.quantity])
}

fn widgets() -> Result<String, SpecError> {
    let kinds = [
        ("Gaussian (P, t) (Song et al.), P <= 10", TableKind::Gaussian { max_p: 10.0, max_t: 4.0 }),
        ("Gaussian U, P <= 316", TableKind::GaussianBounded { max_t: 4.0 }),
        ("sine (k d, M) (Song et al.), M <= 10", TableKind::Sine { max_m: 10.0 }),
        ("sine V, M <= 316", TableKind::SineBounded),
    ];
    let mut rows = Vec::new();
    for (name, kind) in kinds {
        let built = Table::build(&spec(kind, [256, 256, 1], Precision::F32))?;
        let mut row = vec![name.to_owned()];
        for shortest in [1.0, 0.3, 0.05] {
            row.push(scientific(measure_widget(&built, shortest)?.max));
        }
        rows.push(row);
    }
    let triangle = error_of(TableKind::Triangle { max_a: 10.0 }, [256, 256, 1], Precision::F32)?;
    let mut text = "## Widgets\n\nLargest error of w_b from 256 x 256 tables in f32, for segments of at least the \
        given length in the units of the profile's argument (A D, k D). The optical depth is exact.\n\n"
        .to_owned();
    text += &table(&["table", ">= 1", ">= 0.3", ">= 0.05"], &rows);
    writeln!(
        text,
        "Falling ramp of a triangle wave (Song et al.), A <= 10, a tenth of a ramp or longer: {}. A ramp is linear \
         extinction: q serves it without another table.\n",
        scientific(triangle.max)
    )
    .ok();
    Ok(text)
}

fn transfer_functions() -> Result<String, SpecError> {
    let mut rows = Vec::new();
    for max_length in [1.0, 10.0] {
        let transfer = || nine_nodes(max_length);
        let kinds = [
            ("uniform thickness", Thickness::Uniform, Construction::Incremental, [128, 128, 256]),
            ("uniform thickness", Thickness::Uniform, Construction::Exact, [128, 128, 256]),
            ("logarithmic thickness", Thickness::Logarithmic, Construction::Incremental, [256, 256, 16]),
            ("logarithmic thickness", Thickness::Logarithmic, Construction::Exact, [256, 256, 16]),
        ];
        for (name, thickness, construction, size) in kinds {
            let kind = TableKind::PreIntegrated { transfer: transfer(), thickness, construction };
            let error = error_of(kind, size, Precision::F32)?;
            let how = format!("{name}, {construction:?}").to_lowercase();
            rows.push(transfer_row(max_length, &how, size, &error));
        }
        let size = [256, 256, 16];
        let mean = TableKind::MeanExtinction { transfer: transfer() };
        let mean = Table::build(&spec(mean, [256, 256, 1], Precision::F32))?;
        let ratio = Table::build(&spec(TableKind::ColorRatio { transfer: transfer() }, size, Precision::F32))?;
        rows.push(transfer_row(max_length, "mean extinction and C/alpha", size, &measure_color_ratio(&mean, &ratio)?));
        rows.push(transfer_row(max_length, "C/alpha with the exact alpha", size, &measure(&ratio)?));
    }
    Ok("## Pre-integrated 1D transfer functions\n\nA function of nine opacity nodes with a narrow peak and a step in \
        colour, trilinear in f32. Steps and kinks between nodes of the scalar axes limit every table; integrating piece \
        by piece needs none and has no such error.\n\n"
        .to_owned()
        + &table(&["l_max", "table", "size", "max error", "mean error"], &rows))
}

fn transfer_row(max_length: f64, name: &str, size: [u32; 3], error: &MeasuredError) -> Vec<String> {
    let size = size.map(|nodes| nodes.to_string()).join(" x ");
    vec![max_length.to_string(), name.to_owned(), size, scientific(error.max), scientific(error.mean)]
}
