//! Rays through more cells than the loop of a shader may take turns: right, or an error, never a picture cut short.

use glam::DVec3;
use tetlux_mesh::procedural::{Split, cuboid};
use tetlux_render::{Model, RenderError};
use tetlux_tests::{Way, mesh_of, orthographic, plan, renderer, scene, white};

/// Hexahedra behind one another, each of which a ray passes in three cells or four: Mesa's software driver ends a shader's
/// loops after 65 535 turns.
const LAYERS: usize = 24_000;

/// Of alpha: some 90 000 additions, each rounded by up to 2^-25, a third of them all one way.
const TOLERANCE: f64 = 1e-3;

#[test]
fn a_picture_is_whole_or_an_error() {
    let mesh = mesh_of(&cuboid([1, 1, LAYERS], Split::Five, [DVec3::ZERO, DVec3::new(1.0, 1.0, 8.0)]), |_| 0.0);
    let camera = orthographic(DVec3::new(0.47, 0.52, -1.0), DVec3::new(0.47, 0.52, 4.0), 0.2);
    let scene = scene(&mesh, white(&[[0.0, 0.125]]), camera, [6, 6]);
    let model = Model::new(&mesh);
    let truth = -(-1.0f64).exp_m1();
    for way in [Way::GpuMarch, Way::GpuTiles, Way::GpuExact, Way::CpuExact] {
        match renderer().render(&scene, &model, &plan(&mesh, &scene, way)) {
            Ok(frame) => {
                let error = frame.image.pixels().iter().map(|p| (f64::from(p[3]) - truth).abs()).fold(0.0, f64::max);
                assert!(error <= TOLERANCE, "{way:?}: off by {error:.1e}");
            }
            Err(RenderError::CutShort { rays, .. }) => {
                assert!(matches!(way, Way::GpuMarch | Way::GpuTiles) && rays > 0, "{way:?}: {rays}");
            }
            Err(error) => panic!("{way:?}: {error}"),
        }
    }
}
