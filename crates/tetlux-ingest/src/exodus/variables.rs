//! Nodal and element variables at a time step.

use tetlux_mesh::Field;

use super::blocks::Block;
use super::file::File;
use super::netcdf::Variable;
use crate::source::Source;
use crate::{IngestError, MixedMesh, Place};

/// Adds the fields, and notes those without values.
pub(super) fn read(
    source: &Source,
    file: &File,
    step: Option<u64>,
    blocks: &[Block],
    mesh: &mut MixedMesh,
) -> Result<(), IngestError> {
    let names = |name: &str| match file.variable(name) {
        Some(variable) => file.texts(name, variable),
        None => Ok(Vec::new()),
    };
    let (nodal, element) = (names("name_nod_var")?, names("name_elem_var")?);
    let Some(step) = step else {
        if !nodal.is_empty() || !element.is_empty() {
            mesh.notes.push("the file names variables but has no time steps: there are no fields".into());
        }
        return Ok(());
    };
    let points = mesh.points.len();
    let mut fields = Vec::new();
    for (index, name) in nodal.into_iter().enumerate() {
        let values = match (file.variable(&format!("vals_nod_var{}", index + 1)), file.variable("vals_nod_var")) {
            (Some(own), _) => file.numbers(&name, own, &[step])?,
            (None, Some(all)) => file.numbers(&name, all, &[step, index as u64])?,
            (None, None) => {
                mesh.notes.push(format!("nodal variable \"{name}\" has no values: left out"));
                continue;
            }
        };
        check_length(source, &name, values.len(), points)?;
        fields.push(Field::point(name, 1, values));
    }
    fields = join_vectors(fields, &mut mesh.notes);
    let cells = element_fields(source, file, step, blocks, element, mesh)?;
    fields.extend(join_vectors(cells, &mut mesh.notes));
    mesh.fields = fields;
    Ok(())
}

fn check_length(source: &Source, name: &str, found: usize, expected: usize) -> Result<(), IngestError> {
    if found == expected {
        return Ok(());
    }
    let remedy = format!("it must have {expected}: write the file again");
    Err(source.malformed(Place::File, format!("the number of values of variable \"{name}\""), found, remedy))
}

/// Fields on the cells; NaN in blocks that do not have the variable.
fn element_fields(
    source: &Source,
    file: &File,
    step: u64,
    blocks: &[Block],
    names: Vec<String>,
    mesh: &mut MixedMesh,
) -> Result<Vec<Field>, IngestError> {
    // By variable, then block, both numbered from 1.
    let mut parts: Vec<(usize, &Block, &Variable)> = file
        .variables()
        .filter_map(|variable| {
            let (index, block) = variable.name.strip_prefix("vals_elem_var")?.split_once("eb")?;
            let block: u64 = block.parse().ok()?;
            let block = &blocks[blocks.binary_search_by_key(&block, |b| b.number).ok()?];
            Some((index.parse().ok()?, block, variable))
        })
        .collect();
    parts.sort_by_key(|&(index, block, _)| (index, block.number));
    // A variable may be on few of many cells: what is filled with NaN is not in the file, and is bounded apart.
    let mut fillable = source.bytes.len().saturating_mul(4).saturating_add(FILLABLE_ALWAYS);
    let mut fields = Vec::new();
    for own in parts.chunk_by(|a, b| a.0 == b.0) {
        let Some(name) = own[0].0.checked_sub(1).and_then(|index| names.get(index)) else { continue };
        let cells = mesh.cells.types.len();
        let missing = cells.saturating_sub(own.iter().map(|(_, block, _)| block.cells).sum());
        let Some(rest) = fillable.checked_sub(missing * size_of::<f64>()) else {
            let what = format!("element variable \"{name}\" is missing on {missing} of {cells} cells");
            mesh.notes.push(format!("{what}, and too many variables are alike: left out"));
            continue;
        };
        fillable = rest;
        let mut values = vec![f64::NAN; cells];
        for (_, block, variable) in own {
            let part = file.numbers(name, variable, &[step])?;
            check_length(source, name, part.len(), block.cells)?;
            values[block.first..block.first + block.cells].copy_from_slice(&part);
        }
        if missing > 0 {
            mesh.notes.push(format!("element variable \"{name}\" is on some blocks only: NaN on {missing} cells"));
        }
        fields.push(Field::cell(name, 1, values));
    }
    Ok(fields)
}

/// Bytes of NaN that a file of any size may ask for.
const FILLABLE_ALWAYS: usize = 16 << 20;

/// Makes one field of three components of each three in a row that are called alike but for a last X, Y and Z.
fn join_vectors(fields: Vec<Field>, notes: &mut Vec<String>) -> Vec<Field> {
    let names: Vec<String> = fields.iter().map(|f| f.name.clone()).collect();
    let mut joined = Vec::new();
    let mut rest = fields.into_iter();
    let mut at = 0;
    while let Some(first) = rest.next() {
        let name = names.get(at..at + 3).and_then(vector_name).filter(|name| !names.iter().any(|n| n == name));
        at += 1;
        let Some(name) = name else {
            joined.push(first);
            continue;
        };
        let parts: Vec<Field> = rest.by_ref().take(2).collect();
        at += parts.len();
        let [y, z] = [0, 1].map(|i| &parts[i].values);
        let values = first.values.iter().zip(y).zip(z).flat_map(|((&x, &y), &z)| [x, y, z]).collect();
        notes.push(format!(
            "{}, {} and {} are components 0, 1 and 2 of {name}",
            first.name, parts[0].name, parts[1].name
        ));
        joined.push(Field { name: name.into(), components: 3, values, ..first });
    }
    joined
}

/// What three names share, if they end in X, Y and Z or in x, y and z.
fn vector_name(names: &[String]) -> Option<&str> {
    let stem = ["XYZ", "xyz"].into_iter().find_map(|axes| {
        let mut stems = names.iter().zip(axes.chars()).map(|(name, axis)| name.strip_suffix(axis));
        let first = stems.next()??;
        stems.all(|stem| stem == Some(first)).then_some(first)
    })?;
    Some(stem.trim_end_matches(['_', '-', '.', ' '])).filter(|name| !name.is_empty())
}
