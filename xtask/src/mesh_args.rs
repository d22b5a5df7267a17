//! What a mesh file's path alone does not say, as flags.

use std::path::PathBuf;

use tetlux_ingest::{Expression, ReadOptions, Split};

#[derive(clap::Args, Default)]
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
    time: Option<usize>,
    /// Size of the tetrahedra that fill a closed surface (OBJ, STL) [default: 1/40 of its diagonal]
    #[arg(long, value_name = "LENGTH")]
    cell_size: Option<f64>,
    /// Field on what fills a surface, such as wave=sin(4*x)*y; may be repeated
    #[arg(long, value_name = "NAME=EXPRESSION", value_parser = parse_expression)]
    expression: Vec<(String, Expression)>,
}

impl MeshArgs {
    /// The options of a file read with this solution.
    pub(crate) fn options(&self, solution: Option<PathBuf>) -> ReadOptions {
        ReadOptions { solution, time: self.time, cell_size: self.cell_size, expressions: self.expression.clone() }
    }
}

/// The split that makes 5 or 6 tetrahedra of a hexahedron.
pub(crate) fn split_of(tetrahedra: Option<u32>) -> Split {
    if tetrahedra == Some(5) { Split::Five } else { Split::Six }
}

fn parse_expression(text: &str) -> Result<(String, Expression), String> {
    let (name, expression) = text.split_once('=').ok_or("it needs a name: name=expression")?;
    if name.is_empty() {
        return Err("the name is empty: name=expression".into());
    }
    Ok((name.to_string(), Expression::parse(expression).map_err(|e| e.to_string())?))
}
