//! Hostile input.

use anyhow::Result;

use super::Stress;
use super::section::Section;

pub(crate) fn run(_stress: &Stress) -> Result<Section> {
    Ok(Section {
        title: "Hostile input",
        markdown: String::new(),
        figures: serde_json::Value::Null,
        failures: Vec::new(),
    })
}
