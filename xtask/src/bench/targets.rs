//! The targets, and whether what was measured meets them.

use serde::Serialize;

use super::measure::Cost;
use super::race::{AVX2, DEFAULT, Race};
use super::scaling::{Grown, MeshPoint, Scaling};
use super::table::number;

#[derive(Serialize)]
pub(crate) struct Target {
    pub(crate) what: String,
    pub(crate) goal: String,
    pub(crate) found: String,
    pub(crate) verdict: Verdict,
}

#[derive(Serialize, Clone, Copy, PartialEq, Eq, Debug)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum Verdict {
    Met,
    Missed,
    NotMeasured,
}

impl Verdict {
    pub(crate) fn words(self) -> &'static str {
        match self {
            Verdict::Met => "met",
            Verdict::Missed => "**missed**",
            Verdict::NotMeasured => "not measured",
        }
    }
}

/// Largest error at which speed counts.
const EXACT: f64 = 1e-4;
/// Of the exponent of growth: what a cache that is too small adds to a linear one.
const LINEAR: f64 = 1.15;
/// Sizes of meshes are met to a tenth.
const ABOUT: f64 = 1.15;

/// Scene, and the goals: the shares of the processor seconds of projected tetrahedra and of Bunyk's ray cast.
const RATIOS: [(&str, f64, f64); 4] = [
    ("bluntfin-smooth", 8.0, 70.0),
    ("post-smooth", 9.0, 70.0),
    ("bluntfin-spiky", 15.0, 150.0),
    ("post-spiky", 15.0, 150.0),
];
/// Scenes whose goal in wall seconds is this share of those of projected tetrahedra.
const WALL: [(&str, f64); 2] = [("bluntfin-smooth", 9.0), ("post-smooth", 9.0)];
/// Cells; milliseconds for the order of a view, and for a mesh to be ready.
const PER_MESH: [(usize, f64, f64); 3] = [(187_000, 6.0, 15.0), (513_000, 18.0, 45.0), (2_000_000, 65.0, 250.0)];

pub(crate) fn targets(races: &[Race], scaling: &Scaling, hardware: bool) -> Vec<Target> {
    let mut all = Vec::new();
    for (scene, projected, cast) in RATIOS {
        for (rival, title, goal) in
            [("pt", "VTK projected tetrahedra", projected), ("bunyk-partial", "VTK Bunyk", cast)]
        {
            all.push(ratio(races, scene, (rival, title), goal, "processor seconds", Cost::seconds));
        }
    }
    for (scene, goal) in WALL {
        let rival = ("pt", "VTK projected tetrahedra");
        all.push(ratio(races, scene, rival, goal, "wall seconds", |cost| cost.wall_seconds));
    }
    all.push(of_avx2(races));
    all.extend(of_growth(scaling));
    all.push(of_device(races, hardware));
    all.push(of_transfer_function(races));
    for (cells, order, ready) in PER_MESH {
        let what = [format!("exact order of a view, {cells} cells, one thread"), format!("mesh ready, {cells} cells")];
        let goals = [order, ready].map(|ms| format!("<= {ms} ms"));
        let Some(point) = near(&scaling.cells, cells) else {
            all.extend(what.into_iter().zip(goals).map(|(what, goal)| not_measured(&what, &goal, "a quick run")));
            continue;
        };
        let took = grown(point, "CPU").map_or(0.0, |way| way.cost.stage("order")) * 1e3;
        let wall = point.assemble_wall_seconds * 1e3;
        let cpu = point.assemble_cpu_seconds.unwrap_or(point.assemble_wall_seconds) * 1e3;
        let [order_what, ready_what] = what;
        let [order_goal, ready_goal] = goals;
        all.push(judged(order_what, order_goal, took <= order, format!("{} ms CPU", number(took))));
        all.push(judged(
            ready_what,
            ready_goal,
            wall <= ready,
            format!("{} ms wall, {} CPU", number(wall), number(cpu)),
        ));
    }
    all
}

fn judged(what: String, goal: String, met: bool, found: String) -> Target {
    Target { what, goal, found, verdict: if met { Verdict::Met } else { Verdict::Missed } }
}

fn not_measured(what: &str, goal: &str, why: &str) -> Target {
    Target { what: what.into(), goal: goal.into(), found: why.into(), verdict: Verdict::NotMeasured }
}

/// The default's share of a rival's time on a scene.
fn ratio(
    races: &[Race],
    scene: &str,
    (rival, title): (&str, &str),
    goal: f64,
    unit: &str,
    seconds: fn(&Cost) -> f64,
) -> Target {
    let (what, bound) = (format!("{scene}: {unit}, share of {title}"), format!("<= 1/{goal}, error <= {EXACT:.0e}"));
    let race = races.iter().find(|race| race.name == scene);
    let pair = race.and_then(|race| race.entry(DEFAULT).zip(race.rival(rival)));
    let Some((ours, theirs)) = pair else {
        return not_measured(&what, &bound, "needs --data and --peer vtk");
    };
    let times = seconds(&theirs.cost) / seconds(&ours.cost);
    let met = times >= goal && ours.error.max <= EXACT;
    let spent = if met { String::new() } else { format!("; {}", spent(&ours.cost)) };
    let found = format!("1/{}, error {:.1e}{spent}", number(times), ours.error.max);
    judged(what, bound, met, found)
}

/// Where most of the time goes.
fn spent(cost: &Cost) -> String {
    let mut stages: Vec<_> = cost.stages.iter().map(|stage| (cost.stage(stage.name), stage.name)).collect();
    stages.sort_by(|a, b| b.0.total_cmp(&a.0));
    let share = |(seconds, name): &(f64, &str)| format!("{name} {:.0} %", 100.0 * seconds / cost.seconds());
    stages.iter().take(3).map(share).collect::<Vec<_>>().join(", ")
}

/// The largest of the ratios of narrower vectors to the best, on the scenes whose goals are told.
fn of_avx2(races: &[Race]) -> Target {
    let (what, goal) = ("the same by AVX2, against AVX-512", "<= 1.7 x these");
    let ratio = |scene: &str| {
        let race = races.iter().find(|race| race.name == scene)?;
        let best = race.entry("CPU").or(race.entry(DEFAULT))?;
        Some((race.entry(AVX2.0)?.cost.seconds() / best.cost.seconds(), scene.to_owned()))
    };
    match RATIOS.iter().filter_map(|(scene, ..)| ratio(scene)).max_by(|a, b| a.0.total_cmp(&b.0)) {
        Some((most, scene)) => {
            judged(what.into(), goal.into(), most <= 1.7, format!("{} at most ({scene})", number(most)))
        }
        None => not_measured(what, goal, "needs --data, and a processor that has both"),
    }
}

fn of_growth(scaling: &Scaling) -> Vec<Target> {
    let Scaling { cells, pixels, million } = scaling;
    let seconds = million.cost.seconds();
    let whole = million.cells > 900_000;
    let what = format!("{} cells, {:.0} % of 800 x 800, exact order, CPU", million.cells, million.covered * 100.0);
    let mut all = vec![if whole {
        let spent = if seconds <= 0.35 { String::new() } else { format!("; {}", spent(&million.cost)) };
        judged(what, "<= 0.35 s".into(), seconds <= 0.35, format!("{} s CPU{spent}", number(seconds)))
    } else {
        not_measured("1M cells, 51M fragments, exact order", "<= 0.35 s", "a quick run")
    }];
    // All but the fragments; and the fragments alone.
    let in_cells = exponent(cells, |point| {
        let way = grown(point, "CPU")?;
        Some([point.cells as f64, way.cost.seconds() - way.cost.stage("draw")])
    });
    let in_pixels = exponent(pixels, |point| {
        let way = point.ways.iter().find(|way| way.name == "CPU")?;
        Some([f64::from(point.side).powi(2), way.cost.stage("draw")])
    });
    for (what, found) in [
        ("growth with cells but for their fragments, from a million", in_cells),
        ("growth with fragments, from 400 x 400", in_pixels),
    ] {
        let goal = format!("linear: exponent <= {LINEAR}");
        all.push(match found {
            Some(e) => judged(what.into(), goal, e <= LINEAR, format!("exponent {e:.2}")),
            None => not_measured(what, &goal, "a quick run"),
        });
    }
    let largest = near(cells, 8_000_000).and_then(|point| Some((point, grown(point, "CPU")?.peak_bytes?)));
    all.push(match largest {
        Some((point, peak)) => {
            let gib = peak as f64 / f64::from(1 << 30);
            judged(
                format!("memory of {} cells, all told", point.cells),
                "<= 24 GiB".into(),
                gib <= 24.0,
                format!("{gib:.1} GiB"),
            )
        }
        None => not_measured("memory of 8M cells, all told", "<= 24 GiB", "a quick run, or no Linux"),
    });
    let host = largest.map(|(point, peak)| (peak as f64, point.cells as f64));
    let device = near(cells, 1_000_000).and_then(|point| {
        let bytes = point.ways.iter().filter(|way| way.device_bytes > 0).map(|way| way.device_bytes).min()?;
        Some((bytes as f64, point.cells as f64))
    });
    for (what, goal, found) in [
        ("memory on the host while it draws, 8M cells, all told", 200.0, host),
        ("memory on the device, 1M cells, the least of our ways", 100.0, device),
    ] {
        let bound = format!("<= {goal} bytes a cell");
        all.push(match found {
            Some((bytes, cells)) => judged(
                what.into(),
                bound,
                bytes / cells <= goal,
                format!("{} bytes a cell", number((bytes / cells).round())),
            ),
            None => not_measured(what, &bound, "a quick run, or no way that tells"),
        });
    }
    all
}

/// The exponent of growth between the largest size and the first of at most an eighth of it.
fn exponent<T>(points: &[T], of: impl Fn(&T) -> Option<[f64; 2]>) -> Option<f64> {
    let all: Vec<[f64; 2]> = points.iter().filter_map(of).collect();
    let last = all.last()?;
    let first = all.iter().rfind(|point| point[0] <= last[0] / 7.0)?;
    // Less than a million cells, or a hundred thousand pixels, say nothing yet of large ones.
    if first[0] < 1e5 || first[1] <= 0.0 || last[1] <= 0.0 {
        return None;
    }
    Some((last[1] / first[1]).ln() / (last[0] / first[0]).ln())
}

fn of_device(races: &[Race], hardware: bool) -> Target {
    let (what, goal) = ("a discrete graphics card, exact order", ">= 200 Mtet/s");
    let rates = races.iter().flat_map(|race| &race.entries).filter(|entry| entry.device_bytes.is_some());
    let exact = rates.filter(|entry| entry.error.max <= EXACT);
    let rate = |entry: &super::race::Entry| entry.cells_drawn.unwrap_or(0) as f64 / entry.cost.wall_seconds * 1e-6;
    match exact.map(rate).max_by(f64::total_cmp).filter(|_| hardware) {
        Some(best) => judged(what.into(), goal.into(), best >= 200.0, format!("{} Mtet/s", number(best))),
        None => not_measured(what, goal, "the adapter is this processor"),
    }
}

fn of_transfer_function(races: &[Race]) -> Target {
    let (what, goal) = ("a new transfer function on a loaded mesh, before the first fragment", "<= 5 ms");
    // The dearest of the largest meshes.
    let took = |race: &Race| Some((race.cells, race.new_function.clone()?));
    let order = |a: &(usize, Cost), b: &(usize, Cost)| {
        a.0.cmp(&b.0).then(a.1.before_drawing().total_cmp(&b.1.before_drawing()))
    };
    let Some((cells, cost)) = races.iter().filter_map(took).max_by(order) else {
        return not_measured(what, goal, "no race");
    };
    let took = cost.before_drawing() * 1e3;
    let stage = |name: &str| format!("{name} {}", number(cost.stage(name) * 1e3));
    let found = format!(
        "{} ms CPU before the first of {cells} cells is set up, the eye at rest: {}",
        number(took),
        ["plan", "order", "project"].map(stage).join(", ")
    );
    judged(what.into(), goal.into(), took <= 5.0, found)
}

fn near(points: &[MeshPoint], cells: usize) -> Option<&MeshPoint> {
    points.iter().find(|point| (1.0 / ABOUT..ABOUT).contains(&(point.cells as f64 / cells as f64)))
}

fn grown<'a>(point: &'a MeshPoint, name: &str) -> Option<&'a Grown> {
    point.ways.iter().find(|way| way.name == name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exponents_are_those_of_powers() {
        let of = |power: f64| {
            let points: Vec<f64> = vec![1e5, 2e5, 1e6, 2e6, 8e6];
            exponent(&points, |&n| Some([n, 3e-9 * n.powf(power)]))
        };
        for power in [0.5, 1.0, 2.0] {
            assert!((of(power).unwrap() - power).abs() < 1e-9);
        }
        assert_eq!(exponent(&[1e3, 1e4], |&n| Some([n, n])), None, "too small to tell");
        assert_eq!(exponent(&[0.0; 0], |&n| Some([n, n])), None);
    }

    #[test]
    fn without_measurements_nothing_is_met() {
        let stage =
            |name, seconds| crate::report::StageReport { name, wall_seconds: seconds, cpu_seconds: Some(seconds) };
        let cost = Cost {
            frames: 1,
            wall_seconds: 1.0,
            cpu_seconds: Some(1.0),
            stages: vec![stage("plan", 0.1), stage("draw", 0.7), stage("order", 0.2)],
        };
        assert_eq!(spent(&cost), "draw 70 %, order 20 %, plan 10 %");
        assert!((cost.before_drawing() - 0.3).abs() < 1e-9, "all but the draw stage");
        let million = super::super::scaling::Million { cells: 3072, size: [48; 2], covered: 0.6, cost };
        let scaling = Scaling { cells: Vec::new(), pixels: Vec::new(), million };
        let all = targets(&[], &scaling, false);
        assert!(all.len() > 20 && all.iter().all(|target| target.verdict == Verdict::NotMeasured));
    }
}
