//! What a picture may do without, by name.

use serde::{Deserialize, Serialize};

use crate::method::{UnknownName, parse_name};

/// Work that is left undone where a scene does not need it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Skip {
    /// Cells whose opacity is zero on their whole range of scalars.
    Transparent,
    /// Cells so faint that all of them together change no pixel by more than a share of the error budget.
    Faint,
    /// Cells outside the frustum, or behind the eye.
    Outside,
    /// What lies behind pixels that are opaque, but for a share of the error budget.
    Opaque,
    /// The order of cells, where it cannot change the picture by more than a share of the error budget.
    Order,
    /// Another search for the order where neither the eye nor the mesh has changed.
    LastOrder,
    /// The search for rays that leave the mesh and come back, where it is convex.
    Gaps,
    /// The search for cells that occlude one another in a cycle, where the cells can be ordered without.
    Components,
    /// Cuts at control points, in cells whose scalars hold none; and control points that the budget can spare.
    Cuts,
    /// Where in a segment its light comes from, where its luminance is constant.
    Weights,
    /// Gradients, where neither light nor a second axis asks for them.
    Gradients,
    /// Tables, where the integral is found without.
    Tables,
    /// Pipelines and bindings that the picture does not use.
    Pipelines,
    /// Preparing and uploading the mesh again, where it is that of the last picture.
    Uploads,
}

impl Skip {
    /// Every one, in the order of the plan.
    pub const ALL: &'static [Skip] = &[
        Skip::Transparent,
        Skip::Faint,
        Skip::Outside,
        Skip::Opaque,
        Skip::Order,
        Skip::LastOrder,
        Skip::Gaps,
        Skip::Components,
        Skip::Cuts,
        Skip::Weights,
        Skip::Gradients,
        Skip::Tables,
        Skip::Pipelines,
        Skip::Uploads,
    ];
}

impl std::fmt::Display for Skip {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        self.serialize(f)
    }
}

impl std::str::FromStr for Skip {
    type Err = UnknownName;

    fn from_str(name: &str) -> Result<Self, UnknownName> {
        parse_name(name)
    }
}

/// Some of [`Skip::ALL`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct SkipSet(u16);

impl SkipSet {
    /// None of them.
    pub const NONE: SkipSet = SkipSet(0);

    /// Whether it holds one.
    pub fn contains(self, skip: Skip) -> bool {
        self.0 >> skip as u16 & 1 != 0
    }

    /// The set with one more.
    #[must_use]
    pub fn with(self, skip: Skip) -> SkipSet {
        SkipSet(self.0 | 1 << skip as u16)
    }
}

impl FromIterator<Skip> for SkipSet {
    fn from_iter<I: IntoIterator<Item = Skip>>(skips: I) -> SkipSet {
        skips.into_iter().fold(SkipSet::default(), SkipSet::with)
    }
}

/// What becomes of a skip in one picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Fate {
    /// It is skipped.
    Skipped,
    /// It is done: the scene needs it, or there is nothing to skip.
    Done,
    /// It is known when the picture is made only: the frame tells.
    Later,
    /// It would be skipped, and is not, as asked.
    Kept,
}

impl std::fmt::Display for Fate {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        self.serialize(f)
    }
}

/// A line of the plan: what is not done, and why, or why it must be.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct SkipLine {
    /// What.
    pub skip: Skip,
    /// What becomes of it.
    pub fate: Fate,
    /// Why.
    pub why: String,
    /// Cells that are not drawn by it.
    pub cells: usize,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_skip_has_its_own_place_and_name() {
        for (index, &skip) in Skip::ALL.iter().enumerate() {
            assert_eq!(skip.to_string().parse(), Ok(skip));
            assert_eq!(skip as usize, index);
            let set = SkipSet::default().with(skip);
            assert_eq!(Skip::ALL.iter().filter(|&&other| set.contains(other)).collect::<Vec<_>>(), [&skip]);
        }
        assert_eq!(Skip::LastOrder.to_string(), "last-order");
        let all: SkipSet = Skip::ALL.iter().copied().collect();
        assert!(Skip::ALL.iter().all(|&skip| all.contains(skip)));
        assert!("nothing".parse::<Skip>().unwrap_err().to_string().contains("transparent"));
    }
}
