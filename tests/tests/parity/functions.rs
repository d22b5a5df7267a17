//! Functions with numbers in them: WGSL on the driver, Rust here, the same inputs bit for bit.

use tetlux_optics::no_data_f32::shade_no_data;
use tetlux_optics::published_f32::linear_published;
use tetlux_optics::segment_f32::{mean_depth, opacity, share_before, weights_average, weights_direct};
use tetlux_optics::symmetric_f32::weights_symmetric;
use tetlux_optics::transfer_f32::{self, Piece, Weights};
use tetlux_optics::vertex_f32;
use tetlux_shaders::{DEFAULTS, choose, compose};
use tetlux_tests::{Random, transfer};

use crate::device::{Bound, run};

/// What a driver's exp leaves: 2 units of the last place near 0, 62 at -80, where the result is 1e-35; Vulkan allows
/// 3 + 2 |x|. Divisions may be off by 2.5 units, and multiplications and additions may be fused.
const ABSOLUTE: f32 = 2e-6;

/// The same of small results: weights of thin segments keep their digits.
const RELATIVE: f32 = 1e-5;

/// Below this results are denormal or nearly so, and a driver may flush them.
const SMALLEST: f32 = 1e-37;

/// Whether a shader's result is its twin's, and finite.
pub(crate) fn agree(shader: f32, twin: f32) -> bool {
    let error = (shader - twin).abs();
    shader.is_finite() && error <= ABSOLUTE && (error <= RELATIVE * twin.abs() || error <= SMALLEST)
}

/// Every kind of number that bits can make, and log-uniform positive ones.
pub(crate) fn any_number(random: &mut Random) -> f32 {
    const SPECIAL: [f32; 18] = [
        0.0,
        -0.0,
        1e-45,
        1e-40,
        f32::MIN_POSITIVE,
        1e-30,
        1e-7,
        0.25,
        1.0,
        3.0,
        1e15,
        1e16,
        f32::MAX,
        f32::INFINITY,
        f32::NEG_INFINITY,
        f32::NAN,
        -1.0,
        -1e-40,
    ];
    match random.below(8) {
        0 => SPECIAL[random.below(SPECIAL.len())],
        1 => f32::from_bits(random.bits() as u32),
        2 => 10f64.powf(random.between(-38.0, 38.0)) as f32,
        3 | 4 => random.between(0.0, 10.0) as f32,
        _ => 10f64.powf(random.between(-8.0, 6.0)) as f32,
    }
}

const ROWS: usize = 1_000_000;

const SEGMENT_TEST: &str = "
fn row(i: u32) {
    let a = bitcast<f32>(inputs[2u * i]);
    let b = bitcast<f32>(inputs[2u * i + 1u]);
    let direct = weights_direct(a, b);
    let average = weights_average(a, b);
    let x = 0.5 * (clean(a) + clean(b));
    let rho = clean(b) / max(clean(a) + clean(b), 1e-30);
    let rest = vec2<f32>(opacity(clean(a)), mean_depth(x, rho, clean(a), clean(b)));
    for (var k = 0u; k < 3u; k++) {
        outputs[8u * i + k] = bitcast<u32>(direct[k]);
        outputs[8u * i + 3u + k] = bitcast<u32>(average[k]);
    }
    outputs[8u * i + 6u] = bitcast<u32>(rest.x);
    outputs[8u * i + 7u] = bitcast<u32>(rest.y);
}
";

/// The cleaning of inputs, which is private to the twin.
fn clean(depth: f32) -> f32 {
    if depth > 0.0 { depth.min(1e15) } else { 0.0 }
}

#[test]
fn segment_weights() {
    let mut random = Random::new(11);
    let mut inputs: Vec<f32> = (0..2 * ROWS).map(|_| any_number(&mut random)).collect();
    // Nearly constant extinction, where the closed forms have a removable singularity.
    for pair in inputs[..ROWS / 2].chunks_exact_mut(2) {
        pair[1] = pair[0] * (1.0 + random.between(-1e-6, 1e-6) as f32);
    }
    let outputs = run(&(compose("lib::segment", DEFAULTS).unwrap() + SEGMENT_TEST), &[], &inputs, ROWS, 8);
    let names = ["alpha", "w_b", "w_f", "average alpha", "average w_b", "average w_f", "opacity", "mean depth"];
    let mut worst = [0.0f32; 8];
    for (pair, found) in inputs.chunks_exact(2).zip(outputs.chunks_exact(8)) {
        let (a, b) = (pair[0], pair[1]);
        let (back, front) = (clean(a), clean(b));
        let (direct, average) = (weights_direct(a, b), weights_average(a, b));
        let mean = mean_depth(0.5 * (back + front), front / (back + front).max(1e-30), back, front);
        let twin = [direct[0], direct[1], direct[2], average[0], average[1], average[2], opacity(back), mean];
        for k in 0..8 {
            worst[k] = worst[k].max((found[k] - twin[k]).abs());
            assert!(agree(found[k], twin[k]), "{} of ({a:e}, {b:e}): {} and {}", names[k], found[k], twin[k]);
        }
    }
    for (name, worst) in names.iter().zip(worst) {
        println!("{name}: at most {worst:.1e} apart");
    }
}

/// Three numbers of two: `FUNCTION` stands for the function's name.
pub(crate) const THREE_TEST: &str = "
fn row(i: u32) {
    let result = FUNCTION(bitcast<f32>(inputs[2u * i]), bitcast<f32>(inputs[2u * i + 1u]));
    for (var k = 0u; k < 3u; k++) {
        outputs[3u * i + k] = bitcast<u32>(result[k]);
    }
}
";

#[test]
fn symmetric_weights() {
    let mut random = Random::new(13);
    let inputs: Vec<f32> = (0..2 * ROWS).map(|_| any_number(&mut random)).collect();
    let source = compose("lib::symmetric", DEFAULTS).unwrap() + &THREE_TEST.replace("FUNCTION", "weights_symmetric");
    let outputs = run(&source, &[], &inputs, ROWS, 3);
    for (pair, found) in inputs.chunks_exact(2).zip(outputs.chunks_exact(3)) {
        let twin = weights_symmetric(pair[0], pair[1]);
        for k in 0..3 {
            // The smaller weight is half a difference of numbers of the size of alpha, each a few roundings off.
            let rounding = 8.0 * f32::EPSILON * twin[0];
            let close = agree(found[k], twin[k]) || (found[k] - twin[k]).abs() <= rounding;
            assert!(found[k].is_finite() && close, "{k} of {pair:?}: {found:?} and {twin:?}");
        }
    }
}

#[test]
fn published_weights_are_finite_and_alike_where_they_are_stable() {
    let mut random = Random::new(14);
    // The published form is stable where the back end is much the denser.
    let mut inputs: Vec<f32> = (0..ROWS / 4).map(|_| any_number(&mut random)).collect();
    let stable = inputs.len() / 2;
    for pair in inputs[..stable].chunks_exact_mut(2) {
        pair[0] = random.between(1.0, 50.0) as f32;
        pair[1] = pair[0] * random.between(0.0, 0.1) as f32;
    }
    let rows = inputs.len() / 2;
    let source = compose("lib::published", DEFAULTS).unwrap() + &THREE_TEST.replace("FUNCTION", "linear_published");
    let outputs = run(&source, &[], &inputs, rows, 3);
    for (i, (pair, found)) in inputs.chunks_exact(2).zip(outputs.chunks_exact(3)).enumerate() {
        let twin = linear_published(pair[0], pair[1]);
        for k in 0..3 {
            assert!(found[k].is_finite() && twin[k].is_finite(), "{k} of {pair:?}: {found:?} and {twin:?}");
            // Differences of error functions, as published: a few roundings of the terms, which are of the order of 10.
            let close = (found[k] - twin[k]).abs() <= 1e-5;
            assert!(2 * i >= stable || close, "{k} of {pair:?}: {found:?} and {twin:?}");
        }
    }
}

const INTEGRATE_TEST: &str = "
fn row(i: u32) {
    let range = vec2<u32>(inputs[5u * i], inputs[5u * i + 1u]);
    let s_front = bitcast<f32>(inputs[5u * i + 2u]);
    let s_back = bitcast<f32>(inputs[5u * i + 3u]);
    let result = integrate(range, s_front, s_back, bitcast<f32>(inputs[5u * i + 4u]));
    for (var k = 0u; k < 4u; k++) {
        outputs[4u * i + k] = bitcast<u32>(result[k]);
    }
}
";

pub(crate) fn bytes(pieces: &[Piece]) -> Vec<u8> {
    pieces.iter().flat_map(|p| [p.low, p.high, p.s].concat()).flat_map(f32::to_ne_bytes).collect()
}

/// Up to 12 control points with steps and peaks; every piece linear.
pub(crate) fn random_pieces(random: &mut Random) -> Vec<Piece> {
    let mut places: Vec<f64> = (0..2 + random.below(11)).map(|_| random.between(-0.2, 1.2)).collect();
    places.sort_by(f64::total_cmp);
    let mut opacity: Vec<[f64; 2]> = Vec::new();
    let mut color: Vec<[f64; 4]> = Vec::new();
    for s in places {
        let height = [0.0, 1.0, 30.0][random.below(3)];
        opacity.push([s, random.between(0.0, 1.0) * height]);
        if random.below(3) == 0 {
            opacity.push([s, random.between(0.0, 1.0) * height]);
        }
        color.push([s, random.between(0.0, 1.0), random.between(0.0, 1.0), random.between(0.0, 2.0)]);
    }
    transfer_f32::pieces(&transfer(&color, &opacity), [0.0, 1.0], 1.0)
}

#[test]
fn whole_segments() {
    let source = compose("shading::post_exact", DEFAULTS).unwrap() + INTEGRATE_TEST;
    let mut random = Random::new(12);
    let (rows, mut worst) = (10_000, 0.0f32);
    for _ in 0..20 {
        let pieces = random_pieces(&mut random);
        let inputs: Vec<f32> = (0..rows)
            .flat_map(|_| {
                let front = match random.below(4) {
                    // Exactly on a control point, and at the ends of the range.
                    0 => pieces[random.below(pieces.len())].s[0].clamp(0.0, 1.0),
                    1 => random.below(2) as f32,
                    _ => random.between(0.0, 1.0) as f32,
                };
                let back = match random.below(4) {
                    0 => front,
                    1 => (front + random.between(-1e-6, 1e-6) as f32).clamp(0.0, 1.0),
                    _ => random.between(0.0, 1.0) as f32,
                };
                let length = [0.0, 10f64.powf(random.between(-8.0, 1.0)) as f32][random.below(16).min(1)];
                // The pieces that the segment meets, or all.
                let met = [front.min(back), front.max(back)].map(|s| transfer_f32::piece_at(&pieces, s));
                let range = if random.below(2) == 0 { met } else { [0, pieces.len() - 1] };
                let [first, last] = range.map(|k| f32::from_bits(k as u32));
                [first, last, front, back, length]
            })
            .collect();
        let outputs = run(&source, &[Bound::Storage(0, 1, &bytes(&pieces))], &inputs, rows, 4);
        for (row, found) in inputs.chunks_exact(5).zip(outputs.chunks_exact(4)) {
            let range = [row[0], row[1]].map(|k| k.to_bits() as usize);
            let twin = transfer_f32::integrate(&pieces, range, Weights::Direct, row[2], row[3], row[4]);
            for k in 0..4 {
                let error = (found[k] - twin[k]).abs();
                worst = worst.max(error);
                // A dozen pieces, each with the error of its weights.
                let close = error <= 4.0 * ABSOLUTE && error <= 4.0 * RELATIVE * twin[k].abs() + SMALLEST;
                assert!(found[k].is_finite() && close, "{row:?}: {found:?} and {twin:?}");
            }
        }
    }
    println!("largest difference {worst:.1e} over {} segments", 20 * rows);
}

const VERTEX_TEST: &str = "
fn row(i: u32) {
    var segment: Segment;
    for (var k = 0u; k < 4u; k++) {
        segment.front[k] = bitcast<f32>(inputs[9u * i + k]);
        segment.back[k] = bitcast<f32>(inputs[9u * i + 4u + k]);
    }
    segment.length = bitcast<f32>(inputs[9u * i + 8u]);
    let result = shade(vec2<u32>(0u), segment);
    for (var k = 0u; k < 4u; k++) {
        outputs[4u * i + k] = bitcast<u32>(result[k]);
    }
}
";

#[test]
fn segments_classified_at_the_vertices() {
    let axes = [("shading", "shading::vertex"), ("quantity", "quantity::color"), ("attributes", "attributes::given")];
    let source = compose("shading::vertex", &choose(DEFAULTS, &axes)).unwrap() + VERTEX_TEST;
    let (mut random, rows) = (Random::new(15), 100_000);
    let inputs: Vec<f32> = (0..rows)
        .flat_map(|_| {
            let mut row = [0.0; 9].map(|_: f32| random.between(0.0, 1.0) as f32);
            for k in [3, 7, 8] {
                row[k] = [0.0, 10f64.powf(random.between(-8.0, 4.0)) as f32][random.below(16).min(1)];
            }
            row
        })
        .collect();
    let outputs = run(&source, &[], &inputs, rows, 4);
    for (row, found) in inputs.chunks_exact(9).zip(outputs.chunks_exact(4)) {
        let [front, back] = [0, 4].map(|from| std::array::from_fn(|k| row[from + k]));
        let twin = vertex_f32::shade(Weights::Direct, front, back, row[8]);
        assert!((0..4).all(|k| agree(found[k], twin[k])), "{row:?}: {found:?} and {twin:?}");
    }
}

#[test]
fn a_planted_difference_is_seen() {
    let good = weights_direct(0.7, 1.9);
    for value in good {
        assert!(agree(value, value));
        for bad in [value * (1.0 + 3e-5), value + 3e-6, f32::NAN, f32::INFINITY, 0.0] {
            assert!(!agree(bad, value), "{bad} for {value}");
        }
    }
    assert!(agree(0.0, 1e-39) && !agree(0.0, 1e-30), "flushed to zero only where denormal");
    // A shader with a wrong digit in a coefficient is caught by the same inputs.
    let source = compose("lib::segment", DEFAULTS).unwrap().replace("0.37945005", "0.37955005") + SEGMENT_TEST;
    let outputs = run(&source, &[], &[1.5, 1.5], 1, 8);
    let twin = weights_direct(1.5, 1.5);
    assert!(agree(outputs[0], twin[0]) && !agree(outputs[1], twin[1]) && !agree(outputs[2], twin[2]));
}

const NO_DATA_TEST: &str = "
fn row(i: u32) {
    let at = 5u * i;
    let segment = bitcast<vec4<f32>>(vec4<u32>(inputs[at], inputs[at + 1u], inputs[at + 2u], inputs[at + 3u]));
    let shaded = shade_no_data(segment, bitcast<f32>(inputs[at + 4u]));
    for (var k = 0u; k < 4u; k++) {
        outputs[4u * i + k] = bitcast<u32>(shaded[k]);
    }
}
";

#[test]
fn segments_without_data() {
    let mut random = Random::new(23);
    let rows = ROWS / 4;
    let mut inputs = Vec::with_capacity(5 * rows);
    for _ in 0..rows {
        // Luminances are cleaned where scenes are made; the optical depth here.
        inputs.extend([0; 3].map(|_| random.between(0.0, 1.0) as f32));
        inputs.extend([0; 2].map(|_| any_number(&mut random)));
    }
    let outputs = run(&(compose("lib::no_data", DEFAULTS).unwrap() + NO_DATA_TEST), &[], &inputs, rows, 4);
    for (row, found) in inputs.chunks_exact(5).zip(outputs.chunks_exact(4)) {
        let twin = shade_no_data([row[0], row[1], row[2], row[3]], row[4]);
        assert!((0..4).all(|k| agree(found[k], twin[k])), "{row:?}: {found:?} and {twin:?}");
    }
}

const SHARE_TEST: &str = "
fn row(i: u32) {
    let ends = bitcast<vec2<f32>>(vec2<u32>(inputs[3u * i + 1u], inputs[3u * i + 2u]));
    outputs[i] = bitcast<u32>(share_before(bitcast<f32>(inputs[3u * i]), ends));
}
";

#[test]
fn shares_of_segments_before_a_depth() {
    let mut random = Random::new(17);
    let mut inputs = Vec::with_capacity(3 * ROWS);
    for row in 0..ROWS {
        let front = random.between(-2.0, 2.0);
        // Down to lengths that single precision does not tell, and none.
        let length = if row % 9 == 0 { 0.0 } else { 10f64.powf(random.between(-9.0, 1.0)) };
        let limit = if row % 7 == 0 { 1e30 } else { front + length * random.between(-0.5, 1.5) };
        inputs.extend([limit, front, front + length].map(|v| v as f32));
    }
    let outputs = run(&(compose("lib::segment", DEFAULTS).unwrap() + SHARE_TEST), &[], &inputs, ROWS, 1);
    let (mut none, mut some, mut all) = (0, 0, 0);
    for (row, &found) in inputs.chunks_exact(3).zip(&outputs) {
        let twin = share_before(row[0], [row[1], row[2]]);
        assert!(agree(found, twin) && (0.0..=1.0).contains(&found), "{row:?}: {found} and {twin}");
        let exact = (f64::from(row[0]) - f64::from(row[1])) / (f64::from(row[2]) - f64::from(row[1]));
        assert!(row[2] <= row[1] || (f64::from(twin) - exact.clamp(0.0, 1.0)).abs() < 1e-6, "{row:?}: {twin}");
        none += usize::from(twin == 0.0);
        all += usize::from(twin == 1.0);
        some += usize::from(twin > 0.0 && twin < 1.0);
    }
    assert!(none > ROWS / 10 && some > ROWS / 10 && all > ROWS / 10, "{none} {some} {all}");
}
