//! A camera resolved for a picture.

use glam::DVec3;

/// Pixels, rays and eye space.
///
/// Eye space has x to the right, y down and z forward: a right-handed frame in which pixel rows run as they are
/// stored. A point at (x, y, z) is seen (x, y) / (z pixel) pixels from the middle of a perspective picture,
/// (x, y) / pixel from that of an orthographic one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct View {
    /// World position of the eye.
    pub eye: DVec3,
    /// Unit vector to the right.
    pub right: DVec3,
    /// Unit vector down.
    pub down: DVec3,
    /// Unit vector forward.
    pub forward: DVec3,
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// Side of a pixel: at unit depth if perspective, in world units if orthographic. Pixels are square.
    pub pixel: f64,
    /// Rays are parallel.
    pub orthographic: bool,
    /// Depth before which nothing is seen.
    pub near: f64,
}

impl View {
    /// Origin and direction of the ray through a position in pixels, (0, 0) the picture's top left corner and
    /// (0.5, 0.5) the first pixel's centre. The direction's component along `forward` is 1: the parameter is depth.
    pub fn ray(&self, x: f64, y: f64) -> (DVec3, DVec3) {
        let across = self.right * ((x - f64::from(self.size[0]) * 0.5) * self.pixel)
            + self.down * ((y - f64::from(self.size[1]) * 0.5) * self.pixel);
        if self.orthographic { (self.eye + across, self.forward) } else { (self.eye, self.forward + across) }
    }

    /// A world vector in the frame of eye space.
    pub fn rotate(&self, v: DVec3) -> DVec3 {
        DVec3::new(self.right.dot(v), self.down.dot(v), self.forward.dot(v))
    }

    /// A world position in eye space.
    pub fn to_eye(&self, world: DVec3) -> DVec3 {
        self.rotate(world - self.eye)
    }

    /// The planes that bound what is seen, in eye space: a point p is inside where n . p + c >= 0 for all (n, c).
    pub fn frustum(&self) -> [(DVec3, f64); 5] {
        let half = DVec3::new(f64::from(self.size[0]), f64::from(self.size[1]), 0.0) * (0.5 * self.pixel);
        let side = |n: DVec3, extent: f64| {
            if self.orthographic { (n, extent) } else { (n + DVec3::Z * extent, 0.0) }
        };
        [
            (DVec3::Z, -self.near),
            side(DVec3::X, half.x),
            side(DVec3::NEG_X, half.x),
            side(DVec3::Y, half.y),
            side(DVec3::NEG_Y, half.y),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Camera, Projection};

    fn camera(projection: Projection) -> Camera {
        Camera {
            position: DVec3::new(3.0, -7.0, 2.0),
            focal_point: DVec3::new(-1.0, 0.5, 0.25),
            view_up: DVec3::Z,
            projection,
            near: 0.0,
        }
    }

    /// A few roundings of values of the order of ten.
    const ROUNDING: f64 = 1e-13;

    #[test]
    fn rays_and_eye_space_agree() {
        for projection in
            [Projection::Perspective { view_angle: 50.0 }, Projection::Orthographic { parallel_scale: 2.5 }]
        {
            let view = camera(projection).view([640, 360]).unwrap();
            for (x, y, depth) in [(0.0, 0.0, 1.0), (320.0, 180.0, 4.0), (639.5, 12.25, 9.0)] {
                let (origin, direction) = view.ray(x, y);
                let p = view.to_eye(origin + direction * depth);
                let scale = if view.orthographic { view.pixel } else { view.pixel * depth };
                assert!((p.z - depth).abs() < ROUNDING);
                assert!((p.x / scale + 320.0 - x).abs() < ROUNDING / scale);
                assert!((p.y / scale + 180.0 - y).abs() < ROUNDING / scale);
            }
        }
    }

    #[test]
    fn the_frame_is_right_handed_with_up_upwards() {
        let view = camera(Projection::Perspective { view_angle: 30.0 }).view([10, 10]).unwrap();
        assert!((view.right.cross(view.down) - view.forward).length() < ROUNDING);
        assert!(view.down.z < 0.0, "z is up, so down points to lower z");
        // Looking from -y to +y with z up, +x is on the right.
        let front = Camera {
            position: DVec3::new(0.0, -5.0, 0.0),
            focal_point: DVec3::ZERO,
            ..camera(Projection::Perspective { view_angle: 30.0 })
        };
        assert!((front.view([10, 10]).unwrap().right - DVec3::X).length() < ROUNDING);
    }

    #[test]
    fn the_view_angle_spans_the_height() {
        let view = camera(Projection::Perspective { view_angle: 90.0 }).view([30, 20]).unwrap();
        // tan 45 = 1: the picture is 2 high at unit depth.
        assert!((view.pixel - 2.0 / 20.0).abs() < ROUNDING);
        let view = camera(Projection::Orthographic { parallel_scale: 3.0 }).view([30, 20]).unwrap();
        assert!((view.pixel - 6.0 / 20.0).abs() < ROUNDING);
    }

    #[test]
    fn the_frustum_holds_what_the_corner_rays_bound() {
        for projection in
            [Projection::Perspective { view_angle: 40.0 }, Projection::Orthographic { parallel_scale: 1.5 }]
        {
            let view = camera(projection).view([40, 20]).unwrap();
            let inside = |x: f64, y: f64| {
                let (o, d) = view.ray(x, y);
                let p = view.to_eye(o + d * 3.0);
                view.frustum().iter().all(|(n, c)| n.dot(p) + c >= 0.0)
            };
            assert!(inside(0.01, 0.01) && inside(39.99, 19.99) && inside(20.0, 10.0));
            assert!(!inside(-0.01, 10.0) && !inside(40.01, 10.0) && !inside(20.0, -0.01) && !inside(20.0, 20.01));
        }
    }

    #[test]
    fn impossible_cameras_are_refused() {
        let good = camera(Projection::Perspective { view_angle: 30.0 });
        for (bad, word) in [
            (Camera { focal_point: good.position, ..good }, "focal point"),
            (Camera { view_up: good.focal_point - good.position, ..good }, "view up"),
            (Camera { view_up: DVec3::ZERO, ..good }, "view up"),
            (Camera { position: DVec3::NAN, ..good }, "finite"),
            (Camera { near: -1.0, ..good }, "near"),
            (Camera { projection: Projection::Perspective { view_angle: 180.0 }, ..good }, "view angle"),
            (Camera { projection: Projection::Orthographic { parallel_scale: 0.0 }, ..good }, "parallel scale"),
        ] {
            let error = bad.view([10, 10]).unwrap_err().to_string();
            assert!(error.contains(word), "{error}");
        }
        assert!(good.view([0, 10]).is_err());
    }
}
