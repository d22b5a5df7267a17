use tetlux_optics::segment::segment;

use super::*;
use crate::accuracy::nine_nodes;
use crate::{Precision, Table, TableKind, TableSpec, Thickness, measure, measure_color_ratio, sample_pre_integrated};

fn build(kind: TableKind, size: [u32; 3]) -> Table {
    Table::build(&TableSpec { id: "t".to_owned(), kind, size, precision: Precision::F32 }).unwrap()
}

fn pre_integrated(max_length: f64, thickness: Thickness, construction: Construction, size: [u32; 3]) -> Table {
    build(TableKind::PreIntegrated { transfer: nine_nodes(max_length), thickness, construction }, size)
}

/// A constant function: every table is exact, whatever its resolution.
fn constant() -> TransferSpec {
    TransferSpec {
        color: vec![[0.0, 0.25, 0.5, 1.0]],
        opacity: vec![[0.0, 0.7]],
        range: [-3.0, 5.0],
        unit_distance: 0.5,
        max_length: 2.0,
    }
}

#[test]
fn nodes_hold_the_exact_integral() {
    // Of f32 arithmetic: segment weights (6.3e-6) over up to ten pieces, and cuts of 1e-7 times slopes of up to 80.
    let tolerance = 1e-4;
    let transfer = nine_nodes(3.0);
    let function = transfer.function().unwrap();
    for thickness in [Thickness::Uniform, Thickness::Logarithmic] {
        let table = pre_integrated(3.0, thickness, Construction::Exact, [12, 13, 6]);
        for (i, j, k) in [(0, 12, 5), (11, 0, 3), (4, 7, 1), (5, 5, 5), (2, 9, 0)] {
            let [s_f, s_b, l] = [(0, i), (1, j), (2, k)].map(|(axis, at): (usize, u32)| table.axes()[axis].value(at));
            let exact = segment(&function, 1.0, s_f, s_b, l);
            let got = table.texel(i as usize, j as usize, k as usize);
            for c in 0..3 {
                assert!((f64::from(got[c]) - exact.color[c]).abs() < tolerance, "{thickness:?} {i} {j} {k}: {got:?}");
            }
            assert!((f64::from(got[3]) - exact.alpha).abs() < tolerance, "{thickness:?} {i} {j} {k}: {got:?}");
        }
    }
}

#[test]
fn composing_a_constant_function_is_exact() {
    // f32 rounding of up to 20 compositions.
    let tolerance = 2e-6;
    for (thickness, slices) in [(Thickness::Uniform, 21), (Thickness::Logarithmic, 10)] {
        let kind =
            TableKind::PreIntegrated { transfer: constant(), thickness, construction: Construction::Incremental };
        let table = build(kind, [5, 5, slices]);
        for k in 0..slices as usize {
            let alpha = -(-0.7 / 0.5 * table.axes()[2].value(k as u32)).exp_m1();
            for (i, j) in [(0, 0), (4, 0), (1, 3)] {
                let got = table.texel(i, j, k).map(f64::from);
                for (value, share) in got.into_iter().zip([0.25, 0.5, 1.0, 1.0]) {
                    assert!((value - share * alpha).abs() < tolerance, "{thickness:?} ({i}, {j}, {k}): {got:?}");
                }
            }
        }
    }
}

#[test]
fn incremental_slices_approach_the_exact_ones_with_resolution() {
    for thickness in [Thickness::Uniform, Thickness::Logarithmic] {
        let difference = |n: u32| {
            let [a, b] = [Construction::Exact, Construction::Incremental]
                .map(|construction| pre_integrated(2.0, thickness, construction, [n, n, 10]));
            a.texels().iter().zip(b.texels()).map(|(a, b)| f64::from((a - b).abs())).sum::<f64>()
                / a.texels().len() as f64
        };
        let (coarse, fine) = (difference(32), difference(128));
        assert!(fine < 0.5 * coarse && fine > 0.0, "{thickness:?}: {coarse}, {fine}");
    }
}

#[test]
fn mean_extinction_is_exact_at_its_nodes() {
    let transfer = TransferSpec { unit_distance: 0.25, ..nine_nodes(1.0) };
    let table = build(TableKind::MeanExtinction { transfer: transfer.clone() }, [64, 65, 1]);
    let function = transfer.function().unwrap();
    for (i, j) in [(0, 64), (63, 0), (10, 50), (33, 2), (0, 0), (63, 64)] {
        let [s_f, s_b] = [(0, i), (1, j)].map(|(axis, at): (usize, u32)| table.axes()[axis].value(at));
        // A depth small enough not to be opaque, large enough for its logarithm to keep its digits.
        let exact = -segment(&function, 0.25, s_f, s_b, 0.5).transmittance.ln() / 0.5;
        let got = f64::from(table.texel(i as usize, j as usize, 0)[0]);
        assert!((got - exact).abs() < 1e-6 * (1.0 + exact), "({i}, {j}): {got} for {exact}");
    }
}

#[test]
fn the_thin_slice_is_the_weighted_mean_colour() {
    // Opacity s, red 1 up to 1/2 and 0 above (a step): from 0 to 1 the weights of the halves are 1/8 and 3/8.
    let transfer = TransferSpec {
        color: vec![[0.0, 1.0, 0.3, 0.0], [0.5, 1.0, 0.3, 0.0], [0.5, 0.0, 0.3, 1.0], [1.0, 0.0, 0.3, 1.0]],
        opacity: vec![[0.0, 0.0], [1.0, 1.0]],
        range: [0.0, 1.0],
        unit_distance: 1.0,
        max_length: 1.0,
    };
    let table = build(TableKind::ColorRatio { transfer }, [5, 5, 4]);
    // THIN, and f32 weights of thin segments.
    let tolerance = 1e-5;
    for (i, j) in [(0, 4), (4, 0)] {
        let [r, g, b, _] = table.texel(i, j, 0);
        assert!((r - 0.25).abs() < tolerance && (g - 0.3).abs() < tolerance && (b - 0.75).abs() < tolerance, "{r} {b}");
    }
    // An infinite depth shows the front end alone.
    assert!((table.texel(4, 0, 3)[2] - 1.0).abs() < 1e-4, "{:?}", table.texel(4, 0, 3));
    // Nothing between 0 and 0 absorbs: the mean of the ends' luminances, and no NaN.
    assert_eq!(table.texel(0, 0, 2)[..3], [1.0, 0.3, 0.0]);
}

#[test]
fn the_better_form_is_better() {
    let size = [128, 128, 16];
    let raw = pre_integrated(10.0, Thickness::Logarithmic, Construction::Exact, size);
    let mean = build(TableKind::MeanExtinction { transfer: nine_nodes(10.0) }, [128, 128, 1]);
    let ratio = build(TableKind::ColorRatio { transfer: nine_nodes(10.0) }, size);
    let [raw, better] = [measure(&raw).unwrap(), measure_color_ratio(&mean, &ratio).unwrap()];
    assert!(better.mean < 0.5 * raw.mean, "{better:?} and {raw:?}");
}

#[test]
fn the_logarithmic_axis_overestimates_thin_segments_by_six_percent() {
    // Kraus, Qiao and Ebert's axis interpolates linearly in log2 l: 1 + f for a value of 2^f, at most 1.0615.
    let kind = TableKind::PreIntegrated {
        transfer: TransferSpec { opacity: vec![[0.0, 1e-4]], ..constant() },
        thickness: Thickness::Logarithmic,
        construction: Construction::Exact,
    };
    let table = build(kind, [2, 2, 12]);
    let worst = (0..200).map(|i| 0.1 * 2.0_f64.powf(f64::from(i) / 50.0)).map(|l| {
        let exact = -(-1e-4 / 0.5 * l).exp_m1();
        f64::from(sample_pre_integrated(&table, 0.3, 0.6, l as f32)[3]) / exact
    });
    let worst = worst.fold(0.0, f64::max);
    assert!((worst - 1.0615).abs() < 2e-4, "{worst}");
}
