//! From where, and along which rays, the cells are seen.

use glam::DVec3;

/// From where the cells are seen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Eye {
    /// A world position: perspective.
    Point(DVec3),
    /// A direction of view, of any length but zero: orthographic.
    Direction(DVec3),
}

/// The rays of a picture, one through the centre of every pixel.
///
/// With x to the right and y down from the middle of the picture, in pixels, the ray through (x, y) starts at `eye`
/// in the direction `forward + (x right + y down) pixel` in perspective, and at `eye + (x right + y down) pixel` in
/// the direction `forward` in orthographic views. The centres of pixels are at x = i + 1/2 - width/2, and y alike.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sampling {
    /// World position of the eye.
    pub eye: DVec3,
    /// Unit vector to the right.
    pub right: DVec3,
    /// Unit vector down.
    pub down: DVec3,
    /// Unit vector forward.
    pub forward: DVec3,
    /// Side of a pixel: at unit depth if perspective, in world units if orthographic. Pixels are square.
    pub pixel: f64,
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// Depth before which nothing is seen. Cells before it are ordered all the same.
    pub near: f64,
    /// Rays are parallel.
    pub orthographic: bool,
}

impl Sampling {
    /// From where the cells are seen.
    pub fn eye(&self) -> Eye {
        if self.orthographic { Eye::Direction(self.forward) } else { Eye::Point(self.eye) }
    }

    /// Origin and direction, in world space, of the ray through the centre of the pixel of column `i` and row `j`.
    /// The direction's component along `forward` is 1: the parameter is depth.
    pub fn ray(&self, i: u32, j: u32) -> (DVec3, DVec3) {
        let [x, y] =
            [(i, self.size[0]), (j, self.size[1])].map(|(at, size)| f64::from(at) + 0.5 - f64::from(size) * 0.5);
        let across = self.right * (x * self.pixel) + self.down * (y * self.pixel);
        if self.orthographic { (self.eye + across, self.forward) } else { (self.eye, self.forward + across) }
    }
}
