//! Cases of optics.

use super::case::Case;

pub(crate) const CASES: &[Case] = &[];
