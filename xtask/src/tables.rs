//! The tables that a method looks values up in.

use std::path::PathBuf;
use std::sync::Arc;

use anyhow::Result;
use tetlux_render::table_specs;
use tetlux_scene::{Integrator, Plan, Skip};
use tetlux_tables::{Store, Table, TableKind, TableSpec};

use crate::input::Input;
use crate::progress;

/// Where `build-tables` writes.
pub(crate) const FOLDER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../tables");

/// The tables of a plan: those of its transfer function are built, all others read. No plan chooses a method with tables
/// unasked, so that a table which cannot be used is an error; it names the command that builds it.
pub(crate) fn load(input: &Input, plan: &Plan) -> Result<Vec<Arc<Table>>> {
    let store = Store::new(PathBuf::from(FOLDER));
    let load = |spec: &TableSpec| -> Result<Arc<Table>> {
        Ok(Arc::new(match spec.kind {
            TableKind::PreIntegrated { .. } | TableKind::MeanExtinction { .. } | TableKind::ColorRatio { .. } => {
                progress::during("building tables", || Table::build(spec))?
            }
            _ => store.read(spec)?.table,
        }))
    };
    let mut specs = table_specs(&input.scene, &input.mesh, plan);
    if plan.kept.contains(Skip::Tables) {
        specs.push(TableSpec::default_q());
    }
    specs.iter().map(load).collect()
}

/// What to do about tables that cannot be used: an integrator of the command line is an order, so that they are an error;
/// one of a scene file is a wish, and the integral is evaluated without tables instead. The warning goes into the plan.
pub(crate) fn or_directly(loaded: Result<Vec<Arc<Table>>>, forced: bool, plan: &mut Plan) -> Result<Vec<Arc<Table>>> {
    match loaded {
        Err(error) if !forced => {
            let instead = if plan.integrator.is_for_two_fields() { Integrator::Adaptive } else { Integrator::Direct };
            let asked = std::mem::replace(&mut plan.integrator, instead);
            plan.warnings
                .push(format!("{error}; until then the integral is evaluated as {instead} instead of {asked}"));
            Ok(Vec::new())
        }
        loaded => loaded,
    }
}

/// The same as [`load`], for programs that are to run at once: a table that is not stored is built for this run, unless it
/// was for an earlier picture; `made` holds these.
pub(crate) fn load_or_build(input: &Input, plan: &Plan, made: &mut Vec<Arc<Table>>) -> Result<Vec<Arc<Table>>> {
    let store = Store::new(PathBuf::from(FOLDER));
    let load = |spec: &TableSpec| -> Result<Arc<Table>> {
        if let Some(table) = made.iter().find(|table| table.spec() == spec) {
            return Ok(table.clone());
        }
        let stored = store.path(spec).exists().then(|| store.read(spec)).transpose()?;
        let table = Arc::new(match stored {
            Some(stored) => stored.table,
            None => progress::during("building tables", || Table::build(spec))?,
        });
        made.push(table.clone());
        Ok(table)
    };
    table_specs(&input.scene, &input.mesh, plan).iter().map(load).collect()
}

#[cfg(test)]
mod tests {
    use anyhow::anyhow;
    use tetlux_mesh::procedural::{Split, cuboid};
    use tetlux_mesh::{Field, TetMesh};
    use tetlux_scene::SceneFile;

    use super::*;

    #[test]
    fn a_table_that_cannot_be_used_is_an_error_only_where_it_is_forced() {
        let parts = cuboid([1, 1, 1], Split::Six, [[0.0; 3].into(), [1.0; 3].into()]);
        let field = Field::point("x", 1, parts.sample(|p| p.x));
        let mesh = TetMesh::assemble(&parts.points, &parts.cells, vec![field]).unwrap();
        let text = "[transfer]\ncolor = [[0.0, 1.0, 0.5, 0.2]]\nopacity = [[0.0, 1.0]]";
        let scene = SceneFile::parse("scene.toml", text).unwrap().scene(&mesh, 0).unwrap();
        let plan = Plan { integrator: Integrator::Q, ..Plan::new(&scene, &mesh, None).unwrap() };
        let missing = || Err(anyhow!("q.exr is not there: cargo xtask build-tables --only q"));

        let mut wished = plan.clone();
        assert!(or_directly(missing(), false, &mut wished).unwrap().is_empty());
        assert_eq!(wished.integrator, Integrator::Direct);
        let warning = wished.warnings.last().unwrap();
        assert!(warning.contains("build-tables --only q") && warning.contains("direct"), "{warning}");

        let mut forced = plan.clone();
        assert!(or_directly(missing(), true, &mut forced).is_err());
        assert_eq!((forced.integrator, &forced.warnings), (Integrator::Q, &plan.warnings));
        assert!(or_directly(Ok(Vec::new()), false, &mut forced).unwrap().is_empty());
        assert_eq!(forced.integrator, Integrator::Q);
    }
}
