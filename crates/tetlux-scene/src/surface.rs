//! Opaque surfaces of triangles, such as the body that a flow passes.

use std::path::PathBuf;

use glam::{DVec3, Vec3};
use tetlux_mesh::TetMesh;
use tetlux_optics::Light;

use crate::SceneError;

/// How a surface is shown, without its triangles.
#[derive(Debug, Clone, PartialEq)]
pub struct SurfaceSpec {
    /// The file of its triangles.
    pub path: PathBuf,
    /// Linear RGB before it is lit, finite and at least 0.
    pub color: [f64; 3],
    /// Lights each triangle on both sides by its own normal; a silhouette does not count.
    pub light: Light,
    /// A position p of the file is `scale * p + translate` in world space. Positive.
    pub scale: f64,
    /// See `scale`.
    pub translate: DVec3,
}

/// The colour of a surface that is given none: light grey.
const GREY: [f64; 3] = [0.6; 3];

impl SurfaceSpec {
    /// A grey surface in a scene of this light: it takes the scene's if that shades, else [`Light::default`].
    pub fn new(path: PathBuf, light: Option<Light>) -> SurfaceSpec {
        let light = light.filter(Light::shades).unwrap_or_default();
        SurfaceSpec { path, color: GREY, light, scale: 1.0, translate: DVec3::ZERO }
    }

    /// The surface in the space of a mesh; `points` are positions as the file has them, `triangles` name them from 0.
    ///
    /// # Errors
    ///
    /// Names the colour, the scale, the position or the triangle that cannot be.
    pub fn on(&self, mesh: &TetMesh, points: &[DVec3], triangles: Vec<[u32; 3]>) -> Result<Surface, SceneError> {
        let bad = |message: String| Err(SceneError::Surface { path: self.path.clone(), message });
        if self.color.iter().any(|c| !(*c >= 0.0 && c.is_finite())) {
            return bad(format!("the colour is {:?}: each channel must be finite and at least 0", self.color));
        }
        if !(self.scale > 0.0 && self.scale.is_finite() && self.translate.is_finite()) {
            return bad(format!(
                "scale {} and translate {} must be finite, and the scale positive",
                self.scale, self.translate
            ));
        }
        let local: Vec<Vec3> =
            points.iter().map(|&p| (p * self.scale + self.translate - mesh.origin()).as_vec3()).collect();
        if let Some(i) = local.iter().position(|p| !p.is_finite()) {
            return bad(format!(
                "point {i} at {} is too far from the mesh for single precision, once scaled and moved: make scale or \
                 translate smaller",
                points[i]
            ));
        }
        if let Some(i) = triangles.iter().position(|t| t.iter().any(|&v| v as usize >= points.len())) {
            return bad(format!(
                "triangle {i} names the points {:?} of {}: each must be one",
                triangles[i],
                points.len()
            ));
        }
        Ok(Surface { points: local, triangles, color: self.color, light: self.light })
    }
}

/// An opaque surface in a mesh's space: see [`SurfaceSpec::on`].
///
/// Positions are single precision relative to the mesh's origin, as its own are, so that a surface that bounds the mesh
/// still does. Triangles may be of no area: these are not seen.
#[derive(Debug, Clone, PartialEq)]
pub struct Surface {
    points: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
    color: [f64; 3],
    light: Light,
}

impl Surface {
    /// Positions relative to the mesh's origin.
    pub fn points(&self) -> &[Vec3] {
        &self.points
    }

    /// Triangles by point.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// Linear RGB before it is lit.
    pub fn color(&self) -> [f64; 3] {
        self.color
    }

    /// What lights both sides, by each triangle's own normal.
    pub fn light(&self) -> &Light {
        &self.light
    }
}
