//! A scene, rays through it, and the light they gather.

use std::sync::atomic::{AtomicU32, Ordering};

use glam::{DVec3, Vec3};
use rayon::prelude::*;
use tetlux_mesh::{Location, ScalarField, TetMesh};
use tetlux_optics::{Classification, Light, NoData};

use crate::ReferenceError;
use crate::definition::Definition;
use crate::hierarchy::Hierarchy;
use crate::line::Line;
use crate::quadrature::{Gathered, Integrator, Workspace};
use crate::surface::{Surface, Surfaces};
use crate::walk::{BoundaryFace, Contents, Segment, Space, segments};

/// The tolerance to take where nothing else is asked.
pub const DEFAULT_TOLERANCE: f64 = 1e-10;

/// What is seen: a mesh, its scalars, and how they glow and absorb.
#[derive(Clone, Copy, Debug)]
pub struct Scene<'a> {
    /// The mesh.
    pub mesh: &'a TetMesh,
    /// A scalar of this mesh. Cells with a value that is not finite, of this or the second, have no optical depth
    /// ([`Caster::with_no_data`] gives them one).
    pub scalar: &'a ScalarField,
    /// A second scalar of this mesh, where the classification takes two.
    pub second: Option<&'a ScalarField>,
    /// Luminance and opacity of the scalars.
    pub classification: &'a Classification,
    /// A light, and the gradient of the first scalar at every point, per world length.
    pub lighting: Option<(&'a Light, &'a [DVec3])>,
    /// Luminance (linear RGB) and opacity at every point, linear in each cell: they take the classification's place, of which
    /// only the largest luminance is asked.
    pub colors: Option<&'a [[f64; 4]]>,
    /// World length over which an opacity of 1 is an optical depth of 1; above 0.
    pub unit_distance: f64,
    /// Largest error of a ray's colour and alpha, above 0: see [`DEFAULT_TOLERANCE`]. Rounding adds some 1e-14, and
    /// more where the functions are so steep that the rounding of positions shows.
    pub tolerance: f64,
}

/// A ray in world space: the points `origin + t direction` with t in [`start`, `end`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Where t is 0.
    pub origin: DVec3,
    /// Need not be of unit length.
    pub direction: DVec3,
    /// Parameter at the eye.
    pub start: f64,
    /// Parameter at the far end; may be infinite.
    pub end: f64,
}

/// The light that reaches the start of a ray.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Radiance {
    /// Linear RGB, premultiplied by alpha, over black.
    pub color: [f64; 3],
    /// 1 - transmittance, accurate also where it is tiny.
    pub alpha: f64,
    /// Segments of cells along the ray.
    pub segments: usize,
    /// Points at which the classification was asked.
    pub evaluations: usize,
}

/// Casts rays through a scene.
///
/// The exact lines of the rays are followed through the face adjacency; rays through edges, vertices or along faces
/// are treated as if moved by an infinitesimal amount, hence see each stretch of the mesh exactly once. A ray that
/// grazes the surface sees it whole or not at all. Where cells overlap, extinctions and emissions add.
pub struct Caster<'a> {
    space: Space<'a>,
    hierarchy: Hierarchy<BoundaryFace>,
    /// What ends rays, if anything does.
    surfaces: Option<Surfaces<'a>>,
    integrator: Integrator<'a>,
    unit_distance: f64,
}

/// A ray's line in a space of about unit size and the way back.
pub(crate) struct LocalRay {
    pub(crate) line: Line,
    /// Parameters on the line between which the ray runs.
    pub(crate) limits: [f64; 2],
    /// World length of the line's direction.
    length: f64,
    /// The line's parameter is the ray's times the second, less the first.
    shift: f64,
    per_parameter: f64,
}

impl<'a> Caster<'a> {
    /// Prepares a scene.
    ///
    /// # Errors
    ///
    /// If the length of the scalar, of the gradients or of the colours does not fit the mesh, a colour is negative or not
    /// finite, or unit distance or tolerance is not finite and above 0.
    pub fn new(scene: Scene<'a>) -> Result<Self, ReferenceError> {
        let Scene { mesh, scalar, second, classification, lighting, colors, unit_distance, tolerance } = scene;
        for scalar in [Some(scalar), second].into_iter().flatten() {
            let expected = match scalar.location {
                Location::Point => mesh.points().len(),
                Location::Cell => mesh.cells().len(),
            };
            if scalar.values.len() != expected {
                return Err(ReferenceError::ScalarLength {
                    name: scalar.name.clone(),
                    found: scalar.values.len(),
                    expected,
                    location: scalar.location.plural(),
                });
            }
        }
        if classification.is_bivariate() && second.is_none() {
            return Err(ReferenceError::SecondScalar);
        }
        if let Some((_, gradients)) = lighting
            && gradients.len() != mesh.points().len()
        {
            return Err(ReferenceError::Gradients { found: gradients.len(), expected: mesh.points().len() });
        }
        if let Some(colors) = colors {
            if colors.len() != mesh.points().len() {
                return Err(ReferenceError::Colors { found: colors.len(), expected: mesh.points().len() });
            }
            if let Some(color) = colors.iter().find(|color| color.iter().any(|c| !(*c >= 0.0 && c.is_finite()))) {
                return Err(ReferenceError::Color(*color));
            }
        }
        if !(unit_distance.is_finite() && unit_distance > 0.0) {
            return Err(ReferenceError::UnitDistance(unit_distance));
        }
        if !(tolerance.is_finite() && tolerance > 0.0) {
            return Err(ReferenceError::Tolerance(tolerance));
        }
        let scale = unit_scale(mesh.points().iter());
        let gradients = lighting.map(|(_, gradients)| gradients);
        let mut space = Space { mesh, scalars: [Some(scalar), second], gradients, colors, scale, contents: Vec::new() };
        space.contents = (0..mesh.cells().len()).into_par_iter().map(|cell| contents(&space, cell)).collect();
        let hierarchy = BoundaryFace::hierarchy(&space);
        let definition = Definition::new(classification, lighting.map(|(light, _)| light), colors.is_some());
        let integrator = Integrator::new(definition, tolerance);
        Ok(Self { hierarchy, space, surfaces: None, integrator, unit_distance })
    }

    /// The same scene with cells seen that have a value which is not finite: of one luminance and opacity throughout, unlit.
    #[must_use]
    pub fn with_no_data(mut self, no_data: NoData) -> Self {
        self.integrator = self.integrator.with_no_data(no_data);
        self
    }

    /// The same scene with opaque surfaces in it: the first that a ray meets ends the volume, and is seen through what of
    /// the volume is before it. They may lie anywhere.
    ///
    /// # Errors
    ///
    /// If a triangle names a point that a surface does not have, or a position is not finite.
    pub fn with_surfaces(mut self, surfaces: Vec<Surface<'a>>) -> Result<Self, ReferenceError> {
        self.surfaces = Surfaces::new(surfaces)?;
        Ok(self)
    }

    /// The light along one ray: none if its origin or direction is not finite, the direction is 0 or its length,
    /// against the mesh's, beyond 1e300 or below 1e-300.
    pub fn cast(&self, ray: &Ray) -> Radiance {
        self.cast_with(ray, &mut Vec::new(), &mut Workspace::default())
    }

    fn cast_with(&self, ray: &Ray, found: &mut Vec<Segment>, work: &mut Workspace) -> Radiance {
        let hit = self.surfaces.as_ref().and_then(|surfaces| surfaces.first(ray, self.space.mesh.origin()));
        let Some(hit) = hit else { return self.through(ray, found, work) };
        let before = self.through(&Ray { end: hit.t, ..*ray }, found, work);
        let color = [0, 1, 2].map(|k| before.color[k] + (1.0 - before.alpha) * hit.color[k]);
        Radiance { color, alpha: 1.0, ..before }
    }

    /// The light of the volume alone.
    fn through(&self, ray: &Ray, found: &mut Vec<Segment>, work: &mut Workspace) -> Radiance {
        let local = LocalRay::new(ray, self.space.mesh.origin(), self.space.scale);
        let Some(LocalRay { line, limits, length, .. }) = local else { return Radiance::default() };
        found.clear();
        segments(&self.space, &self.hierarchy, &line, limits, found);
        if found.is_empty() {
            return Radiance::default();
        }
        let Gathered { color, optical_depth, evaluations } =
            self.integrator.integrate(found, length / self.unit_distance, self.integrator.sight(ray.direction), work);
        Radiance { color, alpha: -(-optical_depth).exp_m1(), segments: found.len(), evaluations }
    }

    /// Casts the ray of every pixel, in parallel. `ray` takes column and row, row 0 at the top; `progress` is told
    /// the number of rows done, from any thread. Returns RGBA, premultiplied, row by row from the top.
    pub fn render(
        &self,
        width: u32,
        height: u32,
        ray: impl Fn(u32, u32) -> Ray + Sync,
        progress: impl Fn(u32) + Sync,
    ) -> Vec<[f64; 4]> {
        let mut image = vec![[0.0; 4]; width as usize * height as usize];
        let done = AtomicU32::new(0);
        image.par_chunks_mut((width as usize).max(1)).enumerate().for_each_init(
            || (Vec::new(), Workspace::default()),
            |(found, work), (y, row)| {
                for (x, pixel) in row.iter_mut().enumerate() {
                    let seen = self.cast_with(&ray(x as u32, y as u32), found, work);
                    let [r, g, b] = seen.color;
                    *pixel = [r, g, b, seen.alpha];
                }
                progress(done.fetch_add(1, Ordering::Relaxed) + 1);
            },
        );
        image
    }
}

impl LocalRay {
    /// The ray on a line that starts outside of what lies round `origin` and is of about unit size times `scale`, some
    /// such width ahead of it; `None` if it passes far from it.
    pub(crate) fn new(ray: &Ray, origin: DVec3, scale: f64) -> Option<LocalRay> {
        // Powers of two, here and in the scale, keep grid-aligned rays exactly on the grid.
        let unit = power_of_two_below(ray.direction.abs().max_element());
        let per_parameter = unit * scale;
        if !(ray.direction.is_finite() && per_parameter.is_normal() && per_parameter.recip().is_normal()) {
            return None;
        }
        let direction = flush(ray.direction / unit);
        let eye = (ray.origin - origin) * scale;
        // From the foot of the origin two units back, where no point of the mesh is: it lies within sqrt(3).
        let shift = -eye.dot(direction) / direction.length_squared() - 2.0 / direction.length();
        let start = flush(direction.mul_add(DVec3::splat(shift), eye));
        let squared = start.length_squared();
        if squared.is_nan() || squared > 8.0 {
            return None;
        }
        let line = Line::new(start, direction);
        let limits = [ray.start, ray.end].map(|t| t * per_parameter - shift);
        let length = line.direction().length() / scale;
        Some(LocalRay { line, limits, length, shift, per_parameter })
    }

    /// The ray's parameter at one of the line.
    pub(crate) fn parameter(&self, t: f64) -> f64 {
        (t + self.shift) / self.per_parameter
    }
}

/// The power of two that takes the half-width of points around 0 into [0.5, 1).
pub(crate) fn unit_scale<'p>(points: impl Iterator<Item = &'p Vec3>) -> f64 {
    0.5 / power_of_two_below(points.fold(0.0, |m: f64, p| m.max(p.as_dvec3().abs().max_element())))
}

/// The largest power of two not above a positive number; 1 for 0, and for a subnormal number 0.
fn power_of_two_below(x: f64) -> f64 {
    if x == 0.0 { 1.0 } else { f64::from_bits(x.to_bits() & f64::INFINITY.to_bits()) }
}

/// Takes components that are nothing against 1 to 0, so that exact products of them do not underflow.
fn flush(v: DVec3) -> DVec3 {
    DVec3::select(v.abs().cmplt(DVec3::splat(1e-30)), DVec3::ZERO, v)
}

fn contents(space: &Space, cell: usize) -> Contents {
    let vertices = space.mesh.cells()[cell];
    let missing = space.scalars.into_iter().flatten().any(|scalar| match scalar.location {
        Location::Point => vertices.iter().any(|&v| !scalar.values[v as usize].is_finite()),
        Location::Cell => !scalar.values[cell].is_finite(),
    });
    let [a, b, c, d] = vertices.map(|v| {
        let p = space.position(v);
        robust::Coord3D { x: p.x, y: p.y, z: p.z }
    });
    match (robust::orient3d(a, b, c, d) == 0.0, missing) {
        (true, _) => Contents::Nothing,
        (false, true) => Contents::NoData,
        (false, false) => Contents::Data,
    }
}

#[cfg(test)]
mod tests;
