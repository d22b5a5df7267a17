//! The view in double precision, for the set-up of cells.

use glam::DVec3;
use rayon::prelude::*;
use tetlux_mesh::TetMesh;
use tetlux_scene::View;

use crate::device_mesh::DeviceMesh;
use crate::seen::Seen;

/// From device positions to eye space (x right, y down, z forward) and to pixels, in device units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct EyeSpace {
    /// Rows of the rotation.
    axes: [DVec3; 3],
    /// The mesh's origin in eye space.
    pub(crate) offset: DVec3,
    /// Side of a pixel: at unit depth if perspective.
    pub(crate) pixel: f64,
    /// Depth before which nothing is seen; above 0 if perspective.
    pub(crate) near: f64,
    /// Rays are parallel.
    pub(crate) orthographic: bool,
    /// The picture's middle in pixels from its top left corner.
    pub(crate) middle: [f64; 2],
}

/// Depth in device units, of which the mesh is about one wide, before which a perspective view shows nothing even if the
/// scene asks for none, so that depths have an inverse. A ray far aside in a wide view, or one among the smallest cells of
/// a graded mesh, has gone a long way at a small depth: this is as small as leaves products of two inverses finite.
pub(crate) const LEAST_NEAR: f64 = 1e-12;

impl EyeSpace {
    pub(crate) fn new(view: &View, mesh: &TetMesh, device: &DeviceMesh) -> EyeSpace {
        let near = view.near * device.scale;
        EyeSpace {
            axes: [view.right, view.down, view.forward],
            offset: view.rotate((mesh.origin() - view.eye) * device.scale),
            pixel: if view.orthographic { view.pixel * device.scale } else { view.pixel },
            near: if view.orthographic { near } else { near.max(LEAST_NEAR) },
            orthographic: view.orthographic,
            middle: view.size.map(|n| 0.5 * f64::from(n)),
        }
    }

    /// A position relative to the mesh's origin, in the axes of eye space: differences of these keep their digits
    /// however far away the eye is.
    pub(crate) fn frame(&self, position: DVec3) -> DVec3 {
        DVec3::new(self.axes[0].dot(position), self.axes[1].dot(position), self.axes[2].dot(position))
    }

    /// A vector in the axes of eye space in those of the mesh.
    pub(crate) fn turned_back(&self, v: DVec3) -> DVec3 {
        self.axes[0] * v.x + self.axes[1] * v.y + self.axes[2] * v.z
    }

    /// The pixel position, from the picture's top left corner, of a point in eye space; not before the near plane.
    pub(crate) fn pixel_of(&self, eye: DVec3) -> [f64; 2] {
        let scale = 1.0 / (self.pixel * if self.orthographic { 1.0 } else { eye.z.max(self.near) });
        [eye.x * scale + self.middle[0], eye.y * scale + self.middle[1]]
    }

    /// Pixel bounds of what lies beyond the near plane of the hull of some points in eye space; low above high if that is
    /// nothing.
    pub(crate) fn seen_bounds<const N: usize>(&self, points: [DVec3; N]) -> [[f64; 2]; 2] {
        let mut bounds = [[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]];
        let mut reach = |p: [f64; 2]| {
            for axis in 0..2 {
                bounds[0][axis] = bounds[0][axis].min(p[axis]);
                bounds[1][axis] = bounds[1][axis].max(p[axis]);
            }
        };
        for i in 0..N {
            if points[i].z >= self.near {
                reach(self.pixel_of(points[i]));
            }
            for j in 0..i {
                // Where an edge passes the near plane.
                if (points[i].z < self.near) != (points[j].z < self.near) {
                    let t = (self.near - points[i].z) / (points[j].z - points[i].z);
                    let crossing = points[i] + (points[j] - points[i]) * t;
                    reach(self.pixel_of(crossing.with_z(self.near)));
                }
            }
        }
        bounds
    }

    /// The points of a mesh as they are seen.
    pub(crate) fn seen(&self, mesh: &DeviceMesh) -> Vec<Seen> {
        let seen = |&[x, y, z, _]: &[f32; 4]| {
            let position = DVec3::new(f64::from(x), f64::from(y), f64::from(z));
            let eye = self.frame(position) + self.offset;
            let at = self.pixel_of(eye);
            Seen::new([at[0] - self.middle[0], at[1] - self.middle[1]], eye.z)
        };
        mesh.points.par_iter().map(seen).collect()
    }
}
