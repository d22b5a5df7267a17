//! Opacity emphasised where a field says something: at steep places, contours, boundaries between materials, silhouettes.
//!
//! Each is a factor between 0 and 1 of a point's opacity, from the scalar s there, its gradient g and its second
//! derivative s'' along the gradient; several are multiplied. With t(d, w) = max(0, 1 - |d| / w), 1 at a distance d of 0
//! and 0 from w on:
//!
//! ```text
//! gradient     ((|g| - low) / (high - low))^power, clamped                       (Levoy 1988, region boundaries)
//! contour      t((value - s) / |g|, width)                                       (Levoy 1988, isovalue contours)
//! boundary     t(p, width),  p = -sigma^2 s'' / max(|g| - threshold, 0)          (Kindlmann and Durkin 1998)
//! silhouette   (1 - |g.v| / |g|)^power                                           (Ebert and Rheingans 2000)
//! ```
//!
//! (value - s) / |g| is about the distance to the contour, and p that to the middle of a boundary that is a step blurred by
//! a Gaussian of standard deviation sigma, wherever the point is on it: exactly so with a threshold of 0.

use std::f64::consts::E;
use std::fmt;

#[cfg(test)]
mod tests;

/// What is emphasised. Numbers that are left out are taken from the field: see [`Emphasis::fit`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Emphasis {
    /// Steep places.
    pub gradient: Option<Steepness>,
    /// Where the scalar has one value.
    pub contour: Option<Contour>,
    /// Boundaries between materials.
    pub boundary: Option<Boundary>,
    /// Exponent of the silhouette, at least 0; none: there is no silhouette.
    pub silhouette: Option<f64>,
}

/// Opacity that grows with the gradient's magnitude.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Steepness {
    /// The magnitudes, per world length, of the factors 0 and 1, ascending and at least 0; none: 0 and the field's largest.
    pub range: Option<[f64; 2]>,
    /// At least 0.
    pub power: f64,
}

/// Opacity about a contour.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contour {
    /// The scalar on it.
    pub value: f64,
    /// World length from it at which nothing is left, above 0.
    pub width: f64,
}

/// Opacity about the middles of boundaries.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Boundary {
    /// Standard deviation of the blur in world length, above 0; none: that of an ideal boundary whose first and second
    /// derivative are as large as the field's at most (Kindlmann and Durkin 1998).
    pub sigma: Option<f64>,
    /// World length from the middle at which nothing is left, above 0; none: sigma.
    pub width: Option<f64>,
    /// Gradients of up to this share of the field's largest are no boundary; at least 0 and below 1.
    pub threshold: f64,
}

/// Why numbers make no emphasis.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("{member}: {key} is {value}: it must be {must}")]
pub struct EmphasisError {
    /// What is emphasised, as in the scene file.
    pub member: &'static str,
    /// The number's name there.
    pub key: &'static str,
    /// Its value.
    pub value: f64,
    /// What it must be.
    pub must: &'static str,
}

/// The largest values that a field's derivatives take, and the diagonal of its bounding box: the scales that an emphasis
/// may leave out.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Scales {
    /// Largest magnitude of the gradient, per world length.
    pub gradient: f64,
    /// Largest magnitude of the second derivative along it.
    pub second: f64,
    /// World length.
    pub diagonal: f64,
}

/// A point of the field.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Derivatives {
    /// The scalar.
    pub value: f64,
    /// Magnitude of its gradient, per world length.
    pub gradient: f64,
    /// Second derivative along the gradient, per world length squared.
    pub second: f64,
}

/// An emphasis with every scale known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fitted {
    gradient: Option<([f64; 2], f64)>,
    contour: Option<Contour>,
    boundary: Option<Ideal>,
    silhouette: Option<f64>,
}

/// The boundary that is looked for: a threshold in the gradient's unit.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Ideal {
    sigma: f64,
    width: f64,
    threshold: f64,
}

impl Emphasis {
    /// Whether every number is what it must be.
    ///
    /// # Errors
    ///
    /// The first that is not.
    pub fn check(&self) -> Result<(), EmphasisError> {
        let mut checks = Vec::new();
        let mut check = |member, key, value: f64, holds: bool, must| {
            checks.push((holds && value.is_finite(), EmphasisError { member, key, value, must }));
        };
        let (at_least_0, above_0) = ("finite and at least 0", "finite and above 0");
        if let Some(Steepness { range, power }) = self.gradient {
            if let Some([low, high]) = range {
                check("gradient", "range", low, low >= 0.0, at_least_0);
                check("gradient", "range", high, high > low, "finite and above its lower end");
            }
            check("gradient", "power", power, power >= 0.0, at_least_0);
        }
        if let Some(Contour { value, width }) = self.contour {
            check("contour", "value", value, true, "finite");
            check("contour", "width", width, width > 0.0, above_0);
        }
        if let Some(Boundary { sigma, width, threshold }) = self.boundary {
            for (key, length) in [("sigma", sigma), ("width", width)] {
                let length = length.unwrap_or(1.0);
                check("boundary", key, length, length > 0.0, above_0);
            }
            check("boundary", "threshold", threshold, (0.0..1.0).contains(&threshold), "at least 0 and below 1");
        }
        if let Some(power) = self.silhouette {
            check("silhouette", "power", power, power >= 0.0, at_least_0);
        }
        checks.into_iter().find(|(holds, _)| !holds).map_or(Ok(()), |(_, error)| Err(error))
    }

    /// The same with every number that was left out taken from the field's scales. Sigma is no larger than the diagonal.
    ///
    /// # Errors
    ///
    /// As [`Emphasis::check`].
    pub fn fit(&self, scales: &Scales) -> Result<Fitted, EmphasisError> {
        self.check()?;
        let boundary = self.boundary.map(|boundary| {
            let ideal = scales.gradient / (E.sqrt() * scales.second);
            let ideal = if ideal < scales.diagonal { ideal } else { scales.diagonal };
            let sigma = boundary.sigma.unwrap_or(ideal).max(f64::MIN_POSITIVE);
            let threshold = boundary.threshold * scales.gradient;
            Ideal { sigma, width: boundary.width.unwrap_or(sigma), threshold }
        });
        Ok(Fitted {
            gradient: self.gradient.map(|s| (s.range.unwrap_or([0.0, scales.gradient]), s.power)),
            contour: self.contour,
            boundary,
            silhouette: self.silhouette,
        })
    }
}

impl Fitted {
    /// The exponent of the silhouette, if there is one: what alone depends on the view.
    pub fn silhouette(&self) -> Option<f64> {
        self.silhouette
    }

    /// What the opacity of a point is multiplied with, whatever the view: between 0 and 1 for any input.
    pub fn factor(&self, at: &Derivatives) -> f64 {
        let steep = self.gradient.map_or(1.0, |([low, high], power)| {
            if at.gradient > low { share((at.gradient - low) / (high - low)).powf(power) } else { 0.0 }
        });
        let contour = self.contour.map_or(1.0, |Contour { value, width }| {
            // Where nothing changes all is on the contour or nothing.
            let apart = value - at.value;
            tent(if apart == 0.0 { 0.0 } else { apart / at.gradient }, width)
        });
        let boundary = self.boundary.map_or(1.0, |Ideal { sigma, width, threshold }| {
            let steepness = at.gradient - threshold;
            if steepness > 0.0 { tent(-sigma * sigma * at.second / steepness, width) } else { 0.0 }
        });
        steep * contour * boundary
    }

    /// The silhouette's factor: `gradient` in any unit, `view` the unit vector to the eye; 1 where there is no gradient.
    pub fn silhouette_factor(&self, gradient: [f64; 3], view: [f64; 3]) -> f64 {
        match (self.silhouette, crate::light::unit(gradient)) {
            (Some(power), Some(normal)) => (1.0 - crate::light::dot(normal, view).abs()).max(0.0).powf(power),
            _ => 1.0,
        }
    }
}

/// 1 at a distance of 0, 0 from a width on and where there is no distance.
fn tent(distance: f64, width: f64) -> f64 {
    share(1.0 - distance.abs() / width)
}

/// Between 0 and 1; 0 if it is no number.
fn share(x: f64) -> f64 {
    if x > 0.0 { x.min(1.0) } else { 0.0 }
}

impl fmt::Display for Fitted {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut said = Vec::new();
        said.extend(
            self.gradient.map(|([low, high], power)| format!("gradient from {low:.3e} to {high:.3e}, power {power}")),
        );
        said.extend(self.contour.map(|c| format!("contour {} of width {:.3e}", c.value, c.width)));
        said.extend(self.boundary.map(|b| format!("boundaries of sigma {:.3e}, width {:.3e}", b.sigma, b.width)));
        said.extend(self.silhouette.map(|power| format!("silhouettes, power {power}")));
        f.write_str(&said.join("; "))
    }
}
