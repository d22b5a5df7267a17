//! A renderer's earlier pictures change nothing in its later ones.

use tetlux_render::Renderer;
use tetlux_tests::{Recipe, Way, render_by};

#[test]
fn two_scenes_in_a_row_are_each_as_alone() {
    // Of one projection, so that they share pipelines, and of another; on meshes of their own.
    let scenes: Vec<_> = (0..3).map(|seed| Recipe::random(seed, 24).made()).collect();
    let kinds: Vec<bool> = scenes.iter().map(|(_, scene)| tetlux_tests::view(scene).orthographic).collect();
    assert!(kinds.contains(&true) && kinds.contains(&false), "{kinds:?}");
    let [one, other] = [Renderer::new(), Renderer::new()];
    for way in Way::RIGHT {
        let picture = |renderer, which: usize| {
            let (mesh, scene) = &scenes[which];
            let image = render_by(renderer, mesh, scene, way);
            image.pixels().iter().map(|p| p.map(f32::to_bits)).collect::<Vec<_>>()
        };
        let row = [0, 1, 0, 2, 1].map(|which| (which, picture(&one, which)));
        let reversed = [2, 1, 0].map(|which| (which, picture(&other, which)));
        for (which, bits) in row.iter().chain(&reversed) {
            let (_, first) = row.iter().chain(&reversed).find(|(w, _)| w == which).unwrap_or(&row[0]);
            assert!(bits == first, "{way:?}: scene {which} is not what it was");
        }
        assert!(row[0].1 != row[1].1 && row[1].1 != row[3].1, "{way:?}: the scenes differ");
    }
}
