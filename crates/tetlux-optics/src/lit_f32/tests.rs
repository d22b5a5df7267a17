use super::*;

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
