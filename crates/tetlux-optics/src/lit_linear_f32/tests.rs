use super::*;
use crate::accuracy::Random;
use crate::light::Light;
use crate::transfer::{ColorNode, OpacityNode, TransferFunction};
use crate::transfer_f32::pieces;
use crate::two_field_f32::axes;

/// Steps of the f64 sum: kinks and peaks as narrow as 0.01 of the segment leave 1e-6.
const STEPS: u32 = 6000;

/// What single precision cannot hold.
const ROUNDING: f64 = 2e-5;

/// Continuous, with narrow peaks.
pub(crate) fn random_transfer(random: &mut Random) -> TransferFunction {
    let mut color: Vec<f64> = (0..4).map(|_| random.unit()).collect();
    color.sort_by(f64::total_cmp);
    let color =
        color.into_iter().map(|s| ColorNode { s, rgb: [random.unit(), random.unit(), random.unit()] }).collect();
    let thick = f64::from(random.decades(-0.5, 1.5));
    let peak = 0.1 + 0.7 * random.unit();
    let width = f64::from(random.decades(-2.0, -0.7));
    let haze = if random.unit() < 0.5 { 0.0 } else { 0.2 * thick };
    let nodes = [(0.0, haze), (peak - 0.5 * width, 0.0), (peak, thick), (peak + 0.5 * width, 0.3 * haze), (1.0, haze)];
    let opacity = nodes.map(|(s, opacity)| OpacityNode { s, opacity });
    TransferFunction::new(color, opacity.to_vec()).unwrap()
}

fn random_light(random: &mut Random) -> Light {
    let direction = (random.unit() < 0.5).then(|| random_vector(random).map(f64::from));
    let silhouette = if random.unit() < 0.5 { 0.0 } else { 1.0 + 2.0 * random.unit() };
    let shares = [0.3 * random.unit(), random.unit(), 0.5 * random.unit()];
    Light::new(direction, shares, 2.0 + 30.0 * random.unit(), silhouette).unwrap()
}

fn random_vector(random: &mut Random) -> [f32; 3] {
    [0, 1, 2].map(|_| (2.0 * random.unit() - 1.0) as f32)
}

/// In f64, by so many steps that linear ends do not matter.
pub(crate) fn exact(light: &Light, segment: &Illuminated, at: impl Fn(f64) -> ([f64; 3], f64)) -> [f64; 4] {
    let eye = segment.eye.map(f64::from);
    let point = |u: f64| {
        let [f, b] = segment.gradients;
        let gradient = [0, 1, 2].map(|i| f64::from(f[i]) * (1.0 - u) + f64::from(b[i]) * u);
        let (luminance, opacity) = at(u);
        (light.luminance(luminance, gradient, eye), opacity * light.opacity_factor(gradient, eye))
    };
    let mut result = [0.0; 4];
    let mut near = point(0.0);
    for k in 1..=STEPS {
        let far = point(f64::from(k) / f64::from(STEPS));
        let depth = 0.5 * (near.1 + far.1) * f64::from(segment.length) / f64::from(STEPS);
        let seen = (1.0 - result[3]) * -(-depth).exp_m1();
        for channel in 0..3 {
            result[channel] += seen * 0.5 * (near.0[channel] + far.0[channel]);
        }
        result[3] += seen;
        near = far;
    }
    result
}

/// A lit segment of random scalars.
pub(crate) fn random_case(random: &mut Random, error: f32) -> (Light, Illuminated, [f32; 2], [f32; 2]) {
    let light = random_light(random);
    let front = random_vector(random);
    // From hardly a turn to half of all, past the origin too.
    let reach = random.decades(-2.0, 0.5);
    let other = random_vector(random);
    let back = [0, 1, 2].map(|i| front[i] + reach * (other[i] - front[i]));
    let illuminated = Illuminated {
        light: LightUniform::new(&light, |d| d.map(|x| x as f32).map(f64::from)),
        eye: normal(random_vector(random)),
        gradients: [front, back],
        length: random.decades(-1.0, 0.5),
        error,
    };
    let mut scalars = || [random.unit() as f32, random.unit() as f32];
    (light, illuminated, scalars(), scalars())
}

#[test]
fn measured_errors_keep_to_the_bound_whatever_is_lit() {
    for error in [8e-3, 8e-4, 8e-5] {
        let mut random = Random::new(41);
        let (mut worst, mut parts, mut cases) = (0.0_f64, 0, 0);
        while cases < 60 {
            let transfer = random_transfer(&mut random);
            let (light, segment, front, back) = random_case(&mut random, error);
            let line = |axis: usize, u: f64| f64::from(front[axis]) * (1.0 - u) + f64::from(back[axis]) * u;
            let (got, exact) = if cases % 2 == 0 {
                let got = one_field(&segment, &pieces(&transfer, [0.0, 1.0], 1.0), Weights::Direct, front[0], back[0]);
                let at = |u| (transfer.luminance(line(0, u)), transfer.opacity(line(0, u)));
                (got, exact(&light, &segment, at))
            } else {
                let [color, opacity] = axes(&transfer, [[0.0, 1.0]; 2], 1.0);
                let got = two_fields(&segment, &color, &opacity, front, back);
                let at = |u| (transfer.luminance(line(0, u)), transfer.opacity(line(1, u)));
                (got, exact(&light, &segment, at))
            };
            if exact[3] < 1e-3 {
                continue;
            }
            cases += 1;
            parts += got.pieces;
            let allowed = f64::from(error) * exact[3];
            let apart = (0..4).map(|c| (f64::from(got.color[c]) - exact[c]).abs()).fold(0.0, f64::max);
            assert!(apart <= allowed + ROUNDING, "{apart:e} for {allowed:e}: {light:?} {segment:?} {transfer:?}");
            worst = worst.max((apart - ROUNDING) / allowed);
        }
        println!(
            "error {error:.0e}: largest share of the bound {worst:.2}, {:.1} parts a segment",
            f64::from(parts) / 60.0
        );
        // The planted difference: the bound is one, not some number far above what is measured.
        assert!(error < 1e-4 || worst > 0.05, "{worst}");
    }
}

#[test]
fn a_normal_that_does_not_turn_takes_a_part_a_piece() {
    let light = Light::new(None, [0.2, 0.8, 0.5], 20.0, 0.0).unwrap();
    let mut random = Random::new(2);
    let (_, segment, ..) = random_case(&mut random, 1e-4);
    let gradient = [0.3, -0.2, 0.9];
    let segment = Illuminated {
        light: LightUniform::new(&light, |d| d),
        gradients: [gradient, gradient.map(|g| 2.0 * g)],
        length: 1.0,
        ..segment
    };
    let node = |s, rgb| ColorNode { s, rgb };
    let ramp = TransferFunction::new(
        vec![node(0.0, [1.0, 0.5, 0.2]), node(1.0, [0.1, 0.9, 0.2])],
        vec![OpacityNode { s: 0.0, opacity: 1.0 }, OpacityNode { s: 1.0, opacity: 3.0 }],
    );
    let got = one_field(&segment, &pieces(&ramp.unwrap(), [0.0, 1.0], 1.0), Weights::Direct, 0.1, 0.9);
    assert_eq!(got.pieces, 1);
    let turning = Illuminated { gradients: [gradient, [-0.5, 0.7, 0.1]], ..segment };
    let counts = [1e-2, 1e-4].map(|error| parts(&Illuminated { error, ..turning }, turning.gradients, 1.5, 0.5, 1.0));
    assert!(counts[0] >= 2.0 && (counts[1] / counts[0] - 10.0).abs() < 5.0, "second order: {counts:?}");
}

#[test]
fn missing_and_opposite_gradients_stay_finite() {
    let light = Light::new(Some([0.0, 0.0, 1.0]), [0.2, 0.8, 0.5], 1.0, 0.5).unwrap();
    let fog =
        TransferFunction::new(vec![ColorNode { s: 0.0, rgb: [1.0; 3] }], vec![OpacityNode { s: 0.0, opacity: 2.0 }]);
    let pieces = pieces(&fog.unwrap(), [0.0, 1.0], 1.0);
    for gradients in [
        [[0.0; 3]; 2],
        [[0.0; 3], [1.0, 0.0, 0.0]],
        [[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0]],
        [[1e-20, 0.0, 0.0], [1e20, 1e20, 0.0]],
        [[1.0, 2.0, 3.0], [-1.0, -2.0, -2.999_999_8]],
    ] {
        let light = LightUniform::new(&light, |d| d);
        let segment = Illuminated { light, eye: [1.0, 0.0, 0.0], gradients, length: 1.0, error: 1e-4 };
        let got = one_field(&segment, &pieces, Weights::Direct, 0.2, 0.8);
        assert!(got.color.iter().all(|v| v.is_finite() && *v >= 0.0), "{gradients:?}: {got:?}");
    }
}
