//! Faults for tests to find, of the feature `planted` alone: no program is built with it.

use std::sync::{Mutex, PoisonError};

/// Other text in a module.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Edit {
    /// The module, by name.
    pub module: &'static str,
    /// What is replaced wherever the module has it.
    pub from: &'static str,
    /// What stands there instead.
    pub to: &'static str,
}

static EDIT: Mutex<Option<Edit>> = Mutex::new(None);

/// Edits whatever this process composes from now on; `None`: no more.
pub fn edit(edit: Option<Edit>) {
    *EDIT.lock().unwrap_or_else(PoisonError::into_inner) = edit;
}

/// A module's text as it is composed.
pub(crate) fn edited(module: &str, text: &str) -> String {
    match *EDIT.lock().unwrap_or_else(PoisonError::into_inner) {
        Some(edit) if edit.module == module => text.replace(edit.from, edit.to),
        _ => text.into(),
    }
}
