//! tetlux at the command line. It parses, calls and prints; the work is done in the crates.

#[macro_use]
mod output;

mod bench;
mod build_tables;
mod cache;
mod calibration;
mod compare;
mod explain;
mod histogram;
mod info;
mod input;
mod machine;
mod memory;
mod mesh_args;
mod methods;
mod order;
mod progress;
mod render;
mod report;
mod sequence;
mod stress;
mod tables;
mod test;
mod testbed;
mod truth;

use std::process::ExitCode;

use clap::{Parser, Subcommand};

/// Direct volume rendering of tetrahedral meshes, with an error it can state.
#[derive(Parser)]
#[command(name = "cargo xtask", version, max_term_width = 110)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Render a scene to a PNG and a linear EXR; without a scene file, the built-in one
    #[command(after_help = render::EXAMPLES)]
    Render(render::Args),
    /// Measure a picture's error: a scene against the f64 reference, or one EXR file against another
    #[command(after_help = compare::EXAMPLES)]
    Compare(compare::Args),
    /// Build the tables of ray-segment integrals, and state the error of each
    #[command(after_help = build_tables::EXAMPLES)]
    BuildTables(build_tables::Args),
    /// Draw how much of a mesh lies where over its two fields, with the scene's widgets, and say how narrow bands may be
    #[command(after_help = histogram::EXAMPLES)]
    Histogram(histogram::Args),
    /// Say what a mesh file holds, and what is wrong with it
    #[command(after_help = info::EXAMPLES)]
    Info(info::Args),
    /// List the meshes that are kept between runs, or remove them
    #[command(after_help = cache::EXAMPLES)]
    Cache(cache::Args),
    /// Judge visibility orders along rays: inversions, cycles, times, and what they do to the picture
    #[command(after_help = order::EXAMPLES)]
    Order(order::Args),
    /// Render the literature's artifacts beside their cures, and write a page of them with their errors
    #[command(after_help = testbed::EXAMPLES)]
    Testbed(testbed::Args),
    /// Measure every method by name: its error and its cost, as a table in a page
    #[command(after_help = methods::EXAMPLES)]
    Methods(methods::Args),
    /// Time methods against their error, beside their peers and the papers' own tables
    #[command(after_help = bench::EXAMPLES)]
    Bench(bench::Args),
    /// Try hard geometry, optics, faults, hostile input and long runs, and write a page of what held
    #[command(after_help = stress::EXAMPLES)]
    Stress(stress::Args),
    #[command(hide = true)]
    StressCases(stress::CasesArgs),
    #[command(hide = true)]
    StressNoMemory,
    /// Run format, lints, all tests and the documentation; installs a Vulkan driver on Debian if there is none
    Test,
}

fn main() -> ExitCode {
    let result = match Cli::parse().command {
        Command::Render(args) => render::run(&args).map(|()| true),
        Command::Compare(args) => compare::run(&args),
        Command::BuildTables(args) => build_tables::run(&args),
        Command::Histogram(args) => histogram::run(&args).map(|()| true),
        Command::Info(args) => info::run(&args).map(|()| true),
        Command::Cache(args) => cache::run(&args).map(|()| true),
        Command::Order(args) => order::run(&args),
        Command::Testbed(args) => testbed::run(&args).map(|()| true),
        Command::Methods(args) => methods::run(&args).map(|()| true),
        Command::Bench(args) => bench::run(&args).map(|()| true),
        Command::Stress(args) => stress::run(&args),
        Command::StressCases(args) => stress::run_cases(&args).map(|()| true),
        Command::StressNoMemory => stress::run_without_memory().map(|()| true),
        Command::Test => test::run().map(|()| true),
    };
    match result {
        Ok(true) => ExitCode::SUCCESS,
        // The figures that were printed say why.
        Ok(false) => ExitCode::FAILURE,
        Err(error) => {
            // Most errors name their cause themselves: it is said once.
            let message = error
                .chain()
                .map(ToString::to_string)
                .reduce(|said, cause| if said.contains(&cause) { said } else { format!("{said}: {cause}") });
            eprintln!("error: {}", message.unwrap_or_default());
            ExitCode::from(2)
        }
    }
}
