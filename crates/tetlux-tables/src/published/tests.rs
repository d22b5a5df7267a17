use std::sync::LazyLock;

use tetlux_optics::EmissionConvention::EmissionDensity;
use tetlux_optics::accuracy::Random;
use tetlux_optics::widget::{BivariateFunction, Rectangle, Shape, WaveProfile, Widget};
use tetlux_optics::widget_f32::widgets;
use tetlux_optics::widget_integral::{RaySegment, bivariate_segment, widget_integral};
use tetlux_optics::widgets_f32::classify;

use super::*;
use crate::spec::TableSpec;

const UNIT: [[f64; 2]; 2] = [[0.0, 1.0]; 2];

static TABLES: LazyLock<[Table; 3]> = LazyLock::new(|| TableSpec::widgets().map(|spec| Table::build(&spec).unwrap()));

fn tables() -> WidgetTables<'static> {
    let [gaussian, sine, triangle] = &*TABLES;
    WidgetTables { gaussian, sine, triangle }
}

fn ray(front: [f32; 2], back: [f32; 2], length: f32) -> RaySegment {
    RaySegment { front: front.map(f64::from), back: back.map(f64::from), length: f64::from(length) }
}

fn function(shape: Shape, support: Option<Rectangle>, opacity: f64) -> BivariateFunction {
    BivariateFunction { widgets: vec![Widget::new(shape, support, opacity, [1.0; 3]).unwrap()] }.as_published()
}

fn wave(profile: WaveProfile, frequency: f64) -> Shape {
    Shape::Wave { profile, frequency: [frequency, 0.0], offset: 0.0 }
}

/// Largest and mean error of the light, as a share of the segment's length, and of alpha, over segments of one peak, whose
/// strength is at most that of the tables.
fn errors(shape: impl Fn(&mut Random) -> Shape, shortest: f64) -> [f64; 3] {
    let mut random = Random::new(9);
    let mut result = [0.0_f64; 3];
    const CASES: usize = 4000;
    for _ in 0..CASES {
        let function = function(shape(&mut random), None, random.decades(-1.0, 0.5).into());
        let front = [random.unit() as f32, 0.5];
        let reach = (shortest + (1.0 - shortest) * random.unit()) as f32;
        let back = [front[0] + if random.unit() < 0.5 { reach } else { -reach }, 0.5];
        let got = analytic(&tables(), &widgets(&function, UNIT, 1.0), front, back, 1.0, 1.0).map(f64::from);
        let exact = widget_integral(&function.widgets[0], 1.0, &ray(front, back, 1.0));
        let error = (got[0] - exact.emission_only).abs();
        result[0] = result[0].max(error);
        result[1] += error / CASES as f64;
        result[2] = result[2].max((got[3] - exact.alpha).abs());
    }
    result
}

#[test]
fn each_shape_is_its_integral_to_what_its_table_holds() {
    let uniform = errors(|_| Shape::Uniform, 0.1);
    let gaussian =
        errors(|random| Shape::Gaussian { center: [random.unit(), 0.5], sigma: [0.2 + random.unit(); 2] }, 0.1);
    // At most one peak in a segment of up to one period.
    let triangle = errors(|_| wave(WaveProfile::Triangle, 1.0), 0.1);
    let sine = errors(|_| wave(WaveProfile::AbsSine, 1.0), 0.1);
    for (name, found) in [("uniform", uniform), ("gaussian", gaussian), ("triangle", triangle), ("sine", sine)] {
        println!("{name}: largest error {:.1e}, mean {:.1e}, alpha {:.1e}", found[0], found[1], found[2]);
        // Depths are exact but for the rounding of rims.
        assert!(found[2] < 3e-5, "{name}");
    }
    assert!(uniform[0] < 1e-5);
    // Right in the mean; the worst is what the tables lose (docs/accuracy.md) where M, P or A is almost 10 and the part
    // short, multiplied by up to e^10.
    assert!(gaussian[1] < 1e-3 && triangle[1] < 1e-3 && sine[1] < 1e-3);
    assert!(gaussian[0] < 5e-2 && triangle[0] < 0.1 && sine[0] < 1.0);
}

#[test]
fn beyond_a_table_the_profile_counts_as_even() {
    // Almost constant along the segment: P, M and A are far above 10, the mean transmittance is that of even extinction.
    for shape in [
        Shape::Gaussian { center: [0.5; 2], sigma: [0.3; 2] },
        wave(WaveProfile::Triangle, 1.0),
        wave(WaveProfile::AbsSine, 1.0),
    ] {
        let function = function(shape, None, 2.0);
        for (front, back) in [([0.7, 0.5], [0.7003, 0.5]), ([0.6, 0.5], [0.5997, 0.5])] {
            let got = analytic(&tables(), &widgets(&function, UNIT, 1.0), front, back, 1.0, 1.0);
            let exact = widget_integral(&function.widgets[0], 1.0, &ray(front, back, 1.0));
            assert!((f64::from(got[0]) - exact.emission_only).abs() < 1e-3, "{shape:?}: {got:?} {exact:?}");
        }
    }
}

#[test]
fn what_lies_behind_the_second_peak_is_left_out() {
    for profile in [WaveProfile::Triangle, WaveProfile::AbsSine] {
        let function = function(wave(profile, 1.0), None, 1.0);
        let device = widgets(&function, UNIT, 1.0);
        let at = |front: f32, back: f32| {
            let length = (back - front).abs();
            analytic(&tables(), &device, [front, 0.5], [back, 0.5], length, 1.0)
        };
        // Peaks at 0.5, 1.5 and 2.5.
        for (whole, seen) in [(at(0.2, 3.0), at(0.2, 1.5)), (at(2.9, -4.0), at(2.9, 1.5))] {
            for channel in 0..4 {
                assert!((whole[channel] - seen[channel]).abs() < 1e-5, "{profile:?}: {whole:?} {seen:?}");
            }
        }
        let exact = widget_integral(&function.widgets[0], 1.0, &ray([0.2, 0.5], [3.0, 0.5], 2.8));
        assert!(exact.alpha - f64::from(at(0.2, 3.0)[3]) > 0.1, "the planted difference");
    }
}

#[test]
fn widgets_are_met_one_after_the_other_from_either_side() {
    let band = |low: f64, color| {
        let support = Rectangle { s: [low, low + 0.2], g: [0.0, 1.0] };
        Widget::new(Shape::Uniform, Some(support), 30.0, color).unwrap()
    };
    let function = BivariateFunction { widgets: vec![band(0.6, [0.0, 1.0, 0.0]), band(0.1, [1.0, 0.0, 0.0])] };
    let device = widgets(&function.as_published(), UNIT, 1.0);
    for (front, back) in [([0.0, 0.5], [1.0, 0.5]), ([1.0, 0.5], [0.0, 0.5])] {
        let got = analytic(&tables(), &device, front, back, 1.0, 1.0);
        let exact = bivariate_segment(&function, 1.0, &ray(front, back, 1.0), 1, EmissionDensity);
        for channel in 0..3 {
            assert!((f64::from(got[channel]) - exact.color[channel]).abs() < 1e-5, "{got:?} {exact:?}");
        }
        assert!(f64::from(got[3]) - exact.alpha < 1e-5);
    }
}

#[test]
fn more_equal_pieces_come_closer_and_few_oversee_a_peak() {
    let table = Table::build(&TableSpec::front_back()).unwrap();
    let bell = function(Shape::Gaussian { center: [0.5; 2], sigma: [0.03; 2] }, None, 20.0);
    let device = widgets(&bell, UNIT, 1.0);
    let line = ray([0.0; 2], [1.0; 2], 1.0);
    let exact = bivariate_segment(&bell, 1.0, &line, 4000, EmissionDensity);
    let apart = |count: u32| {
        let at = |point| classify(&device, point);
        let got = approximate(&table, at, [0.0; 2], [1.0; 2], 1.0, 1.0, count, 1.0 / count as f32);
        [0, 3].map(|c| (f64::from(got[c]) - if c == 3 { exact.alpha } else { exact.color[c] }).abs())
    };
    // Three pieces are classified at 1/3 and 2/3, beyond 3 sigma: nothing is seen.
    assert_eq!(apart(3), [exact.color[0], exact.alpha]);
    for quantity in [0, 1] {
        let [few, more, most] = [10, 40, 400].map(|count| apart(count)[quantity]);
        assert!(few > more && more > most && most < 2e-3, "{few:e} {more:e} {most:e}");
    }
}

#[test]
fn any_input_gives_finite_light() {
    let mut random = Random::new(4);
    let shapes = [
        Shape::Uniform,
        Shape::Gaussian { center: [0.5; 2], sigma: [0.01, 3.0] },
        wave(WaveProfile::Triangle, 3e4),
        wave(WaveProfile::AbsSine, 1e-3),
    ];
    for shape in shapes {
        for opacity in [0.0, 1e-20, 1.0, 1e12] {
            let device = widgets(&function(shape, None, opacity), UNIT, 1.0);
            for _ in 0..200 {
                let mut point = || [random.decades(-3.0, 3.0), random.unit() as f32];
                let (front, back) = (point(), point());
                let length = random.decades(-8.0, 4.0);
                let got = analytic(&tables(), &device, front, back, length, 1.0);
                assert!(got[..3].iter().all(|light| *light >= 0.0 && *light <= length * 1.0001), "{got:?}");
                assert!((0.0..=1.0).contains(&got[3]), "{got:?}");
            }
        }
    }
    assert_eq!(analytic(&tables(), &[], [0.0; 2], [1.0; 2], 1.0, 1.0), [0.0; 4]);
}
