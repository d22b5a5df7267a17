//! What a mesh file's path alone does not say, as flags.

use std::path::{Path, PathBuf};

use anyhow::Result;
use tetlux_ingest::{Cache, Expression, Loaded, ReadOptions, Split, read_cached, time_steps};

use crate::progress;

#[derive(clap::Args, Clone, Default)]
#[command(next_help_heading = "Mesh file")]
pub(crate) struct MeshArgs {
    /// PLOT3D solution (q file) that belongs to the grid
    #[arg(long, value_name = "FILE")]
    pub(crate) solution: Option<PathBuf>,
    /// Tetrahedra a hexahedron of a structured grid becomes, 5 or 6 [default: 6]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(5..=6))]
    pub(crate) split: Option<u32>,
    /// Time step, from 0 (Exodus II, Gmsh, VTK XML) [default: the last]
    #[arg(long, value_name = "N")]
    pub(crate) time: Option<usize>,
    /// Size of the tetrahedra that fill a closed surface (OBJ, STL) [default: 1/40 of its diagonal]
    #[arg(long, value_name = "LENGTH")]
    cell_size: Option<f64>,
    /// Field on what fills a surface, such as wave=sin(4*x)*y; may be repeated
    #[arg(long, value_name = "NAME=EXPRESSION", value_parser = parse_expression)]
    expression: Vec<(String, Expression)>,
    /// Read the file anew, and neither use nor store its mesh in the cache (see `cargo xtask cache`)
    #[arg(long)]
    no_cache: bool,
    /// Read without a sign of progress
    #[arg(skip)]
    pub(crate) quiet: bool,
}

impl MeshArgs {
    /// The mesh of a file, from the cache or read with this solution and split.
    pub(crate) fn load(&self, path: &Path, solution: Option<PathBuf>, split: Option<u32>) -> Result<Loaded> {
        let options = self.options(solution);
        let cache = if self.no_cache { None } else { Cache::of_user() };
        let read = || read_cached(path, &options, split_of(split), cache.as_ref());
        Ok(if self.quiet { read()? } else { progress::during("reading the mesh", read)? })
    }

    /// The time steps of a file that has several.
    pub(crate) fn time_steps(&self, path: &Path) -> Result<usize> {
        Ok(progress::during("counting the time steps", || time_steps(path, &self.options(None)))?)
    }

    fn options(&self, solution: Option<PathBuf>) -> ReadOptions {
        let MeshArgs { time, cell_size, .. } = *self;
        ReadOptions { solution, time, cell_size, expressions: self.expression.clone() }
    }

    /// The first of the flags that only a file can follow, if any is given.
    pub(crate) fn of_a_file(&self) -> Option<&'static str> {
        let flags = [
            (self.solution.is_some(), "--solution"),
            (self.split.is_some(), "--split"),
            (self.time.is_some(), "--time"),
            (self.cell_size.is_some(), "--cell-size"),
            (!self.expression.is_empty(), "--expression"),
        ];
        flags.into_iter().find(|(given, _)| *given).map(|(_, flag)| flag)
    }
}

/// The split that makes 5 or 6 tetrahedra of a hexahedron.
fn split_of(tetrahedra: Option<u32>) -> Split {
    if tetrahedra == Some(5) { Split::Five } else { Split::Six }
}

fn parse_expression(text: &str) -> Result<(String, Expression), String> {
    let (name, expression) = text.split_once('=').ok_or("it needs a name: name=expression")?;
    if name.is_empty() {
        return Err("the name is empty: name=expression".into());
    }
    Ok((name.to_string(), Expression::parse(expression).map_err(|e| e.to_string())?))
}
