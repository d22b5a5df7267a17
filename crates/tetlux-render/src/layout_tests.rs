//! The structures uploaded here are laid out as the shaders have them.

use std::mem::{offset_of, size_of};

use naga::TypeInner;
use tetlux_optics::widget_f32::Widget;

use crate::device_view::DeviceView;
use crate::gpu::frame::Batch;
use crate::gpu::look::LookUniform;
use crate::gpu::march::Limits;
use crate::gpu::radix::Digit;
use crate::gpu::scan::Scanned;
use crate::gpu::tables::Lookup;
use crate::gpu::tiles::{Sorted, Tiling};
use crate::gpu::variant::{BALANCED_BYTES, CELL_BYTES, READY_BYTES};
use crate::seen::Seen;

/// (member, offset) of a structure of the drawing stage, and its size.
fn layout(structure: &str) -> (Vec<(String, usize)>, usize) {
    layout_in("stages::draw", structure)
}

fn layout_in(stage: &str, structure: &str) -> (Vec<(String, usize)>, usize) {
    let source = tetlux_shaders::compose(stage, tetlux_shaders::DEFAULTS).unwrap();
    let module = naga::front::wgsl::parse_str(&source).unwrap();
    let found = module.types.iter().find(|(_, t)| t.name.as_deref() == Some(structure));
    let TypeInner::Struct { members, span } = &found.unwrap().1.inner else { panic!("{structure} is no structure") };
    (members.iter().map(|m| (m.name.clone().unwrap(), m.offset as usize)).collect(), *span as usize)
}

fn named<const N: usize>(members: [(&str, usize); N]) -> Vec<(String, usize)> {
    members.map(|(name, offset)| (name.to_string(), offset)).to_vec()
}

#[test]
fn the_view() {
    let ours = named([
        ("right", offset_of!(DeviceView, right)),
        ("down", offset_of!(DeviceView, down)),
        ("forward", offset_of!(DeviceView, forward)),
        ("pivot_high", offset_of!(DeviceView, pivot_high)),
        ("pivot_low", offset_of!(DeviceView, pivot_low)),
        ("size", offset_of!(DeviceView, size)),
        ("pixel", offset_of!(DeviceView, pixel)),
        ("near", offset_of!(DeviceView, near)),
    ]);
    assert_eq!(layout("View"), (ours, size_of::<DeviceView>()));
}

#[test]
fn a_point_as_seen() {
    let ours = named([
        ("pixel", offset_of!(Seen, pixel)),
        ("rest", offset_of!(Seen, rest)),
        ("depth", offset_of!(Seen, depth)),
    ]);
    assert_eq!(layout("Seen"), (ours, size_of::<Seen>()));
}

#[test]
fn the_batch() {
    let ours = named([
        ("last", offset_of!(Batch, last)),
        ("count", offset_of!(Batch, count)),
        ("unused", offset_of!(Batch, unused)),
    ]);
    assert_eq!(layout("Batch"), (ours, size_of::<Batch>()));
}

#[test]
fn a_projected_cell() {
    assert_eq!(layout("Cell").1 as u64, CELL_BYTES);
    const { assert!(CELL_BYTES <= 80) }
}

#[test]
fn the_decoding_of_tables() {
    let ours = named([
        ("low", offset_of!(Lookup, low)),
        ("range", offset_of!(Lookup, range)),
        ("length", offset_of!(Lookup, length)),
    ]);
    assert_eq!(layout_in("lib::lookup", "Lookup"), (ours, size_of::<Lookup>()));
}

#[test]
fn the_look() {
    let ours = named([
        ("shares", offset_of!(LookUniform, shares)),
        ("direction", offset_of!(LookUniform, direction)),
        ("silhouette", offset_of!(LookUniform, silhouette)),
        ("errors", offset_of!(LookUniform, errors)),
        ("slope", offset_of!(LookUniform, slope)),
        ("curvature", offset_of!(LookUniform, curvature)),
        ("scale", offset_of!(LookUniform, scale)),
        ("origin", offset_of!(LookUniform, origin)),
        ("size", offset_of!(LookUniform, size)),
        ("color_pieces", offset_of!(LookUniform, color_pieces)),
        ("pieces", offset_of!(LookUniform, pieces)),
        ("emission", offset_of!(LookUniform, emission)),
        ("unit", offset_of!(LookUniform, unit)),
        ("unused", offset_of!(LookUniform, unused)),
        ("no_data", offset_of!(LookUniform, no_data)),
    ]);
    assert_eq!(layout_in("lib::look", "Look"), (ours, size_of::<LookUniform>()));
}

#[test]
fn a_widget() {
    let ours = named([
        ("color", offset_of!(Widget, color)),
        ("support", offset_of!(Widget, support)),
        ("shape", offset_of!(Widget, shape)),
        ("kind", offset_of!(Widget, kind)),
    ]);
    assert_eq!(layout_in("lib::widget", "Widget"), (ours, size_of::<Widget>()));
}

#[test]
fn the_limits_of_a_march() {
    let ours = named([
        ("opaque", offset_of!(Limits, opaque)),
        ("steps", offset_of!(Limits, steps)),
        ("unused", offset_of!(Limits, unused)),
    ]);
    assert_eq!(layout_in("stages::march", "March"), (ours, size_of::<Limits>()));
}

#[test]
fn what_is_scanned_and_a_digit() {
    let ours = named([
        ("count", offset_of!(Scanned, count)),
        ("unused", offset_of!(Scanned, unused)),
        ("unused_pair", offset_of!(Scanned, unused_pair)),
    ]);
    assert_eq!(layout_in("stages::scan", "Scanned"), (ours, size_of::<Scanned>()));
    let ours = named([
        ("count", offset_of!(Digit, count)),
        ("blocks", offset_of!(Digit, blocks)),
        ("shift", offset_of!(Digit, shift)),
        ("bits", offset_of!(Digit, bits)),
    ]);
    assert_eq!(layout_in("stages::scatter", "Digit"), (ours, size_of::<Digit>()));
}

#[test]
fn a_run_of_cells_on_tiles() {
    assert_eq!(layout_in("stages::tiles", "Ready").1 as u64, READY_BYTES);
    let ours = named([
        ("columns", offset_of!(Tiling, columns)),
        ("first", offset_of!(Tiling, first)),
        ("end", offset_of!(Tiling, end)),
        ("opaque", offset_of!(Tiling, opaque)),
    ]);
    assert_eq!(layout_in("stages::tiles", "Tiling"), (ours, size_of::<Tiling>()));
    let ours = named([
        ("pairs", offset_of!(Sorted, pairs)),
        ("tiles", offset_of!(Sorted, tiles)),
        ("unused", offset_of!(Sorted, unused)),
    ]);
    assert_eq!(layout_in("stages::bounds", "Sorted"), (ours, size_of::<Sorted>()));
}

/// What is seen of the four vertices and their scalars, which are pulled; the face opposite goes without saying.
const PULLED_FLOATS: u64 = 4 * (size_of::<Seen>() as u64 / 4 + 1);

#[test]
fn a_balanced_cell_moves_at_most_as_much_as_published() {
    assert_eq!(layout_in("stages::balance", "Balanced").1 as u64, BALANCED_BYTES);
    // Moreland and Angel 2004, section 3.1: seven floats for each of four vertices, drawn by index.
    const { assert!(PULLED_FLOATS + BALANCED_BYTES / 4 <= 28) }
}
