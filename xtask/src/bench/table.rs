//! Tables of figures, for people and for programs.

use std::fmt::{Display, Formatter};

use serde::Serialize;

/// A table under a heading.
#[derive(Serialize)]
pub(crate) struct Table {
    /// As it is asked for.
    pub(crate) name: &'static str,
    pub(crate) title: String,
    /// What must be known to read it.
    pub(crate) notes: Vec<String>,
    pub(crate) head: Vec<String>,
    pub(crate) rows: Vec<Vec<Cell>>,
}

/// An entry of a table.
#[derive(Serialize, Clone)]
#[serde(untagged)]
pub(crate) enum Cell {
    Text(String),
    Number(f64),
    /// Not known.
    Unknown,
}

impl From<&str> for Cell {
    fn from(text: &str) -> Cell {
        Cell::Text(text.to_owned())
    }
}

impl From<String> for Cell {
    fn from(text: String) -> Cell {
        Cell::Text(text)
    }
}

impl From<f64> for Cell {
    fn from(value: f64) -> Cell {
        Cell::Number(value)
    }
}

impl From<usize> for Cell {
    fn from(count: usize) -> Cell {
        Cell::Number(count as f64)
    }
}

impl From<Option<f64>> for Cell {
    fn from(value: Option<f64>) -> Cell {
        value.map_or(Cell::Unknown, Cell::Number)
    }
}

impl Display for Cell {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        match self {
            Cell::Text(text) => f.pad(text),
            Cell::Number(value) => f.pad(&number(*value)),
            Cell::Unknown => f.pad("-"),
        }
    }
}

/// A number with three digits that count; whole numbers in full.
pub(crate) fn number(value: f64) -> String {
    let size = value.abs();
    if value.fract() == 0.0 && size < 1e15 {
        format!("{value}")
    } else if !(1e-3..1e7).contains(&size) {
        format!("{value:.1e}")
    } else {
        let decimals = (2 - size.log10().floor() as i32).clamp(0, 5);
        format!("{value:.*}", decimals as usize)
    }
}

impl Table {
    /// In columns, as it is printed.
    pub(crate) fn text(&self) -> String {
        let body = self.rows.iter().map(|row| row.iter().map(Cell::to_string).collect());
        let all: Vec<Vec<String>> = std::iter::once(self.head.clone()).chain(body).collect();
        let width = |column: usize| all.iter().filter_map(|row| row.get(column)).map(|c| c.chars().count()).max();
        let widths: Vec<usize> = (0..self.head.len()).map(|column| width(column).unwrap_or(0)).collect();
        // Words begin below one another, numbers end so.
        let is_words = |column: usize| matches!(self.rows.first().and_then(|row| row.get(column)), Some(Cell::Text(_)));
        let mut text = format!("{}: {}\n", self.name, self.title);
        for row in &all {
            for (column, (entry, &width)) in row.iter().zip(&widths).enumerate() {
                text += &if is_words(column) { format!("{entry:<width$}  ") } else { format!("{entry:>width$}  ") };
            }
            text.truncate(text.trim_end().len());
            text.push('\n');
        }
        self.notes.iter().for_each(|note| text += &format!("  {note}\n"));
        text
    }

    /// The same in Markdown.
    pub(crate) fn markdown(&self) -> String {
        format!("### {}\n\n{}", self.title, self.body())
    }

    /// The same without its title.
    pub(crate) fn body(&self) -> String {
        let rows = self.rows.iter().map(|row| row.iter().map(Cell::to_string).collect());
        let notes: String = self.notes.iter().map(|note| format!("{note}\n\n")).collect();
        format!("{notes}{}", markdown(&self.head, rows))
    }
}

/// A Markdown table.
pub(crate) fn markdown<S: AsRef<str>>(head: &[S], rows: impl Iterator<Item = Vec<String>>) -> String {
    let head: Vec<&str> = head.iter().map(AsRef::as_ref).collect();
    let mut text = format!("| {} |\n|{}\n", head.join(" | "), "---|".repeat(head.len()));
    rows.for_each(|row| text += &format!("| {} |\n", row.join(" | ")));
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_keep_three_digits() {
        let values = [0.0, 187_395.0, 2236e3, 11.935, 0.194_6, 0.0456, 1234.5, 2.1e-6, -0.5];
        let texts = ["0", "187395", "2236000", "11.9", "0.195", "0.0456", "1234", "2.1e-6", "-0.500"];
        assert_eq!(values.map(number), texts);
    }

    #[test]
    fn columns_line_up_and_what_is_not_known_is_a_dash() {
        let table = Table {
            name: "t",
            title: "A table".into(),
            notes: vec!["Noted.".into()],
            head: vec!["of".into(), "theirs".into()],
            rows: vec![vec!["one".into(), 1.5.into()], vec!["three".into(), Cell::Unknown]],
        };
        assert_eq!(table.text(), "t: A table\nof     theirs\none      1.50\nthree       -\n  Noted.\n");
        let page = "### A table\n\nNoted.\n\n| of | theirs |\n|---|---|\n| one | 1.50 |\n| three | - |\n";
        assert_eq!(table.markdown(), page);
    }
}
