//! Disks that are full, and folders that cannot be written to.

use std::fs;
use std::path::Path;

use anyhow::Result;

use super::super::Stress;
use super::Row;
use super::program::{Program, failed, run, succeeded, symlink};

/// Commands that write, and what they write.
const WRITERS: [(&[&str], &[&str]); 2] = [
    (
        &["render", "--grid", "3", "--size", "240x180", "--backend", "cpu", "--output", "p.png", "--json", "p.json"],
        &["p.exr", "p.png", "p.json"],
    ),
    (&["build-tables", "--folder", "tables", "--only", "q", "--size", "48x48"], &[]),
];

/// Units of 512 bytes that a file may have, doubled until all fits.
const FIRST_LIMIT: u64 = 1;

pub(super) fn rows(_: &Stress) -> Result<Vec<Row>> {
    if !cfg!(unix) {
        let outcome = "not tried: the system has no limit of files".into();
        return Ok(vec![Row { outcome, ..Row::new("the disk is full") }]);
    }
    let program = Program::new()?;
    Ok(vec![full(&program)?, full_device(&program), full_cache(&program)?, not_writable(&program)?])
}

/// The disk is full at one place after another of what is written: files may not grow beyond a limit.
fn full(program: &Program) -> Result<Row> {
    let mut row = Row::new("the disk is full at some byte of the results");
    for (args, outputs) in WRITERS {
        let mut limit = FIRST_LIMIT;
        loop {
            program.remove(&["tables"])?;
            outputs.iter().try_for_each(|name| program.write(name, "earlier"))?;
            let output = run(program.after(&format!("trap '' XFSZ; ulimit -f {limit}"), args));
            let output = output.map_err(anyhow::Error::msg)?;
            let done = output.status.success();
            let mut held = if done { Ok(()) } else { failed(&output, &["p.png", "p.exr", "p.json", "tables"]) };
            // Each is whole, or what it was: the next run finds out that what it writes is the same.
            let written: Vec<_> = outputs.iter().map(|name| program.read(name)).collect();
            let left = program.unfinished();
            held = held.and(if left.is_empty() { Ok(()) } else { Err(format!("{left:?} is left")) });
            let tables = if args[0] == "build-tables" { program.only("tables", "exr").ok() } else { None };
            let table = tables.map(|path| (fs::read(&path), path));
            held = held.and(program.succeed(args));
            for (name, written) in outputs.iter().zip(written).filter(|(name, _)| !name.ends_with("json")) {
                let whole = written == program.read(name) || written.as_deref() == Some(b"earlier");
                held = held.and(if whole { Ok(()) } else { Err(format!("{name} is neither whole nor what it was")) });
            }
            if let Some((Ok(bytes), path)) = table {
                let whole = fs::read(&path)? == bytes;
                held = held.and(if whole { Ok(()) } else { Err("a table was not written whole".into()) });
            }
            row.add(held.map_err(|failure| format!("{} in {limit} units: {failure}", args[0])));
            if done {
                break;
            }
            limit *= 2;
        }
    }
    row.outcome =
        "status 2 and the name of the file; the earlier file stays, or the new one is whole; none unfinished is left; \
                   the next run succeeds"
            .into();
    Ok(row)
}

/// A device that is always full, and one that takes everything: neither may be replaced by a file. They are named by links
/// in the program's own folder, so that no failure could reach the devices themselves.
fn full_device(program: &Program) -> Row {
    let mut row = Row::new("a device in place of a file");
    for (name, device, full) in [("full.json", "/dev/full", true), ("null.json", "/dev/null", false)] {
        let link = program.path(name);
        if !is_device(Path::new(device)) || !symlink(device, &link) {
            continue;
        }
        let args =
            ["render", "--grid", "2", "--size", "20x20", "--backend", "cpu", "--output", "d.png", "--json", name];
        let held = run(program.command(&args));
        let held = held.and_then(|output| if full { failed(&output, &[name]) } else { succeeded(&output) });
        row.add(held.and(if is_device(&link) { Ok(()) } else { Err(format!("{device} would be a file now")) }));
    }
    row.outcome = "written to and not replaced; where it is full, status 2 and its name".into();
    row
}

/// Whether what is at a path, if need be behind links, is there and neither file nor folder.
fn is_device(path: &Path) -> bool {
    fs::metadata(path).is_ok_and(|metadata| !metadata.is_file() && !metadata.is_dir())
}

/// What is kept between runs does not fit: no fault of the picture's.
fn full_cache(program: &Program) -> Result<Row> {
    let mut row = Row::new("the disk is full where a mesh is to be kept");
    program.write("grid.vtk", super::kill::large_grid())?;
    for limit in [0, 64, 2_048] {
        program.remove(&["cache"])?;
        let output = run(program.after(&format!("trap '' XFSZ; ulimit -f {limit}"), &["info", "grid.vtk"]));
        let output = output.map_err(anyhow::Error::msg)?;
        let told = String::from_utf8_lossy(&output.stdout).contains("cannot be used");
        let held = succeeded(&output).and(if told { Ok(()) } else { Err("it is not told".into()) });
        let left = program.unfinished();
        row.add(held.and(if left.is_empty() { Ok(()) } else { Err(format!("{left:?} is left")) }));
    }
    row.outcome = "the mesh is used, and that it is not kept is told; nothing unfinished is left".into();
    Ok(row)
}

/// Folders where no file can be made: a file where the folder is to be and, for whom permissions bind, one without them.
fn not_writable(program: &Program) -> Result<Row> {
    let mut row = Row::new("a folder that cannot be written to");
    program.write("file", "kept")?;
    let mut folders = vec!["file"];
    let binding = read_only(&program.path("bound"))?;
    if binding {
        folders.push("bound");
    }
    if cfg!(target_os = "linux") {
        folders.push("/proc");
    }
    for folder in &folders {
        let picture = format!("{folder}/p.png");
        let render = ["render", "--grid", "2", "--size", "20x20", "--backend", "cpu"];
        let held = run(program.command(&[&render[..], &["--output", &picture]].concat()));
        row.add(held.and_then(|output| failed(&output, &[folder])));
        let tables = ["build-tables", "--only", "q", "--size", "8x8", "--folder", folder];
        let held = run(program.command(&tables));
        row.add(held.and_then(|output| failed(&output, &[folder])));
        let mut command = program.command(&["info", "grid.vtk"]);
        command.env("TETLUX_CACHE_DIR", program.path(folder));
        row.add(run(command).and_then(|output| succeeded(&output)));
    }
    let kept = program.read("file").as_deref() == Some(b"kept");
    row.add(if kept { Ok(()) } else { Err("the file in the folder's place was changed".into()) });
    let bound = if binding { "a folder without permissions, " } else { "" };
    let unbound = if binding { "" } else { " (permissions do not bind who ran this)" };
    row.outcome = format!(
        "a file in the folder's place, {bound}the system's own: status 2 and its name; where a mesh was to be kept, none \
         is{unbound}"
    );
    Ok(row)
}

/// Makes a folder without permission to write; whether that binds this user.
fn read_only(folder: &Path) -> Result<bool> {
    fs::create_dir(folder)?;
    let mut permissions = fs::metadata(folder)?.permissions();
    permissions.set_readonly(true);
    fs::set_permissions(folder, permissions)?;
    Ok(fs::write(folder.join("try"), "").is_err())
}
