//! What is told of orders, for people and for programs.

use serde::Serialize;
use tetlux_order::verify::{Example, Verification};
use tetlux_order::{Facts, Method, Order};
use tetlux_render::Stage;

use super::along::ColorError;
use crate::input::Input;

#[derive(Serialize)]
pub(super) struct Report {
    mesh: String,
    points: usize,
    cells: usize,
    #[serde(flatten)]
    facts: FactsReport,
    facts_wall_seconds: f64,
    facts_cpu_seconds: Option<f64>,
    views: usize,
    methods: Vec<MethodReport>,
}

/// What no view changes.
#[derive(Serialize, Clone, Copy)]
pub(crate) struct FactsReport {
    convex: bool,
    conforming: bool,
    quads_split_both_ways: usize,
    folded_faces: usize,
    non_manifold_faces: usize,
    components: usize,
}

impl FactsReport {
    pub(crate) fn new(facts: &Facts) -> FactsReport {
        FactsReport {
            convex: facts.convex(),
            conforming: facts.quads_split_both_ways() == 0,
            quads_split_both_ways: facts.quads_split_both_ways(),
            folded_faces: facts.folded_faces(),
            non_manifold_faces: facts.non_manifold_faces(),
            components: facts.components(),
        }
    }
}

impl std::fmt::Display for FactsReport {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let yes = |is: bool, what: &str| if is { what.to_string() } else { format!("not {what}") };
        write!(f, "{}, {}", yes(self.convex, "convex"), yes(self.conforming, "conforming"))?;
        for (count, what) in [
            (self.quads_split_both_ways, "quadrilaterals split both ways"),
            (self.folded_faces, "folded faces"),
            (self.non_manifold_faces, "faces of three or more cells"),
        ] {
            if count > 0 {
                write!(f, ", {count} {what}")?;
            }
        }
        write!(f, ", {} component{}", self.components, if self.components == 1 { "" } else { "s" })
    }
}

/// One method over all views.
#[derive(Serialize)]
pub(super) struct MethodReport {
    method: &'static str,
    /// What `auto` chose, and why.
    used: Vec<String>,
    views: usize,
    rays: usize,
    intervals: u64,
    pairs: u64,
    inversions: u64,
    rays_inverted: usize,
    overlaps: u64,
    rays_overlapping: usize,
    /// Most groups, and most cells in groups, of any view.
    groups: usize,
    cells_in_groups: usize,
    /// Means over the views.
    gap_arrows: f64,
    signs_in_double: f64,
    signs_exact: f64,
    overlap_pixels: f64,
    /// Of the order alone, linear.
    max_error: f64,
    rays_over_budget: usize,
    /// Means over the views.
    wall_seconds: f64,
    cpu_seconds: Option<f64>,
    stages: Vec<StageReport>,
    examples: Vec<ExampleReport>,
}

#[derive(Serialize)]
struct StageReport {
    name: &'static str,
    wall_seconds: f64,
    cpu_seconds: Option<f64>,
}

#[derive(Serialize)]
struct ExampleReport {
    view: usize,
    ray: usize,
    cells: [u32; 2],
    depths: [[f64; 2]; 2],
    positions: [u32; 2],
}

/// Inversions that are told in full.
const EXAMPLES: usize = 3;

impl MethodReport {
    pub(super) fn new(method: Method) -> MethodReport {
        MethodReport {
            method: method.name(),
            used: Vec::new(),
            views: 0,
            rays: 0,
            intervals: 0,
            pairs: 0,
            inversions: 0,
            rays_inverted: 0,
            overlaps: 0,
            rays_overlapping: 0,
            groups: 0,
            cells_in_groups: 0,
            gap_arrows: 0.0,
            signs_in_double: 0.0,
            signs_exact: 0.0,
            overlap_pixels: 0.0,
            max_error: 0.0,
            rays_over_budget: 0,
            wall_seconds: 0.0,
            cpu_seconds: Some(0.0),
            stages: Vec::new(),
            examples: Vec::new(),
        }
    }

    /// Adds a view.
    pub(super) fn add(&mut self, order: &Order, found: &Verification, error: &ColorError) {
        let report = &order.report;
        let used = format!("{}: {}", report.method, report.reason);
        if !self.used.contains(&used) {
            self.used.push(used);
        }
        self.rays += found.rays;
        self.intervals += found.intervals;
        self.pairs += found.pairs;
        self.inversions += found.inversions;
        self.rays_inverted += found.inverted.len();
        self.overlaps += found.overlaps;
        self.rays_overlapping += found.rays_overlapping;
        self.groups = self.groups.max(order.groups.len());
        self.cells_in_groups = self.cells_in_groups.max(report.cells_in_groups);
        self.max_error = self.max_error.max(error.max);
        self.rays_over_budget += error.over;
        for example in found.examples.iter().take(EXAMPLES - self.examples.len()) {
            self.examples.push(ExampleReport::new(self.views, example));
        }

        let n = self.views as f64;
        let mean = |mean: &mut f64, new: f64| *mean = (*mean * n + new) / (n + 1.0);
        let mean_known = |mean: &mut Option<f64>, new: Option<f64>| {
            *mean = mean.zip(new).map(|(mean, new)| (mean * n + new) / (n + 1.0));
        };
        mean(&mut self.gap_arrows, report.gap_arrows as f64);
        mean(&mut self.signs_in_double, report.signs_in_double as f64);
        mean(&mut self.signs_exact, report.signs_exact as f64);
        mean(&mut self.overlap_pixels, report.overlap_pixels as f64);
        mean(&mut self.wall_seconds, report.stages.iter().map(|s| s.wall).sum());
        mean_known(&mut self.cpu_seconds, report.stages.iter().map(|s| s.cpu).sum());
        // A stage that a view does without takes no time there.
        for stage in &report.stages {
            if !self.stages.iter().any(|s| s.name == stage.name) {
                self.stages.push(StageReport { name: stage.name, wall_seconds: 0.0, cpu_seconds: Some(0.0) });
            }
        }
        for stage in &mut self.stages {
            let this = || report.stages.iter().filter(|s| s.name == stage.name);
            mean(&mut stage.wall_seconds, this().map(|s| s.wall).sum());
            mean_known(&mut stage.cpu_seconds, this().map(|s| s.cpu).sum());
        }
        self.views += 1;
    }
}

impl ExampleReport {
    fn new(view: usize, example: &Example) -> ExampleReport {
        ExampleReport {
            view,
            ray: example.ray,
            cells: example.intervals.map(|interval| interval.cell),
            depths: example.intervals.map(|interval| [interval.entry, interval.exit]),
            positions: example.positions,
        }
    }
}

impl Report {
    pub(super) fn new(
        input: &Input,
        facts: &Facts,
        stages: &[Stage],
        views: usize,
        methods: Vec<MethodReport>,
    ) -> Report {
        Report {
            mesh: input.name.clone(),
            points: input.mesh.points().len(),
            cells: input.mesh.cells().len(),
            facts: FactsReport::new(facts),
            facts_wall_seconds: stages.iter().map(|s| s.wall).sum(),
            facts_cpu_seconds: stages.iter().map(|s| s.cpu).sum(),
            views,
            methods,
        }
    }

    /// Whether the orders that claim to be right everywhere are.
    pub(super) fn is_right(&self) -> bool {
        let claims = [Method::Exact, Method::Auto].map(Method::name);
        self.methods.iter().all(|m| m.inversions == 0 || !claims.contains(&m.method))
    }

    pub(super) fn print(&self) {
        let times = |wall: f64, cpu: Option<f64>| {
            let cpu = cpu.map_or("-".to_string(), |s| format!("{:.1}", s * 1e3));
            (cpu, format!("{:.1}", wall * 1e3))
        };
        say!("{}: {} points, {} cells; {}", self.mesh, self.points, self.cells, self.facts);
        let (cpu, wall) = times(self.facts_wall_seconds, self.facts_cpu_seconds);
        say!("facts of the mesh, found once: {cpu} ms CPU, {wall} ms by the clock");
        if let Some(m) = self.methods.first() {
            let overlapping = m.rays_overlapping;
            say!(
                "{} view{}: {} rays meet the mesh, {:.1} cells each; cells overlap on {overlapping} of them",
                self.views,
                if self.views == 1 { "" } else { "s" },
                m.rays,
                m.intervals as f64 / m.rays.max(1) as f64
            );
        }
        say!(
            "{:<9} {:>11} {:>8} {:>9} {:>7} {:>7} {:>8} {:>9} {:>9} {:>8} {:>8}",
            "method",
            "inversions",
            "of pairs",
            "rays",
            "of rays",
            "groups",
            "cells",
            "gap arrows",
            "max error",
            "CPU ms",
            "wall ms"
        );
        for m in &self.methods {
            let percent = |part: f64, of: f64| format!("{:.2}%", 100.0 * part / of.max(1.0));
            let (cpu, wall) = times(m.wall_seconds, m.cpu_seconds);
            say!(
                "{:<9} {:>11} {:>8} {:>9} {:>7} {:>7} {:>8} {:>9.0} {:>9.2e} {cpu:>8} {wall:>8}",
                m.method,
                m.inversions,
                percent(m.inversions as f64, m.pairs as f64),
                m.rays_inverted,
                percent(m.rays_inverted as f64, m.rays as f64),
                m.groups,
                m.cells_in_groups,
                m.gap_arrows,
                m.max_error
            );
        }
        for m in &self.methods {
            for used in m.used.iter().filter(|_| m.method == Method::Auto.name()) {
                say!("auto used {used}");
            }
        }
        say!("stages, mean of a view, CPU / wall ms:");
        for m in &self.methods {
            let stage = |s: &StageReport| {
                let (cpu, wall) = times(s.wall_seconds, s.cpu_seconds);
                format!("{} {cpu} / {wall}", s.name)
            };
            say!("  {:<9} {}", m.method, m.stages.iter().map(stage).collect::<Vec<_>>().join(", "));
        }
        let claims = [Method::Exact, Method::Auto].map(Method::name);
        for m in self.methods.iter().filter(|m| claims.contains(&m.method)) {
            for e in &m.examples {
                say!(
                    "{}: view {}, ray {}: cell {} at {} to {} is nearer than cell {} at {} to {}, but comes after it",
                    m.method,
                    e.view,
                    e.ray,
                    e.cells[0],
                    e.depths[0][0],
                    e.depths[0][1],
                    e.cells[1],
                    e.depths[1][0],
                    e.depths[1][1]
                );
            }
        }
    }
}
