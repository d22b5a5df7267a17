//! Arrows across gaps: where a ray of the picture leaves the mesh and enters it again (Cook, Max, Silva and Williams
//! 2004, Image-space visibility ordering for cell projection volume rendering of unstructured data).
//!
//! The picture is worked through in bands of rows, each on its own. A band first counts the faces through which each
//! ray enters the mesh; only tiles in which some ray does so twice are then looked at closely: each such ray's
//! crossings of the boundary are sorted by depth and paired.

mod walk;

use glam::Vec3;
use rayon::prelude::*;
use tetlux_mesh::TetMesh;

use self::walk::{Findings, walk};
use crate::Facts;
use crate::coverage::{Depth, Pixels, Rays, Triangle};
use crate::signs::{is_entry, is_exit};

/// Height of a band, and width of a tile, in pixels.
const BAND: u32 = 16;

/// So many counted crossings leave no gap.
const SIMPLE: u8 = 1;

/// A ray's passage through a face of the boundary.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Crossing {
    depth: f64,
    cell: u32,
    /// In the band.
    pixel: u32,
    entry: bool,
}

/// What the picture's rays tell, and memory kept for the next view.
#[derive(Debug, Default)]
pub(crate) struct Gaps {
    /// Ascending, each once: from a cell, times 2^32, plus to a cell.
    pub(crate) arrows: Vec<u64>,
    pub(crate) overlap_pixels: usize,
    pub(crate) overlap_cells: usize,
    bounds: Vec<Option<Pixels>>,
    /// Where each band's faces start in `faces`.
    starts: Vec<usize>,
    faces: Vec<u32>,
    bands: Vec<Band>,
    overlapping: Vec<u32>,
}

/// What one band needs and finds.
#[derive(Debug, Default)]
struct Band {
    /// Entries of each pixel, and exits if the eye is inside.
    counts: Vec<u8>,
    /// Tiles with a pixel of more than [`SIMPLE`] of them.
    tiles: Vec<bool>,
    crossings: Vec<Crossing>,
    /// Where each pixel's crossings end in `sorted`.
    ends: Vec<usize>,
    sorted: Vec<Crossing>,
    findings: Findings,
}

/// What all bands share.
struct View<'a> {
    mesh: &'a TetMesh,
    facts: &'a Facts,
    codes: &'a [u8],
    rays: &'a Rays,
    bounds: &'a [Option<Pixels>],
    /// The eye is in or on a cell: rays leave before they enter.
    inside: bool,
    tolerance: f64,
}

impl Gaps {
    /// Finds the arrows; `codes` are those of the faces, `inside` says whether the eye is in or on a cell.
    pub(crate) fn find(&mut self, mesh: &TetMesh, facts: &Facts, codes: &[u8], rays: &Rays, inside: bool) {
        let boundary = facts.interior..facts.owners.len();
        boundary
            .clone()
            .into_par_iter()
            .with_min_len(256)
            .map(|face| {
                let seen = is_entry(codes[face]) || is_exit(codes[face]);
                let bounds = seen.then(|| rays.bounds(corners(mesh, facts, face).1))?;
                (!bounds.rows.is_empty() && !bounds.columns.is_empty()).then_some(bounds)
            })
            .collect_into_vec(&mut self.bounds);
        self.fill_bands(rays, boundary.start);

        let [width, height] = rays.size();
        let view = View {
            mesh,
            facts,
            codes,
            rays,
            bounds: &self.bounds,
            inside,
            tolerance: tolerance(facts, rays),
        };
        let (starts, faces) = (&self.starts, &self.faces);
        let count = height.div_ceil(BAND) as usize;
        self.bands.resize_with(count, Band::default);
        self.bands.par_iter_mut().enumerate().for_each(|(band, memory)| {
            let top = band as u32 * BAND;
            let area = Pixels { columns: 0..width, rows: top..(top + BAND).min(height) };
            memory.find(&view, &faces[starts[band]..starts[band + 1]], &area);
        });

        self.arrows.clear();
        self.overlapping.clear();
        self.overlap_pixels = 0;
        for band in &self.bands {
            self.arrows.extend_from_slice(&band.findings.arrows);
            self.overlapping.extend_from_slice(&band.findings.overlapping);
            self.overlap_pixels += band.findings.overlap_pixels;
        }
        self.arrows.sort_unstable();
        self.arrows.dedup();
        self.overlapping.sort_unstable();
        self.overlapping.dedup();
        self.overlap_cells = self.overlapping.len();
    }

    /// Lists the faces of every band: a counting sort.
    fn fill_bands(&mut self, rays: &Rays, first: usize) {
        let bands = rays.size()[1].div_ceil(BAND) as usize;
        let spans = |bounds: &Option<Pixels>| {
            bounds.as_ref().map_or(0..0, |p| (p.rows.start / BAND) as usize..p.rows.end.div_ceil(BAND) as usize)
        };
        self.starts.clear();
        self.starts.resize(bands + 2, 0);
        for band in self.bounds.iter().flat_map(spans) {
            self.starts[band + 2] += 1;
        }
        for band in 0..bands {
            self.starts[band + 2] += self.starts[band + 1];
        }
        self.faces.clear();
        self.faces.resize(self.starts[bands + 1], 0);
        for (i, bounds) in self.bounds.iter().enumerate() {
            for band in spans(bounds) {
                let place = &mut self.starts[band + 1];
                self.faces[*place] = (first + i) as u32;
                *place += 1;
            }
        }
    }
}

/// Depths closer than this may be in either order: where cells do not conform they overlap a little, and everywhere
/// positions are rounded to single precision.
fn tolerance(facts: &Facts, rays: &Rays) -> f64 {
    let known = &facts.known;
    let conforming = known.quads_split_both_ways + known.folded_faces + known.non_manifold_faces == 0;
    let reach = f64::from(facts.reach);
    let share = if conforming { 8.0 * f64::from(f32::EPSILON) } else { 1e-3 };
    share * reach + 1e-12 * (reach + rays.eye_distance())
}

/// The owner of a face, and its corners counter-clockwise seen from outside.
fn corners(mesh: &TetMesh, facts: &Facts, face: usize) -> (u32, [Vec3; 3]) {
    let (cell, vertices) = facts.vertices(mesh, face);
    (cell, vertices.map(|v| mesh.points()[v as usize]))
}

impl View<'_> {
    /// The pixels of a face within `area`.
    fn pixels(&self, face: u32, area: &Pixels) -> Option<Pixels> {
        let bounds = self.bounds[face as usize - self.facts.interior].as_ref()?;
        let rows = bounds.rows.start.max(area.rows.start)..bounds.rows.end.min(area.rows.end);
        Some(Pixels { columns: bounds.columns.clone(), rows })
    }

    /// A face as the rays that enter or leave through it see it.
    fn triangle(&self, [a, b, c]: [Vec3; 3], entry: bool) -> Triangle {
        Triangle::new(self.rays, if entry { [a, c, b] } else { [a, b, c] })
    }
}

impl Band {
    fn find(&mut self, view: &View, faces: &[u32], area: &Pixels) {
        self.findings.clear();
        if !self.count(view, faces, area) {
            return;
        }
        self.cross(view, faces, area);
        self.sort(area);
        let mut start = 0;
        for &end in &self.ends {
            walk(&mut self.sorted[start..end], view.tolerance, &mut self.findings);
            start = end;
        }
    }

    /// Counts every pixel's entries, exits too if there may be more of them, and marks the tiles to be looked at; false
    /// if there are none.
    fn count(&mut self, view: &View, faces: &[u32], area: &Pixels) -> bool {
        let width = area.columns.len();
        self.counts.clear();
        self.counts.resize(width * area.rows.len(), 0);
        for &face in faces {
            let entry = is_entry(view.codes[face as usize]);
            if !entry && !view.inside {
                continue;
            }
            let Some(pixels) = view.pixels(face, area) else { continue };
            let (_, corners) = corners(view.mesh, view.facts, face as usize);
            view.triangle(corners, entry).cover(view.rays, pixels, |row, columns| {
                let start = (row - area.rows.start) as usize * width;
                for count in &mut self.counts[start + columns.start as usize..start + columns.end as usize] {
                    *count = count.saturating_add(1);
                }
            });
        }
        self.tiles.clear();
        self.tiles.resize(width.div_ceil(BAND as usize), false);
        for row in self.counts.chunks(width) {
            for (tile, counts) in self.tiles.iter_mut().zip(row.chunks(BAND as usize)) {
                *tile |= counts.iter().any(|&count| count > SIMPLE);
            }
        }
        self.tiles.contains(&true)
    }

    /// Lists the crossings of the pixels to be looked at.
    fn cross(&mut self, view: &View, faces: &[u32], area: &Pixels) {
        let width = area.columns.len();
        self.crossings.clear();
        for &face in faces {
            let Some(pixels) = view.pixels(face, area) else { continue };
            let tiles = (pixels.columns.start / BAND) as usize..pixels.columns.end.div_ceil(BAND) as usize;
            if !self.tiles[tiles].contains(&true) {
                continue;
            }
            let entry = is_entry(view.codes[face as usize]);
            let (cell, corners) = corners(view.mesh, view.facts, face as usize);
            let depth = Depth::new(view.rays, corners);
            view.triangle(corners, entry).cover(view.rays, pixels, |row, columns| {
                let start = (row - area.rows.start) as usize * width;
                for column in columns {
                    let pixel = start + column as usize;
                    if self.counts[pixel] > SIMPLE {
                        let depth = depth.at(view.rays, column, row);
                        self.crossings.push(Crossing { depth, cell, pixel: pixel as u32, entry });
                    }
                }
            });
        }
    }

    /// Sorts the crossings by pixel, and each pixel's by depth.
    fn sort(&mut self, area: &Pixels) {
        self.ends.clear();
        self.ends.resize(area.columns.len() * area.rows.len() + 1, 0);
        for crossing in &self.crossings {
            self.ends[crossing.pixel as usize + 1] += 1;
        }
        for pixel in 1..self.ends.len() {
            self.ends[pixel] += self.ends[pixel - 1];
        }
        // Starts become ends as the places fill.
        self.ends.pop();
        let nothing = Crossing { depth: 0.0, cell: 0, pixel: 0, entry: false };
        self.sorted.clear();
        self.sorted.resize(self.crossings.len(), nothing);
        for crossing in &self.crossings {
            let place = &mut self.ends[crossing.pixel as usize];
            self.sorted[*place] = *crossing;
            *place += 1;
        }
        let mut start = 0;
        for &end in &self.ends {
            let key = |c: &Crossing| (c.cell, c.entry);
            self.sorted[start..end].sort_unstable_by(|a, b| a.depth.total_cmp(&b.depth).then(key(a).cmp(&key(b))));
            start = end;
        }
    }
}

#[cfg(test)]
mod tests;
