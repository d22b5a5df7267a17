//! From positions to eye space and pixels in single precision: the twin of shaders/lib/view.wgsl.

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

/// A vertex in eye space and in pixels.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Vertex {
    pub(crate) frame: Vec3,
    pub(crate) eye: Vec3,
    pub(crate) pixel: Vec2,
}

impl Lens {
    pub(crate) fn vertex(&self, position: Vec3) -> Vertex {
        let view = &self.view;
        let p = (position - DeviceView::axis(view.pivot_high)) - DeviceView::axis(view.pivot_low);
        let rows = [view.right, view.down, view.forward];
        let frame = Vec3::from(rows.map(|row| DeviceView::axis(row).dot(p)));
        let eye = frame + Vec3::from(rows.map(|row| row[3]));
        Vertex { frame, eye, pixel: self.pixel_of(eye) }
    }

    pub(crate) fn pixel_of(&self, eye: Vec3) -> Vec2 {
        let scale = if self.orthographic { 1.0 } else { eye.z.max(self.view.near) };
        eye.truncate() / (scale * self.view.pixel)
    }
}
