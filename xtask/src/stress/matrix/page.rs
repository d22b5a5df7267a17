//! The matrix as a page.

use std::fmt::Write;

use super::judge::{BESIDE, CLEAN, Verdict};
use super::{Line, OURS, Outcome};
use crate::bench::table::{markdown as table, number};
use crate::methods::Row;

/// A case in a line, as it is done.
pub(super) fn said(line: &Line, methods: &[&Row]) -> String {
    let worst = line.outcomes[..OURS.len()].iter().zip(methods).filter_map(|(outcome, (name, _))| match outcome {
        Outcome::Drawn(verdict) => Some((verdict.max.max(verdict.thin.unwrap_or(0.0)), *name)),
        _ => None,
    });
    let worst = worst.max_by(|a, b| a.0.total_cmp(&b.0));
    let worst = worst.map_or("drawn by none".to_owned(), |(error, name)| format!("{error:.1e} by {name}"));
    format!("{:<28} {:>8} cells  {:>5.1} s  ours at worst {worst}", line.case, line.cells, line.seconds)
}

/// Columns of a table: its title, and which methods.
struct Group {
    title: &'static str,
    columns: Vec<usize>,
}

/// Ours; the published ones by what they are ways of.
fn groups(methods: &[&Row]) -> [Group; 3] {
    let is_number = |name: &str| {
        ["q", "psi", "linear", "average", "preint", "rgba"].iter().any(|word| name.trim_matches('`').starts_with(word))
    };
    let published = |wanted: bool| (OURS.len()..methods.len()).filter(|&i| is_number(methods[i].0) == wanted).collect();
    [
        Group { title: "Ours", columns: (0..OURS.len()).collect() },
        Group { title: "Published projections, classifications and orders", columns: published(false) },
        Group { title: "Published integrals, tables and targets", columns: published(true) },
    ]
}

pub(super) fn markdown(lines: &[Line], methods: &[&Row]) -> String {
    let mut page = format!(
        "Every picture against an f64 ray caster that shares no formula with what it judges. Pixels whose truth changes by more \
         than {CLEAN:.0e} where the ray is moved by {BESIDE:.0e} of the picture's side are edges and not judged. Promised of ours: no error above \
         {CLEAN:.0e}, neither absolute nor, where alpha is below 0.01, relative to alpha; no coverage fault (a pixel lit where \
         nothing is, or dark where something is). Promised of every method: no value that is infinite or not a number. What \
         follows an error in a cell: `c3` three coverage faults, `n3` three pixels not finite, **bold** a promise broken; `r` \
         stands where a method refuses the case with a reason, which is said below.\n\n"
    );
    page += &cases(lines);
    for Group { title, columns } in groups(methods) {
        let _ = write!(page, "\n### {title}: worst absolute error\n\n");
        page += &errors(lines, methods, &columns, |_| true, |verdict| Some(verdict.max));
        let _ = write!(page, "\n### {title}: worst relative error where the medium is thin\n\n");
        let has_thin = |line: &Line| line.pixels.is_some_and(|pixels| pixels.thin > 0);
        page += &errors(lines, methods, &columns, has_thin, |verdict| verdict.thin);
    }
    page + &refusals(lines, methods)
}

fn cases(lines: &[Line]) -> String {
    let rows = lines.iter().map(|line| {
        let pixels = line.pixels.map_or("-".to_owned(), |p| format!("{} / {} / {}", p.lit, p.judged, p.thin));
        vec![line.case.to_owned(), line.what.to_owned(), line.cells.to_string(), pixels]
    });
    table(&["case", "what is hard about it", "cells", "pixels lit / judged / thin"], rows)
}

fn errors(
    lines: &[Line],
    methods: &[&Row],
    columns: &[usize],
    wanted: impl Fn(&Line) -> bool,
    figure: impl Fn(&Verdict) -> Option<f64>,
) -> String {
    let head: Vec<&str> = std::iter::once("case").chain(columns.iter().map(|&i| methods[i].0)).collect();
    let cell = |line: &Line, i: usize| match &line.outcomes[i] {
        Outcome::Refused(_) => "r".to_owned(),
        Outcome::Broke(_) => "**broke**".to_owned(),
        Outcome::Drawn(verdict) => {
            let mut text = figure(verdict).map_or("-".to_owned(), number);
            for (count, letter) in [(verdict.coverage, 'c'), (verdict.not_finite, 'n')] {
                if count > 0 {
                    let _ = write!(text, " {letter}{count}");
                }
            }
            let broken = verdict.not_finite > 0 || (i < OURS.len() && !verdict.is_clean());
            if broken { format!("**{text}**") } else { text }
        }
    };
    let row =
        |line: &Line| std::iter::once(line.case.to_owned()).chain(columns.iter().map(|&i| cell(line, i))).collect();
    table(&head, lines.iter().filter(|line| wanted(line)).map(row))
}

/// Each reason once, with all that it is given for.
fn refusals(lines: &[Line], methods: &[&Row]) -> String {
    let mut reasons: Vec<(&str, Vec<String>)> = Vec::new();
    for line in lines {
        for (outcome, (name, _)) in line.outcomes.iter().zip(methods) {
            let Outcome::Refused(why) = outcome else { continue };
            let place = match reasons.iter().position(|(reason, _)| reason == why) {
                Some(place) => place,
                None => {
                    reasons.push((why, Vec::new()));
                    reasons.len() - 1
                }
            };
            let of = &mut reasons[place].1;
            match of.last_mut().filter(|last| last.starts_with(&format!("{} by ", line.case))) {
                Some(last) => {
                    let _ = write!(last, "; {name}");
                }
                None => of.push(format!("{} by {name}", line.case)),
            }
        }
    }
    if reasons.is_empty() {
        return String::new();
    }
    let mut text = String::from("\n### Refused\n\n");
    for (reason, of) in reasons {
        let _ = writeln!(text, "- {reason} ({})", of.join("), ("));
    }
    text
}
