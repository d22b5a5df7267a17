use proptest::prelude::*;

use super::*;
use crate::Table;
use crate::accuracy::nine_nodes;

fn with(kind: TableKind, size: [u32; 3]) -> TableSpec {
    TableSpec { id: "t".to_owned(), kind, size, precision: Precision::F32 }
}

fn pre_integrated(transfer: TransferSpec) -> TableSpec {
    let kind =
        TableKind::PreIntegrated { transfer, thickness: Thickness::Uniform, construction: Construction::Incremental };
    with(kind, [8, 8, 8])
}

/// The field that a specification is refused for.
fn refused(spec: &TableSpec) -> String {
    let error = spec.validate().unwrap_err();
    assert_eq!(Table::build(spec).unwrap_err().to_string(), error.to_string(), "nothing is built");
    error.to_string()
}

#[test]
fn defaults_are_valid_and_named_apart() {
    let all = TableSpec::defaults();
    for (index, spec) in all.iter().enumerate() {
        spec.validate().unwrap();
        assert_eq!(TableSpec::named(&spec.id).unwrap(), *spec);
        assert!(all[..index].iter().all(|other| other.id != spec.id));
        assert_eq!(spec.axes().len(), if spec.kind.has_depth() { 3 } else { 2 });
        let text = serde_json::to_string(spec).unwrap();
        assert_eq!(serde_json::from_str::<TableSpec>(&text).unwrap(), *spec, "{text}");
    }
    let error = TableSpec::named("nothing").unwrap_err().to_string();
    assert!(error.contains("nothing") && error.contains("psi"), "{error}");
}

#[test]
fn sizes_are_refused_by_name() {
    for size in [[0, 8, 1], [8, 1, 1], [8, 8, 0], [8, 8, 2], [MAX_NODES + 1, 8, 1], [u32::MAX, u32::MAX, 1]] {
        assert!(refused(&with(TableKind::Psi, size)).contains("size"), "{size:?}");
    }
    let cube = TableKind::FrontBack { max_extinction: 1.0, max_length: 1.0 };
    for size in [[8, 8, 1], [8, 8, 0], [1, 8, 8], [4096, 4096, 4096]] {
        assert!(refused(&with(cube.clone(), size)).contains("size"), "{size:?}");
    }
    let mut spec = pre_integrated(nine_nodes(1.0));
    spec.size = [8, 9, 8];
    assert!(refused(&spec).contains("size"));
}

#[test]
fn names_that_are_no_file_names_are_refused() {
    for id in ["", "a/b", "..", "Q", "a b", "q\n", &"x".repeat(41)] {
        let spec = TableSpec { id: id.to_owned(), ..with(TableKind::Psi, [8, 8, 1]) };
        assert!(refused(&spec).contains("id is"), "{id}");
    }
}

#[test]
fn parameters_are_refused_by_name() {
    let bad = [-1.0, 0.0, f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e300];
    for value in bad {
        let cases = [
            (TableKind::Gaussian { max_p: value, max_t: 4.0 }, "max_p"),
            (TableKind::Gaussian { max_p: 10.0, max_t: value }, "max_t"),
            (TableKind::GaussianBounded { max_t: value }, "max_t"),
            (TableKind::Sine { max_m: value }, "max_m"),
            (TableKind::Triangle { max_a: value }, "max_a"),
        ];
        for (kind, field) in cases {
            let error = refused(&with(kind, [8, 8, 1]));
            assert!(error.contains(&format!("{field} is {value}")), "{error}");
        }
        let cube = TableKind::FrontBack { max_extinction: value, max_length: 1.0 };
        assert!(refused(&with(cube, [8, 8, 8])).contains("max_extinction"));
        let cube = TableKind::FrontBack { max_extinction: 1.0, max_length: value };
        assert!(refused(&with(cube, [8, 8, 8])).contains("max_length"));
        assert!(refused(&pre_integrated(nine_nodes(value))).contains("transfer.max_length"));
        let transfer = TransferSpec { unit_distance: value, ..nine_nodes(1.0) };
        assert!(refused(&pre_integrated(transfer)).contains("transfer.unit_distance"));
    }
    // An exponential of it leaves f32.
    assert!(refused(&with(TableKind::Sine { max_m: 81.0 }, [8, 8, 1])).contains("max_m"));
}

#[test]
fn transfer_functions_are_refused_by_node() {
    for range in [[1.0, 0.0], [0.5, 0.5], [f64::NAN, 1.0], [0.0, f64::INFINITY], [-1.7e308, 1.7e308]] {
        let transfer = TransferSpec { range, ..nine_nodes(1.0) };
        assert!(refused(&pre_integrated(transfer)).contains("transfer.range"), "{range:?}");
    }
    let mut descending = nine_nodes(1.0);
    descending.opacity[3][0] = 0.05;
    assert!(refused(&pre_integrated(descending)).contains("opacity node 3"));
    let mut negative = nine_nodes(1.0);
    negative.color[1][2] = -0.5;
    assert!(refused(&pre_integrated(negative)).contains("color node 1"));
    let mut nan = nine_nodes(1.0);
    nan.opacity[2][1] = f64::NAN;
    assert!(refused(&pre_integrated(nan)).contains("opacity node 2"));
    let empty = TransferSpec { opacity: Vec::new(), ..nine_nodes(1.0) };
    assert!(refused(&pre_integrated(empty)).contains("no opacity nodes"));
}

#[test]
fn a_transfer_function_survives_its_description() {
    let function = nine_nodes(2.0).function().unwrap();
    assert_eq!(TransferSpec::new(&function, [0.0, 1.0], 1.0, 2.0), nine_nodes(2.0));
}

proptest! {
    #[test]
    fn what_is_not_refused_is_built_finite(
        size in prop::array::uniform3(0u32..6),
        values in prop::array::uniform2(prop_oneof![prop::num::f64::ANY, 1e-15..100.0, Just(1e15), Just(1e-15), Just(80.0)]),
        which in 0usize..8,
        precision in prop::sample::select(&Precision::ALL),
    ) {
        let [v, w] = values;
        let kinds = [
            TableKind::Psi,
            TableKind::Q { design: Design::R },
            TableKind::QPair,
            TableKind::FrontBack { max_extinction: v, max_length: w },
            TableKind::Gaussian { max_p: v, max_t: w.min(100.0) },
            TableKind::GaussianBounded { max_t: v },
            TableKind::Sine { max_m: v },
            TableKind::Triangle { max_a: v },
        ];
        let spec = TableSpec { id: "p".to_owned(), kind: kinds[which].clone(), size, precision };
        if let Ok(table) = Table::build(&spec) {
            // Values that f32 or half cannot hold are refused when they are stored, not here.
            prop_assert!(table.texels().iter().all(|v| !v.is_nan()), "{spec:?}");
        }
    }
}
