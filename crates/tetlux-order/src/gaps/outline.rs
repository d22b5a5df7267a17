//! The outline of the faces through which rays enter the mesh.
//!
//! Seen from before all of the boundary, all these faces run the same way round, so that as many of them cover a pixel as
//! their outline winds about it: a few edges tell what all the faces would.

use std::ops::Range;

use rayon::prelude::*;
use tetlux_mesh::TetMesh;

use crate::Facts;
use crate::coverage::{PROJECTION_ERROR, Pixels, Rays};
use crate::signs::is_entry;

/// Where the boundary and its outline are seen, in pixels from the middle of the picture.
#[derive(Debug, Default)]
pub(super) struct Outline {
    /// Of each vertex of the boundary.
    seen: Vec<[f64; 2]>,
    pub(super) lines: Vec<Line>,
}

/// An edge of the outline, in the direction of the face through which rays enter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Line {
    from: [f64; 2],
    to: [f64; 2],
}

impl Outline {
    /// Finds the outline; false if some vertex is not well before the eye, which tells nothing then.
    pub(super) fn find(&mut self, mesh: &TetMesh, facts: &Facts, codes: &[u8], rays: &Rays) -> bool {
        let surface = facts.surface(mesh);
        self.seen.resize(surface.positions.len(), [0.0; 2]);
        let seen = self.seen.par_iter_mut().zip(&surface.positions).with_min_len(1024);
        let before = seen.map(|(seen, &position)| {
            let at = rays.project(position).filter(|at| at.iter().all(|x| x.is_finite()));
            *seen = at.unwrap_or_default();
            at.is_some()
        });
        if !before.reduce(|| true, |a, b| a & b) {
            return false;
        }
        let entry = |face: u32| is_entry(codes[facts.interior + face as usize]);
        self.lines.clear();
        self.lines.par_extend(surface.edges.par_iter().with_min_len(4096).filter_map(|edge| {
            let [there, back] = edge.faces.map(entry);
            let [from, to] = edge.ends.map(|end| self.seen[end as usize]);
            let line = if there { Line { from, to } } else { Line { from: to, to: from } };
            (there != back).then_some(line)
        }));
        true
    }

    /// All pixels whose rays may pass through a face of the boundary.
    pub(super) fn pixels(&self, rays: &Rays, corners: [u32; 3]) -> Pixels {
        rays.pixels(corners.map(|corner| self.seen[corner as usize]))
    }
}

impl Line {
    /// The rows of which a pixel's centre may be beside it, or on it.
    pub(super) fn rows(&self, rays: &Rays) -> Range<u32> {
        rays.pixels([self.from, self.to, self.to]).rows
    }

    /// Calls `turn` with each of `rows` that it crosses, the first column to the right of the crossing, and what that
    /// adds to the winding of a picture that is not mirrored; and `doubt` with columns whose centres are so near that they may be on either side.
    pub(super) fn trace(
        &self,
        rays: &Rays,
        rows: Range<u32>,
        mut turn: impl FnMut(u32, u32, i32),
        mut doubt: impl FnMut(u32, Range<u32>),
    ) {
        let width = rays.size()[0];
        let [first_x, first_y] = [0, 1].map(|axis| rays.center_offset(axis, 0.0));
        // Outlines run counter-clockwise: down on the left of what they surround.
        let (top, bottom, sign) =
            if self.from[1] < self.to[1] { (self.from, self.to, 1) } else { (self.to, self.from, -1) };
        let slope = (bottom[0] - top[0]) / (bottom[1] - top[1]);
        let x_at = |y: f64| match y {
            _ if y <= top[1] => top[0],
            _ if y >= bottom[1] => bottom[0],
            _ => top[0] + (y - top[1]) * slope,
        };
        for row in rows {
            let y = f64::from(row) + first_y;
            // Two lines that share an end decide alike whether a row is above it.
            if top[1] < y && y <= bottom[1] {
                turn(row, ((x_at(y) - first_x).floor() + 1.0).max(0.0).min(f64::from(width)) as u32, sign);
            }
            let [a, b] = [x_at(y - PROJECTION_ERROR), x_at(y + PROJECTION_ERROR)];
            let start = (a.min(b) - PROJECTION_ERROR - first_x).ceil() as u32;
            let end = ((a.max(b) + PROJECTION_ERROR - first_x).floor() + 1.0) as u32;
            if start < end.min(width) && y + PROJECTION_ERROR >= top[1] && y - PROJECTION_ERROR <= bottom[1] {
                doubt(row, start..end.min(width));
            }
        }
    }
}
