//! Structures that the shaders and the program share have one layout.

#![allow(clippy::unwrap_used, reason = "a test stops at its first surprise")]

use std::mem::{offset_of, size_of};

use naga::{TypeInner, front::wgsl};
use tetlux_optics::transfer_f32::Piece;

/// (member, offset) of a structure of a composed module, and its size.
fn layout(module: &str, structure: &str) -> (Vec<(String, usize)>, usize) {
    let source = tetlux_shaders::compose(module, tetlux_shaders::DEFAULTS).unwrap();
    let module = wgsl::parse_str(&source).unwrap();
    let (_, found) = module
        .types
        .iter()
        .find(|(_, t)| t.name.as_deref() == Some(structure))
        .unwrap_or_else(|| panic!("no structure {structure}"));
    let TypeInner::Struct { members, span } = &found.inner else { panic!("{structure} is no structure") };
    let members = members.iter().map(|m| (m.name.clone().unwrap_or_default(), m.offset as usize)).collect();
    (members, *span as usize)
}

#[test]
fn a_piece_of_the_transfer_function() {
    let (members, size) = layout("lib::transfer", "Piece");
    let ours = [("low", offset_of!(Piece, low)), ("high", offset_of!(Piece, high)), ("s", offset_of!(Piece, s))];
    assert_eq!(members, ours.map(|(name, offset)| (name.to_string(), offset)));
    assert_eq!(size, size_of::<Piece>());
}

#[test]
fn a_stage_sees_the_same_structures_as_the_next() {
    // The projection writes what drawing reads.
    for structure in ["Cell", "View", "Batch"] {
        assert_eq!(layout("stages::project", structure), layout("stages::draw", structure), "{structure}");
    }
}

#[test]
fn structures_of_uniforms_and_storage_have_no_gap_at_their_end() {
    // A size that is no multiple of 16 would be padded, and arrays of it would drift.
    for (module, structure) in
        [("stages::draw", "Cell"), ("stages::draw", "View"), ("stages::draw", "Batch"), ("stages::draw", "Piece")]
    {
        assert_eq!(layout(module, structure).1 % 16, 0, "{structure}");
    }
}
