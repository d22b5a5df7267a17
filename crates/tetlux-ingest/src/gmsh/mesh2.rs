//! Nodes and elements of version 2.

use glam::DVec3;

use super::element::{self, Elements, Kind};
use super::input::Input;
use crate::IngestError;

/// Reads the nodes and gives their tags.
pub(super) fn nodes(input: &mut Input, parametric: bool, points: &mut Vec<DVec3>) -> Result<Vec<u64>, IngestError> {
    let count: u64 = input.words.number("the number of nodes")?;
    input.begin_binary();
    let mut tags = Vec::with_capacity(input.bounded(count, 28, 8));
    points.reserve_exact(tags.capacity());
    for _ in 0..count {
        let [tag] = input.ints_of("the tag of a node")?;
        tags.push(input.tag(tag)?);
        let at = input.reals("the coordinates of a node", 3)?;
        points.push(DVec3::from_slice(&at));
        if parametric {
            // The entity that the node lies on, and its coordinates there: one on a curve, two on a surface.
            let [dimension, _] = input.ints_of("the entity of a node")?;
            input.reals("the parameters of a node", [0, 1, 2, 0][dimension.clamp(0, 3) as usize])?;
        }
    }
    Ok(tags)
}

/// Reads the elements.
pub(super) fn elements(input: &mut Input, elements: &mut Elements) -> Result<(), IngestError> {
    let count: u64 = input.words.number("the number of elements")?;
    input.begin_binary();
    let mut read = 0;
    while read < count {
        // In binary a heading for several elements of one type.
        let (first, kind, number, labels) = if input.order.is_some() {
            let [kind, number, labels] = input.ints_of("the heading of a block of elements")?;
            (None, kind, input.tag(number)?, labels)
        } else {
            let [tag, kind, labels] = input.ints_of("tag, type and number of labels of an element")?;
            (Some(tag), kind, 1, labels)
        };
        if number == 0 || number > count - read {
            let what = format!("the elements of a block, of {} that are left", count - read);
            return Err(input.words.malformed(what, number, "it must be from 1 to these"));
        }
        let kind = known(input, kind)?;
        let labels = input.tag(labels)?;
        for _ in 0..number {
            let tag = match first {
                Some(tag) => tag,
                None => input.ints_of::<1>("the tag of an element")?[0],
            };
            input.ints("the labels of an element", labels)?;
            let tag = input.tag(tag)?;
            let nodes = input.ints("the nodes of an element", kind.nodes as u64)?;
            nodes.iter().try_for_each(|&node| input.tag(node).map(drop))?;
            elements.push(tag, &kind, |i| nodes[i] as u64);
        }
        read += number;
    }
    Ok(())
}

/// The type of an element, which must be known.
pub(super) fn known(input: &Input, number: i64) -> Result<Kind, IngestError> {
    element::kind(number).ok_or_else(|| {
        let words = &input.words;
        let remedy = "read are elements of the first and second order: in Gmsh, set Mesh.ElementOrder to 1 or 2";
        words.source.unsupported(words.place(), "an element of Gmsh's type", &number.to_string(), remedy)
    })
}
