use super::*;
use crate::{Design, Precision, TableSpec};

fn build(kind: TableKind, size: [u32; 3], precision: Precision) -> Table {
    Table::build(&TableSpec { id: "m".to_owned(), kind, size, precision }).unwrap()
}

fn max_error(kind: TableKind, n: u32, precision: Precision) -> f64 {
    measure(&build(kind, [n, n, 1], precision)).unwrap().max
}

#[test]
fn q_falls_with_the_square_of_the_size_and_psi_with_its_root() {
    let design_q = TableKind::Q { design: Design::Q };
    let q = [64, 128, 256].map(|n| max_error(design_q.clone(), n, Precision::F32));
    let psi = [64, 128, 256].map(|n| max_error(TableKind::Psi, n, Precision::F32));
    for i in 0..2 {
        // Halving the step of a bilinear table divides its error by 4 where it is smooth, and by sqrt 2 at the end of
        // an axis where the function is a square root.
        assert!((3.5..4.5).contains(&(q[i] / q[i + 1])), "{q:?}");
        assert!((1.35..1.5).contains(&(psi[i] / psi[i + 1])), "{psi:?}");
    }
    assert!(q[1] < 5e-5, "the default table: {}", q[1]);
}

#[test]
fn design_r_is_better_than_q_and_r4_between() {
    let [q, r] = [Design::Q, Design::R].map(|design| max_error(TableKind::Q { design }, 96, Precision::F32));
    assert!(r < 0.6 * q, "{r} and {q}");
}

#[test]
fn coarse_texels_cost_half_a_step() {
    let q = TableKind::Q { design: Design::Q };
    let exact = max_error(q.clone(), 128, Precision::F32);
    for (precision, half_step) in [(Precision::U8, 0.5 / 255.0), (Precision::U16, 0.5 / 65_535.0)] {
        // Values span 2/3 at most, and alpha is at most 1.
        let error = max_error(q.clone(), 128, precision);
        assert!(error > exact && error < exact + half_step, "{precision:?}: {error}");
    }
    let half = max_error(q, 128, Precision::F16);
    assert!(half > exact && half < exact + 2.5e-4, "2^-12 of a value of up to 2/3 and more: {half}");
}

#[test]
fn a_planted_fault_in_one_texel_is_measured() {
    let table = build(TableKind::Q { design: Design::Q }, [64, 64, 1], Precision::F32);
    let mut texels = table.texels().to_vec();
    // Node (20, 30): X is 3.6.
    texels[30 * 64 + 20] += 0.1;
    let faulty = Table::from_texels(table.spec(), texels).unwrap();
    let (before, after) = (measure(&table).unwrap().max, measure(&faulty).unwrap().max);
    assert!(after > 0.05 && before < 1e-3, "{before} and {after}");

    let mut texels = table.texels().to_vec();
    texels[100] = f32::NAN;
    assert_eq!(measure(&Table::from_texels(table.spec(), texels).unwrap()).unwrap().max, f64::INFINITY);
}

#[test]
fn both_emission_conventions_from_one_pair() {
    let pair = measure(&build(TableKind::QPair, [128, 128, 1], Precision::F32)).unwrap();
    let cube = TableKind::FrontBack { max_extinction: 10.0, max_length: 1.0 };
    let cube = measure(&build(cube, [24, 24, 24], Precision::F32)).unwrap();
    assert!(pair.max < 6e-5, "{pair:?}");
    // Bilinear in a product: of second order in the step.
    assert!(cube.max > pair.max && cube.max < 1e-2, "{cube:?}");
}

#[test]
fn bounded_widget_tables_hold_for_strengths_where_published_ones_end() {
    for kind in [TableKind::GaussianBounded { max_t: 4.0 }, TableKind::SineBounded] {
        let error = measure(&build(kind, [256, 256, 1], Precision::F32)).unwrap();
        assert!(error.max < 5e-4, "{error:?}");
    }
    for kind in [TableKind::Gaussian { max_p: 10.0, max_t: 4.0 }, TableKind::Sine { max_m: 10.0 }] {
        let error = measure(&build(kind, [256, 256, 1], Precision::F32)).unwrap();
        // The factor e^10 multiplies what interpolation loses.
        assert!(error.max.is_finite() && error.max > 5e-4, "{error:?}");
    }
    let ramp = measure(&build(TableKind::Triangle { max_a: 10.0 }, [256, 256, 1], Precision::F32)).unwrap();
    assert!(ramp.max < 1e-2, "{ramp:?}");
}

#[test]
fn shorter_widget_segments_are_worse() {
    let table = build(TableKind::GaussianBounded { max_t: 4.0 }, [128, 128, 1], Precision::F32);
    assert!(measure_widget(&table, 0.05).unwrap().max > 2.0 * measure_widget(&table, 1.0).unwrap().max);
}

#[test]
fn the_mean_does_not_depend_on_threads() {
    let table = build(TableKind::Psi, [32, 32, 1], Precision::F32);
    assert_eq!(measure(&table).unwrap(), measure(&table).unwrap());
}
