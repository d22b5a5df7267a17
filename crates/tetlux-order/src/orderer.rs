//! From a mesh and a view to an order.

use glam::Vec3;
use tetlux_mesh::TetMesh;

use crate::clock::timed;
use crate::coverage::Rays;
use crate::exact::Viewpoint;
use crate::gaps::Gaps;
use crate::search::{GAPS, Graph, Search};
use crate::signs::{cell_arrows, face_codes, is_entry};
use crate::{Eye, Facts, Method, Order, Sampling, centroid};

/// Finds orders; keeps its memory, and the last order, from view to view.
#[derive(Debug, Default)]
pub struct Orderer {
    /// Facts, view and method of the last order.
    last: Option<(u64, Sampling, Method)>,
    order: Order,
    thorough: Thorough,
    /// Of every face, on which side of it the eye is.
    codes: Vec<u8>,
    /// Of every cell, its arrows and what the search did.
    states: Vec<u8>,
    gaps: Gaps,
    search: Search,
    /// Where searches begin: distances and cells, and the cells alone.
    far: Vec<u64>,
    seeds: Vec<u32>,
}

/// What is searched for though it is known that nothing will be found: to measure what not searching saves.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Thorough {
    /// Search again though nothing has changed.
    pub again: bool,
    /// Search convex meshes for gaps.
    pub gaps: bool,
    /// Search for cycles before any is met.
    pub components: bool,
}

impl Orderer {
    /// One that has found none yet.
    pub fn new() -> Orderer {
        Orderer::default()
    }

    /// Does from now on more than it must.
    pub fn set_thorough(&mut self, thorough: Thorough) {
        if self.thorough != thorough {
            (self.thorough, self.last) = (thorough, None);
        }
    }

    /// The order of a mesh's cells, front to back: the last one if nothing has changed since.
    ///
    /// `facts` must be those of `mesh`; those of another one give an order by index.
    pub fn order(&mut self, mesh: &TetMesh, facts: &Facts, sampling: &Sampling, method: Method) -> &Order {
        let asked = Some((facts.id, *sampling, method));
        if self.last == asked && !self.thorough.again {
            self.order.report.reused = true;
            self.order.report.reason = "nothing has changed since the last order";
            self.order.report.stages.clear();
            return &self.order;
        }
        self.last = asked;
        let (method, reason) = choose(mesh, facts, method);
        let report = &mut self.order.report;
        let mut stages = std::mem::take(&mut report.stages);
        stages.clear();
        *report = crate::OrderReport { method, reason, folded_faces: facts.folded_faces(), ..Default::default() };
        report.stages = stages;
        self.order.groups.clear();
        self.order.cells.clear();
        self.order.cells.extend(0..mesh.cells().len() as u32);
        match method {
            Method::None => {}
            Method::Centroid => {
                let cells = timed(&mut report.stages, "sort", || centroid(mesh, sampling.eye(), &self.order.cells));
                self.order.cells = cells;
            }
            Method::Power => self.by_power(mesh, facts, sampling),
            Method::Mpvo | Method::Mpvonc | Method::Exact | Method::Auto => {
                self.by_arrows(mesh, facts, sampling, method);
            }
        }
        let report = &mut self.order.report;
        report.cells_in_groups = self.order.groups.iter().map(|group| group.len()).sum();
        &self.order
    }

    fn by_power(&mut self, mesh: &TetMesh, facts: &Facts, sampling: &Sampling) {
        let spheres = facts.spheres(mesh);
        if spheres.shared {
            self.by_arrows(mesh, facts, sampling, Method::Mpvo);
            // The sort tears groups apart.
            self.order.groups.clear();
        }
        let eye = viewpoint(mesh, sampling);
        let Order { cells, report, .. } = &mut self.order;
        timed(&mut report.stages, "sort", || spheres.sort(&eye, cells));
    }

    fn by_arrows(&mut self, mesh: &TetMesh, facts: &Facts, sampling: &Sampling, method: Method) {
        let Orderer { order, thorough, codes, states, gaps, search, far, seeds, .. } = self;
        let Order { cells, groups, report } = order;
        let stages = &mut report.stages;
        let eye = viewpoint(mesh, sampling);
        let doubts = timed(stages, "signs", || face_codes(mesh, facts, &eye, codes));
        let inside = timed(stages, "arrows", || cell_arrows(facts, codes, states));
        (report.signs_in_double, report.signs_exact) = (doubts.in_double, doubts.exact);

        gaps.arrows.clear();
        if method == Method::Exact && (thorough.gaps || !facts.convex()) {
            report.gap_pass = true;
            let rays = Rays::new(sampling, mesh.origin());
            timed(stages, "gaps", || gaps.find(mesh, facts, codes, &rays, inside));
            report.gap_arrows = gaps.arrows.len();
            (report.overlap_pixels, report.overlap_cells) = (gaps.overlap_pixels, gaps.overlap_cells);
        }
        #[cfg(feature = "planted")]
        crate::planted::apply(states, &mut gaps.arrows);
        seeds.clear();
        if method == Method::Mpvonc || !gaps.arrows.is_empty() {
            timed(stages, "seeds", || farthest_entries(mesh, facts, codes, &eye, far, seeds));
        }
        let graph = Graph { neighbors: mesh.neighbors(), steps: facts.steps(mesh), gaps: &gaps.arrows };
        mark_gaps(&gaps.arrows, states);
        let sorted = !thorough.components && timed(stages, "search", || search.sort(graph, states, seeds, cells));
        if !sorted {
            report.component_search = true;
            timed(stages, "groups", || {
                cell_arrows(facts, codes, states);
                mark_gaps(&gaps.arrows, states);
                search.sort_components(graph, states, seeds, cells, groups);
                // Groups are sorted for every pixel: until then, the best guess.
                for group in groups.iter() {
                    let members = &mut cells[group.start as usize..group.end as usize];
                    members.sort_unstable();
                    let sorted = centroid(mesh, sampling.eye(), members);
                    members.copy_from_slice(&sorted);
                }
            });
        }
    }
}

/// What `auto` stands for, and why.
fn choose(mesh: &TetMesh, facts: &Facts, method: Method) -> (Method, &'static str) {
    if mesh.cells().len() != facts.cells() || mesh.points().len() != facts.points {
        return (Method::None, "the facts are those of another mesh");
    }
    match method {
        Method::Auto if facts.convex() => (Method::Mpvo, "the mesh is convex"),
        Method::Auto => (Method::Exact, "the mesh is not convex"),
        Method::Exact if facts.convex() => (Method::Exact, "asked for by name; the mesh is convex, without gaps"),
        named => (named, "asked for by name"),
    }
}

fn viewpoint(mesh: &TetMesh, sampling: &Sampling) -> Viewpoint {
    match sampling.eye() {
        Eye::Point(eye) => Viewpoint::new(eye - mesh.origin(), true),
        Eye::Direction(direction) => Viewpoint::new(-direction, false),
    }
}

fn mark_gaps(arrows: &[u64], states: &mut [u8]) {
    for arrow in arrows {
        states[(arrow >> 32) as usize] |= GAPS;
    }
}

/// The cells that the eye sees through faces of the boundary, farthest first.
fn farthest_entries(
    mesh: &TetMesh,
    facts: &Facts,
    codes: &[u8],
    eye: &Viewpoint,
    far: &mut Vec<u64>,
    seeds: &mut Vec<u32>,
) {
    far.clear();
    for face in (facts.interior..facts.owners.len()).filter(|&face| is_entry(codes[face])) {
        let (cell, vertices) = facts.vertices(mesh, face);
        let sum: Vec3 = vertices.iter().map(|&v| mesh.points()[v as usize]).sum();
        let to_eye = eye.at - sum.as_dvec3() / 3.0;
        let depth = if eye.finite { to_eye.length_squared() } else { -eye.at.dot(sum.as_dvec3()) };
        far.push(u64::from(!ascending(depth as f32)) << 32 | u64::from(cell));
    }
    far.sort_unstable();
    seeds.extend(far.iter().map(|&key| key as u32));
}

/// Bits that compare as the numbers do.
fn ascending(x: f32) -> u32 {
    let bits = x.to_bits();
    if bits >> 31 == 0 { bits | 1 << 31 } else { !bits }
}

#[cfg(test)]
mod tests;
