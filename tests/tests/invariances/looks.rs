//! The same of scenes that look at two fields, or that are lit.

use tetlux_tests::twins::{Make, numbering, refining, reversing, scaling, turning};
use tetlux_tests::{Recipe, Way};

use crate::assert_same_of;

/// Tiles on wgpu are for one field without light.
const WAYS: [Way; 4] = [Way::CpuExact, Way::CpuPixel, Way::GpuExact, Way::GpuMarch];

/// Transfer functions, widgets and an image, twice.
const SEEDS: u64 = 6;

/// What changes no gradient but by rounding.
const RIGID: [(&str, Make); 8] = [
    ("scaled by a power of two", scaling::by_power_of_two),
    ("scaled by any number", scaling::by_any),
    ("turned", turning::turned),
    ("moved by what is exact", turning::moved_exactly),
    ("moved far away", turning::moved_far),
    ("seen from behind", reversing::parallel),
    ("cells numbered anew", numbering::cells),
    ("points numbered anew", numbering::points),
];

#[test]
fn two_fields() {
    let refined: [(&str, Make); 3] = [
        ("cells in four", refining::into_four),
        ("cells in eight", refining::into_eight),
        ("one cell", refining::one_cell),
    ];
    for (name, make) in RIGID.into_iter().chain(refined) {
        assert_same_of(&format!("two fields, {name}"), &WAYS, |seed| Recipe::of_two_fields(seed, 24), make, 0..SEEDS);
    }
}

#[test]
fn light() {
    let lit = |seed| if seed % 2 == 0 { Recipe::random(seed, 24).lit() } else { Recipe::of_two_fields(seed, 24).lit() };
    for (name, make) in RIGID {
        assert_same_of(&format!("lit, {name}"), &WAYS, lit, make, 0..SEEDS);
    }
}
