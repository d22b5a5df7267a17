//! What the plan leaves undone, what it spends the error budget on, and frames in sequence.
#![expect(clippy::unwrap_used, reason = "a test's helpers fail like the test")]

mod budget;
mod sequence;
mod skips;

use tetlux_image::Image;
use tetlux_mesh::TetMesh;
use tetlux_render::{Frame, Model};
use tetlux_scene::{Plan, Scene};
use tetlux_tests::renderer;

/// A scene's plan by its own method, and its picture.
fn planned(mesh: &TetMesh, scene: &Scene) -> (Plan, Frame) {
    let plan = Plan::new(scene, mesh, renderer().device()).unwrap();
    let frame = renderer().render(scene, &Model::new(mesh), &plan).unwrap();
    (plan, frame)
}

/// Whether two pictures are the same bit for bit.
fn same_bits(a: &Image, b: &Image) -> bool {
    let bits = |image: &Image| image.pixels().iter().flatten().map(|c| c.to_bits()).collect::<Vec<_>>();
    bits(a) == bits(b)
}

/// The largest difference of any pixel.
fn largest_difference(a: &Image, b: &Image) -> f64 {
    tetlux_image::compare(a, b, 1.0).unwrap().max
}

#[test]
fn a_planted_difference_of_a_bit_is_seen() {
    let image = Image::from_pixels(2, 1, vec![[0.25, 0.5, 0.0, 0.75]; 2]).unwrap();
    let mut other = image.clone();
    assert!(same_bits(&image, &other));
    other.pixels_mut()[1][2] = -0.0;
    assert!(!same_bits(&image, &other));
    other.pixels_mut()[0][1] = 0.625;
    assert_eq!(largest_difference(&image, &other), 0.125);
}
