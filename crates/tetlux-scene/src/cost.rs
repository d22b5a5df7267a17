//! What a picture costs by each way of drawing it, as a device was measured, and the cheapest of those that can be.

use glam::DVec3;
use serde::{Deserialize, Serialize};
use tetlux_mesh::TetMesh;

use crate::{CellProjection, Interpolation, Method, Order, Target, View};

/// What one way of drawing costs on an adapter, in nanoseconds of the clock.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Cost {
    /// A picture, whatever is in it.
    pub picture: f64,
    /// A cell.
    pub cell: f64,
    /// A cell on a pixel's ray.
    pub fragment: f64,
}

/// What the ways of drawing cost on an adapter that has been measured.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Costs {
    /// Of `pt`.
    pub pt: Cost,
    /// Of `tiles`.
    pub tiles: Cost,
    /// Of `march`.
    pub march: Cost,
}

/// How much there is to draw.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Work {
    /// Cells.
    pub cells: f64,
    /// Cells on the rays of all pixels, about.
    pub fragments: f64,
}

/// Cells that a mean ray crosses of a box of n cells: so many times the cube root of n (each cube split in six).
const CROSSED: f64 = 1.33;

/// Pictures of less work than this, in cells and fragments, are drawn before anything could be gained.
const SMALL: f64 = 4e6;

impl Work {
    /// All of a mesh in a view: of an upper bound of the pixels that see it. It is the same for every way of drawing.
    pub fn new(mesh: &TetMesh, view: &View) -> Work {
        let cells = mesh.cells().len() as f64;
        let [width, height] = view.size.map(f64::from);
        let [low, high] = mesh.bounds();
        let corner =
            |i: u32| DVec3::from_array([0, 1, 2].map(|axis| if i >> axis & 1 == 0 { low[axis] } else { high[axis] }));
        let corners: Vec<DVec3> = (0..8).map(|i| view.to_eye(corner(i))).collect();
        let pixel = |p: &DVec3, i: usize| {
            let scale = if view.orthographic { view.pixel } else { view.pixel * p.z };
            p[i] / scale + 0.5 * f64::from(view.size[i])
        };
        let span = |i: usize, most: f64| {
            // A corner behind the eye is seen anywhere.
            if !view.orthographic && corners.iter().any(|p| p.z <= view.near.max(0.0)) {
                return most;
            }
            let (mut first, mut last) = (f64::INFINITY, f64::NEG_INFINITY);
            for p in &corners {
                first = first.min(pixel(p, i));
                last = last.max(pixel(p, i));
            }
            (last.min(most) - first.max(0.0)).clamp(0.0, most)
        };
        Work { cells, fragments: span(0, width) * span(1, height) * CROSSED * cells.cbrt() }
    }

    /// Whether it is so little that no way of drawing is worth being looked for.
    pub fn is_small(&self) -> bool {
        self.cells + self.fragments < SMALL
    }
}

impl Cost {
    /// Of three pictures' work and nanoseconds: little of everything; more cells; more fragments of as many cells. What
    /// noise would make negative is nothing.
    pub fn measured(pictures: [(Work, f64); 3]) -> Cost {
        let [(few, least), (cells, more), (fragments, most)] = pictures;
        let rate = |rise: f64, by: f64| if by > 0.0 { (rise / by).max(0.0) } else { 0.0 };
        let fragment = rate(most - more, fragments.fragments - cells.fragments);
        let in_fragments = fragment * (cells.fragments - few.fragments);
        let cell = rate(more - least - in_fragments, cells.cells - few.cells);
        let picture = (least - cell * few.cells - fragment * few.fragments).max(0.0);
        Cost { picture, cell, fragment }
    }

    /// Nanoseconds of a picture.
    pub fn of(&self, work: &Work) -> f64 {
        self.picture + self.cell * work.cells + self.fragment * work.fragments
    }
}

impl Costs {
    /// The cheapest way of drawing, and why, among those that a method leaves open; `blends` tells whether the adapter blends
    /// single precision.
    pub(crate) fn choose(&self, method: &Method, work: &Work, blends: bool) -> Option<(CellProjection, String)> {
        let mut open = open(method);
        open.retain(|&way| blends || way != CellProjection::Pt);
        let cost = |projection| match projection {
            CellProjection::Tiles => self.tiles.of(work),
            CellProjection::March => self.march.of(work),
            _ => self.pt.of(work),
        };
        let chosen = *open.iter().min_by(|a, b| cost(**a).total_cmp(&cost(**b)))?;
        let told: Vec<_> = open.iter().map(|&p| format!("{p} {:.1} ms", 1e-6 * cost(p))).collect();
        let why = format!("of {} by what this adapter was measured to take", told.join(", "));
        Some((chosen, why))
    }
}

/// The ways of drawing that a method leaves open and that make the same picture; none where one is asked for.
fn open(method: &Method) -> Vec<CellProjection> {
    let free = method.projection == CellProjection::Auto
        && matches!(method.interpolation, Interpolation::Auto | Interpolation::Ray)
        && matches!(method.target, Target::Auto | Target::Rgba32f);
    if !free {
        return Vec::new();
    }
    // The march takes no order, and is right as the exact one is.
    let can = |way: CellProjection| match way {
        CellProjection::March => {
            matches!(method.order, Order::Auto | Order::Exact)
                && Method { projection: way, order: Order::Auto, ..*method }.refusal().is_none()
        }
        _ => Method { projection: way, ..*method }.refusal().is_none(),
    };
    let ways = [CellProjection::Pt, CellProjection::Tiles, CellProjection::March];
    ways.into_iter().filter(|&way| can(way)).collect()
}

impl Method {
    /// Whether it would follow what a device is measured to cost.
    pub fn follows_costs(&self) -> bool {
        !open(self).is_empty()
    }
}

#[cfg(test)]
mod tests {
    use tetlux_mesh::procedural::{self, Split};

    use super::*;
    use crate::{Backend, Camera, Integrator, Projection};

    fn work(cells: f64, fragments: f64) -> Work {
        Work { cells, fragments }
    }

    const PT: Cost = Cost { picture: 1e5, cell: 100.0, fragment: 1.0 };
    const TILES: Cost = Cost { picture: 1e6, cell: 20.0, fragment: 0.5 };
    const MARCH: Cost = Cost { picture: 1e5, cell: 1.0, fragment: 10.0 };
    const COSTS: Costs = Costs { pt: PT, tiles: TILES, march: MARCH };

    #[test]
    fn costs_are_found_from_three_pictures() {
        let pictures = [work(48.0, 3e4), work(1e4, 2e5), work(1e4, 3e6)];
        for cost in [PT, TILES, MARCH] {
            let found = Cost::measured(pictures.map(|work| (work, cost.of(&work))));
            let close = |a: f64, b: f64| (a - b).abs() <= 1e-9 * cost.of(&pictures[2]);
            assert!(close(found.picture, cost.picture), "{found:?}");
            assert!(close(found.cell, cost.cell) && close(found.fragment, cost.fragment), "{found:?}");
        }
        // Noise: more work in less time.
        let noise = Cost::measured([(pictures[0], 9.0), (pictures[1], 5.0), (pictures[2], 1.0)]);
        assert_eq!(noise, Cost { picture: 9.0, cell: 0.0, fragment: 0.0 });
    }

    #[test]
    fn the_cheapest_is_chosen_among_those_left_open() {
        let chosen = |method: Method, work| COSTS.choose(&method, &work, true).map(|(way, _)| way);
        let auto = Method::default();
        // Next to nothing; many cells and fragments; few cells, many fragments.
        assert_eq!(chosen(auto, work(10.0, 100.0)), Some(CellProjection::March));
        assert_eq!(chosen(auto, work(1e6, 1e7)), Some(CellProjection::Tiles));
        assert_eq!(chosen(auto, work(1e3, 1e6)), Some(CellProjection::Pt));
        let tables = Method { integrator: Integrator::Q, ..auto };
        assert_eq!(chosen(tables, work(10.0, 100.0)), Some(CellProjection::March), "it looks tables up too");
        let two = Method { integrator: Integrator::PreintQ, ..auto };
        assert_eq!(chosen(two, work(1e6, 1e7)), Some(CellProjection::March), "tiles look up one table");
        assert_eq!(chosen(Method { order: Order::Centroid, ..auto }, work(10.0, 100.0)), Some(CellProjection::Pt));
        for method in [
            Method { projection: CellProjection::Vicp, ..auto },
            Method { target: Target::Rgba16f, ..auto },
            Method { interpolation: Interpolation::ScreenLinear, ..auto },
        ] {
            assert!(!method.follows_costs() && chosen(method, work(1e6, 1e7)).is_none());
        }
        let (_, why) = COSTS.choose(&auto, &work(1e6, 1e7), true).unwrap();
        assert_eq!(why, "of pt 110.1 ms, tiles 26.0 ms, march 101.1 ms by what this adapter was measured to take");
        assert!(Method { backend: Backend::Gpu, ..auto }.follows_costs());
    }

    #[test]
    fn work_is_of_the_pixels_that_see_the_mesh() {
        let parts = procedural::cuboid([10, 10, 10], Split::Six, [DVec3::splat(-1.0), DVec3::ONE]);
        let mesh = TetMesh::assemble(&parts.points, &parts.cells, vec![]).unwrap();
        let camera = |scale| Camera {
            position: DVec3::new(0.0, -9.0, 0.0),
            focal_point: DVec3::ZERO,
            view_up: DVec3::Z,
            projection: Projection::Orthographic { parallel_scale: scale },
            near: 0.0,
        };
        // The cube fills the picture's height, half of it, more than all of it.
        let crossed = 1.33 * 6000f64.cbrt();
        for (scale, pixels) in [(1.0, 100.0 * 100.0), (2.0, 50.0 * 50.0), (0.5, 200.0 * 100.0)] {
            let work = Work::new(&mesh, &camera(scale).view([200, 100]).unwrap());
            assert_eq!(work.cells, 6000.0);
            assert!((work.fragments / (pixels * crossed) - 1.0).abs() < 1e-6, "{scale}: {work:?}");
        }
        assert!(work(1e5, 1e6).is_small() && !work(1e6, 1e7).is_small());
    }
}
