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
    /// Its number in the band.
    pixel: u32,
    entry: bool,
}

/// A face of the boundary as the rays meet it.
#[derive(Debug, Clone)]
struct Face {
    cell: u32,
    /// Rays enter the mesh through it; else they leave.
    entry: bool,
    /// Counter-clockwise seen from where rays go.
    corners: [Vec3; 3],
    pixels: Pixels,
}

/// What the picture's rays tell, and memory kept for the next view.
#[derive(Debug, Default)]
pub(crate) struct Gaps {
    /// Ascending, each once: from a cell, times 2^32, plus to a cell.
    pub(crate) arrows: Vec<u64>,
    pub(crate) overlap_pixels: usize,
    pub(crate) overlap_cells: usize,
    /// The faces of the boundary that rays may meet; nothing for the others.
    faces: Vec<Option<Face>>,
    /// Where each band's faces start in `listed`.
    starts: Vec<usize>,
    listed: Vec<u32>,
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
    /// The number, from 0, of every such pixel; of no meaning for others.
    numbers: Vec<u32>,
    crossings: Vec<Crossing>,
    /// Where the crossings of each such pixel end in `sorted`.
    ends: Vec<u32>,
    sorted: Vec<Crossing>,
    findings: Findings,
}

/// What all bands share.
struct View<'a> {
    rays: &'a Rays,
    faces: &'a [Option<Face>],
    /// The eye is in or on a cell: rays leave before they enter.
    inside: bool,
    tolerance: f64,
}

impl Gaps {
    /// Finds the arrows; `codes` are those of the faces, `inside` says whether the eye is in or on a cell.
    pub(crate) fn find(&mut self, mesh: &TetMesh, facts: &Facts, codes: &[u8], rays: &Rays, inside: bool) {
        (facts.interior..facts.owners.len())
            .into_par_iter()
            .with_min_len(256)
            .map(|face| Face::new(mesh, facts, rays, face, codes[face]))
            .collect_into_vec(&mut self.faces);
        self.list_faces(rays);

        let [width, height] = rays.size();
        let view = View { rays, faces: &self.faces, inside, tolerance: tolerance(facts, rays) };
        let (starts, listed) = (&self.starts, &self.listed);
        self.bands.resize_with(height.div_ceil(BAND) as usize, Band::default);
        self.bands.par_iter_mut().enumerate().for_each(|(band, memory)| {
            let top = band as u32 * BAND;
            let area = Pixels { columns: 0..width, rows: top..(top + BAND).min(height) };
            memory.find(&view, &listed[starts[band]..starts[band + 1]], &area);
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
    fn list_faces(&mut self, rays: &Rays) {
        let bands = rays.size()[1].div_ceil(BAND) as usize;
        let spans = |face: &Option<Face>| {
            let rows = face.as_ref().map_or(0..0, |face| face.pixels.rows.clone());
            (rows.start / BAND) as usize..rows.end.div_ceil(BAND) as usize
        };
        self.starts.clear();
        self.starts.resize(bands + 2, 0);
        for band in self.faces.iter().flat_map(spans) {
            self.starts[band + 2] += 1;
        }
        for band in 0..bands {
            self.starts[band + 2] += self.starts[band + 1];
        }
        self.listed.clear();
        self.listed.resize(self.starts[bands + 1], 0);
        for (i, face) in self.faces.iter().enumerate() {
            for band in spans(face) {
                let place = &mut self.starts[band + 1];
                self.listed[*place] = i as u32;
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

impl Face {
    fn new(mesh: &TetMesh, facts: &Facts, rays: &Rays, face: usize, code: u8) -> Option<Face> {
        let entry = is_entry(code);
        if !entry && !is_exit(code) {
            return None;
        }
        let (cell, vertices) = facts.vertices(mesh, face);
        let [a, b, c] = vertices.map(|v| mesh.points()[v as usize]);
        let pixels = rays.bounds([a, b, c]);
        let met = !pixels.rows.is_empty() && !pixels.columns.is_empty();
        met.then_some(Face { cell, entry, corners: if entry { [a, c, b] } else { [a, b, c] }, pixels })
    }

    fn pixels_in(&self, area: &Pixels) -> Pixels {
        let rows = self.pixels.rows.start.max(area.rows.start)..self.pixels.rows.end.min(area.rows.end);
        Pixels { columns: self.pixels.columns.clone(), rows }
    }
}

impl Band {
    fn find(&mut self, view: &View, listed: &[u32], area: &Pixels) {
        self.findings.clear();
        let faces = listed.iter().filter_map(|&face| view.faces[face as usize].as_ref());
        self.count(view, faces.clone(), area);
        let pixels = self.mark(area.columns.len());
        if pixels == 0 {
            return;
        }
        self.cross(view, faces, area);
        self.sort(pixels);
        let mut start = 0;
        for &end in &self.ends {
            walk(&mut self.sorted[start..end as usize], view.tolerance, &mut self.findings);
            start = end as usize;
        }
    }

    /// Counts every pixel's entries, exits too if there may be more of them.
    fn count<'a>(&mut self, view: &View, faces: impl Iterator<Item = &'a Face>, area: &Pixels) {
        let width = area.columns.len();
        self.counts.clear();
        self.counts.resize(width * area.rows.len(), 0);
        for face in faces.filter(|face| face.entry || view.inside) {
            Triangle::new(view.rays, face.corners).cover(view.rays, face.pixels_in(area), |row, columns| {
                let start = (row - area.rows.start) as usize * width;
                for count in &mut self.counts[start + columns.start as usize..start + columns.end as usize] {
                    *count = count.saturating_add(1);
                }
            });
        }
    }

    /// Marks the tiles to be looked at, and numbers their pixels of more than [`SIMPLE`] crossings; gives their number.
    fn mark(&mut self, width: usize) -> u32 {
        let mut pixels = 0;
        self.tiles.clear();
        self.tiles.resize(width.div_ceil(BAND as usize), false);
        self.numbers.resize(self.counts.len(), 0);
        for (counts, numbers) in self.counts.chunks(width).zip(self.numbers.chunks_mut(width)) {
            let tiles = counts.chunks(BAND as usize).zip(numbers.chunks_mut(BAND as usize));
            for (marked, (counts, numbers)) in self.tiles.iter_mut().zip(tiles) {
                if counts.iter().fold(0, |most, &count| count.max(most)) <= SIMPLE {
                    continue;
                }
                *marked = true;
                for (&count, number) in counts.iter().zip(numbers) {
                    *number = pixels;
                    pixels += u32::from(count > SIMPLE);
                }
            }
        }
        pixels
    }

    /// Lists the crossings of the pixels to be looked at.
    fn cross<'a>(&mut self, view: &View, faces: impl Iterator<Item = &'a Face>, area: &Pixels) {
        let width = area.columns.len();
        self.crossings.clear();
        for face in faces {
            let columns = &face.pixels.columns;
            let tiles = (columns.start / BAND) as usize..columns.end.div_ceil(BAND) as usize;
            if !self.tiles[tiles].contains(&true) {
                continue;
            }
            let depth = Depth::new(view.rays, face.corners);
            Triangle::new(view.rays, face.corners).cover(view.rays, face.pixels_in(area), |row, columns| {
                let start = (row - area.rows.start) as usize * width;
                for column in columns {
                    let pixel = start + column as usize;
                    if self.counts[pixel] > SIMPLE {
                        let depth = depth.at(view.rays, column, row);
                        let pixel = self.numbers[pixel];
                        self.crossings.push(Crossing { depth, cell: face.cell, pixel, entry: face.entry });
                    }
                }
            });
        }
    }

    /// Sorts the crossings by pixel, and each pixel's by depth.
    fn sort(&mut self, pixels: u32) {
        self.ends.clear();
        self.ends.resize(pixels as usize + 1, 0);
        for crossing in &self.crossings {
            self.ends[crossing.pixel as usize + 1] += 1;
        }
        for pixel in 1..self.ends.len() {
            self.ends[pixel] += self.ends[pixel - 1];
        }
        // Starts become ends as the places fill.
        self.ends.pop();
        let nothing = Crossing { depth: 0.0, cell: 0, pixel: 0, entry: false };
        self.sorted.resize(self.crossings.len(), nothing);
        for crossing in &self.crossings {
            let place = &mut self.ends[crossing.pixel as usize];
            self.sorted[*place as usize] = *crossing;
            *place += 1;
        }
        let mut start = 0;
        for &end in &self.ends {
            let key = |c: &Crossing| (c.cell, c.entry);
            self.sorted[start..end as usize]
                .sort_unstable_by(|a, b| a.depth.total_cmp(&b.depth).then(key(a).cmp(&key(b))));
            start = end as usize;
        }
    }
}

#[cfg(test)]
mod tests;
