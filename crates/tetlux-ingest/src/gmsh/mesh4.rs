//! Nodes and elements of version 4.1, in blocks by the entity that they lie on.

use glam::DVec3;

use super::element::Elements;
use super::input::Input;
use super::mesh2::known;
use crate::IngestError;

/// Reads the nodes and gives their tags.
pub(super) fn nodes(input: &mut Input, points: &mut Vec<DVec3>) -> Result<Vec<u64>, IngestError> {
    input.begin_binary();
    let [blocks, count, _, _] = input.sizes_of("the heading of the nodes")?;
    let mut tags = Vec::with_capacity(input.bounded(count, 28, 8));
    points.reserve_exact(tags.capacity());
    for _ in 0..blocks {
        let [dimension, _, parametric] = input.ints_of("the entity of a block of nodes")?;
        let [number] = input.sizes_of("the number of nodes of a block")?;
        tags.extend(input.sizes("the tags of nodes", number)?);
        let parameters = if parametric == 0 { 0 } else { dimension.clamp(0, 3) as usize };
        let stride = 3 + parameters;
        let values = input.reals("the coordinates of nodes", number.saturating_mul(stride as u64))?;
        points.extend(values.chunks_exact(stride).map(DVec3::from_slice));
    }
    total(input, "nodes", tags.len() as u64, count)?;
    Ok(tags)
}

/// Reads the elements.
pub(super) fn elements(input: &mut Input, elements: &mut Elements) -> Result<(), IngestError> {
    input.begin_binary();
    let [blocks, count, _, _] = input.sizes_of("the heading of the elements")?;
    let mut read = 0u64;
    for _ in 0..blocks {
        let [_, _, kind] = input.ints_of("the entity of a block of elements")?;
        let [number] = input.sizes_of("the number of elements of a block")?;
        let kind = known(input, kind)?;
        let stride = 1 + kind.nodes;
        let values = input.sizes("the nodes of elements", number.saturating_mul(stride as u64))?;
        for element in values.chunks_exact(stride) {
            elements.push(element[0], &kind, |i| element[1 + i]);
        }
        read = read.saturating_add(number);
    }
    total(input, "elements", read, count)
}

fn total(input: &Input, what: &str, found: u64, expected: u64) -> Result<(), IngestError> {
    if found != expected {
        let what = format!("the {what} of all blocks, {expected} by their heading");
        return Err(input.words.malformed(what, found, "they must agree: write the file again"));
    }
    Ok(())
}
