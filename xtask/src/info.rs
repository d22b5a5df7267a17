//! `cargo xtask info`

use std::path::PathBuf;

use anyhow::Result;
use serde::Serialize;
use tetlux_mesh::{Check, Component, ScalarField, TetMesh};
use tetlux_order::Facts;
use tetlux_scene::{FrequencyLimits, frequency_limits, gradient_magnitude};

use crate::mesh_args::MeshArgs;
use crate::order::FactsReport;
use crate::progress;
use crate::report::write_json;

pub(crate) const EXAMPLES: &str = "\
Examples:
  cargo xtask info mesh.vtu
  cargo xtask info mesh.vtu --field pressure
  cargo xtask info bluntfinxyz.bin --solution bluntfinq.bin --split 5";

#[derive(clap::Args)]
pub(crate) struct Args {
    /// Mesh file: VTK (XML or legacy), Exodus II, Gmsh, TetGen, PLOT3D; or a closed surface: OBJ, STL
    file: PathBuf,
    /// Say too how many bands a transfer function may have over this field and its gradient's magnitude, one a cell
    #[arg(long, value_name = "NAME")]
    field: Option<String>,
    /// Component of a vector field, from 0; default its magnitude
    #[arg(long, value_name = "I", requires = "field")]
    component: Option<usize>,
    #[command(flatten)]
    mesh: MeshArgs,
    /// Write every figure as JSON
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
}

#[derive(Serialize)]
struct Info {
    file: String,
    cells_by_type: Vec<(String, u64)>,
    notes: Vec<String>,
    cache: String,
    points: usize,
    tetrahedra: usize,
    bounds: [[f64; 3]; 2],
    edge_lengths: [f64; 2],
    edge_ratio: f64,
    mean_edge_length: f64,
    volume: f64,
    components: usize,
    boundary_faces: usize,
    checks: Vec<Checked>,
    ordering: FactsReport,
    faults: Vec<String>,
    fields: Vec<FieldInfo>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    bands: Vec<Bands>,
}

/// Highest frequencies of bands at which no cell holds more than one.
#[derive(Serialize)]
struct Bands {
    field: String,
    range: [f64; 2],
    #[serde(skip)]
    limits: Option<FrequencyLimits>,
    /// Bands a unit: for every cell, for 99 of 100, for half.
    per_unit: Option<[f64; 3]>,
}

impl Bands {
    fn new(mesh: &TetMesh, scalar: &ScalarField) -> Bands {
        let limits = frequency_limits(&mesh.scalar_ranges(scalar));
        let per_unit = limits.map(|l| [l.all, l.most, l.half]);
        Bands { field: scalar.name.clone(), range: scalar.range, limits, per_unit }
    }
}

#[derive(Serialize)]
struct Checked {
    name: &'static str,
    count: usize,
    meaning: &'static str,
}

#[derive(Serialize)]
struct FieldInfo {
    name: String,
    location: &'static str,
    components: usize,
    /// Of the magnitude and, for vectors, of each component; none where there is no finite value.
    ranges: Vec<Option<[f64; 2]>>,
    not_finite: usize,
}

pub(crate) fn run(args: &Args) -> Result<()> {
    let loaded = args.mesh.load(&args.file, args.mesh.solution.clone(), args.mesh.split)?;
    let info = progress::during("looking at the mesh", || {
        let mesh = loaded.mesh;
        let report = mesh.validate();
        let fields = mesh.fields().iter().map(|field| {
            let components = (0..field.components).map(Component::Index).filter(|_| field.components > 1);
            FieldInfo {
                name: field.name.clone(),
                location: field.location.plural(),
                components: field.components,
                ranges: std::iter::once(Component::Magnitude).chain(components).map(|c| field.range(c)).collect(),
                not_finite: field.values.iter().filter(|v| !v.is_finite()).count(),
            }
        });
        let bands = match &args.field {
            None => Vec::new(),
            Some(name) => {
                let scalar = mesh.scalar(name, args.component.map_or(Component::Magnitude, Component::Index))?;
                let magnitude = gradient_magnitude(&scalar, &mesh.vertex_gradients(&scalar));
                [scalar, magnitude].iter().map(|scalar| Bands::new(&mesh, scalar)).collect()
            }
        };
        Ok::<_, tetlux_mesh::MeshError>(Info {
            bands,
            file: args.file.display().to_string(),
            cells_by_type: loaded.cell_counts,
            notes: loaded.notes,
            cache: loaded.outcome.to_string(),
            points: report.points,
            tetrahedra: report.cells,
            bounds: report.bounds,
            edge_lengths: report.edge_lengths,
            edge_ratio: report.edge_lengths[1] / report.edge_lengths[0],
            mean_edge_length: report.mean_edge_length,
            volume: report.volume,
            components: report.components,
            boundary_faces: report.boundary_faces,
            checks: report.checks().map(|Check { name, count, meaning }| Checked { name, count, meaning }).into(),
            ordering: FactsReport::new(&Facts::new(&mesh)),
            faults: report.faults(),
            fields: fields.collect(),
        })
    })?;
    info.print();
    if let Some(path) = &args.json {
        write_json(path, &info)?;
    }
    Ok(())
}

impl Info {
    fn print(&self) {
        let row = |name: &str, value: String| say!("{name:<16} {value}");
        say!("{}", self.file);
        for (name, count) in &self.cells_by_type {
            row("in the file", format!("{count} {name}"));
        }
        row("points", self.points.to_string());
        row("tetrahedra", self.tetrahedra.to_string());
        let [lo, hi] = self.bounds;
        row("bounds", format!("({}, {}, {}) to ({}, {}, {})", lo[0], lo[1], lo[2], hi[0], hi[1], hi[2]));
        let [shortest, longest] = self.edge_lengths;
        row(
            "edges",
            format!("{shortest:.3e} to {longest:.3e}, ratio {:.4}, mean {:.4}", self.edge_ratio, self.mean_edge_length),
        );
        row("volume", format!("{:.6}", self.volume));
        row("components", self.components.to_string());
        row("boundary faces", self.boundary_faces.to_string());
        row("for ordering", self.ordering.to_string());
        for field in &self.fields {
            let range = |r: &Option<[f64; 2]>| r.map_or("no finite value".into(), |[lo, hi]| format!("{lo} to {hi}"));
            let missing =
                if field.not_finite > 0 { format!(", {} not finite", field.not_finite) } else { String::new() };
            row(
                "field",
                format!(
                    "\"{}\", {} component{} on {}: {}{missing}",
                    field.name,
                    field.components,
                    if field.components == 1 { "" } else { "s, magnitude" },
                    field.location,
                    range(&field.ranges[0])
                ),
            );
            for (i, component) in field.ranges[1..].iter().enumerate() {
                row("", format!("  component {i}: {}", range(component)));
            }
        }
        for bands in &self.bands {
            row("bands over", format!("\"{}\": {} to {}", bands.field, bands.range[0], bands.range[1]));
            crate::histogram::print_limits(bands.limits.as_ref(), bands.range[1] - bands.range[0]);
        }
        for note in &self.notes {
            row("note", note.clone());
        }
        row("mesh cache", self.cache.clone());
        say!("");
        say!("{:<20} {:>9}  what it means", "checked", "found");
        for Checked { name, count, meaning } in &self.checks {
            say!("{name:<20} {count:>9}  {meaning}");
        }
        row("faults", if self.faults.is_empty() { "none".into() } else { format!("of {} kinds", self.faults.len()) });
    }
}
