//! The papers' own tables, ours beside theirs.

use anyhow::Result;
use tetlux_mesh::procedural::{Parts, Split, cuboid, grid};
use tetlux_mesh::{Field, TetMesh};
use tetlux_scene::{NodeRange, SceneFile, UnitDistance};

use super::Bench;
use super::table::Table;
use super::{kraus, moreland, song};
use crate::input::{Input, SceneArgs, wing};
use crate::testbed::meshes::{graded, log_radius};

/// A table by the name that asks for it.
pub(crate) type Paper = (&'static str, fn(&Bench) -> Result<Table>);

pub(crate) const PAPERS: &[Paper] = &[
    ("moreland-1", moreland::growth),
    ("moreland-2", moreland::projections),
    ("moreland-3", moreland::integrators),
    ("moreland-fig5", moreland::splits),
    ("moreland-fig9", moreland::sizes),
    ("kraus-1", kraus::enhancements),
    ("kraus-2", kraus::data_sets),
    ("song-1", song::modes),
];

/// A data set of the papers: its own file where it is at hand, else a mesh of as many cells.
pub(crate) struct DataSet {
    pub(crate) name: &'static str,
    /// Tetrahedra, as published.
    pub(crate) cells: usize,
    /// The file's stem, and its scene.
    file: Option<(&'static str, &'static str)>,
    stand_in: fn(usize) -> Result<TetMesh>,
}

const BLUNTFIN_SMOOTH: &str = include_str!("../../../scenes/bluntfin-smooth.toml");
const POST_SMOOTH: &str = include_str!("../../../scenes/post-smooth.toml");

pub(crate) const BLUNT_FIN: DataSet =
    DataSet { name: "Blunt Fin", cells: 187_395, file: Some(("bluntfin", BLUNTFIN_SMOOTH)), stand_in: wing };
pub(crate) const OXYGEN_POST: DataSet =
    DataSet { name: "Oxygen Post", cells: 513_375, file: Some(("post", POST_SMOOTH)), stand_in: wing };
pub(crate) const DELTA_WING: DataSet = DataSet { name: "Delta Wing", cells: 1_005_675, file: None, stand_in: wing };
pub(crate) const HEAT_SINK: DataSet = DataSet { name: "heat sink", cells: 121_668, file: None, stand_in: heat_sink };
pub(crate) const CYLINDER: DataSet = DataSet { name: "cylinder", cells: 624_960, file: None, stand_in: cylinder };
pub(crate) const M6_WING: DataSet = DataSet { name: "M6 Wing", cells: 287_962, file: None, stand_in: wing };
pub(crate) const X38: DataSet = DataSet { name: "X38", cells: 1_943_483, file: None, stand_in: x38 };

/// Cells of every stand-in of a quick run.
const QUICK_CELLS: usize = 6_000;

impl DataSet {
    /// The same as another paper has it, with another number of cells.
    pub(crate) fn of_cells(self, cells: usize) -> DataSet {
        DataSet { cells, ..self }
    }

    /// The data set with nine control points, in a picture of that size, and what stands for it.
    pub(crate) fn input(&self, bench: &Bench, size: [u32; 2]) -> Result<(Input, &'static str)> {
        bench.tell(self.name);
        let found = self.file.and_then(|(stem, scene)| Some((bench.data.find(stem)?, scene)));
        let flags = |size| SceneArgs { size: Some(size), ..SceneArgs::default() };
        if let Some((source, scene)) = found {
            let mut file = SceneFile::parse(self.name, scene)?;
            let flags = source.flags(flags(size));
            flags.override_scene(&mut file)?;
            let mesh = source.load(&flags)?;
            return Ok((flags.bind(self.name.to_owned(), file, mesh)?, "its own file"));
        }
        let cells = if bench.quick { self.cells.min(QUICK_CELLS) } else { self.cells };
        let mesh = (self.stand_in)(cells)?;
        // Nine control points over the field's range; the whole mesh is seen.
        let mut file = SceneFile::parse(self.name, BLUNTFIN_SMOOTH)?;
        (file.range, file.unit_distance) = (NodeRange::Field, UnitDistance::OfDiagonal(0.05));
        file.cameras.clear();
        file.field = mesh.fields().first().map(|field| field.name.clone());
        let flags = flags(size);
        flags.override_scene(&mut file)?;
        Ok((flags.bind(self.name.to_owned(), file, mesh)?, "a procedural mesh"))
    }
}

fn assemble(parts: &Parts, value: impl Fn(glam::DVec3) -> f64) -> Result<TetMesh> {
    let field = Field::point("s", 1, parts.sample(value));
    Ok(TetMesh::assemble(&parts.points, &parts.cells, vec![field])?)
}

/// Hexahedra along each axis of a cube of about so many tetrahedra.
fn side(cells: usize) -> usize {
    ((cells as f64 / 6.0).cbrt().round() as usize).max(2)
}

/// A block, warm at one side.
fn heat_sink(cells: usize) -> Result<TetMesh> {
    let parts = cuboid([side(cells); 3], Split::Six, [[0.0; 3].into(), [1.0; 3].into()]);
    assemble(&parts, |p| (-2.0 * p.z).exp() * (2.0 + (9.0 * p.x).sin() * (7.0 * p.y).cos()))
}

/// The air round a tapered cylinder: an O-grid, finer towards the wall.
fn cylinder(cells: usize) -> Result<TetMesh> {
    // 62 x 56 x 30 hexahedra are the published 624 960 tetrahedra.
    let scale = (cells as f64 / 624_960.0).cbrt();
    let counts = [62.0, 56.0, 30.0].map(|n: f64| ((n * scale).round() as usize).max(3));
    let parts = grid(counts, Split::Six, |u| {
        let angle = if u.x == 1.0 { 0.0 } else { u.x * std::f64::consts::TAU };
        let wall = 0.5 - 0.3 * u.y;
        let radius = wall + 3.0 * u.z * u.z;
        glam::DVec3::new(radius * angle.cos(), radius * angle.sin(), 4.0 * u.y)
    });
    assemble(&parts, |p| (3.0 * p.x).sin() * (4.0 * p.y - p.z).cos() / (0.5 + p.truncate().length()))
}

/// Edges from 1e-5 to 1.
fn x38(cells: usize) -> Result<TetMesh> {
    assemble(&graded((side(cells) / 2).max(2)), log_radius)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn papers_have_names_of_their_own() {
        for (i, (name, _)) in PAPERS.iter().enumerate() {
            assert!(PAPERS[..i].iter().all(|(other, _)| other != name), "{name}");
        }
    }

    #[test]
    fn stand_ins_have_about_the_cells_of_what_they_stand_for() {
        for set in [BLUNT_FIN, HEAT_SINK, CYLINDER, X38] {
            let asked = set.cells / 20;
            let mesh = (set.stand_in)(asked).unwrap();
            let ratio = mesh.cells().len() as f64 / asked as f64;
            // Counts along the axes are whole.
            assert!((0.8..1.2).contains(&ratio), "{}: {} of {asked}", set.name, mesh.cells().len());
            // But for the points of the seam, which are merged, nothing is mended, and nothing is left apart.
            let report = mesh.validate();
            let mended = [report.assembly.cells_inverted, report.assembly.cells_flat, report.quads_split_both_ways];
            assert_eq!((mended, report.components), ([0; 3], 1), "{}", set.name);
        }
        assert_eq!(cylinder(CYLINDER.cells).unwrap().cells().len(), CYLINDER.cells);
    }
}
