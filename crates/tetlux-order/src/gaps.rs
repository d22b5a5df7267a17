//! Arrows across gaps: where a ray of the picture leaves the mesh and enters it again (Cook, Max, Silva and Williams
//! 2004, Image-space visibility ordering for cell projection volume rendering of unstructured data).
//!
//! The picture is worked through in bands of rows, each on its own. How often each ray enters the mesh is first found
//! from the outline of the faces through which it may or, where some of them are beside or behind the eye, counted face by
//! face. Only the rays that do so twice are then looked at closely: each one's crossings of the boundary are sorted by
//! depth and paired.

mod outline;
mod walk;

use std::ops::Range;

use glam::Vec3;
use rayon::prelude::*;
use tetlux_mesh::TetMesh;

use self::outline::{Line, Outline};
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
    outline: Outline,
    /// The faces of the boundary that rays may meet where they enter it more than once.
    faces: Vec<Face>,
    lists: Lists,
    bands: Vec<Band>,
    overlapping: Vec<u32>,
}

/// What each band has to look at: places in another list.
#[derive(Debug, Default)]
struct Lists {
    /// Where each band's own start in `listed`.
    starts: Vec<usize>,
    listed: Vec<u32>,
}

/// What one band needs and finds.
#[derive(Debug, Default)]
struct Band {
    /// Entries of each pixel, and exits if the eye is inside; empty if there are no more than [`SIMPLE`] anywhere.
    counts: Vec<u8>,
    /// Where rows cross the outline: pixels, and what is added to the winding from there on.
    turns: Vec<(u32, i32)>,
    /// Pixels about which the outline may wind more than [`SIMPLE`] times.
    many: Vec<Range<u32>>,
    /// How many such pixels there are.
    pixels: u32,
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
    /// The eye is in or on a cell: rays leave before they enter.
    inside: bool,
    tolerance: f64,
}

impl Gaps {
    /// Finds the arrows; `codes` are those of the faces, `inside` says whether the eye is in or on a cell.
    pub(crate) fn find(&mut self, mesh: &TetMesh, facts: &Facts, codes: &[u8], rays: &Rays, inside: bool) {
        let Gaps { arrows, outline, faces, lists, bands, overlapping, .. } = self;
        let [width, height] = rays.size();
        let count = if width == 0 { 0 } else { height.div_ceil(BAND) as usize };
        bands.resize_with(count, Band::default);
        let area = |band: usize| {
            let top = band as u32 * BAND;
            Pixels { columns: 0..width, rows: top..(top + BAND).min(height) }
        };
        let view = View { rays, inside, tolerance: tolerance(facts, rays) };

        let boundary = (facts.interior..facts.owners.len()).into_par_iter().with_min_len(256);
        let surface = facts.surface(mesh);
        faces.clear();
        if !inside && outline.find(mesh, facts, codes, rays) {
            lists.fill(count, outline.lines.iter().map(|line| line.rows(rays)));
            bands.par_iter_mut().enumerate().for_each(|(band, memory)| {
                memory.wind(rays, lists.of(band).map(|line| &outline.lines[line]), &area(band));
            });
            faces.par_extend(boundary.filter_map(|face| {
                let pixels = outline.pixels(rays, surface.corners[face - facts.interior]);
                let looked_at = bands[bands_of(&pixels.rows)].iter().any(|band| band.looks_at(&pixels));
                if looked_at { Face::new(mesh, facts, face, codes[face], pixels) } else { None }
            }));
            lists.fill(count, faces.iter().map(|face| face.pixels.rows.clone()));
        } else {
            faces.par_extend(boundary.filter_map(|face| {
                let pixels = rays.bounds(surface.corners(face - facts.interior));
                Face::new(mesh, facts, face, codes[face], pixels)
            }));
            lists.fill(count, faces.iter().map(|face| face.pixels.rows.clone()));
            bands.par_iter_mut().enumerate().for_each(|(band, memory)| {
                memory.count(&view, lists.of(band).map(|face| &faces[face]), &area(band));
            });
        }
        bands.par_iter_mut().enumerate().for_each(|(band, memory)| {
            memory.find(&view, lists.of(band).map(|face| &faces[face]), &area(band));
        });

        arrows.clear();
        overlapping.clear();
        self.overlap_pixels = 0;
        for band in bands {
            arrows.extend_from_slice(&band.findings.arrows);
            overlapping.extend_from_slice(&band.findings.overlapping);
            self.overlap_pixels += band.findings.overlap_pixels;
        }
        arrows.sort_unstable();
        arrows.dedup();
        overlapping.sort_unstable();
        overlapping.dedup();
        self.overlap_cells = overlapping.len();
    }
}

/// The bands that rows are in.
fn bands_of(rows: &Range<u32>) -> Range<usize> {
    let end = rows.end.div_ceil(BAND) as usize;
    ((rows.start / BAND) as usize).min(end)..end
}

/// The tiles that columns are in.
fn tiles_of(columns: &Range<u32>) -> Range<usize> {
    let end = columns.end.div_ceil(BAND) as usize;
    ((columns.start / BAND) as usize).min(end)..end
}

impl Lists {
    /// Lists for every band what has rows in it: a counting sort.
    fn fill(&mut self, bands: usize, rows: impl Iterator<Item = Range<u32>> + Clone) {
        let spans = rows.map(|rows| if rows.is_empty() { 0..0 } else { bands_of(&rows) });
        self.starts.clear();
        self.starts.resize(bands + 2, 0);
        for band in spans.clone().flatten() {
            self.starts[band + 2] += 1;
        }
        for band in 0..bands {
            self.starts[band + 2] += self.starts[band + 1];
        }
        self.listed.clear();
        self.listed.resize(self.starts[bands + 1], 0);
        for (i, span) in spans.enumerate() {
            for band in span {
                let place = &mut self.starts[band + 1];
                self.listed[*place] = i as u32;
                *place += 1;
            }
        }
    }

    fn of(&self, band: usize) -> impl Iterator<Item = usize> + Clone {
        self.listed[self.starts[band]..self.starts[band + 1]].iter().map(|&place| place as usize)
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
    /// `None` if no ray passes through it.
    fn new(mesh: &TetMesh, facts: &Facts, face: usize, code: u8, pixels: Pixels) -> Option<Face> {
        let entry = is_entry(code);
        if !entry && !is_exit(code) || pixels.rows.is_empty() || pixels.columns.is_empty() {
            return None;
        }
        let cell = facts.owners[face] >> 2;
        let [a, b, c] = facts.surface(mesh).corners(face - facts.interior);
        Some(Face { cell, entry, corners: if entry { [a, c, b] } else { [a, b, c] }, pixels })
    }

    fn pixels_in(&self, area: &Pixels) -> Pixels {
        let rows = self.pixels.rows.start.max(area.rows.start)..self.pixels.rows.end.min(area.rows.end);
        Pixels { columns: self.pixels.columns.clone(), rows }
    }
}

impl Band {
    /// Finds the pixels about which the outline winds more than [`SIMPLE`] times, or may.
    fn wind<'a>(&mut self, rays: &Rays, lines: impl Iterator<Item = &'a Line>, area: &Pixels) {
        let Band { turns, many, .. } = self;
        turns.clear();
        many.clear();
        let width = area.columns.len() as u32;
        let pixel = |row: u32, column: u32| (row - area.rows.start) * width + column;
        for line in lines {
            let rows = line.rows(rays);
            let rows = rows.start.max(area.rows.start)..rows.end.min(area.rows.end);
            line.trace(
                rays,
                rows,
                |row, column, turn| turns.push((pixel(row, column), turn)),
                |row, columns| many.push(pixel(row, columns.start)..pixel(row, columns.end)),
            );
        }
        turns.sort_unstable();
        let mut winding = 0;
        for pair in turns.windows(2) {
            winding += pair[0].1 * rays.handedness();
            if winding > i32::from(SIMPLE) {
                many.push(pair[0].0..pair[1].0);
            }
        }
        self.counts.clear();
        if !many.is_empty() {
            self.counts.resize((width as usize) * area.rows.len(), 0);
            for pixels in many {
                self.counts[pixels.start as usize..pixels.end as usize].fill(SIMPLE + 1);
            }
        }
        self.mark(width as usize);
    }

    /// Some pixel to be looked at is near these.
    fn looks_at(&self, pixels: &Pixels) -> bool {
        self.pixels > 0 && self.tiles[tiles_of(&pixels.columns)].contains(&true)
    }

    /// Finds what the rays of the pixels to be looked at meet.
    fn find<'a>(&mut self, view: &View, faces: impl Iterator<Item = &'a Face>, area: &Pixels) {
        self.findings.clear();
        if self.pixels == 0 {
            return;
        }
        self.cross(view, faces, area);
        self.sort();
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
        self.mark(width);
    }

    /// Marks the tiles to be looked at, and numbers their pixels of more than [`SIMPLE`] crossings.
    fn mark(&mut self, width: usize) {
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
        self.pixels = pixels;
    }

    /// Lists the crossings of the pixels to be looked at.
    fn cross<'a>(&mut self, view: &View, faces: impl Iterator<Item = &'a Face>, area: &Pixels) {
        let width = area.columns.len();
        self.crossings.clear();
        for face in faces.filter(|face| self.tiles[tiles_of(&face.pixels.columns)].contains(&true)) {
            let pixels = face.pixels_in(area);
            let columns = pixels.columns.start as usize..pixels.columns.end as usize;
            let row = |row: u32| &self.counts[(row - area.rows.start) as usize * width..][columns.clone()];
            if !pixels.rows.clone().any(|y| row(y).iter().any(|&count| count > SIMPLE)) {
                continue;
            }
            let depth = Depth::new(view.rays, face.corners);
            Triangle::new(view.rays, face.corners).cover(view.rays, pixels, |row, columns| {
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
    fn sort(&mut self) {
        self.ends.clear();
        self.ends.resize(self.pixels as usize + 1, 0);
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
