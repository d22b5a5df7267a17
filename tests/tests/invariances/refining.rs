//! Refining a mesh without changing its field, or splitting cells, changes nothing.

use tetlux_tests::twins::refining;

use crate::{SEEDS, assert_same};

#[test]
fn cells_in_four() {
    assert_same("cells in four", refining::into_four, 0..SEEDS);
}

#[test]
fn cells_in_eight() {
    assert_same("cells in eight", refining::into_eight, 0..SEEDS);
}

#[test]
fn one_cell_and_the_cells_about_one_edge() {
    assert_same("one cell", refining::one_cell, 0..SEEDS);
    assert_same("one edge", refining::one_edge, 0..SEEDS);
}

#[test]
fn a_linear_field_on_another_mesh() {
    assert_same("another mesh", refining::another_mesh, 0..SEEDS);
}
