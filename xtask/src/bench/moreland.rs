//! Moreland and Angel, "A Fast High Accuracy Volume Renderer for Unstructured Data" (IEEE Symposium on Volume
//! Visualization and Graphics, 2004): Pentium 4 of 3.2 GHz, Quadro FX 3000, 800 x 800, nine control points.

use anyhow::Result;
use tetlux_render::Frame;
use tetlux_scene::{Backend, CellProjection, Classification, Integrator, Interpolation, Method};

use super::Bench;
use super::measure::{Cost, Course, Measured, Way};
use super::paper::{BLUNT_FIN, DELTA_WING, DataSet, OXYGEN_POST};
use super::table::{Cell, Table};

const SETS: [DataSet; 3] = [BLUNT_FIN, OXYGEN_POST, DELTA_WING];
const SIZE: [u32; 2] = [800, 800];

/// Luminance and extinction at the vertices, averaged: Shirley and Tuchman 1990.
fn averaged(m: &mut Method) {
    (m.backend, m.interpolation) = (Backend::Gpu, Interpolation::ScreenLinear);
    (m.integrator, m.classification) = (Integrator::Average, Classification::Vertex);
}

fn pre_integrated(m: &mut Method) {
    (m.backend, m.integrator) = (Backend::Gpu, Integrator::Preint);
}

fn sampled_adaptively(m: &mut Method) {
    (m.backend, m.projection, m.classification) = (Backend::Gpu, CellProjection::Balanced, Classification::PostClip);
}

/// Tables 2 and figure 9: each with the least integration that it was published with.
const PROJECTIONS: [Way; 5] = [
    ("Projected Tetrahedra", |m| {
        averaged(m);
        m.projection = CellProjection::Pt;
    }),
    ("GATOR", |m| {
        averaged(m);
        m.projection = CellProjection::Gator;
    }),
    ("View Independent Cell Projection", |m| {
        pre_integrated(m);
        m.projection = CellProjection::Vicp;
    }),
    ("Balanced Cell Projection", |m| {
        pre_integrated(m);
        m.projection = CellProjection::Balanced;
    }),
    ("Adaptive Sampling", |m| {
        sampled_adaptively(m);
        m.integrator = Integrator::Average;
    }),
];

/// Frames a second and thousands of tetrahedra a second of table 2, by data set.
const PROJECTION_RATES: [[[f64; 2]; 5]; 3] = [
    [[11.935, 2236.0], [2.618, 490.0], [3.051, 572.0], [4.090, 766.0], [1.276, 318.0]],
    [[4.872, 2501.0], [0.674, 346.0], [1.325, 680.0], [2.090, 1073.0], [0.578, 383.0]],
    [[2.489, 2503.0], [0.316, 318.0], [0.702, 706.0], [1.396, 1404.0], [0.408, 561.0]],
];

const INTEGRATORS: [Way; 3] = [
    ("Average Luminance and Attenuation", |m| {
        sampled_adaptively(m);
        m.integrator = Integrator::Average;
    }),
    ("Linear Luminance and Attenuation", |m| {
        sampled_adaptively(m);
        m.integrator = Integrator::Linear;
    }),
    ("Partial Pre-Integration", |m| {
        sampled_adaptively(m);
        m.integrator = Integrator::Psi;
    }),
];

/// The same of table 3.
const INTEGRATOR_RATES: [[[f64; 2]; 3]; 3] = [
    [[1.276, 318.0], [0.094, 22.0], [0.867, 216.0]],
    [[0.578, 383.0], [0.044, 29.0], [0.398, 264.0]],
    [[0.408, 561.0], [0.036, 49.0], [0.301, 414.0]],
];

/// What we draw by default, which no paper has.
const OURS: [Way; 2] = [
    ("here: march", |m| (m.backend, m.projection) = (Backend::Gpu, CellProjection::March)),
    ("here: the default", |_| ()),
];

/// Table 1: how many tetrahedra adaptive sampling draws.
pub(crate) fn growth(bench: &Bench) -> Result<Table> {
    const THEIRS: [[usize; 2]; 3] = [[187_395, 249_278], [513_375, 662_625], [1_005_675, 1_373_010]];
    let mut rows = Vec::new();
    let mut sources = Vec::new();
    for (set, theirs) in SETS.iter().zip(THEIRS) {
        // How many are drawn does not depend on the number of pixels.
        let (input, source) = set.input(bench, [64; 2])?;
        let adaptive: Way = ("adaptive sampling", |m| {
            sampled_adaptively(m);
            m.integrator = Integrator::Psi;
        });
        let (_, plan, frame) = Course::new(&input, bench).start(adaptive)?;
        let percent =
            |[before, after]: [usize; 2]| Cell::from(format!("{:.0} %", (after as f64 / before as f64 - 1.0) * 100.0));
        let ours = [plan.cells.len(), frame.resources.cells];
        let [a, b] = theirs.map(Cell::from);
        let [c, d] = ours.map(Cell::from);
        rows.push(vec![set.name.into(), a, b, percent(theirs), c, d, percent(ours)]);
        sources.push(format!("{}: {source}", set.name));
    }
    Ok(Table {
        name: "moreland-1",
        title: "Moreland and Angel 2004, table 1: growth in data sets by adaptive sampling".into(),
        notes: vec![format!(
            "Ours counts cells that are not transparent throughout. Ours are of {}.",
            sources.join(", ")
        )],
        head: ["data set", "tetrahedra", "rendered", "growth", "ours: tetrahedra", "rendered", "growth"]
            .map(String::from)
            .into(),
        rows,
    })
}

/// Table 2: frames and tetrahedra a second by projection.
pub(crate) fn projections(bench: &Bench) -> Result<Table> {
    rates(bench, "moreland-2", "table 2: cell projection", &PROJECTIONS, PROJECTION_RATES.map(|set| set.to_vec()))
}

/// Table 3: the same by integrator.
pub(crate) fn integrators(bench: &Bench) -> Result<Table> {
    rates(bench, "moreland-3", "table 3: ray integration", &INTEGRATORS, INTEGRATOR_RATES.map(|set| set.to_vec()))
}

/// Frames and thousands of tetrahedra a second, and processor milliseconds.
fn figures(found: Measured) -> [Cell; 3] {
    match found {
        Ok((cost, frame)) => {
            let rate = frame.resources.cells as f64 / cost.wall_seconds * 1e-3;
            [(1.0 / cost.wall_seconds).into(), rate.into(), (cost.seconds() * 1e3).into()]
        }
        Err(why) => [why.into(), Cell::Unknown, Cell::Unknown],
    }
}

fn rates(bench: &Bench, name: &'static str, what: &str, ways: &[Way], theirs: [Vec<[f64; 2]>; 3]) -> Result<Table> {
    let size = bench.paper_size(SIZE);
    let mut rows = Vec::new();
    for (set, theirs) in SETS.iter().zip(theirs) {
        let (input, source) = set.input(bench, size)?;
        let mut course = Course::new(&input, bench);
        let all: Vec<Way> = ways.iter().chain(&OURS).copied().collect();
        let costs = course.costs(all.iter().copied(), bench.runs)?;
        for (i, (way, found)) in all.iter().zip(costs).enumerate() {
            let rate = theirs.get(i).copied();
            let model = format!("{} ({source})", set.name);
            let theirs = [model.into(), way.0.into(), rate.map(|r| r[0]).into(), rate.map(|r| r[1]).into()];
            rows.push([theirs.to_vec(), figures(found).to_vec()].concat());
        }
    }
    Ok(Table {
        name,
        title: format!("Moreland and Angel 2004, {what}"),
        notes: vec![bench.paper_note(size, SIZE)],
        head: ["model", "method", "fps", "ktet/s", "ours: fps", "ours: ktet/s", "ours: CPU ms"]
            .map(String::from)
            .into(),
        rows,
    })
}

/// Figure 5: how many cells a random control point splits.
pub(crate) fn splits(bench: &Bench) -> Result<Table> {
    const POINTS: usize = 1000;
    let mut rows = Vec::new();
    for set in &SETS {
        let (input, source) = set.input(bench, [64; 2])?;
        let ranges = input.mesh.scalar_ranges(&input.scene.scalar);
        let [low, high] = input.scene.scalar.range;
        let mut shares: Vec<f64> = (0..POINTS)
            .map(|i| {
                let point = low + (high - low) * (i as f64 + 0.5) / POINTS as f64;
                let split = ranges.iter().filter(|[low, high]| *low < point && point < *high).count();
                split as f64 / ranges.len().max(1) as f64 * 100.0
            })
            .collect();
        shares.sort_by(f64::total_cmp);
        let mean = shares.iter().sum::<f64>() / POINTS as f64;
        let ours = [mean, shares[0], shares[POINTS / 2], shares[POINTS - 1]].map(Cell::from);
        rows.push([vec![set.name.into(), source.into(), "about 2.5".into()], ours.to_vec()].concat());
    }
    Ok(Table {
        name: "moreland-fig5",
        title: "Moreland and Angel 2004, figure 5: cells that a control point splits, in per cent".into(),
        notes: vec![format!(
            "Theirs is a scatter plot and its mean over three data sets; ours {POINTS} control points at equal distances over \
             the field's range."
        )],
        head: ["data set", "ours is of", "theirs: mean", "ours: mean", "least", "median", "most"]
            .map(String::from)
            .into(),
        rows,
    })
}

/// Figure 9: rates against the size of the picture.
pub(crate) fn sizes(bench: &Bench) -> Result<Table> {
    let all = [50, 100, 200, 400, 800];
    let largest = bench.paper_size(SIZE)[0].max(50);
    let sizes: Vec<u32> = all.into_iter().filter(|&side| side <= largest).collect();
    let (input, source) = BLUNT_FIN.input(bench, SIZE)?;
    let mut course = Course::new(&input, bench);
    let all: Vec<Way> = PROJECTIONS.iter().chain(&OURS).copied().collect();
    let theirs = |i: usize| PROJECTION_RATES[0].get(i).map(|rate| rate[1] * 1e-3);
    let mut rows: Vec<Vec<Cell>> = (0..all.len()).map(|i| vec![all[i].0.into(), theirs(i).into()]).collect();
    for &side in &sizes {
        course.scene.size = [side; 2];
        for (row, found) in rows.iter_mut().zip(course.costs(all.iter().copied(), bench.runs)?) {
            let rate = |(cost, frame): (Cost, Frame)| frame.resources.cells as f64 / cost.wall_seconds * 1e-6;
            row.push(found.map_or_else(Cell::from, |found| rate(found).into()));
        }
    }
    let head = ["method", "theirs: 800 x 800"].map(String::from).into_iter();
    Ok(Table {
        name: "moreland-fig9",
        title: "Moreland and Angel 2004, figure 9: millions of tetrahedra a second against the picture's size".into(),
        notes: vec![
            format!("Blunt Fin: ours is of {source}, on {}.", bench.adapter()),
            "Theirs is a plot whose last points are those of table 2; rates hold up to 200 x 200 and fall from there on, but \
             for Projected Tetrahedra and GATOR, which do not fall."
                .into(),
        ],
        head: head.chain(sizes.iter().map(|side| format!("ours: {side} x {side}"))).collect(),
        rows,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_way_can_be() {
        for (name, change) in PROJECTIONS.iter().chain(&INTEGRATORS).chain(&OURS) {
            let mut method = Method::default();
            change(&mut method);
            assert_eq!(method.refusal(), None, "{name}");
        }
    }

    #[test]
    fn published_rates_agree_with_published_cell_counts() {
        // Frames a second times cells; to the digits printed.
        for (set, rates) in SETS.iter().zip(PROJECTION_RATES) {
            for [fps, rate] in rates.into_iter().take(4) {
                assert!((fps * set.cells as f64 * 1e-3 / rate - 1.0).abs() < 2e-3, "{} {fps} {rate}", set.name);
            }
        }
    }
}
