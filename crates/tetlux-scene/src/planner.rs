//! The cells that a picture draws, and what is known of a mesh from its last one.

use std::sync::{Arc, Mutex, PoisonError};

use glam::DVec3;
use rayon::prelude::*;
use tetlux_mesh::{ScalarField, TetMesh};
use tetlux_optics::Classification;
use tetlux_optics::widget::Rectangle;

use crate::budget::Measures;
use crate::verdict::{Verdict, Verdicts};
use crate::{CellBoxes, Device, Plan, Scene, SceneError, Skip, SkipSet, View};

/// Makes plans for pictures of one mesh. What depends on the field alone, or on the camera alone, is found again only when
/// that changes: a new transfer function on a loaded mesh asks every cell for its range, and no more.
#[derive(Debug)]
pub struct Planner<'a> {
    mesh: &'a TetMesh,
    /// Diagonal of the mesh's bounding box.
    diagonal: f64,
    first: Mutex<Option<Arc<Ranges>>>,
    second: Mutex<Option<Arc<Ranges>>>,
    boxes: Mutex<Option<Arc<Boxed>>>,
    seen: Mutex<Option<Arc<Seen>>>,
}

/// The scalars of each cell.
#[derive(Debug)]
pub(crate) struct Ranges {
    of: ScalarField,
    /// NaN where a value is missing.
    cells: Vec<[f64; 2]>,
    widest: f64,
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
    cells: Vec<Sight>,
}

/// What a camera sees of a cell.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Sight {
    Seen,
    /// Outside the frustum, or behind the eye.
    Outside,
    /// Of no volume.
    Flat,
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
        let [low, high] = mesh.local_bounds();
        let diagonal = if mesh.points().is_empty() { 0.0 } else { low.distance(high) };
        Planner {
            mesh,
            diagonal,
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
        let extent = self.diagonal / scene.unit_distance;
        let edge = extent / (self.mesh.cells().len().max(1) as f64).cbrt();
        Measures { extent, edge, widest: ranges.widest }
    }

    fn seen(&self, view: &View) -> Arc<Seen> {
        known_or(&self.seen, |known| known.view == *view, || Seen::new(self.mesh, view))
    }

    /// For each cell whether widgets may be seen there; `None` for other functions.
    fn touched(&self, scene: &Scene, first: &Arc<Ranges>, second: Option<&Arc<Ranges>>) -> Option<Vec<bool>> {
        let (Classification::Widgets(function), Some(second)) = (&scene.classification, second) else { return None };
        let of = [first, second];
        let holds = |known: &Boxed| known.of.iter().zip(of).all(|(known, now)| Arc::ptr_eq(known, now));
        let make = || Boxed { of: of.map(Arc::clone), boxes: CellBoxes::new(&first.cells, &second.cells) };
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
        let seen = self.seen(view);
        let dark = match &scene.classification {
            Classification::OneField(transfer) => Some([transfer.dark_intervals(0.0), transfer.dark_intervals(faint)]),
            _ => None,
        };
        let touched = self.touched(scene, first, second);
        let clear = |&v: &u32| colors.is_none_or(|colors| colors.get(v as usize).is_none_or(|color| color[3] <= 0.0));
        let [drop_transparent, drop_outside] = [Skip::Transparent, Skip::Outside].map(|skip| !kept.contains(skip));
        let transparent = |cell: usize| {
            let (s, g) = (first.cells[cell], second.map_or([0.0; 2], |second| second.cells[cell]));
            match &touched {
                _ if s[0].is_nan() || g[0].is_nan() => !scene.no_data.is_visible(),
                _ if colors.is_some() => self.mesh.cells()[cell].iter().all(clear),
                Some(touched) => !touched[cell],
                None => !scene.classification.is_visible_over(&Rectangle { s, g }),
            }
        };
        let dark = dark.as_ref().filter(|_| colors.is_none());
        // From the weakest reason to the strongest.
        let decide = |start: usize, verdicts: &mut Verdicts| {
            let cells = start..start + verdicts.0.len();
            let (s, seen) = (&first.cells[cells.clone()], &seen.cells[cells.clone()]);
            if let (Some([dark, faint]), true) = (dark, faint > 0.0) {
                verdicts.mark_within(s, faint, Verdict::Faint);
                verdicts.mark_within(s, dark, Verdict::Drawn);
            }
            verdicts.mark(Verdict::Flat, |i| seen[i] == Sight::Flat);
            if drop_outside {
                verdicts.mark(Verdict::Outside, |i| seen[i] == Sight::Outside);
            }
            match dark {
                _ if !drop_transparent => {}
                Some([dark, _]) => verdicts.mark_within(s, dark, Verdict::Transparent),
                None => verdicts.mark(Verdict::Transparent, |i| transparent(start + i)),
            }
            // Intervals hold no range that is not a number.
            if !scene.no_data.is_visible() {
                verdicts.mark(Verdict::NoData, |i| s[i][0].is_nan());
                if let Some(second) = second {
                    let g = &second.cells[cells];
                    verdicts.mark(Verdict::NoData, |i| g[i][0].is_nan());
                }
            }
        };
        let count = self.mesh.cells().len();
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

impl Ranges {
    fn new(mesh: &TetMesh, scalar: &ScalarField) -> Ranges {
        let cells = mesh.scalar_ranges(scalar);
        let widest = cells.par_iter().map(|[low, high]| high - low).reduce(|| 0.0, f64::max);
        Ranges { of: scalar.clone(), cells, widest }
    }
}

impl Seen {
    fn new(mesh: &TetMesh, view: &View) -> Seen {
        let offset = mesh.origin() - view.eye;
        let eye_space: Vec<DVec3> = mesh.points().par_iter().map(|p| view.rotate(p.as_dvec3() + offset)).collect();
        let frustum = view.frustum();
        let sight = |cell: &[u32; 4]| {
            let p = cell.map(|v| eye_space[v as usize]);
            if frustum.iter().any(|&(n, c)| p.iter().all(|&q| n.dot(q) + c < 0.0)) {
                Sight::Outside
            } else if is_flat(mesh, cell) {
                Sight::Flat
            } else {
                Sight::Seen
            }
        };
        Seen { view: *view, cells: mesh.cells().par_iter().map(sight).collect() }
    }
}

fn is_flat(mesh: &TetMesh, cell: &[u32; 4]) -> bool {
    let p = cell.map(|v| mesh.points()[v as usize].as_dvec3());
    (p[1] - p[0]).cross(p[2] - p[0]).dot(p[3] - p[0]) == 0.0
}
