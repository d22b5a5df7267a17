//! What an error budget buys: time against the budget, the measured and the stated error.

use anyhow::Result;
use tetlux_image::compare;
use tetlux_optics::transfer::ColorNode;
use tetlux_scene::{Backend, Scene};

use super::Bench;
use super::measure::{Course, Way};
use super::paper::BLUNT_FIN;
use super::skips::colored;
use super::table::{Cell, Table, number};
use crate::truth;

/// By the processor, whose ways of spending a budget are the most.
const BUDGETS: [Way; 4] = [
    ("1e-5", |m| (m.backend, m.max_error) = (Backend::Cpu, 1e-5)),
    ("1e-3", |m| (m.backend, m.max_error) = (Backend::Cpu, 1e-3)),
    ("1e-2", |m| (m.backend, m.max_error) = (Backend::Cpu, 1e-2)),
    ("1e-1", |m| (m.backend, m.max_error) = (Backend::Cpu, 1e-1)),
];

const SIZE: u32 = 300;
const QUICK_SIZE: u32 = 32;

/// Colours of a preset.
const MANY: usize = 256;

/// What is looked at: a change of the scene.
type Look = (&'static str, fn(&mut Scene));

const LOOKS: [Look; 4] = [
    ("9 nodes", |_| ()),
    ("256 colours, as presets have them", of_many_colors),
    ("thin: 150 times the unit distance", |scene| scene.unit_distance *= 150.0),
    ("dense: a twentieth of the unit distance", |scene| scene.unit_distance /= 20.0),
];

/// The same opacity, under a smooth scale of colours.
fn of_many_colors(scene: &mut Scene) {
    let [low, high] = scene.scalar.range;
    let nodes = (0..MANY).map(|k| {
        let t = k as f64 / (MANY - 1) as f64;
        let rgb = [t * t, (3.0 * t).sin().abs(), 1.0 - 0.5 * t];
        ColorNode { s: low + (high - low) * t, rgb }
    });
    colored(scene, nodes.collect());
}

/// A table of looks and budgets.
pub(crate) fn budgets(bench: &Bench) -> Result<Table> {
    let side = if bench.quick { QUICK_SIZE } else { SIZE };
    let (mut input, source) = BLUNT_FIN.input(bench, [side; 2])?;
    let plain = input.scene.clone();
    let mut rows = Vec::new();
    for (name, change) in LOOKS {
        input.scene = plain.clone();
        change(&mut input.scene);
        let truth = truth::image(&input, &input.scene.camera.view(input.scene.size)?, [0.0; 2])?;
        let mut course = Course::new(&input, bench);
        let mut started = Vec::new();
        for way in BUDGETS {
            let (runner, plan, frame) = course.start(way)?;
            let error = compare(&truth, &frame.image, input.scene.method.max_error)?.max;
            started.push((runner, plan.stated.total(), error));
        }
        for _ in 0..bench.runs {
            for (runner, ..) in started.iter_mut().filter(|(runner, ..)| !runner.is_slow()) {
                course.run(runner)?;
            }
        }
        let figures = started.into_iter().map(|(runner, stated, error)| {
            let cost = runner.cost();
            let [whole, draw] = [cost.seconds(), cost.stage("draw")].map(|seconds| number(1e3 * seconds));
            let stated = stated.map_or("-".to_owned(), |stated| format!("{stated:.1e}"));
            Cell::from(format!("{whole} ({draw}), {error:.1e}, {stated}"))
        });
        rows.push([Cell::from(name)].into_iter().chain(figures).collect());
    }
    let head = ["transfer function"].into_iter().chain(BUDGETS.map(|(name, _)| name)).map(String::from);
    Ok(Table {
        name: "budgets",
        title: "What an error budget buys".into(),
        notes: vec![format!(
            "Processor ms of a frame, of its draw stage in brackets, the measured and the stated error, by the largest error that \
             is allowed ([the plan](plan.md)): the Blunt Fin's scene on {source} of {} cells, {side} x {side}, on the processor.",
            input.mesh.cells().len()
        )],
        head: head.collect(),
        rows,
    })
}

#[cfg(test)]
mod tests {
    use tetlux_render::Renderer;

    use super::*;

    #[test]
    fn errors_keep_to_what_is_stated_and_looks_differ() {
        let renderer = Renderer::new();
        let bench = Bench { quick: true, ..Bench::new(&renderer) };
        let table = budgets(&bench).unwrap();
        assert_eq!((table.rows.len(), table.head.len()), (LOOKS.len(), 1 + BUDGETS.len()));
        let mut all = Vec::new();
        for row in &table.rows {
            for cell in &row[1..] {
                let text = cell.to_string();
                let figures: Vec<f64> = text.split(", ").skip(1).map(|figure| figure.parse().unwrap()).collect();
                assert!(figures[0] <= figures[1], "{text}");
                all.push(figures[0]);
            }
        }
        // The loosest budget of what has many colours is spent.
        assert!(all[7] > 1e-4 && all[3] < 0.1, "{all:?}");
    }
}
