//! Space and extinction in other units, from 1e-12 to 1e12, change nothing: by powers of two not a bit.

use tetlux_tests::twins::scaling;

use crate::{SEEDS, assert_same};

#[test]
fn by_powers_of_two() {
    assert_same("powers of two", scaling::by_power_of_two, 0..2 * SEEDS);
}

#[test]
fn by_any_number() {
    assert_same("any number", scaling::by_any, 0..SEEDS);
}
