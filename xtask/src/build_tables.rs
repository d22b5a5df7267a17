//! `cargo xtask build-tables`

use std::path::{Path, PathBuf};
use std::time::Instant;

use anyhow::{Context, Result, bail};
use clap::ValueEnum;
use tetlux_image::{Encoding, write_atomically, write_png};
use tetlux_tables::{
    Manifest, Precision, Store, StoredTable, Table, TableSpec, accuracy, error_picture, measure, value_picture,
};

use crate::report::create_folder;
use crate::{progress, tables};

pub(crate) const EXAMPLES: &str = "\
Examples:
  cargo xtask build-tables
  cargo xtask build-tables --only q --size 512x512 --precision f16
  cargo xtask build-tables --check
  cargo xtask build-tables --only psi --plot
  cargo xtask build-tables --accuracy docs/accuracy.md

Exit status: 0 if all is well, 1 if --check finds a table that is not what would be built, 2 if something failed.";

#[derive(clap::Args)]
pub(crate) struct Args {
    /// One table, by name, instead of all
    #[arg(long, value_name = "ID")]
    only: Option<String>,
    /// Nodes along the axes, as 256x256 or 64x64x64
    #[arg(long, value_name = "SIZE", value_parser = parse_size, requires = "only")]
    size: Option<[u32; 3]>,
    /// Texel format
    #[arg(long, value_enum)]
    precision: Option<Format>,
    /// Build again in memory and compare with the files; write nothing
    #[arg(long, conflicts_with_all = ["list", "plot", "accuracy"])]
    check: bool,
    /// Say which tables there are and whether their files are up to date; build nothing
    #[arg(long, conflicts_with_all = ["plot", "accuracy"])]
    list: bool,
    /// Draw each table and its error
    #[arg(long)]
    plot: bool,
    /// Folder for the pictures
    #[arg(long, short, value_name = "FOLDER", default_value = "out/tables")]
    output: PathBuf,
    /// Measure every parametrisation and precision and write the report, with its plot beside it
    #[arg(long, value_name = "FILE.md")]
    accuracy: Option<PathBuf>,
    /// Folder of the tables
    #[arg(long, value_name = "FOLDER", default_value = tables::FOLDER)]
    folder: PathBuf,
}

#[derive(Clone, Copy, ValueEnum)]
enum Format {
    U8,
    U16,
    F16,
    F32,
}

impl From<Format> for Precision {
    fn from(format: Format) -> Self {
        match format {
            Format::U8 => Self::U8,
            Format::U16 => Self::U16,
            Format::F16 => Self::F16,
            Format::F32 => Self::F32,
        }
    }
}

fn parse_size(text: &str) -> Result<[u32; 3], String> {
    let sides: Result<Vec<u32>, _> = text.split('x').map(str::parse).collect();
    match sides.as_deref() {
        Ok(&[x, y]) => Ok([x, y, 1]),
        Ok(&[x, y, z]) => Ok([x, y, z]),
        _ => Err("two or three numbers of nodes joined by x, as 256x256".to_owned()),
    }
}

/// Whether every table that was checked is right.
pub(crate) fn run(args: &Args) -> Result<bool> {
    if let Some(path) = &args.accuracy {
        write_accuracy(path)?;
        return Ok(true);
    }
    let store = Store::new(&args.folder);
    let specs = specs(args)?;
    say!("{:18} {:>15} {:>5} {:>10} {:>10} {:>9} {:>9}  of", "table", "size", "", "max", "mean", "build", "measure");
    let mut right = true;
    let mut stored = Vec::new();
    let bar = progress::bar("tables", u32::try_from(specs.len())?);
    for spec in &specs {
        bar.set_message(spec.id.clone());
        if args.list {
            let state = store.read_metadata(spec).map(|metadata| metadata.error);
            match state {
                Ok(error) => bar.suspend(|| print_row(spec, &error, ["up to date".to_owned(), String::new()])),
                Err(error) => bar.suspend(|| say!("{:18} {error}", spec.id)),
            }
        } else if args.check {
            right &= bar.suspend(|| check(&store, spec))?;
        } else {
            stored.push(up_to_date(&store, spec, &bar)?);
        }
        bar.inc(1);
    }
    bar.finish_and_clear();
    if !stored.is_empty() {
        Manifest::add(&store, stored.iter().map(|table| &table.metadata))?;
    }
    if args.plot {
        stored.iter().try_for_each(|table| plot(&table.table, &args.output))?;
    }
    Ok(right)
}

fn specs(args: &Args) -> Result<Vec<TableSpec>> {
    let mut specs = match &args.only {
        Some(id) => vec![TableSpec::named(id)?],
        None => TableSpec::defaults(),
    };
    for spec in &mut specs {
        spec.size = args.size.unwrap_or(spec.size);
        spec.precision = args.precision.map_or(spec.precision, Precision::from);
        spec.validate()?;
    }
    Ok(specs)
}

fn print_row(spec: &TableSpec, error: &tetlux_tables::MeasuredError, [build, measure]: [String; 2]) {
    let size: Vec<String> = spec.size[..spec.axes().len()].iter().map(u32::to_string).collect();
    let (size, precision) = (size.join(" x "), spec.precision.name());
    say!(
        "{:18} {size:>15} {precision:>5} {:10.2e} {:10.2e} {build:>9} {measure:>9}  {}",
        spec.id,
        error.max,
        error.mean,
        error.quantity
    );
}

fn milliseconds(start: Instant) -> String {
    format!("{:.1} ms", start.elapsed().as_secs_f64() * 1e3)
}

/// The stored table if it is what it says, else a new one.
fn up_to_date(store: &Store, spec: &TableSpec, bar: &indicatif::ProgressBar) -> Result<StoredTable> {
    if let Ok(stored) = store.read(spec) {
        bar.suspend(|| print_row(spec, &stored.metadata.error, ["up to date".to_owned(), String::new()]));
        return Ok(stored);
    }
    let start = Instant::now();
    let table = Table::build(spec)?;
    let build_time = milliseconds(start);
    let start = Instant::now();
    let error = measure(&table)?;
    let measure_time = milliseconds(start);
    let stored = store.write(&table, &error)?;
    bar.suspend(|| print_row(spec, &error, [build_time, measure_time]));
    Ok(stored)
}

/// Whether the stored table is what would be built.
fn check(store: &Store, spec: &TableSpec) -> Result<bool> {
    let stored = match store.read(spec) {
        Ok(stored) => stored,
        Err(error) => {
            say!("{:18} {error}", spec.id);
            return Ok(false);
        }
    };
    let built = Table::build(spec)?;
    let (difference, tolerance) = (stored.table.difference(&built), spec.precision.rebuild_tolerance());
    let verdict = if difference <= tolerance { "right" } else { "WRONG" };
    say!("{:18} {verdict}: differs by {difference:.1e} of its largest value (tolerance {tolerance:.1e})", spec.id);
    Ok(difference <= tolerance)
}

fn plot(table: &Table, folder: &Path) -> Result<()> {
    let spec = table.spec();
    for (channel, name) in spec.channels().iter().enumerate() {
        let path = folder.join(format!("{}-{name}.png", spec.id));
        create_folder(&path)?;
        write_png(&value_picture(table, channel)?, &path, Encoding::Srgb)?;
        say!("{}", path.display());
    }
    let path = folder.join(format!("{}-error.png", spec.id));
    write_png(&error_picture(table)?, &path, Encoding::Srgb)?;
    say!("{}", path.display());
    Ok(())
}

fn write_accuracy(path: &Path) -> Result<()> {
    let plot = path.with_extension("svg");
    let (Some(name), true) = (plot.file_name().and_then(|name| name.to_str()), plot != path) else {
        bail!("{}: the report needs a name such as accuracy.md", path.display());
    };
    create_folder(path)?;
    let bar = progress::bar("accuracy", accuracy::SECTIONS);
    let report = accuracy::report(name, |section| {
        bar.set_message(section.to_owned());
        bar.inc(1);
    })?;
    bar.finish_and_clear();
    write_atomically(path, |file| file.write_all(report.markdown.as_bytes())).context("the report")?;
    write_atomically(&plot, |file| file.write_all(report.plot.as_bytes())).context("its plot")?;
    say!("{}\n{}", path.display(), plot.display());
    Ok(())
}
