//! The mesh's buffers, kept on the device for as long as pictures show the same field of it.

use std::sync::{Arc, Mutex, PoisonError, Weak};

use super::frame::Maker;
use crate::device_mesh::DeviceMesh;

/// The buffers of the last mesh.
#[derive(Debug, Default)]
pub(super) struct Resident(Mutex<Kept>);

#[derive(Debug, Default)]
struct Kept {
    mesh: Weak<DeviceMesh>,
    /// Points, cells and the cells' scalars.
    parts: [Option<wgpu::Buffer>; 3],
}

impl Resident {
    /// The buffer of a part of the mesh, uploaded if it is not that of the last picture.
    pub(super) fn buffer(
        &self,
        make: &Maker,
        mesh: &Arc<DeviceMesh>,
        part: usize,
        fill: &dyn Fn() -> wgpu::Buffer,
    ) -> wgpu::Buffer {
        // A panic elsewhere left nothing half done.
        let mut kept = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        // No other mesh takes the place of one that is still named here.
        if !std::ptr::eq(kept.mesh.as_ptr(), Arc::as_ptr(mesh)) {
            *kept = Kept { mesh: Arc::downgrade(mesh), ..Kept::default() };
        }
        if let Some(buffer) = &kept.parts[part] {
            make.count(1, 0, buffer.size());
            return buffer.clone();
        }
        let buffer = fill();
        kept.parts[part] = Some(buffer.clone());
        buffer
    }
}
