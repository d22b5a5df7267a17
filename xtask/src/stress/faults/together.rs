//! Two processes that do the same at once, in the same folders.

use std::fs;

use anyhow::Result;
use tetlux_tables::{Manifest, Store};

use super::super::Stress;
use super::Row;
use super::kill::large_grid;
use super::program::{Program, succeeded};

/// Times that they are started, in full and in short.
const ROUNDS: [usize; 2] = [8, 1];

pub(super) fn rows(stress: &Stress) -> Result<Vec<Row>> {
    let rounds = ROUNDS[usize::from(stress.short)];
    let program = Program::new()?;
    program.write("grid.vtk", large_grid())?;
    Ok(vec![tables(&program, rounds)?, manifest(&program, rounds)?, meshes(&program, rounds)?])
}

/// Runs two commands at once.
fn both(program: &Program, commands: [&[&str]; 2]) -> Result<(), String> {
    let spawn = |args| program.command(args).spawn().map_err(|error| error.to_string());
    let [first, second] = [spawn(commands[0])?, spawn(commands[1])?];
    for child in [first, second] {
        succeeded(&child.wait_with_output().map_err(|error| error.to_string())?)?;
    }
    let left = program.unfinished();
    if left.is_empty() { Ok(()) } else { Err(format!("{left:?} is left")) }
}

fn tables(program: &Program, rounds: usize) -> Result<Row> {
    let mut row = Row::new("two processes build the same table");
    let args = ["build-tables", "--folder", "tables", "--only", "q", "--size", "96x96"];
    program.succeed(&args).map_err(anyhow::Error::msg)?;
    let expected = fs::read(program.only("tables", "exr")?)?;
    for _ in 0..rounds {
        program.remove(&["tables"])?;
        let held = both(program, [&args, &args]);
        let same = fs::read(program.only("tables", "exr")?)? == expected;
        row.add(held.and(if same { Ok(()) } else { Err("another table".into()) }));
    }
    row.outcome = "both succeed, and the table is that of one alone, byte for byte".into();
    Ok(row)
}

/// Tables of two names: the list of them has both.
fn manifest(program: &Program, rounds: usize) -> Result<Row> {
    let mut row = Row::new("two processes build two tables in one folder");
    let args = |name: &'static str| ["build-tables", "--folder", "tables", "--only", name, "--size", "24x24"];
    for _ in 0..rounds {
        program.remove(&["tables"])?;
        let held = both(program, [&args("q"), &args("psi")]);
        let listed = Manifest::read(&Store::new(program.path("tables"))).tables.len();
        row.add(held.and(if listed == 2 { Ok(()) } else { Err(format!("{listed} are listed, not 2")) }));
    }
    row.outcome = "both succeed, and the manifest lists both tables".into();
    Ok(row)
}

fn meshes(program: &Program, rounds: usize) -> Result<Row> {
    let mut row = Row::new("two processes keep the same mesh");
    let args = ["render", "grid.vtk", "--size", "80x60", "--backend", "cpu", "--output", "p.png"];
    program.succeed(&args).map_err(anyhow::Error::msg)?;
    let expected = program.read("p.exr");
    for _ in 0..rounds {
        program.remove(&["cache"])?;
        let held = both(program, [&args, &args]);
        // And then from what was kept.
        let held = held.and(program.succeed(&args));
        let same = program.read("p.exr") == expected;
        row.add(held.and(if same { Ok(()) } else { Err("another picture".into()) }));
    }
    row.outcome = "both succeed, one mesh is kept, and the picture of it is the same byte for byte".into();
    Ok(row)
}
