//! Light on what the volume emits: the gradient as a normal, two-sided, and silhouettes.
//!
//! Shading changes the luminance of a point, a silhouette its opacity; both look at the direction of the gradient g
//! alone. With n = g/|g|, v the unit vector to the eye, l the one to the light and h half-way between them:
//!
//! ```text
//! L' = L (ambient + diffuse |n.l|) + specular |n.h|^shininess        (Blinn's highlight, white)
//! opacity' = opacity (1 - |n.v|)^silhouette                          (Song et al. 2009, section 6.2)
//! ```
//!
//! Where the gradient is 0 there is no surface: L' = L (ambient + diffuse), opacity' = opacity.

#[cfg(test)]
mod tests;

/// A light, or a silhouette, or both.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Light {
    direction: Option<[f64; 3]>,
    ambient: f64,
    diffuse: f64,
    specular: f64,
    shininess: f64,
    silhouette: f64,
}

/// Why numbers make no light.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum LightError {
    /// A number that must be finite and at least 0.
    #[error("light {field}: {value} must be finite and at least 0")]
    Negative {
        /// The field, as in the scene file.
        field: &'static str,
        /// Its value.
        value: f64,
    },
    /// A direction of no length, or not finite.
    #[error("light direction: [{}, {}, {}] is none: it must be finite and not 0", .0[0], .0[1], .0[2])]
    Direction([f64; 3]),
}

impl Default for Light {
    /// A light at the eye: ambient 0.3, diffuse 0.7, a highlight of 0.2 with exponent 20; no silhouette.
    fn default() -> Self {
        Self { direction: None, ambient: 0.3, diffuse: 0.7, specular: 0.2, shininess: 20.0, silhouette: 0.0 }
    }
}

impl Light {
    /// `direction` points towards the light, in world space, and need not have unit length; none: the light is at the
    /// eye. All other numbers are at least 0; a silhouette of 0 is none.
    ///
    /// # Errors
    ///
    /// Names the value that breaks these rules.
    pub fn new(
        direction: Option<[f64; 3]>,
        [ambient, diffuse, specular]: [f64; 3],
        shininess: f64,
        silhouette: f64,
    ) -> Result<Self, LightError> {
        for (field, value) in [
            ("ambient", ambient),
            ("diffuse", diffuse),
            ("specular", specular),
            ("shininess", shininess),
            ("silhouette", silhouette),
        ] {
            if !(value >= 0.0 && value.is_finite()) {
                return Err(LightError::Negative { field, value });
            }
        }
        let direction = match direction {
            None => None,
            Some(given) => Some(unit(given).ok_or(LightError::Direction(given))?),
        };
        Ok(Self { direction, ambient, diffuse, specular, shininess, silhouette })
    }

    /// Unit vector towards the light; none: it is at the eye.
    pub fn direction(&self) -> Option<[f64; 3]> {
        self.direction
    }

    /// Share of the luminance that is there without light, that of the diffuse light, and the highlight's luminance.
    pub fn shares(&self) -> [f64; 3] {
        [self.ambient, self.diffuse, self.specular]
    }

    /// Exponent of the highlight.
    pub fn shininess(&self) -> f64 {
        self.shininess
    }

    /// Exponent of the silhouette; 0 for none.
    pub fn silhouette(&self) -> f64 {
        self.silhouette
    }

    /// Whether luminance changes at all.
    pub fn shades(&self) -> bool {
        self.shares() != [1.0, 0.0, 0.0]
    }

    /// Unit vectors to the light and half-way between it and the eye; `view` is the unit vector to the eye. Where light
    /// and eye are opposite there is no half-way, and the second is 0.
    pub fn vectors(&self, view: [f64; 3]) -> [[f64; 3]; 2] {
        let light = self.direction.unwrap_or(view);
        let sum = [0, 1, 2].map(|k| light[k] + view[k]);
        [light, unit(sum).unwrap_or([0.0; 3])]
    }

    /// The luminance of a point with this gradient, lit; `view` is the unit vector to the eye.
    pub fn luminance(&self, luminance: [f64; 3], gradient: [f64; 3], view: [f64; 3]) -> [f64; 3] {
        let Some(normal) = unit(gradient) else { return luminance.map(|l| l * (self.ambient + self.diffuse)) };
        let [light, half] = self.vectors(view);
        let matte = self.ambient + self.diffuse * dot(normal, light).abs();
        let highlight = self.specular * dot(normal, half).abs().powf(self.shininess);
        luminance.map(|l| l * matte + highlight)
    }

    /// What the opacity of a point with this gradient is multiplied with.
    pub fn opacity_factor(&self, gradient: [f64; 3], view: [f64; 3]) -> f64 {
        match unit(gradient) {
            Some(normal) if self.silhouette > 0.0 => (1.0 - dot(normal, view).abs()).max(0.0).powf(self.silhouette),
            _ => 1.0,
        }
    }
}

pub(crate) fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// The unit vector of a direction, if it has one; scaled so that squares neither overflow nor vanish.
pub(crate) fn unit(v: [f64; 3]) -> Option<[f64; 3]> {
    let largest = v.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    if largest == 0.0 || v.iter().any(|x| !x.is_finite()) {
        return None;
    }
    let scaled = v.map(|x| x / largest);
    let length = dot(scaled, scaled).sqrt();
    Some(scaled.map(|x| x / length))
}
