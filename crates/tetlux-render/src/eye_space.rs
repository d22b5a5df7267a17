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

/// Depth in device units before which a perspective view shows nothing even if the scene asks for none: a millionth
/// of the mesh, so that depths have an inverse.
pub(crate) const LEAST_NEAR: f64 = 1e-6;

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

    /// The pixel position, from the picture's top left corner, of a point in eye space; not before the near plane.
    pub(crate) fn pixel_of(&self, eye: DVec3) -> [f64; 2] {
        let scale = 1.0 / (self.pixel * if self.orthographic { 1.0 } else { eye.z.max(self.near) });
        [eye.x * scale + self.middle[0], eye.y * scale + self.middle[1]]
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
