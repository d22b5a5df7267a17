//! The order in which a file has cells and points changes nothing.

use tetlux_tests::twins::numbering;

use crate::{SEEDS, assert_same};

#[test]
fn cells() {
    assert_same("cells", numbering::cells, 0..SEEDS);
}

#[test]
fn points() {
    assert_same("points", numbering::points, 0..SEEDS);
}
