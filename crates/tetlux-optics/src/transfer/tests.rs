use super::*;
use proptest::prelude::*;

fn color(nodes: &[(f64, f64)]) -> Vec<ColorNode> {
    nodes.iter().map(|&(s, red)| ColorNode { s, rgb: [red, 0.0, 0.0] }).collect()
}

fn opacity(nodes: &[(f64, f64)]) -> Vec<OpacityNode> {
    nodes.iter().map(|&(s, opacity)| OpacityNode { s, opacity }).collect()
}

fn build(color_nodes: &[(f64, f64)], opacity_nodes: &[(f64, f64)]) -> TransferFunction {
    TransferFunction::new(color(color_nodes), opacity(opacity_nodes)).unwrap()
}

#[test]
fn opacity_nodes_count_where_there_is_no_color_node() {
    let tf = build(&[(0.0, 0.0), (1.0, 1.0)], &[(0.0, 0.0), (0.5, 3.0), (1.0, 0.0)]);
    assert_eq!(tf.opacity(0.5), 3.0);
    assert_eq!(tf.opacity(0.25), 1.5);
    assert_eq!(tf.luminance(0.5), [0.5, 0.0, 0.0]);
    assert_eq!(tf.control_points(), [0.0, 0.5, 1.0]);
    let pieces = tf.pieces();
    assert_eq!(pieces.len(), 2);
    assert_eq!(pieces[0].opacity, [0.0, 3.0]);
    assert_eq!(pieces[1].luminance, [[0.5, 0.0, 0.0], [1.0, 0.0, 0.0]]);
    assert_eq!(tf.max_opacity([0.1, 0.9]), 3.0);
}

#[test]
fn a_step_has_a_value_from_each_side() {
    let tf = build(&[(0.0, 1.0), (0.5, 2.0), (0.5, 4.0), (1.0, 5.0)], &[(0.5, 0.25), (0.5, 7.0)]);
    assert_eq!((tf.opacity_below(0.5), tf.opacity(0.5)), (0.25, 7.0));
    assert_eq!((tf.opacity(-9.0), tf.opacity(9.0)), (0.25, 7.0));
    assert_eq!((tf.luminance_below(0.5)[0], tf.luminance(0.5)[0]), (2.0, 4.0));
    assert_eq!(tf.luminance_below(0.25)[0], 1.5);
    assert_eq!(tf.pieces()[0].opacity, [0.25, 0.25]);
    assert_eq!(tf.pieces()[1].luminance[0][0], 4.0);
    // Closed range: the step at its end counts, from either side.
    assert_eq!(tf.max_opacity([0.0, 0.5]), 7.0);
    assert_eq!(tf.max_opacity([0.0, 0.49]), 0.25);
    let falling = build(&[(0.0, 1.0)], &[(0.5, 7.0), (0.5, 0.25)]);
    assert_eq!(falling.max_opacity([0.5, 1.0]), 7.0);
}

#[test]
fn constant_outside_the_nodes() {
    let tf = build(&[(1.0, 2.0), (2.0, 3.0)], &[(1.5, 0.5)]);
    assert_eq!((tf.luminance(0.0)[0], tf.luminance(5.0)[0]), (2.0, 3.0));
    assert_eq!((tf.luminance_below(0.0)[0], tf.luminance_below(5.0)[0]), (2.0, 3.0));
    assert_eq!((tf.opacity(f64::NEG_INFINITY), tf.opacity(f64::INFINITY)), (0.5, 0.5));
    assert!(tf.opacity(f64::NAN).is_finite());
}

#[test]
fn a_culling_bound_survives_nan_and_reversed_ranges() {
    let tf = build(&[(0.0, 1.0)], &[(0.0, 0.0), (1.0, 4.0), (2.0, 1.0)]);
    assert_eq!(tf.max_opacity([f64::NAN, 0.0]), 4.0);
    assert_eq!(tf.max_opacity([0.5, 0.0]), tf.max_opacity([0.0, 0.5]));
    assert_eq!(tf.max_opacity([0.0, 0.5]), 2.0);
}

#[test]
fn one_luminance_is_recognised_only_where_it_shows() {
    assert_eq!(build(&[(0.0, 3.0)], &[(0.0, 0.0), (1.0, 1.0)]).single_luminance(), Some([3.0, 0.0, 0.0]));
    // Red changes only below 0.5, where nothing shows.
    let hidden = build(&[(0.0, 0.0), (0.5, 3.0), (1.0, 3.0)], &[(0.5, 0.0), (1.0, 1.0)]);
    assert_eq!(hidden.single_luminance(), Some([3.0, 0.0, 0.0]));
    let shown = build(&[(0.0, 0.0), (0.5, 3.0), (1.0, 3.0)], &[(0.4, 0.0), (1.0, 1.0)]);
    assert_eq!(shown.single_luminance(), None);
    // The constant ends show too.
    let outside = build(&[(0.0, 0.0), (0.5, 3.0), (1.0, 3.0)], &[(0.0, 1.0), (0.0, 0.0), (0.5, 0.0), (1.0, 1.0)]);
    assert_eq!(outside.single_luminance(), None);
    assert_eq!(build(&[(0.0, 3.0), (1.0, 4.0)], &[(0.0, 0.0)]).single_luminance(), Some([0.0; 3]));
}

#[test]
fn errors_name_the_node_and_its_value() {
    let good = opacity(&[(0.0, 1.0)]);
    let fail = |nodes: &[(f64, f64)]| TransferFunction::new(color(nodes), good.clone()).unwrap_err();
    assert_eq!(fail(&[]), TransferFunctionError::Empty { kind: NodeKind::Color });
    let disorder = fail(&[(1.0, 0.0), (0.5, 0.0)]);
    let expected = TransferFunctionError::Order { kind: NodeKind::Color, index: 1, s: 0.5, previous: 1.0 };
    assert_eq!(disorder, expected);
    assert!(disorder.to_string().contains("color node 1: position 0.5"));
    let crowd = fail(&[(0.0, 0.0), (2.0, 0.0), (2.0, 0.0), (2.0, 1.0)]);
    assert_eq!(crowd, TransferFunctionError::Crowded { kind: NodeKind::Color, index: 3, s: 2.0 });
    assert!(matches!(fail(&[(f64::NAN, 0.0)]), TransferFunctionError::Position { index: 0, .. }));
    assert!(matches!(fail(&[(f64::MAX, 0.0)]), TransferFunctionError::Position { index: 0, .. }));
    assert!(matches!(fail(&[(0.0, f64::INFINITY)]), TransferFunctionError::Value { index: 0, .. }));
    let negative = TransferFunction::new(color(&[(0.0, 1.0)]), opacity(&[(0.0, 1.0), (1.0, -0.5)])).unwrap_err();
    assert_eq!(negative, TransferFunctionError::Value { kind: NodeKind::Opacity, index: 1, s: 1.0, value: -0.5 });
}

proptest! {
    #[test]
    fn pieces_agree_with_evaluation(
        mut nodes in prop::collection::vec((-5_i32..5, 0.0_f64..3.0), 1..8),
        t in 0.01_f64..0.99,
    ) {
        nodes.sort_by_key(|node| node.0);
        nodes.dedup_by_key(|node| node.0);
        let nodes: Vec<_> = nodes.into_iter().map(|(s, v)| (f64::from(s), v)).collect();
        let tf = build(&[(-1.5, 0.5), (2.5, 2.0)], &nodes);
        prop_assert_eq!(tf.pieces().len() + 1, tf.control_points().len());
        for piece in tf.pieces() {
            let mix = |ends: [f64; 2]| ends[0] + t * (ends[1] - ends[0]);
            let s = mix(piece.s);
            // A few roundings of values below 10.
            let tolerance = 1e-13;
            prop_assert!((tf.opacity(s) - mix(piece.opacity)).abs() < tolerance);
            prop_assert!((tf.opacity_below(s) - tf.opacity(s)).abs() < tolerance);
            let red = piece.luminance.map(|rgb| rgb[0]);
            prop_assert!((tf.luminance(s)[0] - mix(red)).abs() < tolerance);
            prop_assert!(tf.max_opacity(piece.s) >= tf.opacity(s) - tolerance);
        }
    }
}
