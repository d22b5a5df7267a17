//! The view as devices have it.

use glam::DVec3;
use glam::Vec3;
use tetlux_mesh::TetMesh;
use tetlux_scene::View;

use crate::device_mesh::DeviceMesh;
use crate::eye_space::LEAST_NEAR;

/// Laid out as the shader's `View` (shaders/lib/view.wgsl), where its members are explained.
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub(crate) struct DeviceView {
    pub(crate) right: [f32; 4],
    pub(crate) down: [f32; 4],
    pub(crate) forward: [f32; 4],
    pub(crate) pivot_high: [f32; 4],
    pub(crate) pivot_low: [f32; 4],
    pub(crate) size: [f32; 2],
    pub(crate) pixel: f32,
    pub(crate) near: f32,
}

impl DeviceView {
    pub(crate) fn new(view: &View, mesh: &TetMesh, device: &DeviceMesh) -> DeviceView {
        let eye = (view.eye - mesh.origin()) * device.scale;
        let pivot = eye.clamp(device.bounds[0], device.bounds[1]);
        let high = pivot.as_vec3();
        let low = (pivot - high.as_dvec3()).as_vec3();
        let offset = view.rotate(pivot - eye).as_vec3();
        let row = |axis: DVec3, w: f32| axis.as_vec3().extend(w).to_array();
        let near = view.near * device.scale;
        DeviceView {
            right: row(view.right, offset.x),
            down: row(view.down, offset.y),
            forward: row(view.forward, offset.z),
            pivot_high: high.extend(0.0).to_array(),
            pivot_low: low.extend(0.0).to_array(),
            size: view.size.map(|n| n as f32),
            pixel: (if view.orthographic { view.pixel * device.scale } else { view.pixel }) as f32,
            near: (if view.orthographic { near } else { near.max(LEAST_NEAR) }) as f32,
        }
    }

    pub(crate) fn axis(row: [f32; 4]) -> Vec3 {
        Vec3::new(row[0], row[1], row[2])
    }
}
