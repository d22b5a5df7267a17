//! What a march needs besides the mesh: which cells meet at faces, and where each pixel's ray comes in.
//!
//! Areas and crossings are the twins of shaders/lib/walk.wgsl, which explains them.

use std::cmp::Ordering;

use glam::{Vec2, Vec2Swizzles, Vec3};
use rayon::prelude::*;
use tetlux_mesh::{NONE, TetMesh};

use crate::device_mesh::{DeviceMesh, NEGATIVE, ascending};
use crate::lens::{Lens, NUDGE};

/// Rows of pixels whose entries one core finds at a time.
const BAND: usize = 8;

/// Pixels by which a face's bounds are widened, for rounding.
const MARGIN: f32 = 0.03125;

/// Tables of the march, as the shader has them (shaders/stages/march.wgsl).
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct March {
    /// For each cell the cell across the face opposite each vertex, vertices in ascending order; [`NONE`] where there is
    /// none that is drawn.
    pub(crate) neighbors: Vec<[u32; 4]>,
    /// Where each pixel's entries begin, and where the last one's end.
    pub(crate) starts: Vec<u32>,
    /// Faces through which rays come in from outside the cells that are drawn, nearest first in each pixel: four times
    /// the cell plus the vertex opposite.
    pub(crate) entries: Vec<u32>,
}

/// A face at the boundary of the cells that are drawn.
struct Face {
    /// Four times the cell plus the vertex opposite.
    entry: u32,
    names: [u32; 3],
    /// Positions relative to the pivot; they surround a ray that comes in from x towards y.
    frames: [Vec3; 3],
    /// First and one past the last pixel, in x and in y.
    columns: [u32; 2],
    rows: [u32; 2],
}

/// One pixel's ray and a face.
#[derive(Clone, Copy)]
struct Entry {
    pixel: u32,
    distance: f32,
    entry: u32,
}

impl March {
    pub(crate) fn new(mesh: &TetMesh, device: &DeviceMesh, lens: &Lens, drawn: &[u32], size: [u32; 2]) -> March {
        let mut is_drawn = vec![false; mesh.cells().len()];
        drawn.iter().for_each(|&cell| is_drawn[cell as usize] = true);
        let neighbors: Vec<[u32; 4]> =
            (0..mesh.cells().len()).into_par_iter().map(|cell| neighbors_of(mesh, &is_drawn, cell)).collect();
        let faces: Vec<Face> = drawn
            .par_iter()
            .flat_map_iter(|&cell| {
                let neighbors = neighbors[cell as usize];
                (0..4).filter(move |&k| neighbors[k] == NONE).map(move |k| (cell, k))
            })
            .filter_map(|(cell, k)| Face::new(mesh, device, lens, cell, k, size))
            .collect();
        let (starts, entries) = entries(lens, &faces, size);
        March { neighbors, starts, entries }
    }

    /// Bytes of the largest table.
    pub(crate) fn largest(&self) -> u64 {
        let tables = [size_of_val(&self.neighbors[..]), size_of_val(&self.starts[..]), size_of_val(&self.entries[..])];
        tables.into_iter().max().unwrap_or(0) as u64
    }
}

/// The cells across a cell's faces that are drawn.
fn neighbors_of(mesh: &TetMesh, is_drawn: &[bool], cell: usize) -> [u32; 4] {
    let (names, across) = (mesh.cells()[cell], mesh.neighbors()[cell]);
    let mut pairs: [(u32, u32); 4] = std::array::from_fn(|k| (names[k], across[k]));
    pairs.sort_unstable_by_key(|pair| pair.0);
    pairs.map(|(_, other)| if other != NONE && is_drawn[other as usize] { other } else { NONE })
}

impl Face {
    /// The face opposite vertex `k` of a cell; `None` if no pixel's ray can cross it.
    fn new(mesh: &TetMesh, device: &DeviceMesh, lens: &Lens, cell: u32, k: usize, size: [u32; 2]) -> Option<Face> {
        let names = ascending(mesh.cells()[cell as usize]);
        let negative = names[0] & NEGATIVE != 0;
        let mut others = [[1, 2, 3], [0, 2, 3], [0, 1, 3], [0, 1, 2]][k].map(|i| names[i] & !NEGATIVE);
        if k.is_multiple_of(2) != negative {
            others.swap(1, 2);
        }
        let frames: [Vec3; 3] = others.map(|name| {
            let [x, y, z, _] = device.points[name as usize];
            lens.frame_of(Vec3::new(x, y, z))
        });
        let [columns, rows] = pixels_of(lens, &frames, size);
        let entry = 4 * cell + k as u32;
        let seen = columns[0] < columns[1] && rows[0] < rows[1];
        seen.then_some(Face { entry, names: others, frames, columns, rows })
    }

    /// How far along a ray that comes in through this face crosses it.
    fn distance_at(&self, ray: &Ray) -> Option<f32> {
        let corners: [Corner; 3] = std::array::from_fn(|i| Corner {
            name: self.names[i],
            offset: ray.offset_from(self.frames[i]),
            distance: ray.along.dot(self.frames[i]),
        });
        let [a, b, c] = &corners;
        if !(turns(a, b) && turns(b, c) && turns(c, a)) {
            return None;
        }
        Some(distance_of(a, b, c))
    }
}

/// The columns and rows of the pixels that a triangle may cover: the line of each ray counts, before the eye and behind.
fn pixels_of(lens: &Lens, frames: &[Vec3; 3], size: [u32; 2]) -> [[u32; 2]; 2] {
    let eye = frames.map(|frame| lens.eye_of(frame));
    if !lens.orthographic && eye.iter().any(|eye| eye.z <= lens.view.near) {
        return size.map(|n| [0, n]);
    }
    let [a, b, c] = eye.map(|eye| lens.pixel_of(eye));
    let (low, high) = (a.min(b).min(c) - MARGIN, a.max(b).max(c) + MARGIN);
    std::array::from_fn(|axis| {
        // The pixels whose centres, at i + 1/2, lie between the bounds. A conversion of a float saturates.
        let middle = size[axis] as f32 * 0.5;
        let first = (low[axis] + middle - 0.5).ceil().max(0.0) as u32;
        let end = ((high[axis] + middle - 0.5).floor() + 1.0).max(0.0) as u32;
        [first, end.min(size[axis])]
    })
}

/// The starts and the entries of every pixel.
fn entries(lens: &Lens, faces: &[Face], size: [u32; 2]) -> (Vec<u32>, Vec<u32>) {
    let (width, height) = (size[0] as usize, size[1] as usize);
    let mut bands = vec![Vec::new(); height.div_ceil(BAND)];
    for (i, face) in faces.iter().enumerate() {
        for band in face.rows[0] as usize / BAND..=(face.rows[1] as usize - 1) / BAND {
            bands[band].push(i);
        }
    }
    let found: Vec<Vec<Entry>> = bands
        .into_par_iter()
        .enumerate()
        .map(|(band, list)| {
            let first = (band * BAND) as u32;
            let end = (first + BAND as u32).min(size[1]);
            let mut found = Vec::new();
            for face in list.into_iter().map(|i| &faces[i]) {
                for y in face.rows[0].max(first)..face.rows[1].min(end) {
                    for x in face.columns[0]..face.columns[1] {
                        let at = Vec2::new(x as f32, y as f32) + 0.5 - Vec2::from(lens.view.size) * 0.5;
                        if let Some(distance) = face.distance_at(&lens.ray_through(at)) {
                            found.push(Entry { pixel: y * size[0] + x, distance, entry: face.entry });
                        }
                    }
                }
            }
            found.sort_unstable_by(|a, b| {
                a.pixel.cmp(&b.pixel).then(a.distance.total_cmp(&b.distance)).then(a.entry.cmp(&b.entry))
            });
            found
        })
        .collect();
    let mut starts = vec![0; width * height + 1];
    found.iter().flatten().for_each(|entry| starts[entry.pixel as usize + 1] += 1);
    for i in 1..starts.len() {
        starts[i] += starts[i - 1];
    }
    (starts, found.iter().flatten().map(|entry| entry.entry).collect())
}

#[derive(Debug, Clone, Copy)]
struct Ray {
    right: Vec3,
    down: Vec3,
    pivot: Vec2,
    along: Vec3,
}

#[derive(Debug, Clone, Copy)]
struct Corner {
    name: u32,
    offset: Vec2,
    distance: f32,
}

impl Lens {
    fn ray_through(&self, at: Vec2) -> Ray {
        let aside = at * self.view.pixel;
        let eye = self.pivot();
        if self.orthographic {
            return Ray { right: Vec3::X, down: Vec3::Y, pivot: eye.truncate() - aside, along: Vec3::Z };
        }
        let direction = aside.extend(1.0);
        let [mut x, mut y, mut z] = [Vec3::X, Vec3::Y, Vec3::Z];
        if aside.abs().max_element() > 1.0 {
            (x, y, z) = if aside.x.abs() >= aside.y.abs() { (y, z, x) } else { (z, x, y) };
            if z.dot(direction) < 0.0 {
                (x, y, z) = (y, x, -z);
            }
        }
        let per_main = 1.0 / z.dot(direction);
        let right = x - z * (x.dot(direction) * per_main);
        let down = y - z * (y.dot(direction) * per_main);
        let pivot = Vec2::new(right.dot(eye), down.dot(eye));
        Ray { right, down, pivot, along: z * (direction.length() * per_main) }
    }
}

impl Ray {
    fn offset_from(&self, frame: Vec3) -> Vec2 {
        Vec2::new(self.right.dot(frame), self.down.dot(frame)) + self.pivot
    }
}

fn turns(a: &Corner, b: &Corner) -> bool {
    let (left, right) = (a.offset.x * b.offset.y, a.offset.y * b.offset.x);
    let along = NUDGE * (a.offset - b.offset).yx();
    if left != right {
        left > right
    } else if along.x != along.y {
        along.x > along.y
    } else {
        a.name < b.name
    }
}

fn crossing(a: &Corner, b: &Corner, c: &Corner) -> Vec2 {
    let (ab, ac) = (b.offset - a.offset, c.offset - a.offset);
    let whole = ab.x * ac.y - ab.y * ac.x;
    if whole.partial_cmp(&0.0) != Some(Ordering::Greater) {
        return Vec2::splat(1.0 / 3.0);
    }
    let parts = Vec2::new(ac.x * a.offset.y - ac.y * a.offset.x, ab.y * a.offset.x - ab.x * a.offset.y);
    let along = (parts / whole.max(1e-37)).clamp(Vec2::ZERO, Vec2::ONE);
    Vec2::new(along.x, along.y.min(1.0 - along.x))
}

fn opposite_longest(a: &Corner, b: &Corner, c: &Corner) -> usize {
    let squares = [c.offset - b.offset, a.offset - c.offset, b.offset - a.offset].map(Vec2::length_squared);
    if squares[0] >= squares[1].max(squares[2]) {
        0
    } else if squares[1] >= squares[2] {
        1
    } else {
        2
    }
}

/// The distance of the shader's `place_of`.
fn distance_of(a: &Corner, b: &Corner, c: &Corner) -> f32 {
    let [first, second, third] = [[a, b, c], [b, c, a], [c, a, b]][opposite_longest(a, b, c)];
    let along = crossing(first, second, third);
    first.distance + along.x * (second.distance - first.distance) + along.y * (third.distance - first.distance)
}

#[cfg(test)]
mod tests;
