//! What a picture took and how wrong it is, for people and for programs.

use std::path::Path;

use anyhow::Result;
use serde::Serialize;
use tetlux_image::{Metrics, write_atomically};
use tetlux_render::{Frame, Resources, Spent, Stage};
use tetlux_scene::{Plan, Stated};

use crate::explain::{Saving, savings};
use crate::input::Input;

/// Everything that `render` and `compare` print, as JSON.
#[derive(Serialize)]
pub(crate) struct Report<'a> {
    scene: &'a str,
    title: &'a str,
    field: &'a str,
    field_range: [f64; 2],
    points: usize,
    cells: usize,
    cells_drawn: usize,
    size: [u32; 2],
    unit_distance: f64,
    adapter: Option<&'a str>,
    backend: String,
    order: String,
    projection: String,
    interpolation: String,
    integrator: String,
    classification: String,
    table_precision: String,
    target: String,
    max_error: f64,
    plan: Vec<(&'static str, &'a str)>,
    /// What is not done, and what that saves.
    pub(crate) skips: Vec<Saving>,
    /// The error that the picture is stated to have; none where nothing bounds it.
    stated_error: Option<f64>,
    stated: &'a Stated,
    warnings: &'a [String],
    stages: Vec<StageReport>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) resources: Option<ResourceReport>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) adaptive: Option<AdaptiveReport>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) error: Option<Metrics>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) ordering_faults: Option<OrderingFaults>,
    #[serde(skip_serializing_if = "Option::is_none")]
    found: Option<Found<'a>>,
    pub(crate) files: Vec<String>,
}

/// What was found while a picture was made.
#[derive(Serialize)]
struct Found<'a> {
    order: String,
    signs_in_double: usize,
    signs_exact: usize,
    gap_arrows: usize,
    cells_in_groups: usize,
    overlap_pixels: usize,
    warnings: &'a [String],
}

/// Pixels over the budget that come right when their segments are sorted.
#[derive(Serialize, Clone, Copy)]
pub(crate) struct OrderingFaults {
    /// Pixels over the budget.
    pub(crate) pixels_over: u64,
    /// Those among them that sorting mends.
    pub(crate) mended_by_sorting: u64,
    /// Largest error that is left after sorting.
    pub(crate) max_after_sorting: f64,
}

/// What the picture took of a graphics device.
#[derive(Serialize, Clone, Copy)]
pub(crate) struct ResourceReport {
    pipelines: usize,
    buffers: usize,
    textures: usize,
    bytes: u64,
    cells_drawn: usize,
}

impl From<Resources> for ResourceReport {
    fn from(resources: Resources) -> Self {
        let Resources { pipelines, buffers, textures, bytes, cells } = resources;
        ResourceReport { pipelines, buffers, textures, bytes, cells_drawn: cells }
    }
}

/// What segments took that were shaded one by one.
#[derive(Serialize, Clone, Copy)]
pub(crate) struct AdaptiveReport {
    segments: u64,
    pieces: u64,
    pieces_per_segment: f64,
}

impl From<Spent> for AdaptiveReport {
    fn from(spent: Spent) -> Self {
        AdaptiveReport { segments: spent.segments, pieces: spent.pieces, pieces_per_segment: spent.mean() }
    }
}

#[derive(Serialize, Clone)]
pub(crate) struct StageReport {
    pub(crate) name: &'static str,
    pub(crate) wall_seconds: f64,
    pub(crate) cpu_seconds: Option<f64>,
}

impl From<&Stage> for StageReport {
    fn from(stage: &Stage) -> Self {
        StageReport { name: stage.name, wall_seconds: stage.wall, cpu_seconds: stage.cpu }
    }
}

/// Stages as they are reported.
pub(crate) fn stages_of(stages: &[Stage]) -> Vec<StageReport> {
    stages.iter().map(|s| StageReport { name: s.name, wall_seconds: s.wall, cpu_seconds: s.cpu }).collect()
}

impl<'a> Report<'a> {
    pub(crate) fn new(input: &'a Input, plan: &'a Plan, adapter: Option<&'a str>, stages: &[Stage]) -> Report<'a> {
        Report {
            scene: &input.name,
            title: &input.title,
            field: &input.scene.scalar.name,
            field_range: input.scene.scalar.range,
            points: input.mesh.points().len(),
            cells: input.mesh.cells().len(),
            cells_drawn: plan.cells.len(),
            size: plan.view.size,
            unit_distance: input.scene.unit_distance,
            adapter,
            backend: plan.backend.to_string(),
            order: plan.order.to_string(),
            projection: plan.projection.to_string(),
            interpolation: plan.interpolation.to_string(),
            integrator: plan.integrator.to_string(),
            classification: plan.classification.to_string(),
            table_precision: plan.table_precision.to_string(),
            target: plan.target.to_string(),
            max_error: input.scene.method.max_error,
            plan: plan.reasons.iter().map(|(what, why)| (*what, why.as_str())).collect(),
            skips: savings(input, plan),
            stated_error: plan.stated.total(),
            stated: &plan.stated,
            warnings: &plan.warnings,
            stages: stages.iter().map(StageReport::from).collect(),
            resources: None,
            adaptive: None,
            error: None,
            ordering_faults: None,
            found: None,
            files: Vec::new(),
        }
    }

    /// Prints what is rendered, how, and why so.
    pub(crate) fn print_plan(&self, plan: &Plan) {
        let title = if self.title.is_empty() { self.scene } else { self.title };
        say!("{title}: {} points, {} cells", self.points, self.cells);
        say!("field: \"{}\", {} to {}", self.field, self.field_range[0], self.field_range[1]);
        say!("adapter: {}", self.adapter.unwrap_or("none; rendering on the CPU"));
        say!("plan ({} x {}, unit distance {:.4}):", self.size[0], self.size[1], self.unit_distance);
        say!("{}", plan.to_string().trim_end());
        for warning in self.warnings {
            say!("warning: {warning}");
        }
    }

    /// Notes, and prints, what was found while the picture was made.
    pub(crate) fn add(&mut self, frame: &'a Frame) {
        let order = &frame.order;
        if order.cells_in_groups > 0 {
            say!("order: {} cells in cycles or overlapping are sorted for every pixel", order.cells_in_groups);
        }
        frame.warnings.iter().for_each(|warning| say!("warning: {warning}"));
        self.found = Some(Found {
            order: order.method.to_string(),
            signs_in_double: order.signs_in_double,
            signs_exact: order.signs_exact,
            gap_arrows: order.gap_arrows,
            cells_in_groups: order.cells_in_groups,
            overlap_pixels: order.overlap_pixels,
            warnings: &frame.warnings,
        });
    }

    pub(crate) fn print_stages(&self) {
        say!("{:<14} {:>9} {:>9}", "stage", "wall ms", "CPU ms");
        let row = |name: &str, wall: f64, cpu: Option<f64>| {
            let cpu = cpu.map_or("-".to_string(), |s| format!("{:.1}", s * 1e3));
            say!("{name:<14} {:>9.1} {cpu:>9}", wall * 1e3);
        };
        for stage in &self.stages {
            row(stage.name, stage.wall_seconds, stage.cpu_seconds);
        }
        let cpu = self.stages.iter().map(|s| s.cpu_seconds).sum();
        row("total", self.stages.iter().map(|s| s.wall_seconds).sum(), cpu);
        if let Some(ResourceReport { pipelines, buffers, textures, bytes, cells_drawn }) = self.resources {
            say!(
                "device: {pipelines} pipelines, {buffers} buffers, {textures} textures, {:.1} MiB; {cells_drawn} cells drawn",
                bytes as f64 / f64::from(1 << 20)
            );
        }
        if let Some(AdaptiveReport { segments, pieces_per_segment, .. }) = self.adaptive {
            say!("shaded: {segments} segments, {pieces_per_segment:.2} pieces each");
        }
    }

    pub(crate) fn write(&self, path: &Path) -> Result<()> {
        write_json(path, self)
    }
}

/// Prints the figures of a comparison.
pub(crate) fn print_metrics(metrics: &Metrics, budget: f64) {
    say!("error over {} covered pixels, linear, worst channel:", metrics.covered);
    say!("  max    {:.3e} at pixel ({}, {})", metrics.max, metrics.worst[0], metrics.worst[1]);
    say!("  mean   {:.3e}", metrics.mean);
    say!("  p99.9  {:.3e}", metrics.p999);
    say!("  PSNR   {:.1} dB", metrics.psnr);
    say!("  over {budget:.1e}: {} pixels; not finite: {} pixels", metrics.over, metrics.non_finite);
}

/// The middle value, or the mean of the two in the middle; 0 of none.
pub(crate) fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    match (values.len(), values.len() / 2) {
        (0, _) => 0.0,
        (n, half) if n.is_multiple_of(2) => 0.5 * (values[half - 1] + values[half]),
        (_, half) => values[half],
    }
}

pub(crate) fn write_json(path: &Path, value: &impl Serialize) -> Result<()> {
    let text = serde_json::to_string_pretty(value)?;
    create_folder(path)?;
    write_atomically(path, |file| file.write_all(text.as_bytes()))?;
    Ok(())
}

/// Makes the folder that a file is to be in.
pub(crate) fn create_folder(path: &Path) -> Result<()> {
    use anyhow::Context;
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => {
            std::fs::create_dir_all(folder).with_context(|| format!("{}: cannot be made", folder.display()))
        }
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_median_is_in_the_middle() {
        assert_eq!([vec![], vec![3.0], vec![9.0, 1.0], vec![5.0, 1.0, 9.0]].map(median), [0.0, 3.0, 5.0, 5.0]);
    }
}
