//! Functions that look tables up, and those that clip and dither: WGSL on the driver, Rust here.

use tetlux_optics::transfer_f32::{Weights, integrate, piece_at};
use tetlux_shaders::{DEFAULTS, choose, compose};
use tetlux_tables::{
    AxisMap, Construction, Precision, Table, TableKind, TableSpec, Thickness, TransferSpec, sample_color_ratio,
    sample_pre_integrated, sample_weights,
};
use tetlux_tests::Random;

use crate::device::{Bound, run};
use crate::functions::{THREE_TEST, any_number, bytes, random_pieces};

/// A driver's roots and exponentials are a few units of the last place off, which moves a lookup by that share of a
/// table's whole axis; values are at most 1 and change by no more than 60 along an axis.
const TOLERANCE: f32 = 3e-5;

fn table(size: [u32; 3], kind: TableKind) -> Table {
    Table::build(&TableSpec { id: "t".into(), kind, size, precision: Precision::F32 }).unwrap()
}

/// The uniform `Lookup` of tables in single precision.
pub(crate) fn lookup(length: f32) -> Vec<u8> {
    let values = [[0.0f32; 8], [1.0; 8]].concat();
    values.into_iter().chain([length, 0.0, 0.0, 0.0]).flat_map(f32::to_ne_bytes).collect()
}

#[test]
fn weights_from_tables() {
    let mut random = Random::new(21);
    let rows = 200_000;
    let inputs: Vec<f32> = (0..2 * rows).map(|_| any_number(&mut random)).collect();
    for (module, table) in [
        ("weights::psi", Table::build(&TableSpec::default_psi()).unwrap()),
        ("weights::q", Table::build(&TableSpec::default_q()).unwrap()),
    ] {
        let source = compose(module, DEFAULTS).unwrap() + &THREE_TEST.replace("FUNCTION", "weights");
        let bound = [Bound::Uniform(2, 0, &lookup(1.0)), Bound::Texture(2, 1, &table)];
        let outputs = run(&source, &bound, &inputs, rows, 3);
        let mut worst = 0.0f32;
        for (pair, found) in inputs.chunks_exact(2).zip(outputs.chunks_exact(3)) {
            let twin = sample_weights(&table, pair[0], pair[1]);
            for k in 0..3 {
                let error = (found[k] - twin[k]).abs();
                assert!(error <= TOLERANCE, "{module} {k} of {pair:?}: {found:?} and {twin:?}");
                worst = worst.max(error);
            }
        }
        println!("{module}: at most {worst:.1e} apart");
        // Planted: the table of another size gives another result.
        let small = table_of_half(&table);
        let bound = [Bound::Uniform(2, 0, &lookup(1.0)), Bound::Texture(2, 1, &small)];
        let [a, b] = [8.0, 0.01];
        let found = run(&source, &bound, &[a, b], 1, 3);
        assert!((found[1] - sample_weights(&table, a, b)[1]).abs() > TOLERANCE);
    }
}

fn table_of_half(table: &Table) -> Table {
    let spec = table.spec();
    Table::build(&TableSpec { size: [spec.size[0] / 16, spec.size[1] / 16, 1], ..spec.clone() }).unwrap()
}

/// Four numbers of three.
const FOUR_TEST: &str = "
fn row(i: u32) {
    let a = bitcast<f32>(inputs[3u * i]);
    let result = FUNCTION(a, bitcast<f32>(inputs[3u * i + 1u]), bitcast<f32>(inputs[3u * i + 2u]));
    for (var k = 0u; k < 4u; k++) {
        outputs[4u * i + k] = bitcast<u32>(result[k]);
    }
}
";

fn transfer_spec() -> TransferSpec {
    TransferSpec {
        color: vec![[0.0, 0.9, 0.1, 0.2], [0.4, 0.2, 0.8, 0.3], [1.0, 0.1, 0.3, 1.0]],
        opacity: vec![[0.0, 0.0], [0.3, 4.0], [0.35, 0.5], [0.9, 1.0], [1.0, 9.0]],
        range: [0.0, 1.0],
        unit_distance: 1.0,
        max_length: 2.0,
    }
}

#[test]
fn pre_integrated_segments() {
    let mut random = Random::new(22);
    let rows = 100_000;
    let inputs: Vec<f32> = (0..rows)
        .flat_map(|_| {
            let [f, b] = [0.0, 1.0].map(|_| random.between(-0.01, 1.01) as f32);
            [f, b, 10f64.powf(random.between(-6.0, 0.5)) as f32]
        })
        .collect();
    let pre = |thickness| TableKind::PreIntegrated {
        transfer: transfer_spec(),
        thickness,
        construction: Construction::Exact,
    };
    let uniform = table([24, 20, 16], pre(Thickness::Uniform));
    let logarithmic = table([24, 20, 9], pre(Thickness::Logarithmic));
    assert!(matches!(logarithmic.axes()[2].map, AxisMap::Logarithm { .. }));
    let mean = table([32, 28, 1], TableKind::MeanExtinction { transfer: transfer_spec() });
    let ratio = table([24, 20, 12], TableKind::ColorRatio { transfer: transfer_spec() });
    type Twin<'a> = Box<dyn Fn(f32, f32, f32) -> [f32; 4] + 'a>;
    let cases: [(&str, &str, f32, Vec<Bound>, Twin); 3] = [
        (
            "shading::preint",
            "sample_pre_integrated",
            0.5,
            vec![Bound::Texture(2, 2, &uniform)],
            Box::new(|f, b, l| sample_pre_integrated(&uniform, f, b, l)),
        ),
        (
            "shading::preint_log",
            "sample_pre_integrated",
            0.5,
            vec![Bound::Texture(2, 2, &logarithmic)],
            Box::new(|f, b, l| sample_pre_integrated(&logarithmic, f, b, l)),
        ),
        (
            "shading::preint_q",
            "sample_color_ratio",
            1.0,
            vec![Bound::Texture(2, 1, &mean), Bound::Texture(2, 2, &ratio)],
            Box::new(|f, b, l| sample_color_ratio(&mean, &ratio, f, b, l)),
        ),
    ];
    for (module, function, length, textures, twin) in cases {
        let source = compose(module, DEFAULTS).unwrap() + &FOUR_TEST.replace("FUNCTION", function);
        let lookup = lookup(length);
        let bound: Vec<Bound> = std::iter::once(Bound::Uniform(2, 0, &lookup)).chain(textures).collect();
        let outputs = run(&source, &bound, &inputs, rows, 4);
        let mut worst = 0.0f32;
        for (row, found) in inputs.chunks_exact(3).zip(outputs.chunks_exact(4)) {
            let twin = twin(row[0], row[1], row[2]);
            for k in 0..4 {
                let error = (found[k] - twin[k]).abs();
                assert!(error <= TOLERANCE, "{module} {k} of {row:?}: {found:?} and {twin:?}");
                worst = worst.max(error);
            }
        }
        println!("{module}: at most {worst:.1e} apart");
        assert!(outputs.iter().any(|&v| v > 0.5), "something is seen");
    }
}

const CLIP_TEST: &str = "
fn row(i: u32) {
    let s_front = bitcast<f32>(inputs[5u * i + 2u]);
    let s_back = bitcast<f32>(inputs[5u * i + 3u]);
    let length = bitcast<f32>(inputs[5u * i + 4u]);
    let last = arrayLength(&pieces) - 1u;
    // Each piece by itself, composited as the cell's pieces are.
    var result = vec4<f32>(0.0);
    for (var n = inputs[5u * i]; n <= inputs[5u * i + 1u]; n++) {
        let k = select(inputs[5u * i + 1u] - (n - inputs[5u * i]), n, s_back >= s_front);
        result += (1.0 - result.a) * integrate_piece(vec2<u32>(k, last), s_front, s_back, length);
    }
    for (var k = 0u; k < 4u; k++) {
        outputs[4u * i + k] = bitcast<u32>(result[k]);
    }
}
";

#[test]
fn a_segment_clipped_to_each_piece_is_whole() {
    let source = compose("shading::post_clip", DEFAULTS).unwrap() + CLIP_TEST;
    let mut random = Random::new(23);
    for _ in 0..10 {
        let pieces = random_pieces(&mut random);
        let rows = 5000;
        let inputs: Vec<f32> = (0..rows)
            .flat_map(|_| {
                let front = random.between(0.0, 1.0) as f32;
                let back = if random.below(4) == 0 { front } else { random.between(0.0, 1.0) as f32 };
                let met = [front.min(back), front.max(back)].map(|s| f32::from_bits(piece_at(&pieces, s) as u32));
                [met[0], met[1], front, back, 10f64.powf(random.between(-6.0, 1.0)) as f32]
            })
            .collect();
        let outputs = run(&source, &[Bound::Storage(0, 1, &bytes(&pieces))], &inputs, rows, 4);
        for (row, found) in inputs.chunks_exact(5).zip(outputs.chunks_exact(4)) {
            let range = [row[0], row[1]].map(|k| k.to_bits() as usize);
            let twin = integrate(&pieces, range, Weights::Direct, row[2], row[3], row[4]);
            for k in 0..4 {
                // The order of additions differs: a dozen pieces, each with the error of its weights.
                assert!((found[k] - twin[k]).abs() <= 1e-5, "{row:?}: {found:?} and {twin:?}");
            }
        }
    }
}

const DITHER_TEST: &str = "
fn row(i: u32) {
    let random = noise(vec2<u32>(i % 97u, i / 97u), 1000u + i % 13u);
    outputs[2u * i] = bitcast<u32>(random);
    outputs[2u * i + 1u] = bitcast<u32>(dithered(bitcast<f32>(inputs[i]), random));
}
";

#[test]
fn dithering_is_right_in_the_mean() {
    let choices = choose(DEFAULTS, &[("output", "output::dither")]);
    let source = compose("output::dither", &choices).unwrap() + DITHER_TEST;
    let rows = 100_000;
    for alpha in [0.0f32, 0.001, 0.0157, 0.5, 1.0] {
        let outputs = run(&source, &[], &vec![alpha; rows], rows, 2);
        let mean = |k: usize| outputs.iter().skip(k).step_by(2).map(|&v| f64::from(v)).sum::<f64>() / rows as f64;
        // Four standard deviations of a mean of that many: of a uniform number, and of a step of 1/255.
        let deviation = 4.0 / (rows as f64).sqrt();
        assert!((mean(0) - 0.5).abs() < deviation * 0.29, "{}", mean(0));
        assert!((mean(1) - f64::from(alpha)).abs() < deviation * 0.5 / 255.0 + 1e-7, "{alpha}: {}", mean(1));
        for pair in outputs.chunks_exact(2) {
            assert!((0.0..1.0).contains(&pair[0]));
            let steps = pair[1] * 255.0;
            assert!((steps - steps.round()).abs() < 1e-3, "{} is no step", pair[1]);
            assert!((steps - alpha * 255.0).abs() <= 1.001, "the nearest above or below");
        }
    }
    // Planted: rounding down instead is not right in the mean.
    let source = source.replace("select(0.0, 1.0, fract(steps) > random)", "0.0");
    let outputs = run(&source, &[], &vec![0.001; rows], rows, 2);
    assert!(outputs.iter().skip(1).step_by(2).all(|&v| v == 0.0));
}
