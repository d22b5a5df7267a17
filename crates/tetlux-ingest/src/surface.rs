//! Surfaces of triangles: OBJ and STL files.

mod nearest;
mod obj;
mod polygon;
mod stl;

use std::path::{Path, PathBuf};

use glam::DVec3;
use tetlux_mesh::coincident;

use crate::source::Source;
use crate::{IngestError, Place};

pub(crate) use nearest::Nearest;

/// Triangles in space, points that coincide made one.
#[derive(Debug, Clone, Default)]
pub struct Surface {
    /// The file it was read from, for messages.
    pub path: PathBuf,
    /// Positions in world space.
    pub points: Vec<DVec3>,
    /// Triangles by point index, counter-clockwise seen from the side that faces outwards, if the file says so.
    pub triangles: Vec<[u32; 3]>,
    /// What was passed over or left out, a sentence each.
    pub notes: Vec<String>,
}

/// Counts and measures of a surface: see [`Surface::report`].
#[derive(Debug, Clone, PartialEq)]
pub struct SurfaceReport {
    /// Points, coincident ones counted once.
    pub points: usize,
    /// Triangles, without degenerate ones.
    pub triangles: usize,
    /// Edges of one triangle alone.
    pub edges_open: usize,
    /// Edges of three or more triangles.
    pub edges_non_manifold: usize,
    /// Edges of two triangles that run through it the same way: one of them is inside out.
    pub edges_same_way: usize,
    /// Sets of triangles connected through edges.
    pub components: usize,
    /// Corners of the bounding box.
    pub bounds: [[f64; 3]; 2],
    /// Enclosed volume in cubic world units: positive if the triangles face outwards, negative if inwards; without
    /// meaning for a surface that is not closed.
    pub volume: f64,
}

impl SurfaceReport {
    /// Whether every edge is shared by exactly two triangles that run through it in opposite directions.
    pub fn closed(&self) -> bool {
        self.edges_open + self.edges_non_manifold + self.edges_same_way == 0
    }

    /// Whether the triangles face outwards, by the sign of the enclosed volume.
    pub fn outward(&self) -> bool {
        self.volume > 0.0
    }
}

/// Whether a file is one of a surface, by its content.
pub(crate) fn recognizes(bytes: &[u8]) -> bool {
    stl::recognizes(bytes) || obj::recognizes(bytes)
}

/// Whether a file of this extension, in lower case, should be one.
pub(crate) fn has_extension(extension: &str) -> bool {
    ["obj", "stl"].contains(&extension)
}

impl Surface {
    /// Reads an OBJ file, or an STL file as text or binary.
    ///
    /// Polygons are cut into triangles, points that coincide (as [`tetlux_mesh::coincident`] has it) made one, and
    /// triangles with two corners in one point dropped and counted. Materials, normals, texture coordinates, lines
    /// and names are passed over.
    pub fn read(path: &Path) -> Result<Surface, IngestError> {
        Surface::from_source(&Source::open(path)?)
    }

    pub(crate) fn from_source(source: &Source) -> Result<Surface, IngestError> {
        let obj_named = source.path.extension().is_some_and(|e| e.eq_ignore_ascii_case("obj"));
        if stl::recognizes(&source.bytes) || !(obj_named || obj::recognizes(&source.bytes)) {
            stl::read(source)
        } else {
            obj::read(source)
        }
    }

    /// A surface of points and triangles as a file has them; every index must name a point.
    pub(crate) fn assemble(
        source: &Source,
        given: Vec<DVec3>,
        mut triangles: Vec<[u32; 3]>,
        mut notes: Vec<String>,
    ) -> Result<Surface, IngestError> {
        let path = source.path.clone();
        if let Some(point) = given.iter().position(|p| !p.is_finite()) {
            return Err(IngestError::NonFinite { path, point, at: given[point].to_array() });
        }
        let first = coincident(&given).map_err(|e| IngestError::Mesh { path: path.clone(), source: e })?;
        triangles.iter_mut().for_each(|triangle| *triangle = triangle.map(|v| first[v as usize]));
        let count = triangles.len();
        triangles.retain(|&[a, b, c]| a != b && b != c && c != a);
        if triangles.is_empty() {
            let remedy = "a surface needs a triangle with three different corners";
            return Err(source.malformed(Place::File, "the triangles", format!("none of {count} is one"), remedy));
        }
        if count > triangles.len() {
            notes.push(format!("triangles with two corners in one point: {}, dropped", count - triangles.len()));
        }
        // Points that are used, in their order.
        let mut place = vec![u32::MAX; given.len()];
        triangles.iter().flatten().for_each(|&v| place[v as usize] = 0);
        let mut points = Vec::new();
        for (place, point) in place.iter_mut().zip(given).filter(|(place, _)| **place == 0) {
            *place = points.len() as u32;
            points.push(point);
        }
        triangles.iter_mut().for_each(|triangle| *triangle = triangle.map(|v| place[v as usize]));
        Ok(Surface { path, points, triangles, notes })
    }

    /// What is known of the surface: whether it is closed, its parts, where it lies and which way it faces.
    pub fn report(&self) -> SurfaceReport {
        let mut report = SurfaceReport {
            points: self.points.len(),
            triangles: self.triangles.len(),
            edges_open: 0,
            edges_non_manifold: 0,
            edges_same_way: 0,
            components: 0,
            bounds: self.bounds().map(|corner| corner.to_array()),
            volume: self.volume_of(0..self.triangles.len()),
        };
        let mut components = Components::new(self.triangles.len());
        for group in self.edges().chunk_by(|a, b| a.ends == b.ends) {
            match group {
                [_] => report.edges_open += 1,
                [a, b] => report.edges_same_way += usize::from(a.forward == b.forward),
                _ => report.edges_non_manifold += 1,
            }
            group.windows(2).for_each(|pair| components.join(pair[0].triangle, pair[1].triangle));
        }
        report.components = components.count();
        report
    }

    /// Corners of the bounding box.
    pub(crate) fn bounds(&self) -> [DVec3; 2] {
        let empty = [DVec3::INFINITY, DVec3::NEG_INFINITY];
        self.points.iter().fold(empty, |[low, high], &p| [low.min(p), high.max(p)])
    }

    /// Volume between the middle of the box and some of the triangles.
    fn volume_of(&self, triangles: impl Iterator<Item = usize>) -> f64 {
        let [low, high] = self.bounds();
        let middle = low * 0.5 + high * 0.5;
        let cone = |t: usize| {
            let [a, b, c] = self.triangles[t].map(|v| self.points[v as usize] - middle);
            a.cross(b).dot(c)
        };
        triangles.map(cone).sum::<f64>() / 6.0
    }

    /// The edges of all triangles, those between the same points together.
    fn edges(&self) -> Vec<Edge> {
        let of = |(t, &[a, b, c]): (usize, &[u32; 3])| {
            [(a, b), (b, c), (c, a)].map(|(from, to)| Edge {
                ends: [from.min(to), from.max(to)],
                triangle: t as u32,
                forward: from < to,
            })
        };
        let mut edges: Vec<Edge> = self.triangles.iter().enumerate().flat_map(of).collect();
        edges.sort_unstable_by_key(|edge| (edge.ends, edge.triangle));
        edges
    }

    /// Turns triangles round until neighbours agree, and each part in which one was turned so that it faces
    /// outwards; parts that agree already stay as they are. Gives the number turned. Where no way of turning makes
    /// all agree (a Klein bottle) some edges still do not.
    pub(crate) fn orient(&mut self) -> usize {
        let edges = self.edges();
        let mut around = vec![Vec::new(); self.triangles.len()];
        for pair in edges.chunk_by(|a, b| a.ends == b.ends) {
            if let [a, b] = pair {
                let same_way = a.forward == b.forward;
                around[a.triangle as usize].push((b.triangle, same_way));
                around[b.triangle as usize].push((a.triangle, same_way));
            }
        }
        let mut turned: Vec<Option<bool>> = vec![None; self.triangles.len()];
        let mut total = 0;
        for seed in 0..self.triangles.len() {
            if turned[seed].is_some() {
                continue;
            }
            turned[seed] = Some(false);
            let (mut part, mut next) = (vec![seed], 0);
            while let Some(&t) = part.get(next) {
                next += 1;
                for &(other, same_way) in &around[t] {
                    if turned[other as usize].is_none() {
                        turned[other as usize] = turned[t].map(|turned| turned != same_way);
                        part.push(other as usize);
                    }
                }
            }
            if part.iter().all(|&t| turned[t] == Some(false)) {
                continue;
            }
            part.iter().filter(|&&t| turned[t] == Some(true)).for_each(|&t| self.triangles[t].swap(1, 2));
            let inwards = self.volume_of(part.iter().copied()) < 0.0;
            if inwards {
                part.iter().for_each(|&t| self.triangles[t].swap(1, 2));
            }
            total += part.iter().filter(|&&t| (turned[t] == Some(true)) != inwards).count();
        }
        total
    }
}

/// An edge of one triangle.
struct Edge {
    ends: [u32; 2],
    triangle: u32,
    /// From the smaller index to the larger.
    forward: bool,
}

/// Sets that are joined until only what is connected is together.
struct Components {
    parent: Vec<u32>,
}

impl Components {
    fn new(count: usize) -> Self {
        Components { parent: (0..count as u32).collect() }
    }

    fn root(&mut self, mut i: u32) -> u32 {
        while self.parent[i as usize] != i {
            let above = self.parent[self.parent[i as usize] as usize];
            self.parent[i as usize] = above;
            i = above;
        }
        i
    }

    fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.root(a), self.root(b));
        self.parent[a.max(b) as usize] = a.min(b);
    }

    fn count(&self) -> usize {
        self.parent.iter().enumerate().filter(|&(i, &p)| i == p as usize).count()
    }
}

#[cfg(test)]
pub(crate) mod tests;
