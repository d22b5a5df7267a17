//! Which integral a scene's classification has.

use tetlux_optics::Classification::{Image, OneField, TwoFields, Widgets};
use tetlux_optics::widget::{Shape, WaveProfile, Widget};

use crate::plan::says;
use crate::reason::of_integrator;
use crate::{Integrator, Scene, SceneError};

/// The integral inside a cell and its error.
pub(crate) fn integral_of(scene: &Scene, integrator: Integrator, pieces: u32) -> String {
    let budget = scene.method.max_error;
    let color = match (integrator, &scene.classification) {
        (_, TwoFields(_)) => format!("{integrator}: cut at the nodes of both fields, relative error 1e-5"),
        (Integrator::Adaptive, _) => format!("adaptive: opacity exact, colour within the budget of {budget:e}"),
        (Integrator::Approximate, _) => format!("{} ({pieces} equal pieces)", says(integrator, of_integrator)),
        _ => says(integrator, of_integrator),
    };
    let lit = scene.lighting.as_ref().map_or(String::new(), |_| format!("; light in pieces by {budget:e} too"));
    color + &lit
}

/// The integral that the classification has, unless one is asked for that it can have.
pub(crate) fn choose_integrator(scene: &Scene) -> Result<Integrator, SceneError> {
    let refuse = |message: String| Err(SceneError::Method(message));
    let asked = scene.method.integrator;
    let wants = |what: &str, use_instead: &str| {
        refuse(format!("integrator \"{asked}\" is for {what}: use --integrator {use_instead}"))
    };
    if asked.is_published_bivariate() && scene.lighting.is_some() {
        return refuse(format!(
            "integrator \"{asked}\" has no light, as it was published: leave out [light], or use --integrator adaptive"
        ));
    }
    match (asked, &scene.classification) {
        (Integrator::Auto | Integrator::Adaptive, Widgets(_) | Image(_)) => Ok(Integrator::Adaptive),
        (Integrator::Auto | Integrator::Direct, OneField(_) | TwoFields(_)) => Ok(Integrator::Direct),
        (Integrator::Analytic, Widgets(function)) => match function.widgets.iter().any(is_sine_squared) {
            true => refuse(
                "integrator \"analytic\" has no sine-squared wave, as it was published: use shape = \"sine\", or \
                 --integrator adaptive"
                    .into(),
            ),
            false => Ok(asked),
        },
        (Integrator::Approximate, Widgets(_) | Image(_)) => Ok(asked),
        (Integrator::Analytic, Image(_)) => {
            wants("widgets, and an image has no closed form", "approximate or adaptive")
        }
        (Integrator::Adaptive | Integrator::Analytic | Integrator::Approximate, _) => {
            wants("widgets and images, and a transfer function is cut at its nodes exactly", "direct")
        }
        (_, OneField(_)) => Ok(asked),
        (_, TwoFields(_)) => wants("one field with a transfer function", "direct"),
        (_, Widgets(_) | Image(_)) => wants("a transfer function", "adaptive"),
    }
}

fn is_sine_squared(widget: &Widget) -> bool {
    matches!(widget.shape(), Shape::Wave { profile: WaveProfile::SineSquared, .. })
}
