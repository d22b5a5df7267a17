//! Song, Chen, Maciejewski, Gaither and Ebert, "Bivariate Transfer Functions on Unstructured Grids" (Computer Graphics Forum
//! 28(3), 2009): Xeon of 2 GHz, GeForce 8800 GTS.

use anyhow::Result;
use tetlux_image::compare;
use tetlux_scene::{Integrator, SceneFile};

use super::Bench;
use super::measure::{Course, Way};
use super::paper::{BLUNT_FIN, CYLINDER, DELTA_WING, DataSet, HEAT_SINK, M6_WING, X38};
use super::table::{Cell, Table};
use crate::input::{Input, SceneArgs};
use crate::truth;

/// The paper does not say; that of the others.
const SIZE: [u32; 2] = [800; 2];

/// Side of the pictures that are compared with the reference.
const COMPARED: u32 = 64;

/// Cells and frames a second of table 1: one field, analytic, approximate.
const SETS: [(DataSet, usize, [f64; 3]); 6] = [
    (BLUNT_FIN, 224_874, [1.27, 0.16, 0.91]),
    (HEAT_SINK, 121_668, [1.91, 0.23, 1.00]),
    (CYLINDER, 762_048, [0.42, 0.07, 0.36]),
    (M6_WING, 287_962, [1.27, 0.11, 1.27]),
    (X38, 1_943_483, [0.18, 0.04, 0.18]),
    (DELTA_WING, 3_853_502, [0.08, 0.03, 0.07]),
];

/// One field by its transfer function.
const ONE: Way = ("1D", |_| ());

/// Two fields, by widgets; the last is ours.
const TWO: [Way; 3] = [
    ("2D analytic", |m| m.integrator = Integrator::Analytic),
    ("2D approximate", |m| m.integrator = Integrator::Approximate),
    ("2D adaptive, 1e-3", |m| (m.integrator, m.max_error) = (Integrator::Adaptive, 1e-3)),
];

/// Two Gaussians over a field and its gradient's magnitude, as the paper's table has them.
const WIDGETS: &str = "
[transfer]
fit_to_field = true
[[widget]]
shape = \"gaussian\"
center = [0.25, 0.05]
sigma = [0.10, 0.05]
max_opacity = 1.5
color = [0.1, 0.4, 1.0]
[[widget]]
shape = \"gaussian\"
center = [0.60, 0.12]
sigma = [0.12, 0.10]
max_opacity = 2.5
color = [1.0, 0.5, 0.1]
";

/// The mesh and the view of a scene of one field, seen by widgets.
fn by_widgets(Input { name, mesh, scene, .. }: Input) -> Result<Input> {
    let mut file = SceneFile::parse("two Gaussians", WIDGETS)?;
    (file.field, file.size) = (Some(scene.scalar.name.clone()), scene.size);
    let mut input = SceneArgs::default().bind(name, file, mesh)?;
    (input.scene.camera, input.scene.unit_distance) = (scene.camera, scene.unit_distance);
    Ok(input)
}

/// Seconds and processor seconds of a frame, and the largest and the mean error of a small picture against the reference; or
/// why a way is not measured.
fn measure(bench: &Bench, input: &Input, ways: &[Way]) -> Result<Vec<Result<[f64; 4], String>>> {
    let mut course = Course::new(input, bench);
    let costs = course.costs(ways.iter().copied(), bench.runs)?;
    course.scene.size = input.scene.size.map(|side| side.min(COMPARED));
    let truth = truth::image(input, &input.scene.camera.view(course.scene.size)?, [0.0; 2])?;
    let mut found = Vec::new();
    for (way, cost) in ways.iter().zip(costs) {
        found.push(match cost {
            Ok((cost, _)) => {
                let (_, _, frame) = course.start(*way)?;
                let error = compare(&truth, &frame.image, input.scene.method.max_error)?;
                Ok([cost.wall_seconds, cost.seconds(), error.max, error.mean])
            }
            Err(why) => Err(why),
        });
    }
    Ok(found)
}

/// Table 1: one field, two analytically and approximately; and ours.
pub(crate) fn modes(bench: &Bench) -> Result<Table> {
    let size = bench.paper_size(SIZE);
    let mut rows = Vec::new();
    for (set, cells, theirs) in SETS {
        let name = set.name;
        let (one, source) = set.of_cells(cells).input(bench, size)?;
        let count = one.mesh.cells().len();
        let mut found = measure(bench, &one, &[ONE])?;
        found.extend(measure(bench, &by_widgets(one)?, &TWO)?);
        let base = found.first().and_then(|one| one.as_ref().ok()).map(|one| one[1]);
        for (i, ((mode, _), found)) in [ONE].iter().chain(&TWO).zip(found).enumerate() {
            let rate = theirs.get(i).copied();
            let set = format!("{name} ({source}, {count} cells)");
            let published: [Cell; 4] =
                [set.into(), (*mode).into(), rate.into(), rate.map(|rate| theirs[0] / rate).into()];
            let ours: [Cell; 5] = match found {
                Ok([wall, cpu, max, mean]) => {
                    [wall.into(), cpu.into(), base.map(|base| cpu / base).into(), max.into(), mean.into()]
                }
                Err(why) => [why.into(), Cell::Unknown, Cell::Unknown, Cell::Unknown, Cell::Unknown],
            };
            rows.push([published.to_vec(), ours.to_vec()].concat());
        }
    }
    let head = [
        "data set",
        "mode",
        "theirs: fps",
        "time over 1D",
        "ours: s",
        "CPU s",
        "CPU time over 1D",
        "largest error",
        "mean error",
    ];
    Ok(Table {
        name: "song-1",
        title: "Song et al. 2009, table 1: one field, and two Gaussians over it and its gradient's magnitude".into(),
        notes: vec![
            format!(
                "Theirs on a graphics card of 2006; ours {} x {}, in exact order, by the back end that the plan chooses for this \
                 machine ({}); 10 equal pieces a segment of approximate, as published.",
                size[0],
                size[1],
                bench.adapter()
            ),
            format!(
                "Errors are of pictures of at most {COMPARED} pixels a side against the f64 reference, which has \
                 emission-absorption. The published modes have emission density: most of their error is that other model."
            ),
        ],
        head: head.map(String::from).into(),
        rows,
    })
}

#[cfg(test)]
mod tests {
    use tetlux_scene::Method;

    use super::*;
    use crate::methods::PEAK;

    #[test]
    fn every_way_can_be_and_the_scene_is_kept_but_for_its_classification() {
        for (name, change) in [ONE].iter().chain(&TWO) {
            let mut method = Method::default();
            change(&mut method);
            assert_eq!(method.refusal(), None, "{name}");
        }
        let one = PEAK.input("peak", "", 24).unwrap();
        let (camera, unit_distance) = (one.scene.camera, one.scene.unit_distance);
        let two = by_widgets(one).unwrap();
        assert_eq!((two.scene.camera, two.scene.unit_distance), (camera, unit_distance));
        assert!(two.scene.classification.is_bivariate() && two.scene.second.is_some());
    }
}
