use proptest::prelude::*;

use super::*;

const WHITE: [f64; 3] = [1.0; 3];

fn wave(profile: WaveProfile, frequency: [f64; 2], offset: f64) -> Widget {
    Widget::new(Shape::Wave { profile, frequency, offset }, None, 2.0, WHITE).unwrap()
}

#[test]
fn shapes_have_their_closed_values() {
    let box_ = Rectangle { s: [0.2, 0.4], g: [-1.0, f64::INFINITY] };
    let uniform = Widget::new(Shape::Uniform, Some(box_), 3.0, WHITE).unwrap();
    assert_eq!(uniform.opacity([0.3, 1e300]), 3.0);
    assert_eq!(uniform.opacity([0.2, -1.0]), 3.0, "edges belong to it");
    assert_eq!(uniform.opacity([0.5, 0.0]), 0.0);
    assert_eq!(uniform.opacity([f64::NAN, 0.0]), 0.0);

    let gaussian = Widget::new(Shape::Gaussian { center: [1.0, 2.0], sigma: [0.5, 4.0] }, None, 2.0, WHITE).unwrap();
    // One sigma along each axis: exp(-1/2 - 1/2).
    assert!((gaussian.opacity([1.5, 6.0]) - 2.0 * (-1.0_f64).exp()).abs() < 1e-15);

    for (profile, eighth) in [
        (WaveProfile::Triangle, 0.25),
        (WaveProfile::AbsSine, (PI / 8.0).sin()),
        (WaveProfile::SineSquared, 0.5 - 0.5 * (PI / 4.0).cos()),
    ] {
        let wave = wave(profile, [1.0, -2.0], 0.5);
        // Phases 1, 1/2, 1/8 and -17/8.
        for (s, expected) in [(0.5, 0.0), (0.0, 1.0), (-0.375, eighth), (-2.625, eighth)] {
            let value = wave.opacity([s + 2.0, 1.0]);
            assert!((value - 2.0 * expected).abs() < 1e-15, "{profile:?} at {s}: {value}");
        }
    }
}

#[test]
fn errors_name_the_field_and_its_value() {
    let gaussian = |center, sigma| Widget::new(Shape::Gaussian { center, sigma }, None, 1.0, WHITE);
    let error = gaussian([0.0, f64::NAN], [1.0; 2]).unwrap_err();
    assert!(matches!(error, WidgetError::NotFinite { field: "center", .. }));
    for bad in [0.0, -0.5, f64::NAN, f64::INFINITY] {
        let error = gaussian([0.0; 2], [1.0, bad]).unwrap_err().to_string();
        assert!(error.contains("sigma") && error.contains(&bad.to_string()), "{error}");
    }
    let wave = |frequency, offset| {
        Widget::new(Shape::Wave { profile: WaveProfile::Triangle, frequency, offset }, None, 1.0, WHITE).unwrap_err()
    };
    assert!(matches!(wave([f64::INFINITY, 0.0], 0.0), WidgetError::NotFinite { field: "frequency", .. }));
    assert!(matches!(wave([1.0, 0.0], f64::NAN), WidgetError::NotFinite { field: "offset", .. }));
    assert_eq!(wave([0.0, -0.0], 0.0), WidgetError::NoDirection);
    for range in [[1.0, 1.0], [2.0, 1.0], [f64::NAN, 1.0], [f64::INFINITY; 2]] {
        let support = Rectangle { s: [0.0, 1.0], g: range };
        let error = Widget::new(Shape::Uniform, Some(support), 1.0, WHITE).unwrap_err();
        assert!(matches!(error, WidgetError::EmptyRange { field: "support g", .. }));
    }
    for bad in [-1.0, f64::NAN, f64::INFINITY] {
        let opacity = Widget::new(Shape::Uniform, None, bad, WHITE).unwrap_err();
        assert!(matches!(opacity, WidgetError::Negative { field: "max_opacity", .. }));
        let color = Widget::new(Shape::Uniform, None, 1.0, [0.0, bad, 0.0]).unwrap_err();
        assert!(matches!(color, WidgetError::Negative { field: "color", .. }));
    }
}

#[test]
fn one_color_is_recognised_among_visible_widgets_only() {
    let widget = |opacity, color| Widget::new(Shape::Uniform, None, opacity, color).unwrap();
    let mut function = BivariateFunction::default();
    assert_eq!((function.single_color(), function.opacity([0.0; 2])), (Some([0.0; 3]), 0.0));
    assert_eq!(function.luminance([0.0; 2]), [0.0; 3]);
    function.widgets = vec![widget(1.0, WHITE), widget(0.0, [0.5; 3]), widget(3.0, WHITE)];
    assert_eq!(function.single_color(), Some(WHITE));
    function.widgets.push(widget(4.0, [0.5, 1.0, 1.0]));
    assert_eq!(function.single_color(), None);
    assert_eq!((function.opacity([0.0; 2]), function.luminance([0.0; 2])), (8.0, [0.75, 1.0, 1.0]));
}

fn any_widget() -> impl Strategy<Value = Widget> {
    let shape = prop_oneof![
        Just(Shape::Uniform),
        (prop::array::uniform2(-1.0..1.0), prop::array::uniform2(0.05..1.0))
            .prop_map(|(center, sigma)| Shape::Gaussian { center, sigma }),
        (0..3_usize, prop::array::uniform2(-3.0..3.0), -2.0..2.0).prop_map(|(profile, frequency, offset)| {
            let profile = [WaveProfile::Triangle, WaveProfile::AbsSine, WaveProfile::SineSquared][profile];
            Shape::Wave { profile, frequency, offset }
        }),
    ];
    let support = prop_oneof![Just(None), Just(Some(Rectangle { s: [-0.5, 0.5], g: [f64::NEG_INFINITY, 0.25] }))];
    (shape, support).prop_map(|(shape, support)| Widget::new(shape, support, 2.0, WHITE).unwrap())
}

proptest! {
    #[test]
    fn the_culling_bound_is_never_exceeded_and_is_reached(
        widget in any_widget(), corner in prop::array::uniform2(-1.0..1.0), size in prop::array::uniform2(0.0..1.0),
    ) {
        let range = Rectangle { s: [corner[0], corner[0] + size[0]], g: [corner[1], corner[1] + size[1]] };
        let bound = widget.max_opacity_over(&range);
        let mut largest = 0.0_f64;
        for i in 0..=40 {
            for j in 0..=40 {
                let point = [corner[0] + size[0] * f64::from(i) / 40.0, corner[1] + size[1] * f64::from(j) / 40.0];
                largest = largest.max(widget.opacity(point));
            }
        }
        prop_assert!(largest <= bound * (1.0 + 1e-12) + 1e-12);
        if widget.support().is_none() {
            // Slopes: a grid of 1/40 misses at most half a step each way; Gaussians of 0.05 are the steepest.
            prop_assert!(largest >= bound - 0.9, "{largest} {bound}");
        }
    }

    #[test]
    fn nothing_is_seen_where_a_rectangle_is_skipped(
        widget in any_widget(), corner in prop::array::uniform2(-9.0..9.0), size in prop::array::uniform2(0.0..2.0),
        at in prop::array::uniform2(0.0..=1.0_f64),
    ) {
        let range = Rectangle { s: [corner[0], corner[0] + size[0]], g: [corner[1], corner[1] + size[1]] };
        let point = [corner[0] + at[0] * size[0], corner[1] + at[1] * size[1]];
        if !widget.is_visible_over(&range) {
            let tail = if matches!(widget.shape(), Shape::Gaussian { .. }) { GAUSSIAN_TAIL } else { 0.0 };
            // The reach is given to eleven digits.
            prop_assert!(widget.opacity(point) <= tail * widget.max_opacity() * (1.0 + 1e-9));
        } else if let (Shape::Gaussian { .. }, None) = (widget.shape(), widget.support()) {
            // And where it is not skipped there is something: at the corner of the rectangle around it the square.
            let least = GAUSSIAN_TAIL * GAUSSIAN_TAIL;
            prop_assert!(widget.max_opacity_over(&range) >= least * widget.max_opacity() * (1.0 - 1e-9));
        }
    }

    #[test]
    fn other_units_show_the_same(
        widget in any_widget(), point in prop::array::uniform2(-2.0..2.0_f64),
        origin in prop::array::uniform2(-5.0..5.0), scale in prop::array::uniform2(0.1..10.0_f64),
    ) {
        let moved = [0, 1].map(|axis| origin[axis] + point[axis] * scale[axis]);
        // Not at the rim of a support, where rounding decides.
        let rim = [0.5_f64, -0.5].iter().any(|edge: &f64| (point[0] - edge).abs() < 1e-9) || (point[1] - 0.25).abs() < 1e-9;
        // Slopes of up to 20 a unit of the 1e-15 by which points and phases are rounded, scaled by up to 100.
        let close = (widget.mapped(origin, scale).opacity(moved) - widget.opacity(point)).abs() < 1e-11;
        prop_assert!(rim || close);
    }
}

#[test]
fn as_published_a_gaussian_ends_at_three_sigma_and_nothing_else_changes() {
    let bell = |support| Widget::new(Shape::Gaussian { center: [1.0, 2.0], sigma: [0.1, 0.5] }, support, 1.0, [1.0; 3]);
    let band = Widget::new(
        Shape::Wave { profile: WaveProfile::Triangle, frequency: [1.0, 0.0], offset: 0.0 },
        None,
        1.0,
        [1.0; 3],
    );
    let half = Rectangle { s: [1.0, 9.0], g: [f64::NEG_INFINITY, 3.0] };
    let away = Rectangle { s: [5.0, 9.0], g: [0.0, 3.0] };
    let widgets = vec![bell(None).unwrap(), bell(Some(half)).unwrap(), bell(Some(away)).unwrap(), band.unwrap()];
    let published = BivariateFunction { widgets: widgets.clone() }.as_published().widgets;
    assert_eq!(published.len(), 3, "what ends before its rectangle begins is left out");
    let close = |a: [f64; 2], b: [f64; 2]| (0..2).all(|i| (a[i] - b[i]).abs() < 1e-12);
    for (widget, s, g) in [(&published[0], [0.7, 1.3], [0.5, 3.5]), (&published[1], [1.0, 1.3], [0.5, 3.0])] {
        let support = widget.support().unwrap();
        assert!(close(support.s, s) && close(support.g, g), "{support:?}");
    }
    assert_eq!(published[2], widgets[3]);
    assert_eq!(published[0].opacity([1.0, 2.0]), 1.0);
    assert_eq!(published[0].opacity([1.31, 2.0]), 0.0);
}
