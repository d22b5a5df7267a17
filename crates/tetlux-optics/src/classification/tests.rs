use super::*;
use crate::transfer::{ColorNode, OpacityNode};
use crate::widget::{Shape, Widget};

fn transfer(colors: &[[f64; 3]]) -> TransferFunction {
    TransferFunction::new(
        colors.iter().enumerate().map(|(i, &rgb)| ColorNode { s: i as f64, rgb }).collect(),
        vec![OpacityNode { s: 0.0, opacity: 0.0 }, OpacityNode { s: 10.0, opacity: 5.0 }],
    )
    .unwrap()
}

const RED: [f64; 3] = [1.0, 0.0, 0.0];
const BLUE: [f64; 3] = [0.0, 0.0, 1.0];

#[test]
fn each_takes_its_own_scalar() {
    let point = [1.0, 4.0];
    let one = Classification::OneField(transfer(&[RED, BLUE]));
    assert_eq!((one.opacity(point), one.luminance(point)), (0.5, BLUE));
    let two = Classification::TwoFields(transfer(&[RED, BLUE]));
    assert_eq!((two.opacity(point), two.luminance(point)), (2.0, BLUE));
    let support = Rectangle { s: [0.0, 1.0], g: [3.0, 5.0] };
    let widget = Widget::new(Shape::Uniform, Some(support), 3.0, RED).unwrap();
    let widgets = Classification::Widgets(BivariateFunction { widgets: vec![widget] });
    assert_eq!((widgets.opacity(point), widgets.luminance(point)), (3.0, RED));
    let image = ImageFunction::new(1, vec![[0.0, 0.0, 1.0, 7.0]], [[0.0, 1.0]; 2]).unwrap();
    let image = Classification::Image(image);
    assert_eq!((image.opacity(point), image.luminance(point)), (7.0, BLUE));
    assert_eq!([&one, &two, &widgets, &image].map(Classification::is_bivariate), [false, true, true, true]);
    // The rectangle of a cell: of a transfer function the axis that its opacity looks at decides.
    let range = Rectangle { s: [-2.0, -1.0], g: [4.0, 5.0] };
    assert_eq!([&one, &two, &widgets, &image].map(|c| c.is_visible_over(&range)), [false, true, false, true]);
}

#[test]
fn one_luminance_is_recognised() {
    assert_eq!(Classification::TwoFields(transfer(&[RED, RED])).single_luminance(), Some(RED));
    assert_eq!(Classification::TwoFields(transfer(&[RED, BLUE])).single_luminance(), None);
    let image = |texels: Vec<[f32; 4]>| {
        Classification::Image(ImageFunction::new(2, texels, [[0.0, 1.0]; 2]).unwrap()).single_luminance()
    };
    assert_eq!(image(vec![[1.0, 0.0, 0.0, 0.5], [1.0, 0.0, 0.0, 0.0]]), Some(RED));
    assert_eq!(image(vec![[1.0, 0.0, 0.0, 0.5], [0.0, 0.0, 1.0, 0.0]]), None);
}
