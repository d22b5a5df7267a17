//! The program killed at random moments (SIGKILL: nothing of it runs any more), while tables, meshes, pictures and costs are
//! written.

use std::path::PathBuf;
use std::process::Stdio;
use std::time::{Duration, Instant};

use anyhow::{Context, Result, ensure};

use super::super::Stress;
use super::super::hostile::Random;
use super::Row;
use super::program::Program;

/// Kills of each command, in full and in short, and of the one that measures an adapter, which takes seconds.
const KILLS: [usize; 2] = [30, 2];
const KILLS_OF_MEASURING: [usize; 2] = [4, 0];

const SEED: u64 = 5;

/// A command, and what it writes.
struct Job {
    what: &'static str,
    args: &'static [&'static str],
    /// What is removed before, so that all is written.
    fresh: &'static [&'static str],
    /// Files that must be the same, whatever was killed before.
    outputs: &'static [&'static str],
    /// Folder and extension of a file whose name is not known before, likewise.
    stored: Option<(&'static str, &'static str)>,
    kills: [usize; 2],
}

const JOBS: [Job; 3] = [
    Job {
        what: "killed while tables are written",
        args: &["build-tables", "--folder", "tables", "--only", "q", "--size", "160x160"],
        fresh: &["tables"],
        outputs: &["tables/manifest.json"],
        stored: Some(("tables", "exr")),
        kills: KILLS,
    },
    Job {
        what: "killed while a mesh, its order and its picture are written",
        args: &["render", "grid.vtk", "--size", "160x120", "--backend", "cpu", "--output", "p.png"],
        fresh: &["cache"],
        outputs: &["p.png", "p.exr"],
        stored: Some(("cache", "tetlux-mesh")),
        kills: KILLS,
    },
    Job {
        what: "killed while an adapter is measured",
        args: &["render", "--grid", "20", "--size", "480x360", "--backend", "gpu", "--output", "g.png"],
        fresh: &["cache"],
        outputs: &[],
        stored: Some(("cache", "json")),
        kills: KILLS_OF_MEASURING,
    },
];

/// 27^3 cubes, 118 098 tetrahedra: a mesh that is kept between runs.
pub(super) fn large_grid() -> String {
    let values: String = (0..28 * 28 * 28).map(|i| format!("{} ", i % 7)).collect();
    format!(
        "# vtk DataFile Version 3.0\nlarge\nASCII\nDATASET STRUCTURED_POINTS\nDIMENSIONS 28 28 28\nORIGIN 0 0 0\n\
         SPACING 1 1 1\nPOINT_DATA 21952\nSCALARS f float\nLOOKUP_TABLE default\n{values}\n"
    )
}

pub(super) fn rows(stress: &Stress) -> Result<Vec<Row>> {
    let program = Program::new()?;
    program.write("grid.vtk", large_grid())?;
    let mut rows = Vec::new();
    for job in &JOBS {
        let kills = job.kills[usize::from(stress.short)];
        if kills > 0 && (stress.renderer.device().is_some() || !job.args.contains(&"gpu")) {
            rows.push(kill(&program, job, kills)?);
        }
    }
    Ok(rows)
}

/// What the job wrote: its outputs, and the stored file of its own name.
type Written = (Vec<Option<Vec<u8>>>, Option<PathBuf>);

fn written(program: &Program, job: &Job) -> Written {
    let stored = job.stored.and_then(|(folder, extension)| program.only(folder, extension).ok());
    (job.outputs.iter().map(|name| program.read(name)).collect(), stored)
}

fn kill(program: &Program, job: &Job, kills: usize) -> Result<Row> {
    let mut row = Row::new(job.what);
    let mut random = Random::new(SEED);
    let start = Instant::now();
    program.succeed(job.args).map_err(anyhow::Error::msg)?;
    let takes = start.elapsed();
    let expected = written(program, job);
    ensure!(expected.0.iter().all(Option::is_some) && expected.1.is_some(), "{}: it writes something else", job.what);
    let (mut in_writing, mut after) = (0, 0);
    for number in 0..kills {
        program.remove(job.fresh)?;
        let mut child = program.command(job.args).stdout(Stdio::null()).stderr(Stdio::null()).spawn()?;
        // Every other at a moment of its course, the rest as soon as it begins to write its first, second, ... file.
        let ended = if number % 2 == 0 {
            std::thread::sleep(takes.mul_f64(random.between(0.0, 1.1)));
            child.try_wait()?.is_some()
        } else {
            wait_for_files(program, &mut child, 1 + number / 2 % 4)?
        };
        child.kill().context("the child cannot be killed")?;
        child.wait()?;
        let unfinished = program.unfinished();
        in_writing += usize::from(!unfinished.is_empty());
        after += usize::from(ended);
        // What bears the name of a result is whole, or as it was before.
        let (outputs, _) = written(program, job);
        let torn = outputs.iter().zip(&expected.0).position(|(found, whole)| found.is_some() && found != whole);
        let mut held = torn.map_or(Ok(()), |which| Err(format!("{} is torn", job.outputs[which])));
        held = held.and(program.succeed(job.args).map_err(|failure| format!("the next run: {failure}")));
        let again = written(program, job);
        let same = again.0 == expected.0
            && again.1.as_ref().and_then(|p| p.file_name()) == expected.1.as_ref().and_then(|p| p.file_name());
        held = held.and(if same { Ok(()) } else { Err("the next run wrote something else".into()) });
        unfinished.iter().filter(|path| path.exists()).try_for_each(std::fs::remove_file)?;
        row.add(held.map_err(|failure| format!("kill {number}: {failure}")));
    }
    row.outcome = format!(
        "{in_writing} left a file unfinished, under a name that nothing reads; {after} came after the end; no result was torn; \
         each next run succeeded{}",
        if job.outputs.is_empty() { "" } else { " and wrote the same bytes" }
    );
    Ok(row)
}

/// Waits until a process has begun that many files, or ended; whether it has ended.
fn wait_for_files(program: &Program, child: &mut std::process::Child, files: usize) -> Result<bool> {
    let mut seen: Vec<PathBuf> = Vec::new();
    while child.try_wait()?.is_none() {
        for path in program.unfinished() {
            if !seen.contains(&path) {
                seen.push(path);
            }
        }
        if seen.len() >= files {
            return Ok(false);
        }
        std::thread::sleep(Duration::from_micros(100));
    }
    Ok(true)
}
