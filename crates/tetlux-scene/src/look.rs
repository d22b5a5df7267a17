//! What scenes of two fields, or with light, ask of a method.

use crate::{CellProjection, Classification, Interpolation, Scene};

/// Whether there is more than one field's transfer function to shade.
pub(crate) fn is_asked(scene: &Scene) -> bool {
    scene.classification.is_bivariate() || scene.lighting.is_some()
}

/// Why the scene's method cannot be its own but for the integrator, which the plan chooses by the function; `None` if it can,
/// or if one field's transfer function is all there is.
pub(crate) fn refusal(scene: &Scene) -> Option<String> {
    let bivariate = scene.classification.is_bivariate();
    let what = match (bivariate, scene.lighting.is_some()) {
        (true, _) => "classification by two fields",
        (false, true) => "light",
        (false, false) => return None,
    };
    let method = &scene.method;
    let instead = |choice: String, why: &str, use_: &str| Some(format!("{what} goes without {choice}, {why}: {use_}"));
    if matches!(method.projection, CellProjection::Gator | CellProjection::Balanced) {
        let why = "which interpolates one scalar over the faces that it draws";
        return instead(format!("projection \"{}\"", method.projection), why, "use pt, vicp or march");
    }
    if method.projection == CellProjection::Tiles {
        let why = "which is for one field without light";
        return instead(format!("projection \"{}\"", method.projection), why, "use pt, vicp or march");
    }
    if matches!(method.interpolation, Interpolation::Perspective | Interpolation::ScreenLinear) {
        let why = "which carries one scalar over the triangles of the decomposition";
        return instead(format!("interpolation \"{}\"", method.interpolation), why, "use ray");
    }
    if method.classification == Classification::PostClip
        || (bivariate && method.classification == Classification::Vertex)
    {
        let why = "which is for one field's transfer function alone";
        return instead(format!("classification \"{}\"", method.classification), why, "use post-exact");
    }
    if !bivariate && method.integrator.is_pre_integrated() {
        let why = "whose table holds whole segments, unlit";
        return instead(format!("integrator \"{}\"", method.integrator), why, "use direct");
    }
    None
}
