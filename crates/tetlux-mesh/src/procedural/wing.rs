//! A graded mesh round a delta wing, with the vorticity of its leading-edge vortices.

use std::f64::consts::{PI, TAU};

use glam::DVec3;

use super::random::SplitMix64;
use super::vortices::Vortices;
use super::{Parts, Split, grid};
use crate::Field;

/// A mesh that is not yet assembled, and the field on its points.
#[derive(Debug, Clone, PartialEq)]
pub struct Wing {
    /// Points and cells of the air; the wing is a hole.
    pub parts: Parts,
    /// Vorticity magnitude, one number a point, named [`WING_FIELD`].
    pub field: Field,
}

/// Name of the field of [`wing`].
pub const WING_FIELD: &str = "vorticity";

/// Half the wing's width at the blunt apex, at x = 0.
const APEX: f64 = 0.012;
/// Half the wing's width at the trailing edge, at x = 1: a sweep of 68 degrees.
const TRAILING: f64 = 0.42;
/// Half the wing's thickness, in half widths.
const THICKNESS: f64 = 0.03;
/// Height to which the vortices reach, in half widths.
const VORTICES: f64 = 0.75;
/// Corners of the box of air.
const AIR: [DVec3; 2] = [DVec3::new(-0.15, -0.8, -0.22), DVec3::new(1.9, 0.8, 0.6)];
/// Largest displacement of a vertex, in spacings of the grid.
const JITTER: f64 = 0.2;
/// Part of its volume that every cell keeps when its vertices are displaced.
const LEAST_VOLUME: f64 = 0.25;

/// Half the width of the wing at x; before the apex and behind the trailing edge that of the nearer end.
pub(super) fn half_width(x: f64) -> f64 {
    APEX + (TRAILING - APEX) * x.clamp(0.0, 1.0)
}

/// Half the thickness of the wing at x.
pub(super) fn half_thickness(x: f64) -> f64 {
    THICKNESS * half_width(x)
}

/// A delta wing in a box of air, and the vorticity of the flow over it: the built-in scene.
///
/// The wing lies in the plane z = 0, its apex at the origin, its root chord 1 along +x, and is 0.84 wide. A structured
/// grid widens with it, so that spacings near the apex are hundreds of times finer than far away; the hexahedra are
/// split in six, those inside the wing left out, and the vertices away from the surfaces displaced at random, by
/// less wherever a cell would lose most of its volume. `seed` chooses the displacements and the details of the flow;
/// `cells` is the number of tetrahedra, met to about a tenth if above some thousands.
pub fn wing(seed: u64, cells: usize) -> Wing {
    let layout = Layout::new(cells);
    let counts = layout.total;
    let mut parts = grid(counts, Split::Six, |u| layout.place(u));
    let mut hexahedron = 0;
    parts.cells = parts
        .cells
        .chunks(6)
        .filter(|_| {
            let place =
                [hexahedron % counts[0], hexahedron / counts[0] % counts[1], hexahedron / (counts[0] * counts[1])];
            hexahedron += 1;
            !(0..3).all(|axis| (layout.hole[axis][0]..layout.hole[axis][1]).contains(&place[axis]))
        })
        .flatten()
        .copied()
        .collect();
    jitter(&mut parts, &layout, seed);
    let vortices = Vortices::new(seed);
    let field = Field::point(WING_FIELD, 1, parts.sample(|p| vortices.vorticity(p)));
    Wing { parts, field }
}

/// How many hexahedra, and which of them the wing takes.
struct Layout {
    /// Hexahedra along each axis.
    total: [usize; 3],
    /// First and one past the last hexahedron of the wing.
    hole: [[usize; 2]; 3],
}

impl Layout {
    fn new(cells: usize) -> Self {
        // Proportions that make cells near the vortices about as long as wide.
        const X: [f64; 3] = [2.0, 20.0, 18.0];
        const Y: [f64; 3] = [3.0, 26.0, 3.0];
        const Z: [f64; 2] = [2.0, 13.0];
        let sum = |parts: &[f64]| parts.iter().sum::<f64>();
        let hexahedra = cells as f64 / 6.0;
        let scale = (hexahedra / (sum(&X) * sum(&Y) * sum(&Z))).cbrt();
        let count = |n: f64, scale: f64| ((n * scale).round() as usize).max(2);
        let y = Y.map(|n| count(n, scale));
        let z = [count(Z[0], scale), 1, count(Z[1], scale)];
        // The longest axis makes up for what rounding did to the others.
        let plane = y.iter().sum::<usize>() * z.iter().sum::<usize>();
        let x = X.map(|n| count(n, hexahedra / plane as f64 / sum(&X)));
        Layout { total: [x, y, z].map(|n| n.iter().sum()), hole: [x, y, z].map(|n| [n[0], n[0] + n[1]]) }
    }

    /// Position in [-1, 2] of a place in [0, 1] along an axis: -1 to 0 before the wing, 0 to 1 inside, 1 to 2 behind.
    fn stage(&self, axis: usize, u: f64) -> f64 {
        let index = u * self.total[axis] as f64;
        let [lo, hi, end] = [self.hole[axis][0], self.hole[axis][1], self.total[axis]].map(|n| n as f64);
        if index <= lo {
            index / lo - 1.0
        } else if index >= hi {
            1.0 + (index - hi) / (end - hi)
        } else {
            (index - lo) / (hi - lo)
        }
    }

    /// The grid. Each side of a hexahedron lies in a plane: lines of constant x are straight in y and z.
    fn place(&self, u: DVec3) -> DVec3 {
        let x = match self.stage(0, u.x) {
            t if t <= 0.0 => AIR[0].x * graded(-t, 0.03 / -AIR[0].x),
            t if t >= 1.0 => 1.0 + (AIR[1].x - 1.0) * (t - 1.0),
            t => graded(t, 1.0),
        };
        let (s, h) = (half_width(x), half_thickness(x));
        let y = match self.stage(1, u.y) {
            t if t <= 0.0 => -s * (AIR[0].y / -s).powf(-t),
            t if t >= 1.0 => s * (AIR[1].y / s).powf(t - 1.0),
            t => {
                // Closer where the vortices are, about two thirds of the way to the leading edges.
                let w = 2.0 * t - 1.0;
                s * (w + 0.08 * (PI * w).sin() + 0.06 * (TAU * w).sin())
            }
        };
        let z = match self.stage(2, u.z) {
            t if t <= 0.0 => -h + (AIR[0].z + h) * graded(-t, s / (-AIR[0].z - h)),
            t if t >= 1.0 => {
                // Four fifths of the layers evenly through the vortices, the rest in equal ratios up to the top.
                let (low, top) = (VORTICES * s, AIR[1].z);
                let t = (t - 1.0) / 0.8;
                if t <= 1.0 { h + (low - h) * t } else { low * (top / low).powf(4.0 * (t - 1.0)) }
            }
            t => h * (2.0 * t - 1.0),
        };
        DVec3::new(x, y, z)
    }

    /// Grid points on the surface of the air.
    fn is_surface(&self, ijk: [usize; 3]) -> bool {
        (0..3).any(|axis| ijk[axis] == 0 || ijk[axis] == self.total[axis])
            || (0..3).all(|axis| (self.hole[axis][0]..=self.hole[axis][1]).contains(&ijk[axis]))
    }
}

/// From 0 to 1 with the spacing growing as `start` plus the way gone: equal ratios, the finest at 0.
fn graded(t: f64, start: f64) -> f64 {
    start * ((1.0 + 1.0 / start).powf(t) - 1.0)
}

/// Displaces the points inside the air at random; no cell keeps less than [`LEAST_VOLUME`] of its volume.
fn jitter(parts: &mut Parts, layout: &Layout, seed: u64) {
    let mut random = SplitMix64::new(seed);
    let counts = layout.total;
    let n = counts.map(|c| c + 1);
    let spacing = DVec3::from(counts.map(|c| c as f64)).recip();
    let still = parts.points.clone();
    let shifts: Vec<DVec3> = (0..still.len())
        .map(|p| {
            let ijk = [p % n[0], p / n[0] % n[1], p / (n[0] * n[1])];
            // Drawn for surface points too, so that a point's numbers depend on its place alone.
            let draw = DVec3::from([(); 3].map(|()| JITTER * random.signed()));
            if layout.is_surface(ijk) {
                return DVec3::ZERO;
            }
            let index = DVec3::from(ijk.map(|i| i as f64));
            layout.place((index + draw) * spacing) - still[p]
        })
        .collect();
    let volume = |points: &[DVec3], cell: &[u32; 4]| {
        let p = cell.map(|v| points[v as usize]);
        (p[1] - p[0]).cross(p[2] - p[0]).dot(p[3] - p[0])
    };
    let mut scale = vec![1.0f64; still.len()];
    loop {
        parts.points = (0..still.len()).map(|p| still[p] + scale[p] * shifts[p]).collect();
        let mut done = true;
        for cell in &parts.cells {
            if volume(&parts.points, cell) < LEAST_VOLUME * volume(&still, cell) {
                done = false;
                for v in cell.map(|v| v as usize) {
                    // After a few halvings back to the grid, whose cells are all positive: the loop ends.
                    scale[v] = if scale[v] > 0.1 { 0.5 * scale[v] } else { 0.0 };
                }
            }
        }
        if done {
            return;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::TetMesh;

    fn assemble(wing: Wing) -> TetMesh {
        TetMesh::assemble(&wing.parts.points, &wing.parts.cells, vec![wing.field]).unwrap()
    }

    #[test]
    fn wings_are_sound_graded_and_hollow() {
        for (seed, cells) in [(0, 20_000), (1, 50_000), (2, 100_000), (u64::MAX, 100_000)] {
            let mesh = assemble(wing(seed, cells));
            let report = mesh.validate();
            assert_eq!((report.assembly.cells_inverted, report.assembly.cells_flat), (0, 0), "{seed}");
            assert_eq!((report.components, report.faults()), (1, vec![]), "{seed}");
            assert!(report.cells.abs_diff(cells) < cells / 10, "{} for {cells}", report.cells);
            assert!(report.edge_lengths[1] > 20.0 * report.edge_lengths[0], "{:?}", report.edge_lengths);

            // Only points off the surfaces move: the box less the wing, whose cross section (2s)(2h) = 4 THICKNESS s^2
            // is quadratic in x: a frustum of a pyramid.
            let size = AIR[1] - AIR[0];
            let body = 4.0 * THICKNESS / 3.0 * (APEX * APEX + APEX * TRAILING + TRAILING * TRAILING);
            let volume = size.x * size.y * size.z - body;
            // Coordinates rounded to single precision.
            assert!((report.volume / volume - 1.0).abs() < 1e-6, "{} for {volume}", report.volume);
        }
    }

    #[test]
    fn a_few_cells_are_still_a_wing() {
        for cells in [0, 1, 1000] {
            let report = assemble(wing(3, cells)).validate();
            assert_eq!((report.components, report.faults()), (1, vec![]));
        }
    }

    #[test]
    fn a_seed_gives_one_wing_and_another_seed_another() {
        let first = wing(5, 5000);
        assert_eq!(first, wing(5, 5000));
        let other = wing(6, 5000);
        assert_eq!(first.parts.cells, other.parts.cells);
        assert_ne!(first.parts.points, other.parts.points);
        assert_ne!(first.field, other.field);
    }

    #[test]
    fn vertices_are_displaced_and_surfaces_are_not() {
        let layout = Layout::new(20_000);
        let still = grid(layout.total, Split::Six, |u| layout.place(u)).points;
        let moved = wing(1, 20_000).parts.points;
        let n = layout.total.map(|c| c + 1);
        let mut displaced = 0;
        let mut inside = 0;
        for (p, (a, b)) in still.iter().zip(&moved).enumerate() {
            if layout.is_surface([p % n[0], p / n[0] % n[1], p / (n[0] * n[1])]) {
                assert_eq!(a, b);
            } else {
                inside += 1;
                displaced += usize::from(a != b);
            }
        }
        assert!(displaced * 10 > inside * 9, "{displaced} of {inside}");
    }
}
