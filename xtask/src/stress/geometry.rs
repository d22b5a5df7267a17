//! Cases of geometry.

use super::case::Case;

pub(crate) const CASES: &[Case] = &[];
