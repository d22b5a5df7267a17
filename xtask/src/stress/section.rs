//! What a part of the suite found.

use serde::Serialize;

#[derive(Serialize)]
pub(crate) struct Section {
    pub(crate) title: &'static str,
    /// For people: what was done, and its tables.
    #[serde(skip)]
    pub(crate) markdown: String,
    /// For programs: every figure.
    pub(crate) figures: serde_json::Value,
    /// What was promised and did not hold, in a line each; empty if all did.
    pub(crate) failures: Vec<String>,
}
