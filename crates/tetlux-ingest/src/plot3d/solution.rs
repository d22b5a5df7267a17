//! Solutions and function files of a PLOT3D grid.

use tetlux_mesh::Field;

use super::layout::{Candidates, Contents, Encoding, Layout, candidates};
use super::misfit;
use super::values::Values;
use crate::source::Source;
use crate::{IngestError, MixedMesh, Place};

/// Adds the fields of a solution or function file.
pub(super) fn add(mesh: &mut MixedMesh, source: &Source, grid: &Layout) -> Result<(), IngestError> {
    let solutions = candidates(&source.bytes, Contents::Solution);
    if let Some(layout) = choice(&solutions, grid, true) {
        let fields = [("Density", 1), ("Momentum", 3), ("StagnationEnergy", 1)];
        let named = fields.map(|(name, components)| (name.to_string(), components));
        return add_fields(mesh, source, layout, solutions.lengths, &named);
    }
    let functions = candidates(&source.bytes, Contents::Function);
    if let Some(layout) = choice(&functions, grid, false) {
        let variables = layout.blocks[0].variables;
        if let Some(block) = layout.blocks.iter().position(|b| b.variables != variables) {
            let what = format!("the number of variables of block {block}");
            let remedy = format!("all blocks must have as many as the first, {variables}");
            return Err(source.malformed(Place::File, what, layout.blocks[block].variables, remedy));
        }
        let named: Vec<(String, usize)> = (1..=variables).map(|v| (format!("Function{v}"), 1)).collect();
        return add_fields(mesh, source, layout, functions.lengths, &named);
    }
    Err(other(mesh, source, grid, &solutions, &functions))
}

/// The likeliest layout on the grid's blocks: of just the length, with bytes after Fortran's records, or, of the
/// grid's own precision, after the numbers of C.
fn choice<'a>(found: &'a Candidates, grid: &Layout, rest: bool) -> Option<&'a Layout> {
    let fits = |layout: &&Layout| {
        layout.blocks.len() == grid.blocks.len()
            && layout.blocks.iter().zip(&grid.blocks).all(|(a, b)| a.counts == b.counts)
    };
    let longer = |layout: &&Layout| match layout.encoding {
        Encoding::Text => false,
        Encoding::Binary { records: true, .. } => true,
        Encoding::Binary { .. } => rest && layout.wide == grid.wide,
    };
    let exact = found.exact.iter().find(fits);
    exact.or_else(|| found.shorter.iter().filter(fits).find(longer))
}

fn add_fields(
    mesh: &mut MixedMesh,
    source: &Source,
    layout: &Layout,
    lengths: (u64, u64),
    named: &[(String, usize)],
) -> Result<(), IngestError> {
    let mut fields: Vec<Field> = Vec::new();
    for (name, components) in named {
        // The values are in the file: its length is known to hold them.
        fields.push(Field::point(name, *components, vec![0.0; components * mesh.points.len()]));
    }
    let mut values = Values::new(source, layout);
    let mut first = 0;
    for block in &layout.blocks {
        values.skip_to(block.start);
        for Field { components, values: field, .. } in &mut fields {
            for component in 0..*components {
                values.reals(block.points(), |p, value| field[(first + p) * *components + component] = value)?;
            }
        }
        first += block.points();
    }
    mesh.fields = fields;
    let rest = layout.length(lengths) - layout.end;
    if rest > 0 {
        mesh.notes.push(format!("{}: the last {rest} bytes are no data of the solution", source.path.display()));
    }
    Ok(())
}

/// Why a file is no solution of the grid: one of another grid, or none.
fn other(
    mesh: &MixedMesh,
    source: &Source,
    grid: &Layout,
    solutions: &Candidates,
    functions: &Candidates,
) -> IngestError {
    let Some(layout) = solutions.exact.first().or(functions.exact.first()) else {
        return misfit(source, "solution", solutions);
    };
    let differs = layout.blocks.iter().zip(&grid.blocks).find(|(a, b)| a.counts != b.counts);
    match differs {
        Some((found, expected)) => IngestError::SolutionDiffers {
            path: mesh.path.clone(),
            solution: source.path.clone(),
            found: found.counts,
            expected: expected.counts,
        },
        None => {
            let remedy = format!("the grid has {}: name the solution that belongs to it", grid.blocks.len());
            source.malformed(Place::File, "the number of blocks of a solution", layout.blocks.len(), remedy)
        }
    }
}
