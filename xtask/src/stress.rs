//! `cargo xtask stress`

mod case;
mod endurance;
mod faults;
mod geometry;
mod hostile;
mod matrix;
mod optics;
mod section;

use std::fmt::Write;
use std::path::{Path, PathBuf};

use anyhow::{Result, bail};
use tetlux_image::write_atomically;
use tetlux_render::Renderer;

use crate::machine::Machine;
use crate::report::{create_folder, write_json};
pub(crate) use faults::run_without_memory;
pub(crate) use hostile::worker::{Args as CasesArgs, run as run_cases};
use section::Section;

pub(crate) const EXAMPLES: &str = "\
Examples:
  cargo xtask stress
  cargo xtask stress --short
  cargo xtask stress --only matrix --case flat-cells
  cargo xtask stress --write-docs

It ends with status 1 if anything failed that is promised to hold; what a published method cannot do is told, and is no failure.";

#[derive(clap::Args)]
pub(crate) struct Args {
    /// One part alone: matrix, faults, hostile or endurance; may be repeated
    #[arg(long, value_name = "NAME")]
    only: Vec<String>,
    /// A case of the matrix alone, by name; may be repeated
    #[arg(long, value_name = "NAME")]
    case: Vec<String>,
    /// Small meshes, few cases, few frames: seconds, not minutes
    #[arg(long)]
    short: bool,
    /// Folder for the page (Markdown), the figures (JSON), and a picture of each case
    #[arg(long, short, value_name = "FOLDER", default_value = "target/stress")]
    output: PathBuf,
    /// Everything, written to docs/stress.md
    #[arg(long, conflicts_with_all = ["only", "case", "short"])]
    write_docs: bool,
}

/// What every part is run with.
pub(crate) struct Stress<'a> {
    renderer: &'a Renderer,
    /// Names of cases; empty: all.
    cases: &'a [String],
    short: bool,
    /// For pictures.
    folder: &'a Path,
}

/// A part of the suite.
type Part = (&'static str, fn(&Stress) -> Result<Section>);

const PARTS: [Part; 4] =
    [("matrix", matrix::run), ("faults", faults::run), ("hostile", hostile::run), ("endurance", endurance::run)];

/// Whether everything held that is promised to.
pub(crate) fn run(args: &Args) -> Result<bool> {
    if let Some(unknown) = args.only.iter().find(|name| PARTS.iter().all(|(part, _)| part != name)) {
        bail!("--only {unknown}: there is no such part; there are {}", PARTS.map(|(name, _)| name).join(", "));
    }
    let renderer = Renderer::new();
    let stress = Stress { renderer: &renderer, cases: &args.case, short: args.short, folder: &args.output };
    let mut sections = Vec::new();
    // The last part first: what the others give back would hold what endurance loses, and hide it.
    for (name, part) in PARTS.iter().rev() {
        if args.only.is_empty() || args.only.iter().any(|asked| asked == name) {
            sections.push(part(&stress)?);
        }
    }
    sections.reverse();
    let page = if args.write_docs { PathBuf::from("docs/stress.md") } else { args.output.join("stress.md") };
    let json = args.output.join("stress.json");
    let text = markdown(&Machine::new(&renderer), &sections, args.short);
    create_folder(&page)?;
    write_atomically(&page, |file| file.write_all(text.as_bytes()))?;
    write_json(&json, &sections)?;
    let failures: Vec<&String> = sections.iter().flat_map(|section| &section.failures).collect();
    failures.iter().for_each(|failure| say!("FAILED {failure}"));
    say!("{}\n{}", page.display(), json.display());
    Ok(failures.is_empty())
}

fn markdown(machine: &Machine, sections: &[Section], short: bool) -> String {
    let mut page = String::from(HEAD);
    if short {
        page.push_str("\n**A short run**: small meshes, few cases.\n");
    }
    page.push_str("\n| | |\n|---|---|\n");
    // Writing to a string does not fail.
    for [what, value] in machine.rows() {
        let _ = writeln!(page, "| {what} | {value} |");
    }
    for Section { title, markdown, failures, .. } in sections {
        let _ = write!(page, "\n## {title}\n\n{markdown}");
        for failure in failures {
            let _ = writeln!(page, "\n**Failed**: {failure}");
        }
    }
    page
}

const HEAD: &str = "\
# Under stress

What is promised to hold, held to it: `cargo xtask stress --write-docs` writes this page, `cargo xtask test` runs its short form.

What must not change a picture (refining a mesh, splitting, scaling, turning, moving or renumbering it, looking from behind)
is tested on random scenes, `tests/tests/invariances`. That all of these tests find what is wrong is tested by faults planted
on purpose, `tests/tests/planted.rs`: [CONTRIBUTING.md](../CONTRIBUTING.md#planted-faults) lists them, with what finds each.
";
