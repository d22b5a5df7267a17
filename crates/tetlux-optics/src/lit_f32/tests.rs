use super::*;
use crate::accuracy::Random;
use crate::lit_linear_f32::tests::{exact, random_case, random_transfer};
use crate::transfer_f32::{self, Weights, piece_at, pieces};
use crate::widget::BivariateFunction;
use crate::widget_f32::tests::{random_segment, random_widget};
use crate::widget_f32::widgets;
use crate::widgets_f32::integrate_share;

const X: [f32; 3] = [1.0, 0.0, 0.0];
const Y: [f32; 3] = [0.0, 1.0, 0.0];

fn shiny() -> Light {
    Light::new(None, [0.3, 0.7, 0.5], 10.0, 0.0).unwrap()
}

#[test]
fn pieces_grow_with_the_turn_and_with_a_tighter_budget() {
    let counts = [1e-2, 1e-3, 1e-4].map(|error| {
        let turning = Turning::new(&shiny(), 1.0, error);
        assert_eq!(turns_of(&turning, 0.0), 1.0);
        assert!(turns_of(&turning, 0.2) < turns_of(&turning, 1.0));
        turns_of(&turning, 0.5)
    });
    assert!(counts.is_sorted() && counts[0] < counts[2], "{counts:?}");
}

#[test]
fn angles_and_places_at_their_limits() {
    assert_eq!(angle_between([0.0; 3], X), 0.0);
    assert!((angle_between(X.map(|x| x * 1e-8), Y.map(|y| y * 1e8)) - std::f32::consts::FRAC_PI_2).abs() < 1e-6);
    assert!((angle_between(X, X.map(|x| -x)) - std::f32::consts::PI).abs() < 1e-6);
    // int_0^X t e^-t dt / (X (1 - e^-X)): 1/2 - X/12 where thin, 1/X where thick.
    assert!((absorbed_at(1e-9) - 0.5).abs() < 1e-6);
    let alpha = 1.0 - (-1.0_f32).exp();
    let expected = (1.0 - 2.0 * (-1.0_f32).exp()) / alpha;
    assert!((absorbed_at(alpha) - expected).abs() < 1e-5);
    assert!((0.0..0.1).contains(&absorbed_at(1.0)));
}

/// Even fog of one luminance between two normals that are a right angle apart: the pieces converge to the integral.
#[test]
fn light_that_turns_converges_to_the_integral() {
    let light = LightUniform::new(&Light::new(Some([1.0, 0.0, 0.0]), [0.1, 0.9, 0.0], 1.0, 0.0).unwrap(), |d| d);
    let depth = 0.5_f32;
    let fog = |from: f32, to: f32, factor: f32| {
        let alpha = crate::segment_f32::opacity(depth * (to - from) * factor);
        Integrated { color: [alpha; 4], pieces: 1 }
    };
    // By the middle of many thin slices, in double precision.
    let slices = 10_000;
    let expected: f64 = (0..slices)
        .map(|i| {
            let u = (f64::from(i) + 0.5) / f64::from(slices);
            let cosine = (1.0 - u) / (u * u + (1.0 - u) * (1.0 - u)).sqrt();
            (0.1 + 0.9 * cosine) * f64::from(depth) * (-f64::from(depth) * u).exp() / f64::from(slices)
        })
        .sum();
    for error in [1e-2_f32, 1e-3, 1e-4] {
        let turning = Turning { error, slope: 0.9, curvature: 0.9 };
        let got = integrate_lit(&light, &turning, [X, Y], [0.0, 0.0, -1.0], fog);
        let alpha = 1.0 - (-f64::from(depth)).exp();
        let off = (f64::from(got.color[0]) - expected).abs();
        assert!(off <= f64::from(error) * alpha + 1e-6, "{error}: off by {off:.1e} in {} pieces", got.pieces);
        assert!((f64::from(got.color[3]) - alpha).abs() < 1e-6);
    }
}

/// What single precision cannot hold: rims and phases are moved by 1e-7 of the range.
const ROUNDING: f64 = 3e-5;

/// The estimate's margin: no random segment takes more of what it may err by.
const LARGEST_SHARE: f64 = 0.7;

/// Shares of the allowed error that random segments take, ascending, and the mean number of pieces. What is seen of a
/// segment is given by `make`: unlit between two shares, and in f64 at a share.
fn shares_of_the_bound(
    error: f32,
    make: impl Fn(&mut Random, f32) -> (Box<dyn Fn(f32, f32, f32) -> Integrated>, Box<dyn Fn(f64) -> ([f64; 3], f64)>),
) -> (Vec<f64>, f64) {
    let mut random = Random::new(77);
    let (mut shares, mut pieces) = (Vec::new(), 0);
    while shares.len() < 80 {
        let (light, segment, ..) = random_case(&mut random, error);
        let (classified, at) = make(&mut random, segment.length);
        let exact = exact(&light, &segment, at);
        if exact[3] < 1e-3 {
            continue;
        }
        let turning = Turning::new(&light, 1.0, error);
        let got = integrate_lit(&segment.light, &turning, segment.gradients, segment.eye, classified);
        let apart = (0..4).map(|c| (f64::from(got.color[c]) - exact[c]).abs()).fold(0.0, f64::max);
        // Colour and light may take as much each.
        shares.push((apart - ROUNDING).max(0.0) / (2.0 * f64::from(error) * exact[3]));
        pieces += got.pieces;
    }
    shares.sort_by(f64::total_cmp);
    (shares, f64::from(pieces) / 80.0)
}

#[test]
fn measured_errors_of_random_segments_keep_to_the_bound_with_room_to_spare() {
    let line = |front: f32, back: f32, u: f64| f64::from(front) * (1.0 - u) + f64::from(back) * u;
    for error in [4e-3_f32, 4e-4, 4e-5] {
        let widgets = shares_of_the_bound(error, |random, length| {
            let count = 1 + (3.0 * random.unit()) as usize;
            let function = BivariateFunction { widgets: (0..count).map(|_| random_widget(random)).collect() };
            let (front, back) = random_segment(random);
            let device = widgets(&function, [[0.0, 1.0]; 2], 1.0);
            let classified = move |from: f32, to: f32, factor: f32| {
                let ends = [from, to].map(|u| [0, 1].map(|i| front[i] + (back[i] - front[i]) * u));
                integrate_share(&device, ends[0], ends[1], length * (to - from) * factor, error)
            };
            let at = move |u: f64| {
                let point = [0, 1].map(|i| line(front[i], back[i], u));
                (function.luminance(point), function.opacity(point))
            };
            (Box::new(classified), Box::new(at))
        });
        // Peaks as narrow as a hundredth of the segment.
        let one_field = shares_of_the_bound(error, |random, length| {
            let transfer = random_transfer(random);
            let ([front, _], [back, _]) = random_segment(random);
            let pieces = pieces(&transfer, [0.0, 1.0], 1.0);
            let classified = move |from: f32, to: f32, factor: f32| {
                let [f, b] = [from, to].map(|u| front + (back - front) * u);
                let range = [piece_at(&pieces, f.min(b)), piece_at(&pieces, f.max(b))];
                let length = length * (to - from) * factor;
                Integrated { color: transfer_f32::integrate(&pieces, range, Weights::Direct, f, b, length), pieces: 1 }
            };
            let at = move |u: f64| {
                let s = line(front, back, u);
                (transfer.luminance(s), transfer.opacity(s))
            };
            (Box::new(classified), Box::new(at))
        });
        for (name, (shares, pieces)) in [("widgets", widgets), ("one field", one_field)] {
            let [median, most, worst] = [39, 71, 79].map(|i| shares[i]);
            println!(
                "{name}, {error:.0e}: {pieces:.1} pieces; share of the bound {median:.2}, 90 % {most:.2}, worst {worst:.2}"
            );
            assert!(worst <= LARGEST_SHARE, "{name}: {worst}");
        }
    }
}
