use glam::DVec3;
use tetlux_mesh::procedural::{Split, cuboid};
use tetlux_mesh::{Component, Field};
use tetlux_optics::widget::{BivariateFunction, Rectangle, Shape, Widget};

use super::*;

fn block(side: usize, f: impl FnMut(DVec3) -> f64, g: impl FnMut(DVec3) -> f64) -> (TetMesh, [ScalarField; 2]) {
    let parts = cuboid([side; 3], Split::Six, [DVec3::ZERO, DVec3::new(1.0, 2.0, 3.0)]);
    let fields = vec![Field::point("f", 1, parts.sample(f)), Field::point("g", 1, parts.sample(g))];
    let mesh = TetMesh::assemble(&parts.points, &parts.cells, fields).unwrap();
    let scalars = ["f", "g"].map(|name| mesh.scalar(name, Component::Magnitude).unwrap());
    (mesh, scalars)
}

#[test]
fn volumes_are_shared_evenly_and_none_is_lost() {
    // f = x, g = y: the 6 units of volume lie evenly over the plane.
    let (mesh, [f, g]) = block(6, |p| p.x, |p| p.y);
    for bins in [[3, 3], [6, 4], [10, 7]] {
        let histogram = Histogram::new(&mesh, [&f, &g], [None; 2], bins).unwrap();
        assert!((histogram.volumes.iter().sum::<f64>() - 6.0).abs() < 1e-5, "positions are f32");
        let even = 6.0 / (bins[0] * bins[1]) as f64;
        for volume in &histogram.volumes {
            // A lattice of n points an edge misjudges a cut cell by about 1 / n, n at least 4.
            assert!((volume / even - 1.0).abs() < 0.25, "{bins:?}: {volume} for {even}");
        }
    }
}

#[test]
fn what_lies_outside_a_given_range_is_told() {
    let (mesh, [f, g]) = block(4, |p| p.x, |p| p.y);
    let histogram = Histogram::new(&mesh, [&f, &g], [Some([0.0, 0.5]), None], [4, 4]).unwrap();
    assert_eq!(histogram.range, [[0.0, 0.5], [0.0, 2.0]]);
    assert!((histogram.outside - 3.0).abs() < 1e-5 && (histogram.volumes.iter().sum::<f64>() - 3.0).abs() < 1e-5);
}

#[test]
fn a_constant_is_one_column_and_missing_data_are_told() {
    let (mesh, [f, g]) = block(2, |_| 4.0, |p| if p.z > 2.9 { f64::NAN } else { p.y });
    let histogram = Histogram::new(&mesh, [&f, &g], [None; 2], [5, 2]).unwrap();
    assert!((histogram.without_data - 3.0).abs() < 1e-5, "the upper half: {}", histogram.without_data);
    let filled: Vec<usize> = (0..10).filter(|&k| histogram.volumes[k] > 0.0).collect();
    assert_eq!(filled, [2, 7]);
    assert_eq!((histogram.range[0], histogram.center(2, 0)), ([3.5, 4.5], [4.0, 0.5]));
    assert_eq!(histogram.level(0, 0), 0.0);
    assert!((histogram.level(2, 0) - 1.0).abs() < 0.01);
}

#[test]
fn the_picture_shows_widgets_over_the_volumes() {
    let (mesh, [f, g]) = block(4, |p| p.x, |p| p.y);
    let histogram = Histogram::new(&mesh, [&f, &g], [None; 2], [20, 30]).unwrap();
    let support = Rectangle { s: [0.0, 0.5], g: [1.0, 2.0] };
    let widget = Widget::new(Shape::Uniform, Some(support), 2.0, [1.0, 0.0, 0.0]).unwrap();
    let picture = histogram.picture(&Classification::Widgets(BivariateFunction { widgets: vec![widget] })).unwrap();
    let at = |x: usize, y: usize| picture.pixels()[y * 20 + x];
    // The second scalar runs upwards: the widget is at the upper left.
    assert!(at(2, 3)[0] > 2.0 * at(2, 3)[1], "{:?}", at(2, 3));
    assert_eq!(at(15, 3)[0], at(15, 3)[1]);
    assert_eq!(at(2, 25)[0], at(2, 25)[1]);
}

#[test]
fn impossible_bins_and_foreign_fields_are_refused() {
    let (mesh, [f, g]) = block(1, |p| p.x, |p| p.y);
    assert!(Histogram::new(&mesh, [&f, &g], [None; 2], [0, 5]).is_err());
    assert!(Histogram::new(&mesh, [&f, &g], [None; 2], [5, MAX_BINS + 1]).is_err());
    for bad in [[1.0, 1.0], [0.0, f64::NAN], [f64::NEG_INFINITY, 0.0]] {
        assert!(Histogram::new(&mesh, [&f, &g], [None, Some(bad)], [5, 5]).is_err(), "{bad:?}");
    }
    let short = ScalarField { values: vec![0.0], ..f.clone() };
    assert!(Histogram::new(&mesh, [&short, &g], [None; 2], [5, 5]).is_err());
}
