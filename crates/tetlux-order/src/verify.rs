//! Whether an order is right: every ray's cells, clipped and sorted on their own, against their ranks.
//!
//! Nothing here knows of arrows, neighbours or pixels: each cell's interval along a ray is found from its box and its
//! four planes in f64, and kept only as far as rounding errors leave it certain. Two intervals that are certainly
//! apart have an order, and a rank that contradicts it is an inversion beyond doubt.

mod hierarchy;
#[cfg(test)]
mod tests;

use glam::{DVec3, Vec3};
use rayon::prelude::*;
use tetlux_mesh::{FACES, NONE, TetMesh};

use self::hierarchy::{Hierarchy, span};
use crate::Order;

/// A ray: the points `origin` + t `direction` with t of at least `start`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ray {
    /// A world position.
    pub origin: DVec3,
    /// Of any length but zero.
    pub direction: DVec3,
    /// Where the ray begins: 0 at the origin, `f64::MIN` for a whole line.
    pub start: f64,
}

/// The part of a ray that is inside a cell.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Interval {
    /// The cell.
    pub cell: u32,
    /// The ray's parameter where it enters the cell, or its start.
    pub entry: f64,
    /// The ray's parameter where it leaves the cell.
    pub exit: f64,
}

impl Interval {
    fn length(&self) -> f64 {
        self.exit - self.entry
    }

    fn middle(&self) -> f64 {
        0.5 * (self.entry + self.exit)
    }
}

/// Which pairs of a ray's cells are checked.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Pairs {
    /// Each cell with those behind it, up to the first that it does not overlap. Where no cells overlap this finds
    /// every ray that holds an inversion.
    #[default]
    Adjacent,
    /// Each cell with all behind it.
    All,
}

/// Two cells whose ranks contradict the ray, or that overlap along it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Example {
    /// Index of the ray.
    pub ray: usize,
    /// The two intervals, the nearer first.
    pub intervals: [Interval; 2],
    /// The cells' positions in the order.
    pub positions: [u32; 2],
}

/// What the rays say of an order.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Verification {
    /// Rays that meet a cell of the order.
    pub rays: usize,
    /// Cells met, over all rays.
    pub intervals: u64,
    /// Pairs that have an order and were checked.
    pub pairs: u64,
    /// Pairs among them whose farther cell comes first.
    pub inversions: u64,
    /// Indices of the rays with an inversion, ascending.
    pub inverted: Vec<usize>,
    /// Pairs within one group: the order leaves them to each ray.
    pub grouped: u64,
    /// Pairs that overlap along the ray by more than [`OVERLAP`] of the shorter: they have no order.
    pub overlaps: u64,
    /// Rays with such a pair.
    pub rays_overlapping: usize,
    /// Cells of the mesh that the order leaves out.
    pub missing: usize,
    /// Entries of the order that name a cell a second time, or none of the mesh's.
    pub repeated: usize,
    /// The first few inversions.
    pub examples: Vec<Example>,
    /// The first few overlaps.
    pub overlap_examples: Vec<Example>,
}

impl Verification {
    /// Whether the order is a permutation of cells without an inversion.
    pub fn is_right(&self) -> bool {
        self.inversions == 0 && self.repeated == 0
    }
}

/// Cells of which less than this share of the shorter interval is common have an order all the same: cells that meet
/// in a face meet in two planes where their vertices are rounded.
pub const OVERLAP: f64 = 1e-3;

/// How many examples are kept of each kind.
const EXAMPLES: usize = 4;

/// Checks an order along rays: see [`Verifier`], which checks several orders of one mesh.
pub fn verify(mesh: &TetMesh, order: &Order, rays: &[Ray]) -> Verification {
    Verifier::new(mesh).verify(order, rays, Pairs::Adjacent)
}

/// A mesh prepared for casting rays at its cells.
#[derive(Debug)]
pub struct Verifier<'a> {
    mesh: &'a TetMesh,
    hierarchy: Hierarchy,
    /// No point of the mesh is farther from its local origin.
    radius: f64,
}

/// A ray relative to the mesh: from its point nearest the local origin, so that no distance is larger than the mesh,
/// and of unit direction.
struct Local {
    origin: DVec3,
    direction: DVec3,
    start: f64,
    /// The ray's parameter is (t + offset) * scale.
    offset: f64,
    scale: f64,
}

impl Local {
    /// Nothing for a ray that is none: without a direction, or not finite.
    fn new(mesh: &TetMesh, ray: &Ray) -> Option<Local> {
        let length = ray.direction.length();
        let direction = ray.direction.try_normalize()?;
        let origin = ray.origin - mesh.origin();
        let offset = -origin.dot(direction);
        let start = (ray.start * length).clamp(f64::MIN, f64::MAX) - offset;
        let foot = origin + direction * offset;
        (foot.is_finite() && start.is_finite()).then(|| Local {
            origin: foot,
            direction,
            start,
            offset,
            scale: length.recip(),
        })
    }

    fn parameter(&self, t: f64) -> f64 {
        (t + self.offset) * self.scale
    }

    fn interval(&self, local: &Interval) -> Interval {
        Interval { cell: local.cell, entry: self.parameter(local.entry), exit: self.parameter(local.exit) }
    }
}

impl<'a> Verifier<'a> {
    /// Builds a tree of boxes over the cells: n log n in their number.
    pub fn new(mesh: &'a TetMesh) -> Verifier<'a> {
        let bounds: Vec<[Vec3; 2]> = mesh.cells().par_iter().map(|cell| cell_box(mesh, cell)).collect();
        let radius = mesh.points().iter().map(|p| p.as_dvec3().length()).fold(0.0, f64::max);
        Verifier { mesh, hierarchy: Hierarchy::new(&bounds), radius }
    }

    /// The cells that a ray is certainly inside for a while, nearest middle first.
    pub fn intervals(&self, ray: &Ray) -> Vec<Interval> {
        let Some(local) = Local::new(self.mesh, ray) else { return Vec::new() };
        let mut found = Vec::new();
        self.along(&local, &mut found);
        found.iter().map(|interval| local.interval(interval)).collect()
    }

    fn along(&self, ray: &Local, found: &mut Vec<Interval>) {
        found.clear();
        self.hierarchy.along(ray.origin, ray.direction, ray.start, |cell| found.extend(self.clip(cell, ray)));
        found.sort_unstable_by(|a, b| a.middle().total_cmp(&b.middle()).then(a.cell.cmp(&b.cell)));
    }

    /// The part of a ray that is inside a cell, less what rounding may have added.
    fn clip(&self, cell: u32, ray: &Local) -> Option<Interval> {
        let cell_points = &self.mesh.cells()[cell as usize];
        let [mut entry, mut exit] = span(cell_box(self.mesh, cell_points), ray.origin, ray.direction, ray.start)?;
        let p = cell_points.map(|v| self.mesh.points()[v as usize].as_dvec3());
        for [a, b, c] in FACES.map(|face| face.map(|i| p[i])) {
            let (u, v) = (b - a, c - a);
            let normal = u.cross(v);
            // A point of the ray is off by a few roundings of its own coordinates, at most the mesh's; the normal by a
            // few of its factors, over distances within the mesh.
            let doubt = 32.0 * f64::EPSILON * u.length() * v.length() * (self.radius + ray.origin.length());
            let outside = |t: f64| normal.dot(ray.origin + ray.direction * t - a) + doubt;
            let (first, last) = (outside(entry), outside(exit));
            match (first > 0.0, last > 0.0) {
                (false, false) => {}
                (true, true) => return None,
                (true, false) => entry += (exit - entry) * (first / (first - last)),
                (false, true) => exit -= (exit - entry) * (last / (last - first)),
            }
        }
        (entry < exit).then_some(Interval { cell, entry, exit })
    }

    /// Checks an order along rays; seconds for a hundred thousand rays through half a million cells.
    pub fn verify(&self, order: &Order, rays: &[Ray], pairs: Pairs) -> Verification {
        self.verify_all(&[order], rays, pairs).swap_remove(0)
    }

    /// Checks several orders along the same rays, each of which is cast once.
    pub fn verify_all(&self, orders: &[&Order], rays: &[Ray], pairs: Pairs) -> Vec<Verification> {
        let ranks: Vec<Ranks> = orders.iter().map(|order| Ranks::new(self.mesh, order)).collect();
        let per_ray: Vec<Vec<Verification>> = rays
            .par_iter()
            .enumerate()
            .map_init(
                || (Vec::new(), Vec::new()),
                |(found, ranked), (index, ray)| {
                    let Some(local) = Local::new(self.mesh, ray) else { return Vec::new() };
                    self.along(&local, found);
                    let judge = |ranks: &Ranks| {
                        ranked.clear();
                        ranked.extend(found.iter().filter(|i| ranks.position[i.cell as usize] != NONE));
                        check(index, &local, ranked, ranks, pairs)
                    };
                    ranks.iter().map(judge).collect()
                },
            )
            .collect();
        let mut all: Vec<Verification> = ranks.iter().map(Ranks::verification).collect();
        for one in per_ray {
            all.iter_mut().zip(one).for_each(|(all, one)| all.add(one));
        }
        all
    }
}

/// An order, by cell.
struct Ranks {
    /// For each cell its position in the order, [`NONE`] if it has none.
    position: Vec<u32>,
    /// For each position its rank: the same for all of a group.
    rank: Vec<u32>,
    repeated: usize,
}

impl Ranks {
    fn new(mesh: &TetMesh, order: &Order) -> Ranks {
        let mut position = vec![NONE; mesh.cells().len()];
        let mut repeated = 0;
        for (at, &cell) in order.cells.iter().enumerate() {
            match position.get_mut(cell as usize) {
                Some(position) if *position == NONE => *position = at as u32,
                _ => repeated += 1,
            }
        }
        let mut rank: Vec<u32> = (0..order.cells.len() as u32).collect();
        for group in &order.groups {
            if let Some(ranks) = rank.get_mut(group.start as usize..group.end as usize) {
                ranks.fill(group.start);
            }
        }
        Ranks { position, rank, repeated }
    }

    /// What is known without any ray.
    fn verification(&self) -> Verification {
        let missing = self.position.iter().filter(|&&at| at == NONE).count();
        Verification { missing, repeated: self.repeated, ..Verification::default() }
    }
}

impl Verification {
    fn add(&mut self, other: Verification) {
        self.rays += other.rays;
        self.intervals += other.intervals;
        self.pairs += other.pairs;
        self.inversions += other.inversions;
        self.inverted.extend(other.inverted);
        self.grouped += other.grouped;
        self.overlaps += other.overlaps;
        self.rays_overlapping += other.rays_overlapping;
        self.examples.extend(other.examples);
        self.examples.truncate(EXAMPLES);
        self.overlap_examples.extend(other.overlap_examples);
        self.overlap_examples.truncate(EXAMPLES);
    }
}

/// Checks one ray's intervals, sorted by their middles.
fn check(index: usize, ray: &Local, found: &[Interval], order: &Ranks, pairs: Pairs) -> Verification {
    let (rays, intervals) = (usize::from(!found.is_empty()), found.len() as u64);
    let mut result = Verification { rays, intervals, ..Verification::default() };
    for (i, near) in found.iter().enumerate() {
        for far in &found[i + 1..] {
            let positions = [near, far].map(|interval| order.position[interval.cell as usize]);
            let ranks = positions.map(|at| order.rank[at as usize]);
            let example = || Example { ray: index, intervals: [ray.interval(near), ray.interval(far)], positions };
            let common = near.exit.min(far.exit) - near.entry.max(far.entry);
            let overlap = common > OVERLAP * near.length().min(far.length());
            if ranks[0] == ranks[1] {
                result.grouped += 1;
            } else if overlap {
                result.overlaps += 1;
                if result.overlap_examples.len() < EXAMPLES {
                    result.overlap_examples.push(example());
                }
            } else {
                result.pairs += 1;
                if ranks[0] > ranks[1] {
                    result.inversions += 1;
                    if result.examples.len() < EXAMPLES {
                        result.examples.push(example());
                    }
                }
            }
            if pairs == Pairs::Adjacent && !overlap {
                break;
            }
        }
    }
    if result.inversions > 0 {
        result.inverted.push(index);
    }
    result.rays_overlapping = usize::from(result.overlaps > 0);
    result
}

fn cell_box(mesh: &TetMesh, cell: &[u32; 4]) -> [Vec3; 2] {
    let p = cell.map(|v| mesh.points()[v as usize]);
    [p[0].min(p[1]).min(p[2].min(p[3])), p[0].max(p[1]).max(p[2].max(p[3]))]
}
