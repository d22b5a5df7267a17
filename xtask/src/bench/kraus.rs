//! Kraus, Qiao and Ebert, "Projecting Tetrahedra without Rendering Artifacts" (IEEE Visualization 2004): Athlon 64 3400+,
//! Quadro FX 3000, 800 x 600, tables of 256 x 256 x 16.

use anyhow::Result;
use tetlux_scene::{Backend, CellProjection, Integrator, Interpolation, Method, TablePrecision, Target};

use super::Bench;
use super::measure::{Course, Way};
use super::paper::{BLUNT_FIN, CYLINDER, HEAT_SINK, X38};
use super::table::{Cell, Table};

const SIZE: [u32; 2] = [800, 600];

fn basic(m: &mut Method) {
    (m.backend, m.projection, m.interpolation) = (Backend::Gpu, CellProjection::Pt, Interpolation::ScreenLinear);
    (m.integrator, m.table_precision, m.target) = (Integrator::Preint, TablePrecision::U8, Target::Rgba8);
}

fn in_perspective(m: &mut Method) {
    basic(m);
    m.interpolation = Interpolation::Perspective;
}

fn of_16_bits(m: &mut Method) {
    in_perspective(m);
    m.table_precision = TablePrecision::U16;
}

fn logarithmic(m: &mut Method) {
    of_16_bits(m);
    m.integrator = Integrator::PreintLog;
}

/// Each with what the one before it has, but for the last, which dithers no more; and its seconds.
const ENHANCEMENTS: [(Way, f64); 6] = [
    (("basic pre-integrated PT", basic), 0.195),
    (("+ perspective interpolation", in_perspective), 0.243),
    (("+ 16-bit lookup textures", of_16_bits), 0.274),
    (("+ logarithmic lookup", logarithmic), 0.314),
    (
        ("+ alpha dithering", |m| {
            logarithmic(m);
            m.target = Target::Rgba8Dither;
        }),
        0.621,
    ),
    (
        ("floating-point color buffer", |m| {
            logarithmic(m);
            m.target = Target::Auto;
        }),
        1.781,
    ),
];

/// What we draw by default, which the paper does not have.
const OURS: Way = ("here: the default", |_| ());

/// Table 1: what each enhancement costs.
pub(crate) fn enhancements(bench: &Bench) -> Result<Table> {
    let size = bench.paper_size(SIZE);
    let (input, source) = BLUNT_FIN.input(bench, size)?;
    let mut course = Course::new(&input, bench);
    let ways = ENHANCEMENTS.iter().map(|(way, _)| *way).chain([OURS]);
    let costs = course.costs(ways.clone(), bench.runs)?;
    let theirs = ENHANCEMENTS.iter().map(|(_, seconds)| Some(*seconds)).chain([None]);
    // Each over that of the basic algorithm.
    let theirs_basic = ENHANCEMENTS[0].1;
    let ours_basic = costs.first().and_then(|found| found.as_ref().ok()).map(|(cost, _)| cost.wall_seconds);
    let rows = ways.zip(theirs).zip(costs).map(|(((name, _), theirs), found)| {
        let ours = match found {
            Ok((cost, _)) => {
                let wall = cost.wall_seconds;
                [wall.into(), ours_basic.map(|basic| wall / basic).into(), cost.cpu_seconds.into()]
            }
            Err(why) => [why.into(), Cell::Unknown, Cell::Unknown],
        };
        let ratio = theirs.map(|seconds| seconds / theirs_basic);
        [vec![name.into(), theirs.into(), ratio.into()], ours.to_vec()].concat()
    });
    Ok(Table {
        name: "kraus-1",
        title: "Kraus, Qiao and Ebert 2004, table 1: seconds a frame of the Blunt Fin".into(),
        notes: vec![
            bench.paper_note(size, SIZE),
            format!("Ours is of {source}. Their table has the overhead of each enhancement; here they are added up."),
        ],
        head: ["technique", "theirs: s", "ratio", "ours: s", "ratio", "ours: CPU s"].map(String::from).into(),
        rows: rows.collect(),
    })
}

/// Table 2: seconds and tetrahedra a second by data set.
pub(crate) fn data_sets(bench: &Bench) -> Result<Table> {
    let size = bench.paper_size(SIZE);
    let sets = [(HEAT_SINK, 0.252, 483.0), (BLUNT_FIN, 0.314, 597.0), (CYLINDER, 0.929, 673.0), (X38, 3.07, 633.0)];
    let mut rows = Vec::new();
    for (set, seconds, rate) in sets {
        let (input, source) = set.input(bench, size)?;
        let mut course = Course::new(&input, bench);
        let ways: [Way; 2] = [("as published", logarithmic), OURS];
        let costs = course.costs(ways, bench.runs)?;
        for ((way, theirs), found) in ways.iter().zip([Some((seconds, rate)), None]).zip(costs) {
            let ours = match found {
                Ok((cost, frame)) => {
                    let (cells, wall) = (frame.resources.cells, cost.wall_seconds);
                    [cells.into(), wall.into(), (cells as f64 / wall * 1e-3).into(), cost.cpu_seconds.into()]
                }
                Err(why) => [input.mesh.cells().len().into(), why.into(), Cell::Unknown, Cell::Unknown],
            };
            let published: [Cell; 5] = [
                format!("{} ({source})", set.name).into(),
                way.0.into(),
                theirs.map(|_| set.cells as f64).into(),
                theirs.map(|t| t.0).into(),
                theirs.map(|t| t.1).into(),
            ];
            rows.push([published.to_vec(), ours.to_vec()].concat());
        }
    }
    let head = [
        "data set",
        "method",
        "tetrahedra",
        "s",
        "ktet/s",
        "ours: tetrahedra",
        "ours: s",
        "ours: ktet/s",
        "ours: CPU s",
    ];
    Ok(Table {
        name: "kraus-2",
        title: "Kraus, Qiao and Ebert 2004, table 2: perspective interpolation, logarithmic 16-bit lookup".into(),
        notes: vec![bench.paper_note(size, SIZE)],
        head: head.map(String::from).into(),
        rows,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_way_can_be_and_the_published_overheads_add_up() {
        for ((name, change), _) in ENHANCEMENTS {
            let mut method = Method::default();
            change(&mut method);
            assert_eq!(method.refusal(), None, "{name}");
        }
        let overheads = [0.195, 0.048, 0.031, 0.040];
        let mut sum = 0.0;
        for ((_, total), overhead) in ENHANCEMENTS.iter().zip(overheads) {
            sum += overhead;
            assert!((total - sum).abs() < 1e-9, "{total} {sum}");
        }
    }
}
