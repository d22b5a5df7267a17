//! The modes of Song et al. 2009: WGSL on the driver, Rust here, the same inputs bit for bit and the same tables.

use tetlux_optics::widget::{BivariateFunction, Shape, WaveProfile};
use tetlux_optics::{widget_f32, widgets_f32};
use tetlux_shaders::{DEFAULTS, compose};
use tetlux_tables::published::{WidgetTables, analytic, approximate};
use tetlux_tables::{Table, TableSpec};
use tetlux_tests::Random;

use crate::device::{Bound, run};
use crate::lookups::lookup;
use crate::two_fields::{LookBytes, PUT, UNIT, ends, main_of, random_segment, random_widget, widget_bytes};

/// Differences of the tables are as published multiplied by up to e^10: so much of a rounding of a texel is left.
const CANCELLED: f32 = 2e-3;

/// Of segments on which a widget hardly varies the published differences may give any weight, by a rounding: one in so many
/// may differ.
const UNSTABLE: usize = 40;

const ROWS: usize = 4000;

/// A widget that the paper has.
fn is_published(shape: &Shape) -> bool {
    !matches!(shape, Shape::Wave { profile: WaveProfile::SineSquared, .. })
}

#[test]
fn analytic_segments() {
    let tables = TableSpec::widgets().map(|spec| Table::build(&spec).unwrap());
    let [gaussian, sine, triangle] = &tables;
    let twin_tables = WidgetTables { gaussian, sine, triangle };
    let mut random = Random::new(31);
    let body = format!("let r = classified(vec2<f32>(x[0], x[1]), vec2<f32>(x[2], x[3]), x[4]);{PUT}");
    let source = compose("function::analytic", DEFAULTS).unwrap() + &main_of(5, 5, &body);
    for _ in 0..12 {
        let widget = loop {
            let widget = random_widget(&mut random);
            if is_published(widget.shape()) {
                break widget;
            }
        };
        let function = BivariateFunction { widgets: vec![widget] }.as_published();
        let device = widget_f32::widgets(&function, UNIT, 1.0);
        let inputs: Vec<f32> = (0..ROWS).flat_map(|_| random_segment(&mut random)).collect();
        let look = LookBytes { published: (0, 0.5, 0.0), ..LookBytes::none() }.bytes();
        let bound = [
            Bound::Storage(0, 10, &look),
            Bound::Storage(0, 11, &widget_bytes(&device)),
            Bound::Uniform(2, 0, &lookup(1.0)),
            Bound::Layers(2, 2, &tables),
        ];
        let found = run(&source, &bound, &inputs, ROWS, 5);
        let (mut worst, mut others) = (0.0f32, 0);
        for (row, found) in inputs.chunks_exact(5).zip(found.chunks_exact(5)) {
            let (front, back, length) = ends(row);
            let twin = analytic(&twin_tables, &device, front, back, length, 0.5);
            let apart = (0..4).map(|k| (found[k] - twin[k]).abs()).fold(0.0, f32::max);
            assert!(
                found.iter().all(|v| v.is_finite()) && (found[3] - twin[3]).abs() < 2e-5,
                "{row:?}: {found:?}, {twin:?}"
            );
            // Whatever cancels, what is emitted is seen at most once.
            assert!(found[0] <= 0.5 * length * device[0].color[0] + 1e-6, "{row:?}: {found:?}");
            others += usize::from(apart > CANCELLED);
            worst = worst.max(apart);
        }
        println!("{:?}: at most {worst:.1e} apart, {others} of {ROWS} by more than is cancelled", widget.shape());
        assert!(others * UNSTABLE <= ROWS, "{:?}: {others}", widget.shape());
    }
}

#[test]
fn approximate_segments() {
    let table = Table::build(&TableSpec::front_back()).unwrap();
    let mut random = Random::new(32);
    let body = format!("let r = classified(vec2<f32>(x[0], x[1]), vec2<f32>(x[2], x[3]), x[4]);{PUT}");
    let source = compose("function::approximate", DEFAULTS).unwrap() + &main_of(5, 5, &body);
    for count in [1, 10, 40] {
        let function = BivariateFunction { widgets: (0..2).map(|_| random_widget(&mut random)).collect() };
        let device = widget_f32::widgets(&function, UNIT, 1.0);
        let inputs: Vec<f32> = (0..ROWS).flat_map(|_| random_segment(&mut random)).collect();
        let unit = 3.2 / count as f32;
        let look = LookBytes { published: (count, 0.5, unit), ..LookBytes::none() }.bytes();
        let bound = [
            Bound::Storage(0, 10, &look),
            Bound::Storage(0, 11, &widget_bytes(&device)),
            Bound::Uniform(2, 0, &lookup(1.0)),
            Bound::Texture(2, 2, &table),
        ];
        let found = run(&source, &bound, &inputs, ROWS, 5);
        let (mut worst, mut others) = (0.0f32, 0);
        for (row, found) in inputs.chunks_exact(5).zip(found.chunks_exact(5)) {
            let (front, back, length) = ends(row);
            let classify = |point| widgets_f32::classify(&device, point);
            let twin = approximate(&table, classify, front, back, length, 0.5, count, unit);
            let apart = (0..4).map(|k| (found[k] - twin[k]).abs()).fold(0.0, f32::max);
            assert!(found.iter().all(|v| v.is_finite()), "{row:?}: {found:?}");
            // A sample on the rim of a rectangle may be in or out by a rounding.
            others += usize::from(apart > 1e-4);
            worst = worst.max(apart);
        }
        println!("{count} pieces: at most {worst:.1e} apart, {others} of {ROWS} by more than rounding");
        assert!(others * 200 <= ROWS, "{count} pieces: {others}");
    }
}
