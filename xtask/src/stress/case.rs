//! A mesh and a scene that renderers are known, or likely, to fail on.

use anyhow::Result;

use crate::input::Input;

/// A row of the matrix.
pub(crate) struct Case {
    /// As `--case` takes it: kebab-case.
    pub(crate) name: &'static str,
    /// What is hard about it, in a line.
    pub(crate) what: &'static str,
    /// Makes it, at the size of the whole suite or of its short form.
    pub(crate) input: fn(short: bool) -> Result<Input>,
}
