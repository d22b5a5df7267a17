//! Cameras, in VTK's terms.

use glam::{DQuat, DVec3};

use crate::{SceneError, View};

/// How points become pixels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Projection {
    /// Through a point.
    Perspective {
        /// Vertical view angle in degrees, between 0 and 180.
        view_angle: f64,
    },
    /// Along a direction.
    Orthographic {
        /// Half the height of the picture in world units.
        parallel_scale: f64,
    },
}

/// A camera: VTK's position, focal point and view up; pixels are sampled at their centres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Camera {
    /// World position of the eye.
    pub position: DVec3,
    /// World position that is seen in the middle of the picture.
    pub focal_point: DVec3,
    /// A direction that is seen upright; need not be perpendicular to the view.
    pub view_up: DVec3,
    /// Perspective or orthographic.
    pub projection: Projection,
    /// Depth in front of the eye before which nothing is seen, in world units; at least 0. In an orthographic view
    /// too nothing behind the position is seen.
    pub near: f64,
}

/// View angle of cameras that are framed automatically: VTK's default.
const FRAMING_ANGLE: f64 = 30.0;

impl Camera {
    /// A perspective camera that looks along `direction` and sees a whole box, with some air round it.
    pub fn framing(bounds: [DVec3; 2], direction: DVec3, view_up: DVec3) -> Camera {
        let center = (bounds[0] + bounds[1]) * 0.5;
        let radius = (bounds[1] - bounds[0]).length() * 0.5;
        let distance = radius / (FRAMING_ANGLE.to_radians() * 0.5).sin();
        Camera {
            position: center - direction.normalize_or(DVec3::NEG_Y) * distance,
            focal_point: center,
            view_up,
            projection: Projection::Perspective { view_angle: FRAMING_ANGLE },
            near: 0.0,
        }
    }

    /// The same camera turned about the axis of view up through the focal point, counter-clockwise seen from above:
    /// VTK's azimuth. View up stays as it is. By 0 the camera is the same bit for bit.
    #[must_use]
    pub fn turned(&self, degrees: f64) -> Camera {
        let axis = self.view_up.normalize_or_zero();
        if degrees == 0.0 || axis == DVec3::ZERO {
            return *self;
        }
        let arm = DQuat::from_axis_angle(axis, degrees.to_radians()) * (self.position - self.focal_point);
        Camera { position: self.focal_point + arm, ..*self }
    }

    /// The camera resolved for a picture of this size.
    pub fn view(&self, size: [u32; 2]) -> Result<View, SceneError> {
        let bad = |reason: String| Err(SceneError::Camera { reason });
        if !(self.position.is_finite() && self.focal_point.is_finite() && self.view_up.is_finite()) {
            return bad("position, focal point and view up must be finite".into());
        }
        if size.contains(&0) {
            return bad(format!("a picture of {} x {} pixels has none", size[0], size[1]));
        }
        if !(self.near >= 0.0 && self.near.is_finite()) {
            return bad(format!("near is {}; it must be at least 0", self.near));
        }
        let Some(forward) = (self.focal_point - self.position).try_normalize() else {
            return bad(format!("position and focal point are both {}", self.position));
        };
        let Some(right) = forward.cross(self.view_up.normalize_or_zero()).try_normalize() else {
            return bad(format!("view up {} is parallel to the view: choose another direction", self.view_up));
        };
        let half_height = match self.projection {
            Projection::Perspective { view_angle } if view_angle > 0.0 && view_angle < 180.0 => {
                (view_angle.to_radians() * 0.5).tan()
            }
            Projection::Perspective { view_angle } => {
                return bad(format!("view angle is {view_angle} degrees; it must lie between 0 and 180"));
            }
            Projection::Orthographic { parallel_scale } if parallel_scale > 0.0 && parallel_scale.is_finite() => {
                parallel_scale
            }
            Projection::Orthographic { parallel_scale } => {
                return bad(format!("parallel scale is {parallel_scale}; it must be positive"));
            }
        };
        Ok(View {
            eye: self.position,
            right,
            down: forward.cross(right),
            forward,
            size,
            pixel: 2.0 * half_height / f64::from(size[1]),
            orthographic: matches!(self.projection, Projection::Orthographic { .. }),
            near: self.near,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_turn_goes_round_the_focal_point() {
        let camera = Camera {
            position: DVec3::new(4.0, 2.0, 5.0),
            focal_point: DVec3::new(1.0, 2.0, 3.0),
            view_up: DVec3::new(0.0, 0.0, 2.0),
            projection: Projection::Perspective { view_angle: 30.0 },
            near: 0.0,
        };
        // From the focal point (3, 0, 2): a quarter about z makes (0, 3, 2).
        let turned = camera.turned(90.0);
        assert!(turned.position.distance(DVec3::new(1.0, 5.0, 5.0)) < 1e-14, "{turned:?}");
        assert_eq!(turned, Camera { position: turned.position, ..camera });
        assert_eq!(camera.turned(0.0), camera);
        assert!(camera.turned(360.0).position.distance(camera.position) < 1e-14);
    }
}
