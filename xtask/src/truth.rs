//! Pictures by the f64 reference.

use anyhow::Result;
use tetlux_image::Image;
use tetlux_reference::{Caster, DEFAULT_TOLERANCE, Ray};
use tetlux_scene::{Surface, View};

use crate::input::Input;
use crate::progress;

/// The picture that the reference makes of a view's rays, each moved by some pixels.
pub(crate) fn image(input: &Input, view: &View, by: [f64; 2]) -> Result<Image> {
    let colors = input.scene.emphasis.as_ref().map(|emphasis| emphasis.seen(&input.mesh, view));
    let caster = Caster::new(tetlux_reference::Scene {
        mesh: &input.mesh,
        scalar: &input.scene.scalar,
        second: input.scene.second.as_ref(),
        classification: &input.scene.classification,
        lighting: input.scene.lighting.as_ref().map(|lighting| (&lighting.light, &lighting.gradients[..])),
        colors: colors.as_deref(),
        unit_distance: input.scene.unit_distance,
        tolerance: DEFAULT_TOLERANCE,
    })?
    .with_no_data(input.scene.no_data)
    .with_surfaces(input.scene.surfaces.iter().map(surface).collect())?;
    let ray = |x: u32, y: u32| {
        let (origin, direction) = view.ray(f64::from(x) + 0.5 + by[0], f64::from(y) + 0.5 + by[1]);
        Ray { origin, direction, start: view.near, end: f64::INFINITY }
    };
    let bar = progress::bar("reference", view.size[1]);
    let pixels = caster.render(view.size[0], view.size[1], ray, |rows| bar.set_position(u64::from(rows)));
    bar.finish_and_clear();
    let pixels = pixels.into_iter().map(|p| p.map(|c| c as f32)).collect();
    Ok(Image::from_pixels(view.size[0], view.size[1], pixels)?)
}

/// A surface as the reference takes it.
fn surface(surface: &Surface) -> tetlux_reference::Surface<'_> {
    tetlux_reference::Surface {
        points: surface.points(),
        triangles: surface.triangles(),
        color: surface.color(),
        light: surface.light(),
    }
}
