//! Opaque surfaces: where a ray first meets one, and the light from there.

use glam::{DVec3, Vec3};
use tetlux_optics::Light;

use crate::ReferenceError;
use crate::caster::{LocalRay, Ray, unit_scale};
use crate::definition::{Sight, lit_surface};
use crate::hierarchy::Hierarchy;
use crate::line::{Line, Vertex};
use crate::walk::Values;

/// An opaque surface of triangles, lit on both sides by their own normals. Triangles of no area are not seen.
#[derive(Clone, Copy, Debug)]
pub struct Surface<'a> {
    /// Positions relative to the mesh's origin.
    pub points: &'a [Vec3],
    /// Triangles by point.
    pub triangles: &'a [[u32; 3]],
    /// Linear RGB before it is lit.
    pub color: [f64; 3],
    /// The light; its silhouette does not count.
    pub light: &'a Light,
}

/// A triangle of a surface, each by number.
#[derive(Clone, Copy)]
struct Triangle {
    surface: u32,
    index: u32,
}

/// All surfaces of a scene, in a space of their own: they may reach far beyond the mesh.
pub(crate) struct Surfaces<'a> {
    all: Vec<Surface<'a>>,
    hierarchy: Hierarchy<Triangle>,
    scale: f64,
}

/// Where a ray ends.
pub(crate) struct Hit {
    /// Parameter of the ray.
    pub(crate) t: f64,
    /// Linear RGB, lit.
    pub(crate) color: [f64; 3],
}

impl<'a> Surfaces<'a> {
    /// None if there is nothing to be seen.
    pub(crate) fn new(all: Vec<Surface<'a>>) -> Result<Option<Self>, ReferenceError> {
        for (surface, s) in all.iter().enumerate() {
            let bad = |what: String| Err(ReferenceError::Surface { surface, what });
            if let Some(i) = s.points.iter().position(|p| !p.is_finite()) {
                return bad(format!("point {i} is at {}: positions must be finite", s.points[i]));
            }
            if let Some(i) = s.triangles.iter().position(|t| t.iter().any(|&v| v as usize >= s.points.len())) {
                let (t, count) = (s.triangles[i], s.points.len());
                return bad(format!("triangle {i} names the points {t:?} of {count}: each must be one"));
            }
        }
        let scale = unit_scale(all.iter().flat_map(|s| s.points));
        let mut triangles = Vec::new();
        for (surface, s) in (0..).zip(&all) {
            let seen = (0..s.triangles.len() as u32).filter(|&i| normal_of(s, i) != DVec3::ZERO);
            triangles.extend(seen.map(|index| Triangle { surface, index }));
        }
        if triangles.is_empty() {
            return Ok(None);
        }
        let corners = |t: &Triangle| corners(&all[t.surface as usize], t.index).map(|p| p * scale);
        let hierarchy = Hierarchy::new(triangles, &corners);
        Ok(Some(Self { all, hierarchy, scale }))
    }

    /// Where a ray first meets a surface; `origin` is the mesh's.
    pub(crate) fn first(&self, ray: &Ray, origin: DVec3) -> Option<Hit> {
        let local = LocalRay::new(ray, origin, self.scale)?;
        let [start, end] = local.limits;
        let mut first: Option<(f64, Triangle)> = None;
        self.hierarchy.candidates(&local.line, end, |triangle| {
            let meets = self.meets(&local.line, triangle).filter(|t| (start..=end).contains(t));
            if let Some(t) = meets
                && first.is_none_or(|(nearest, _)| t < nearest)
            {
                first = Some((t, triangle));
            }
        });
        let (t, Triangle { surface, index }) = first?;
        let surface = &self.all[surface as usize];
        let normal = normal_of(surface, index).normalize();
        let sight = Sight::new(Some(surface.light), ray.direction);
        Some(Hit { t: local.parameter(t), color: lit_surface(surface.light, surface.color, normal, &sight) })
    }

    /// The line's parameter where it meets a triangle, from either side. On an edge it meets one of the triangles there.
    fn meets(&self, line: &Line, triangle: Triangle) -> Option<f64> {
        let surface = &self.all[triangle.surface as usize];
        let names = surface.triangles[triangle.index as usize];
        let vertices = names.map(|index| {
            let position = surface.points[index as usize].as_dvec3() * self.scale;
            Vertex { index, position, t: line.parameter(position), values: Values::default() }
        });
        let [a, b, c] = &vertices;
        let sides = [line.side(b, c), line.side(c, a), line.side(a, b)];
        if sides.iter().any(|side| side.positive != sides[0].positive) {
            return None;
        }
        let sum: f64 = sides.iter().map(|side| side.value).sum();
        if sum == 0.0 {
            // Seen exactly edge-on: where it begins.
            return vertices.iter().map(|v| v.t).min_by(f64::total_cmp);
        }
        Some(sides.iter().zip(&vertices).map(|(side, vertex)| side.value / sum * vertex.t).sum())
    }
}

fn corners(surface: &Surface, triangle: u32) -> [DVec3; 3] {
    surface.triangles[triangle as usize].map(|v| surface.points[v as usize].as_dvec3())
}

/// A vector along the normal: exactly 0 if the triangle has no area, as products of differences of single precision are
/// exact in double.
fn normal_of(surface: &Surface, triangle: u32) -> DVec3 {
    let [a, b, c] = corners(surface, triangle);
    (b - a).cross(c - a)
}
