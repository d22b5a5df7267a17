//! Cases of geometry.

mod cells;

use super::case::Case;

pub(crate) const CASES: &[Case] =
    &[Case { name: "cube", what: "nothing: what all others are measured by", input: cells::cube }];
