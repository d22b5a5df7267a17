//! The cells that a picture draws, and what is known of a mesh from its last one.

use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use glam::DVec3;
use rayon::prelude::*;
use tetlux_mesh::{ScalarField, TetMesh};
use tetlux_optics::Classification;
use tetlux_optics::widget::Rectangle;

use crate::budget::Measures;
use crate::ranges::{Intervals, Ranges};
use crate::verdict::{Verdict, Verdicts};
use crate::{CellBoxes, Device, Plan, Scene, SceneError, Skip, SkipSet, View};

/// Makes plans for pictures of one mesh. What depends on the mesh, the field or the camera alone is found again only when
/// that changes: a new transfer function on a loaded mesh asks for the ranges of the cells, and no more.
#[derive(Debug)]
pub struct Planner<'a> {
    mesh: &'a TetMesh,
    /// The mesh's bounding box, relative to its origin.
    bounds: [DVec3; 2],
    /// Cells of no volume, ascending.
    flat: OnceLock<Vec<u32>>,
    first: Mutex<Option<Arc<Ranges>>>,
    second: Mutex<Option<Arc<Ranges>>>,
    boxes: Mutex<Option<Arc<Boxed>>>,
    seen: Mutex<Option<Arc<Seen>>>,
}

/// The scalars of each cell as widgets are compared with them.
#[derive(Debug)]
struct Boxed {
    of: [Arc<Ranges>; 2],
    boxes: CellBoxes,
}

/// What a camera sees.
#[derive(Debug)]
struct Seen {
    view: View,
    /// Of each cell whether it is outside the frustum, or behind the eye; empty if none is.
    outside: Vec<bool>,
}

/// Cells that are not drawn, by the first reason that holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Skips {
    /// A vertex has no finite value, and what is without data is not seen.
    pub no_data: usize,
    /// Opacity is zero on the cell's whole scalar range; with an emphasis, at its four vertices.
    pub transparent: usize,
    /// Opacity is so small there that all such cells together are within a share of the error budget.
    pub faint: usize,
    /// Zero volume: no ray is inside for any length.
    pub flat: usize,
    /// Outside the frustum, or behind the eye.
    pub outside: usize,
}

impl Skips {
    fn and(mut self, other: Skips) -> Skips {
        self.no_data += other.no_data;
        self.transparent += other.transparent;
        self.faint += other.faint;
        self.flat += other.flat;
        self.outside += other.outside;
        self
    }
}

/// Cells that one core decides on at a time.
const SHARE: usize = 1 << 13;

impl<'a> Planner<'a> {
    /// Nothing is found before a plan needs it, but for the mesh's bounds.
    pub fn new(mesh: &'a TetMesh) -> Planner<'a> {
        Planner {
            mesh,
            bounds: mesh.local_bounds(),
            flat: OnceLock::new(),
            first: Mutex::default(),
            second: Mutex::default(),
            boxes: Mutex::default(),
            seen: Mutex::default(),
        }
    }

    /// Decides for a scene on the mesh; `device` is the adapter there is, if any.
    ///
    /// # Errors
    ///
    /// A camera that sees nothing, or a combination of backend, order and device that cannot be.
    pub fn plan(&self, scene: &Scene, device: Option<&Device>) -> Result<Plan, SceneError> {
        Plan::with(self, scene, device)
    }

    pub(crate) fn mesh(&self) -> &'a TetMesh {
        self.mesh
    }

    /// The ranges of the scene's scalars in the cells.
    pub(crate) fn ranges(&self, scene: &Scene) -> (Arc<Ranges>, Option<Arc<Ranges>>) {
        let of = |kept: &Mutex<Option<Arc<Ranges>>>, scalar: &ScalarField| {
            known_or(kept, |known| known.of.is_same(scalar), || Ranges::new(self.mesh, scalar))
        };
        (of(&self.first, &scene.scalar), scene.second.as_ref().map(|second| of(&self.second, second)))
    }

    pub(crate) fn measures(&self, scene: &Scene, ranges: &Ranges) -> Measures {
        let [low, high] = self.bounds;
        let diagonal = if self.mesh.points().is_empty() { 0.0 } else { low.distance(high) };
        let extent = diagonal / scene.unit_distance;
        let edge = extent / (self.mesh.cells().len().max(1) as f64).cbrt();
        Measures { extent, edge, widest: ranges.widest }
    }

    fn seen(&self, view: &View) -> Arc<Seen> {
        known_or(&self.seen, |known| known.view == *view, || Seen::new(self.mesh, self.bounds, view))
    }

    fn flat(&self) -> &[u32] {
        self.flat.get_or_init(|| {
            let cells = self.mesh.cells().par_iter().enumerate();
            cells.filter(|(_, cell)| is_flat(self.mesh, cell)).map(|(cell, _)| cell as u32).collect()
        })
    }

    /// For each cell whether widgets may be seen there; `None` for other functions.
    fn touched(&self, scene: &Scene, first: &Arc<Ranges>, second: Option<&Arc<Ranges>>) -> Option<Vec<bool>> {
        let (Classification::Widgets(function), Some(second)) = (&scene.classification, second) else { return None };
        let of = [first, second];
        let holds = |known: &Boxed| known.of.iter().zip(of).all(|(known, now)| Arc::ptr_eq(known, now));
        let ranges = |of: &Ranges| self.mesh.scalar_ranges(&of.of);
        let make = || Boxed { of: of.map(Arc::clone), boxes: CellBoxes::new(&ranges(first), &ranges(second)) };
        Some(known_or(&self.boxes, holds, make).boxes.visible(function))
    }

    /// The cells to draw, in mesh order, by `colors` at the points in place of the classification, if any; those up to an opacity of `faint` are left out, and what `kept` holds is not.
    pub(crate) fn cells(
        &self,
        scene: &Scene,
        view: &View,
        (first, second): (&Arc<Ranges>, Option<&Arc<Ranges>>),
        colors: Option<&[[f64; 4]]>,
        faint: f64,
        kept: SkipSet,
    ) -> (Vec<u32>, Skips) {
        let [drop_transparent, drop_outside] = [Skip::Transparent, Skip::Outside].map(|skip| !kept.contains(skip));
        let (mesh, flat) = (self.mesh, self.flat());
        let seen = drop_outside.then(|| self.seen(view));
        let outside = seen.as_ref().map_or(&[][..], |seen| &seen.outside);
        let dark = match &scene.classification {
            Classification::OneField(transfer) if colors.is_none() => {
                Some([0.0, faint].map(|opacity| Intervals::new(transfer.dark_intervals(opacity))))
            }
            _ => None,
        };
        let touched = self.touched(scene, first, second);
        let clear = |&v: &u32| colors.is_none_or(|colors| colors.get(v as usize).is_none_or(|color| color[3] <= 0.0));
        let is_missing = |cell: usize| first.is_missing(cell) || second.is_some_and(|second| second.is_missing(cell));
        let transparent = |cell: usize| match &touched {
            _ if is_missing(cell) => !scene.no_data.is_visible(),
            _ if colors.is_some() => mesh.cells()[cell].iter().all(clear),
            Some(touched) => !touched[cell],
            None => {
                let [s, g] = [Some(first), second]
                    .map(|ranges| ranges.map_or([0.0; 2], |ranges| mesh.scalar_range(&ranges.of, cell)));
                !scene.classification.is_visible_over(&Rectangle { s, g })
            }
        };
        let missing = first.has_missing || second.is_some_and(|second| second.has_missing);
        // From the weakest reason to the strongest.
        let decide = |start: usize, verdicts: &mut Verdicts| {
            if let (Some([dark, faint]), true) = (&dark, faint > 0.0) {
                first.mark_within(mesh, faint, start, verdicts, Verdict::Faint);
                first.mark_within(mesh, dark, start, verdicts, Verdict::Drawn);
            }
            let end = start + verdicts.0.len();
            let [from, to] = [start, end].map(|at| flat.partition_point(|&cell| (cell as usize) < at));
            flat[from..to].iter().for_each(|&cell| verdicts.0[cell as usize - start] = Verdict::Flat);
            if !outside.is_empty() {
                let outside = &outside[start..end];
                verdicts.mark(Verdict::Outside, |i| outside[i]);
            }
            match &dark {
                _ if !drop_transparent => {}
                Some([dark, _]) => first.mark_within(mesh, dark, start, verdicts, Verdict::Transparent),
                None => verdicts.mark(Verdict::Transparent, |i| transparent(start + i)),
            }
            // Intervals hold no range that is not a number.
            if missing && !scene.no_data.is_visible() {
                verdicts.mark(Verdict::NoData, |i| is_missing(start + i));
            }
        };
        let count = mesh.cells().len();
        let shares: Vec<(Vec<u32>, Skips)> = (0..count.div_ceil(SHARE))
            .into_par_iter()
            .map(|share| {
                let start = share * SHARE;
                let mut verdicts = Verdicts::new(SHARE.min(count - start));
                decide(start, &mut verdicts);
                (verdicts.drawn(start), verdicts.skips())
            })
            .collect();
        let skips = shares.iter().fold(Skips::default(), |sum, (_, skips)| sum.and(*skips));
        let mut cells = Vec::with_capacity(shares.iter().map(|(cells, _)| cells.len()).sum());
        shares.iter().for_each(|(share, _)| cells.extend_from_slice(share));
        (cells, skips)
    }
}

/// What is kept if it still holds, else made anew and kept. It is made without the lock: others may make it too.
fn known_or<T>(kept: &Mutex<Option<Arc<T>>>, holds: impl Fn(&T) -> bool, make: impl FnOnce() -> T) -> Arc<T> {
    // What a panic elsewhere left is as good as before.
    let lock = || kept.lock().unwrap_or_else(PoisonError::into_inner);
    let known = lock().clone();
    known.filter(|known| holds(known)).unwrap_or_else(|| lock().insert(Arc::new(make())).clone())
}

/// A corner of the mesh's box is inside the frustum for certain if it is by this share of what is added up.
const INSIDE: f64 = 1e-9;

impl Seen {
    fn new(mesh: &TetMesh, [low, high]: [DVec3; 2], view: &View) -> Seen {
        let offset = mesh.origin() - view.eye;
        let planes = view.frustum();
        let corner = |i: u32| DVec3::from_array([0, 1, 2].map(|axis| [low, high][(i >> axis & 1) as usize][axis]));
        let is_inside = |p: DVec3| {
            let (q, sum) = (view.rotate(p + offset), (p.abs() + offset.abs()).element_sum());
            planes.iter().all(|&(n, c)| n.dot(q) + c > INSIDE * (n.abs().element_sum() * sum + c.abs()))
        };
        // A box that is inside with all its corners has every cell inside.
        if mesh.points().is_empty() || (0..8).all(|i| is_inside(corner(i))) {
            return Seen { view: *view, outside: Vec::new() };
        }
        // The planes in the mesh's axes; and a bit for each that a point is outside of.
        let planes = planes.map(|(n, c)| (view.right * n.x + view.down * n.y + view.forward * n.z, c));
        let outside_of = |p: &glam::Vec3| {
            let q = p.as_dvec3() + offset;
            planes.iter().enumerate().fold(0, |bits, (i, &(n, c))| bits | u8::from(n.dot(q) + c < 0.0) << i)
        };
        let points: Vec<u8> = mesh.points().par_iter().map(outside_of).collect();
        let outside = |cell: &[u32; 4]| cell.iter().fold(u8::MAX, |bits, &v| bits & points[v as usize]) != 0;
        Seen { view: *view, outside: mesh.cells().par_iter().map(outside).collect() }
    }
}

fn is_flat(mesh: &TetMesh, cell: &[u32; 4]) -> bool {
    let p = cell.map(|v| mesh.points()[v as usize].as_dvec3());
    (p[1] - p[0]).cross(p[2] - p[0]).dot(p[3] - p[0]) == 0.0
}
