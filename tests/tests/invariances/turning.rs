//! Turning or moving mesh and camera together changes nothing.

use tetlux_tests::twins::turning;

use crate::{SEEDS, assert_same};

#[test]
fn turned() {
    assert_same("turned", turning::turned, 0..SEEDS);
}

#[test]
fn moved() {
    assert_same("moved by what is exact", turning::moved_exactly, 0..SEEDS);
    assert_same("moved far", turning::moved_far, 0..SEEDS);
}
