//! Further fields of the cells, for scenes that look at more than one scalar: linear along rays as the first is.

use glam::DVec3;
use rayon::prelude::*;
use tetlux_mesh::Location;

use super::record::{CHUNK, Chunk, Record, at};
use super::set_up::{STEEPEST, SetUp};
use crate::device_mesh::{NEGATIVE, ascending};
use crate::look::Further;

/// A field in a cell, as [`Record`] has its first.
#[derive(Clone, Copy, Default)]
pub(crate) struct Linear {
    /// Less `base`, in perspective times 1 + w, on the cell's lean: (d/dx, d/dy, at the middle).
    at: [f32; 3],
    along: f32,
    /// The cell's lowest value, and its highest less that.
    base: f32,
    range: f32,
}

/// Where a pixel's ray is inside a cell.
#[derive(Clone, Copy)]
pub(crate) struct Inside {
    /// The pixel, counted from the middle of the cell's box.
    pub(crate) place: [f32; 2],
    /// Of the middle, as [`Segments`](super::block::Segments) has them.
    pub(crate) shares: [f32; 2],
    pub(crate) tilt: f32,
    /// The extent in depth, over `z_ref` in perspective.
    pub(crate) extent: f32,
}

impl Linear {
    /// The values at the front and at the back end.
    pub(crate) fn ends(&self, inside: &Inside, orthographic: bool) -> [f32; 2] {
        let [dx, dy, c] = self.at;
        let here = inside.place[0] * dx + inside.place[1] * dy + c;
        let gradient = if orthographic { self.along } else { here + self.along * inside.tilt };
        let [share, aside] = inside.shares;
        let (middle, rise) = (here * share - self.along * aside, 0.5 * gradient * inside.extent);
        [middle - rise, middle + rise].map(|value| self.base + value.max(0.0).min(self.range))
    }
}

/// The further fields of cells that have been set up, one cell after another; none if there are none.
pub(crate) fn further(set_up: &SetUp, fields: &[Further], cells: &[u32], chunks: &[Chunk]) -> Vec<Linear> {
    if fields.is_empty() {
        return Vec::new();
    }
    let mut all = vec![Linear::default(); cells.len() * fields.len()];
    all.par_chunks_mut(CHUNK * fields.len()).enumerate().for_each(|(chunk, all)| {
        for (i, linears) in all.chunks_mut(fields.len()).enumerate() {
            let position = chunk * CHUNK + i;
            let record = at(chunks, position as u32);
            if record.is_seen() {
                in_cell(set_up, fields, cells[position], record, linears);
            }
        }
    });
    all
}

fn in_cell(set_up: &SetUp, fields: &[Further], cell: u32, record: &Record, linears: &mut [Linear]) {
    let eye = set_up.eye;
    // In ascending order, as the cells' first fields are.
    let [a, b, c, d] = ascending(set_up.cells[cell as usize]);
    let vertices = [a & !NEGATIVE, b, c, d].map(|v| v as usize);
    let frame = vertices.map(|v| set_up.points[v].frame());
    let depth = frame.map(|p| p.z + eye.offset.z);
    let farthest = depth[0].max(depth[1]).max(depth[2].max(depth[3])).max(eye.near);
    let scale = if eye.orthographic { eye.pixel } else { farthest * eye.pixel };
    let across = [0, 1].map(|axis| (f64::from(record.middle[axis]) + 0.5 - eye.middle[axis]) * scale);
    let origin = DVec3::new(across[0], across[1], farthest);
    let [e1, e2, e3] = [frame[1] - frame[0], frame[2] - frame[0], frame[3] - frame[0]];
    let faces = [e2.cross(e3), e3.cross(e1), e1.cross(e2)];
    let volume = e1.dot(faces[0]);
    let inverse = if volume.abs() <= f64::MIN_POSITIVE { 0.0 } else { 1.0 / volume };
    for (field, linear) in fields.iter().zip(linears) {
        let values = match field.location {
            Location::Point => vertices.map(|v| field.values[v]),
            Location::Cell => [field.values[cell as usize]; 4],
        };
        let (least, most) = values.iter().fold((values[0], values[0]), |(l, m), &v| (l.min(v), m.max(v)));
        // Single precision, as what is added to it.
        let base = least as f32;
        let s = values.map(|v| v - f64::from(base));
        let rises = [s[1] - s[0], s[2] - s[0], s[3] - s[0]].map(|rise| rise * inverse);
        let gradient = faces[0] * rises[0] + faces[1] * rises[1] + faces[2] * rises[2];
        let here = s[0] + gradient.dot(origin - (frame[0] + eye.offset));
        let along = if eye.orthographic { gradient.z } else { gradient.dot(origin) - here };
        let [x, y, c, along] =
            [gradient.x * scale, gradient.y * scale, here, along].map(|v| v.clamp(-STEEPEST, STEEPEST));
        let at = on_plane([x, y, c], along, record.lean);
        let range = (most - f64::from(base)).max(0.0) as f32;
        *linear = Linear { at, along: along as f32, base, range };
    }
}

/// A scalar on a plane, in perspective times 1 + w: from what it is where w = 0, and `along` the rays ([`Record`]).
fn on_plane(scalar: [f64; 3], along: f64, plane: [f32; 3]) -> [f32; 3] {
    [0, 1, 2].map(|i| (scalar[i] - along * f64::from(plane[i])) as f32)
}
