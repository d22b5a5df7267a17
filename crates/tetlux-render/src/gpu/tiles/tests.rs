//! Runs of cells, and devices with little room.

use glam::DVec3;
use tetlux_mesh::TetMesh;
use tetlux_scene::{Camera, CellProjection, Order, Plan, Projection, Scene};

use super::*;
use crate::calibration::sample;
use crate::{Frame, Model, Renderer};

#[test]
fn runs_fill_their_room_and_cut_no_group() {
    let ends = |runs: Result<Vec<Range<u32>>, u32>| runs.map(|runs| runs.iter().map(|r| r.end).collect::<Vec<_>>());
    // Each cell in one tile.
    assert_eq!(ends(runs(10, |i| i, &[], 4)), Ok(vec![4, 8, 10]));
    assert_eq!(ends(runs(10, |i| i, &[], 10)), Ok(vec![10]));
    assert_eq!(ends(runs(0, |i| i, &[], 4)), Ok(vec![]));
    // A group is left to the next run, and may fill one.
    assert_eq!(ends(runs(10, |i| i, &[2..6, 7..9], 4)), Ok(vec![2, 6, 10]));
    assert_eq!(ends(runs(10, |i| i, std::slice::from_ref(&(0..4)), 4)), Ok(vec![4, 8, 10]));
    assert_eq!(ends(runs(10, |i| i, std::slice::from_ref(&(3..8)), 4)), Err(5));
    // Cells in 0, 3, 1, 4, 0 and 0 tiles.
    let sums = [0, 0, 3, 4, 8, 8, 8];
    let before = |i: u32| sums[i as usize];
    assert_eq!(ends(runs(6, before, &[], 4)), Ok(vec![3, 6]));
    assert_eq!(ends(runs(6, before, &[], 3)), Err(4));
    assert_eq!(ends(runs(6, before, &[], 8)), Ok(vec![6]));
}

#[test]
fn groups_are_those_of_their_batch() {
    assert_eq!(groups_in(&[1..3, 5..7, 9..12], &(5..9)), std::slice::from_ref(&(0..2)));
    assert_eq!(groups_in(&[1..3, 5..7], &(0..7)), [1..3, 5..7]);
}

/// A renderer that does no more at a time than this.
fn small(cells: u32, pairs: u32) -> Renderer {
    let mut renderer = Renderer::new();
    let gpu = renderer.gpu.as_mut().unwrap_or_else(|| panic!("these tests need a driver (a software one will do)"));
    gpu.room = Room { cells, pairs };
    renderer
}

/// 162 cells, each over many of 400 tiles.
fn block() -> (TetMesh, Scene) {
    let (mesh, scene) = sample(CellProjection::Tiles, 3, 320).unwrap();
    let projection = Projection::Perspective { view_angle: 42.0 };
    let camera = Camera { position: DVec3::new(2.5, -3.0, 1.8), projection, ..scene.camera };
    // Thick enough that what lies behind is hardly seen.
    (mesh, Scene { unit_distance: 0.2, camera, size: [320, 310], ..scene })
}

fn draw(renderer: &Renderer, mesh: &TetMesh, scene: &Scene) -> Result<Frame, RenderError> {
    let plan = Plan::new(scene, mesh, renderer.device()).unwrap();
    renderer.render(scene, &Model::new(mesh), &plan)
}

#[test]
fn batches_and_runs_make_the_same_picture() {
    let (mesh, scene) = block();
    let whole = draw(&Renderer::new(), &mesh, &scene).unwrap();
    assert!(whole.image.pixels().iter().any(|p| p[3] > 0.5), "the block is seen");
    let pieces = draw(&small(51, 1024), &mesh, &scene).unwrap();
    assert!(pieces.resources.buffers > 3 * whole.resources.buffers, "{:?}", pieces.resources);
    // What lies before is kept in single precision, as it is in registers: no bit differs.
    assert_eq!(pieces.image, whole.image);
    // A planted difference: a pixel's rest left out would be seen.
    let mut other = whole.image.pixels().to_vec();
    let seen = other.iter().position(|p| p[3] > 0.5).unwrap();
    other[seen][0] += 1e-7;
    assert_ne!(&other[..], whole.image.pixels());
}

#[test]
fn an_order_by_centroid_may_be_found_on_the_device() {
    let (mesh, mut scene) = block();
    scene.method.order = Order::Centroid;
    for projection in [scene.camera.projection, Projection::Orthographic { parallel_scale: 1.6 }] {
        scene.camera.projection = projection;
        // A software adapter leaves the sort to the processor, others do not.
        let taken_for = |software| {
            let mut renderer = Renderer::new();
            renderer.gpu.as_mut().unwrap().device.software = software;
            renderer
        };
        let renderer = taken_for(false);
        let on_host = draw(&taken_for(true), &mesh, &scene).unwrap();
        let on_device = draw(&renderer, &mesh, &scene).unwrap();
        assert_eq!(on_device.resources.pipelines, on_host.resources.pipelines + 1);
        assert!(on_device.stages.iter().all(|stage| stage.name != "order"));
        // No two centroids are as far away by chance.
        assert_eq!(on_device.image, on_host.image);
        // Another order is another picture.
        scene.method.order = Order::None;
        assert_ne!(draw(&renderer, &mesh, &scene).unwrap().image, on_host.image);
        scene.method.order = Order::Centroid;
    }
}

#[test]
fn what_does_not_fit_is_told() {
    let (mesh, mut scene) = block();
    // Any cell is nearer than a pixel's width of the picture: it is on all tiles.
    scene.camera.position = DVec3::new(0.1, 0.05, 0.02);
    scene.size = [800, 800];
    // 1024 pairs for 2500 tiles.
    let error = draw(&small(51, 1024), &mesh, &scene).unwrap_err();
    let RenderError::Limit { what, needed, limit, .. } = &error else { panic!("{error}") };
    assert!(what.contains("tiles of a cell") && *needed > 1024 && *limit == 1024, "{error}");
    assert!(error.to_string().contains("use the CPU back end"), "{error}");
}
