//! `cargo xtask testbed`

#[cfg(test)]
mod agreement;
mod cases;
pub(crate) mod meshes;
mod picture;

use std::fmt::Write;
use std::path::{Path, PathBuf};

use anyhow::{Result, bail};
use tetlux_image::{Encoding, Image, Metrics, compare, write_atomically, write_png};
use tetlux_render::{Frame, Model, Renderer};
use tetlux_scene::{Backend, Method, Plan};

use crate::input::Input;
use crate::report::create_folder;
use crate::{progress, tables, truth};
use cases::{CASES, Case};

pub(crate) const EXAMPLES: &str = "\
Examples:
  cargo xtask testbed
  cargo xtask testbed --only order --output out/testbed --markdown out/testbed.md";

#[derive(clap::Args)]
pub(crate) struct Args {
    /// Folder for the pictures
    #[arg(long, short, value_name = "FOLDER", default_value = "docs/testbed")]
    output: PathBuf,
    /// The page to write
    #[arg(long, value_name = "FILE", default_value = "docs/testbed.md")]
    markdown: PathBuf,
    /// Side of each half, in pixels
    #[arg(long, value_name = "PIXELS", default_value_t = 200, value_parser = clap::value_parser!(u32).range(16..=2048))]
    side: u32,
    /// One pair alone, by name; may be repeated
    #[arg(long, value_name = "NAME")]
    only: Vec<String>,
}

pub(crate) fn run(args: &Args) -> Result<()> {
    if let Some(unknown) = args.only.iter().find(|name| CASES.iter().all(|case| case.name != **name)) {
        let names: Vec<_> = CASES.iter().map(|case| case.name).collect();
        bail!("--only {unknown}: there is no such pair; there are {}", names.join(", "));
    }
    let renderer = Renderer::new();
    let mut page = String::from(HEAD);
    say!("{:<18} {:<30} {:>9} {:>9}", "pair", "method", "max", "mean");
    for case in CASES.iter().filter(|case| args.only.is_empty() || args.only.iter().any(|name| name == case.name)) {
        let png = args.output.join(case.name).with_extension("png");
        let errors = pair(case, &renderer, args.side, &png)?;
        section(&mut page, case, &errors, &link(&png, &args.markdown));
    }
    create_folder(&args.markdown)?;
    write_atomically(&args.markdown, |file| file.write_all(page.as_bytes()))?;
    say!("{}", args.markdown.display());
    Ok(())
}

/// Renders and writes a pair; gives the errors of its halves.
fn pair(case: &Case, renderer: &Renderer, side: u32, png: &Path) -> Result<[Metrics; 2]> {
    let mut input = case.setting.input(case.name, case.title, side)?;
    let truth = truth::image(&input, &input.scene.camera.view(input.scene.size)?, [0.0; 2])?;
    let mut half = |(name, method): cases::Half| -> Result<(Image, Metrics)> {
        let image = frame(&mut input, renderer, method)?.image;
        let metrics = compare(&truth, &image, 0.0)?;
        say!("{:<18} {:<30} {:>9.1e} {:>9.1e}", case.name, name, metrics.max, metrics.mean);
        Ok((image, metrics))
    };
    let (artifact, before) = half(case.artifact)?;
    let (cure, after) = half(case.cure)?;
    let inset = picture::inset_pixels(case.inset, side);
    create_folder(png)?;
    write_png(&picture::side_by_side([&artifact, &cure], &truth, inset, case.gain)?, png, Encoding::Srgb)?;
    Ok([before, after])
}

/// Renders by a method, a change of the default on a graphics adapter.
pub(crate) fn frame(input: &mut Input, renderer: &Renderer, method: fn(&mut Method)) -> Result<Frame> {
    input.scene.method = Method { backend: Backend::Gpu, ..Method::default() };
    method(&mut input.scene.method);
    let plan = Plan::new(&input.scene, &input.mesh, renderer.device())?;
    let tables = tables::load_or_build(input, &plan, &mut Vec::new())?;
    let model = Model::new(&input.mesh);
    Ok(progress::during("rendering", || renderer.render_with(&input.scene, &model, &plan, &tables))?)
}

const HEAD: &str = "\
# Test bed

Artifacts of the literature and what cures them, on meshes that the program makes: `cargo xtask testbed` writes this page
and its pictures. Left is the artifact, right the cure; below each the framed part is magnified, its contrast raised about
the mean of the truth. Errors are against the f64 reference: worst channel of a pixel, linear, the mean over what is covered.
";

fn section(page: &mut String, case: &Case, errors: &[Metrics; 2], link: &str) {
    let Case { title, source, shows, artifact, cure, .. } = case;
    // Writing to a string does not fail.
    let _ = write!(page, "\n## {title}\n\n{shows} ({source}.)\n\n![{}, {}]({link})\n\n", artifact.0, cure.0);
    let _ = writeln!(page, "| | largest error | mean |\n|---|---|---|");
    for ((name, _), error) in [artifact, cure].into_iter().zip(errors) {
        let _ = writeln!(page, "| {name} | {:.1e} | {:.1e} |", error.max, error.mean);
    }
}

/// The picture's place as the page names it.
fn link(png: &Path, page: &Path) -> String {
    let place = png.strip_prefix(page.parent().unwrap_or(Path::new(""))).unwrap_or(png);
    place.display().to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pairs_have_names_of_their_own_and_methods_that_can_be() {
        for (i, case) in CASES.iter().enumerate() {
            assert!(CASES[..i].iter().all(|other| other.name != case.name), "{}", case.name);
            for (name, change) in [case.artifact, case.cure] {
                let mut method = Method { backend: Backend::Gpu, ..Method::default() };
                change(&mut method);
                assert_eq!(method.refusal(), None, "{} {name}", case.name);
            }
        }
    }

    #[test]
    fn a_page_links_to_what_lies_beside_it() {
        assert_eq!(link(Path::new("docs/testbed/a.png"), Path::new("docs/testbed.md")), "testbed/a.png");
        assert_eq!(link(Path::new("/x/a.png"), Path::new("docs/testbed.md")), "/x/a.png");
    }
}
