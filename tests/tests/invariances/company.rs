//! Clear cells change nothing, drawn or not.

use tetlux_tests::twins::company;

use crate::{SEEDS, assert_same};

#[test]
fn in_the_mesh() {
    assert_same("holes", company::filled, 0..SEEDS);
}

#[test]
fn about_the_mesh() {
    assert_same("clear bodies", company::about, 0..SEEDS);
}
