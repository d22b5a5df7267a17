//! From positions to eye space and pixels in single precision: with `cell.rs` the twin of shaders/lib/view.wgsl.

use glam::{Vec2, Vec3};

use crate::device_view::DeviceView;

/// A ray in a plane that is seen edge-on is taken for one this many pixels away: shaders/lib/cell.wgsl says why.
pub(crate) const NUDGE: Vec2 = Vec2::new(7.3e-5, 4.1e-5);

/// What the shaders know of the view.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Lens {
    pub(crate) view: DeviceView,
    pub(crate) orthographic: bool,
}

impl Lens {
    pub(crate) fn rotated(&self, direction: Vec3) -> Vec3 {
        Vec3::from([self.view.right, self.view.down, self.view.forward].map(|row| DeviceView::axis(row).dot(direction)))
    }

    pub(crate) fn beside_pivot(&self, position: Vec3) -> Vec3 {
        (position - DeviceView::axis(self.view.pivot_high)) - DeviceView::axis(self.view.pivot_low)
    }

    pub(crate) fn frame_of(&self, position: Vec3) -> Vec3 {
        self.rotated(self.beside_pivot(position))
    }

    /// The pivot's position in eye space.
    pub(crate) fn pivot(&self) -> Vec3 {
        Vec3::from([self.view.right, self.view.down, self.view.forward].map(|row| row[3]))
    }

    /// A position in eye space from one relative to the pivot.
    pub(crate) fn eye_of(&self, frame: Vec3) -> Vec3 {
        frame + self.pivot()
    }

    pub(crate) fn pixel_of(&self, eye: Vec3) -> Vec2 {
        let scale = if self.orthographic { 1.0 } else { eye.z.max(self.view.near) };
        eye.truncate() / (scale * self.view.pixel)
    }
}
