//! A tetrahedron as a ray sees it: the twin of shaders/lib/cell.wgsl, function by function.
//!
//! The shaders explain the method. What differs here: the orthographic switch is an argument, and a segment also says
//! how deep it lies, for sorting.

use glam::{Vec2, Vec3, Vec4};

use crate::device_view::DeviceView;
use crate::lens::{Lens, NUDGE};
use crate::seen::{Seen, UNIT};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    Hidden,
    Plain,
    Deep,
}

/// A vertex in eye space and in pixels.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Vertex {
    position: Vec3,
    frame: Vec3,
    eye: Vec3,
    pixel: Vec2,
    rest: Vec2,
}

/// The planes of the faces and the rise of the scalar.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Cell {
    pub(crate) planes: [Vec4; 4],
    pub(crate) rise: Vec3,
    pub(crate) kind: Kind,
}

#[derive(Clone, Copy, Debug)]
struct Side {
    normal: Vec3,
    turned: Vec3,
    toward: f32,
    reach: f32,
    is_edge_on: bool,
}

/// A cell as its planes and fields need it.
#[derive(Clone, Copy, Debug)]
struct Leaning {
    planes: [Vec4; 4],
    rises: [Vec3; 4],
}

#[derive(Clone, Copy, Debug)]
pub(crate) struct Reference {
    origins: [Vec2; 2],
    rest: Vec2,
    depth: f32,
    /// Depth of the reference vertex from the pivot, which keeps its digits however far away the eye is.
    level: f32,
    scalar: f32,
    w: [f32; 2],
    pub(crate) s: [f32; 2],
}

#[derive(Clone, Copy, Debug)]
pub(crate) struct Segment {
    pub(crate) s_front: f32,
    pub(crate) s_back: f32,
    pub(crate) length: f32,
    /// Depth of the middle from the pivot, in device units.
    pub(crate) depth: f32,
}

const DEEP_RATIO: f32 = 4.0;
const STEEPEST: f32 = 1e20;
const EDGE_ON: f32 = 1e-6;
const ALONG: f32 = 0.25;

impl Lens {
    pub(crate) fn vertex(&self, position: Vec3, seen: &Seen) -> Vertex {
        let frame = self.frame_of(position);
        let eye = self.eye_of(frame).with_z(seen.depth);
        Vertex { position, frame, eye, pixel: Vec2::from(seen.pixel), rest: rest_of(seen) }
    }

    fn deeper(&self, a: &Vertex, b: &Vertex) -> f32 {
        DeviceView::axis(self.view.forward).dot(b.position - a.position)
    }

    fn cell_kind(&self, z: [f32; 4]) -> Kind {
        let (nearest, farthest) = bounds(z);
        if farthest <= self.view.near {
            Kind::Hidden
        } else if !self.orthographic && (nearest < self.view.near || farthest > DEEP_RATIO * nearest) {
            Kind::Deep
        } else {
            Kind::Plain
        }
    }

    fn side_of_eye(&self, face: [&Vertex; 3], normal: Vec3, turned: Vec3) -> [f32; 2] {
        let from = face.map(|vertex| normal * self.beside_pivot(vertex.position));
        let sums = from.map(|terms| terms.abs().element_sum());
        let mut least = from[0];
        if sums[1] < sums[0] {
            least = from[1];
        }
        if sums[2] < sums[0].min(sums[1]) {
            least = from[2];
        }
        let aside = turned * self.pivot();
        let sum = sums[0].min(sums[1].min(sums[2]));
        [least.element_sum() + aside.element_sum(), sum + aside.abs().element_sum()]
    }

    fn side_of(&self, [a, b, c]: [&Vertex; 3]) -> Side {
        let normal = face_normal(a.position, b.position, c.position);
        let n = self.rotated(normal);
        let ([side, terms], scale) = if self.orthographic {
            let scale = n.x.abs() + n.y.abs();
            ([n.z, scale], scale)
        } else {
            let reach = a.eye.abs().max(b.eye.abs()).max(c.eye.abs()).max_element();
            (self.side_of_eye([a, b, c], normal, n), n.abs().element_sum() * reach)
        };
        let is_edge_on = side.abs() <= EDGE_ON * terms;
        let reach = (if is_edge_on { 1e-12 * scale } else { side.abs() }).max(1e-30);
        Side { normal, turned: n, toward: if side >= 0.0 { 1.0 } else { -1.0 }, reach, is_edge_on }
    }

    fn face_plane(side: &Side, a: &Vertex, origin: &Vertex, rise: f32) -> Vec3 {
        let slope = limited((side.turned.truncate() * (rise * side.toward / side.reach)).extend(0.0)).truncate();
        let aside = (if side.is_edge_on { NUDGE } else { Vec2::ZERO }) - origin.rest;
        let offset = side.normal.dot(origin.position - a.position) * side.toward / side.reach + slope.dot(aside);
        slope.extend(offset.clamp(-STEEPEST, STEEPEST))
    }

    fn beside_edge(&self, a: &Vertex, b: &Vertex, kind: Kind) -> Vec2 {
        if kind == Kind::Deep {
            let edge = self.rotated(b.position - a.position);
            return Vec2::new(a.eye.y * edge.z - a.eye.z * edge.y, a.eye.z * edge.x - a.eye.x * edge.z);
        }
        pixels_between(a, b).perp()
    }

    fn leaning(&self, v: &[Vertex; 4], kind: Kind, parity: f32) -> Leaning {
        let sides = [[1, 2, 3], [0, 2, 3], [0, 1, 3], [0, 1, 2]].map(|face| self.side_of(face.map(|i: usize| &v[i])));
        let reference = reference_index(v, kind);
        let a = &v[reference];
        let rise = self.view.pixel * if self.orthographic { 1.0 } else { a.eye.z };
        let (origin, step) = if kind == Kind::Deep {
            (a, 0.0)
        } else {
            let step = self.deeper(&v[1], &v[0]);
            (&v[1], if self.orthographic { step } else { step / v[1].eye.z })
        };
        let mut planes: [Vec3; 4] = std::array::from_fn(|i| match i {
            0 => Lens::face_plane(&sides[0], &v[1], origin, rise),
            _ => Lens::face_plane(&sides[i], &v[0], a, rise),
        });
        planes[0].z += step;
        let mut lean = usize::from(reference == 0);
        for i in lean + 1..4 {
            if i != reference && sides[i].reach > sides[lean].reach {
                lean = i;
            }
        }
        let others: Vec<usize> = (0..4).filter(|&i| i != reference && i != lean).collect();
        let (second, third) = (others[0], others[1]);
        let [b, c] = [&v[second], &v[third]];
        let side = &sides[lean];
        let way = shortest_way([a, b, c].map(|vertex| vertex.position), v[lean].position);
        let volume = side.normal.dot(way).abs();
        let mut found = Leaning { planes: [Vec4::ZERO; 4], rises: [Vec3::ZERO; 4] };
        let (mut heights, mut along) = ([0.0; 4], [false; 4]);
        for i in 0..4 {
            let inward = if i % 2 == 0 { -parity } else { parity };
            let front = sides[i].toward * inward;
            found.planes[i] = planes[i].extend(front);
            heights[i] = (volume / sides[i].reach).min(STEEPEST);
            if i != reference {
                let rate = sides[i].turned.truncate() * (rise * inward / volume.max(1e-30));
                found.rises[i] = limited(rate.extend(front / heights[i].max(1.0 / STEEPEST)));
            }
            let [slope, apart] = [planes[lean], planes[i] - planes[lean]].map(|x| x.truncate().abs());
            along[i] = apart.max_element() < ALONG * slope.max_element() && !sides[i].is_edge_on;
        }
        if (0..4).all(|i| i == lean || !along[i]) || side.is_edge_on {
            return found;
        }
        let mut rates = [[b, c], [c, a], [a, b]].map(|[a, b]| self.beside_edge(a, b, kind));
        if kind == Kind::Deep {
            let is_between = second < reference && reference < third;
            let scale = rise * side.toward / if is_between { -side.reach } else { side.reach };
            rates = rates.map(|rate| rate * scale);
        } else {
            let area = rates[1].perp_dot(rates[2]);
            let scale = 1.0 / if area >= 0.0 { area.max(1e-30) } else { area.min(-1e-30) };
            rates = rates.map(|rate| rate * scale);
            if !self.orthographic {
                rates[1] *= a.eye.z / b.eye.z;
                rates[2] *= a.eye.z / c.eye.z;
            }
        }
        for i in 0..4 {
            let front = found.planes[i].w;
            let mut rate = Vec3::ZERO;
            if i == second {
                rate = rates[1].extend(-rates[1].dot(a.rest));
            } else if i == third {
                rate = rates[2].extend(-rates[2].dot(a.rest));
            }
            if i == lean {
                found.planes[i].w = 2.0 * front;
            } else if along[i] {
                if i == reference {
                    let here = if kind == Kind::Deep { 1.0 } else { rates[0].dot(pixels_between(b, origin)) };
                    rate = rates[0].extend(here - rates[0].dot(origin.rest));
                }
                found.planes[i] = limited(rate * (heights[i] * front)).extend(3.0 * front);
            }
            if i != reference {
                found.rises[i] = limited(rate.truncate().extend(found.rises[i].z));
            }
        }
        found
    }

    pub(crate) fn project_cell(&self, v: &[Vertex; 4], s: [f32; 4], parity: f32) -> Cell {
        let kind = self.cell_kind(v.map(|vertex| vertex.eye.z));
        if kind == Kind::Hidden {
            return Cell { planes: [Vec4::ZERO; 4], rise: Vec3::ZERO, kind };
        }
        let found = self.leaning(v, kind, parity);
        let own = s[reference_index(v, kind)];
        let [a, b, c, d] = std::array::from_fn(|i| found.rises[i] * (s[i] - own));
        Cell { planes: found.planes, rise: limited(a + b + c + d), kind }
    }

    pub(crate) fn cell_reference(&self, v: &[Vertex; 4], s: [f32; 4], kind: Kind) -> Reference {
        let index = reference_index(v, kind);
        let r = &v[index];
        let (farthest, nearest) = bounds(v.map(|vertex| self.deeper(&vertex, r)));
        let w = [farthest, nearest.min(r.eye.z - self.view.near)]
            .map(|z| if self.orthographic { z } else { z / (r.eye.z - z).max(self.view.near) });
        let (low, high) = bounds(s);
        let origins = [r.pixel, if kind == Kind::Deep { r.pixel } else { v[1].pixel }];
        let (rest, depth, level, scalar) = (r.rest, r.eye.z, r.frame.z, s[index]);
        Reference { origins, rest, depth, level, scalar, w, s: [low, high] }
    }

    /// The segment of the ray through `at`, in pixels from the picture's middle; `None` where it misses the cell.
    #[inline]
    pub(crate) fn cell_segment(&self, cell: &Cell, reference: &Reference, at: Vec2) -> Option<Segment> {
        let from = reference.origins.map(|origin| at - origin);
        let w: [f32; 4] = std::array::from_fn(|i| {
            let plane = cell.planes[i];
            Vec2::new(plane.x, plane.y).dot(from[usize::from(i == 0)]) + plane.z
        });
        let marks = cell.planes.map(|plane| plane.w.abs());
        let lean = (0..4).find(|&i| marks[i] == 2.0).map_or(0.0, |i| w[i]);
        let (mut front, mut back) = (reference.w[1] - lean, reference.w[0] - lean);
        for (i, plane) in cell.planes.iter().enumerate() {
            let beyond = w[i] - if marks[i] > 2.0 { 0.0 } else { lean };
            if plane.w > 0.0 {
                front = front.min(beyond);
            } else {
                back = back.max(beyond);
            }
        }
        // Also where either is NaN.
        if front.partial_cmp(&back) != Some(std::cmp::Ordering::Greater) {
            return None;
        }
        let [near, far] = [front, back].map(|beyond| lean + beyond);
        let (length, shares, closer) = if self.orthographic {
            (front - back, [1.0; 2], near + far)
        } else {
            let shares = [near, far].map(|w| 1.0 / (1.0 + w));
            let stretch = (at * self.view.pixel).extend(1.0).length() * reference.depth;
            (
                (front - back) * (stretch * shares[0] * shares[1]),
                shares,
                reference.depth * (near * shares[0] + far * shares[1]),
            )
        };
        let aside = cell.rise.truncate().dot(from[0]);
        let scalar = reference.scalar - cell.rise.truncate().dot(reference.rest);
        let s = |beyond: f32, share: f32| {
            (scalar + (aside - cell.rise.z * beyond) * share).clamp(reference.s[0], reference.s[1])
        };
        let (s_front, s_back) = (s(front, shares[0]), s(back, shares[1]));
        Some(Segment { s_front, s_back, length, depth: reference.level - 0.5 * closer })
    }

    /// Pixel bounds of what is seen of a cell, from the picture's middle.
    pub(crate) fn pixel_bounds(&self, v: &[Vertex; 4], kind: Kind) -> [Vec2; 2] {
        let mut bounds = [Vec2::splat(1e30), Vec2::splat(-1e30)];
        let mut reach = |p: Vec2| bounds = [bounds[0].min(p), bounds[1].max(p)];
        if kind != Kind::Deep {
            v.iter().for_each(|vertex| reach(vertex.pixel));
            return bounds;
        }
        let near = self.view.near;
        for i in 0..4 {
            if v[i].eye.z >= near {
                reach(v[i].pixel);
            }
            for j in 0..i {
                let (a, b) = (v[i].eye, v[j].eye);
                if (a.z < near) != (b.z < near) {
                    let t = ((near - a.z) / (b.z - a.z)).clamp(0.0, 1.0);
                    reach(self.pixel_of((a.truncate() + (b - a).truncate() * t).extend(near)));
                }
            }
        }
        bounds
    }
}

fn rest_of(seen: &Seen) -> Vec2 {
    let share = Vec2::from(seen.rest.map(|rest| (f32::from(rest) / 32767.0).max(-1.0)));
    share * (Vec2::from(seen.pixel).abs() * UNIT as f32)
}

/// From the corners of a triangle to a point the shortest way: of a thin cell that is across it.
pub(crate) fn shortest_way(corners: [Vec3; 3], point: Vec3) -> Vec3 {
    let ways = corners.map(|corner| point - corner);
    let lengths = ways.map(|way| way.dot(way));
    let mut way = ways[0];
    if lengths[1] < lengths[0] {
        way = ways[1];
    }
    if lengths[2] < lengths[0].min(lengths[1]) {
        way = ways[2];
    }
    way
}

pub(crate) fn face_normal(a: Vec3, b: Vec3, c: Vec3) -> Vec3 {
    let (ab, ac, bc) = (b - a, c - a, c - b);
    let squares = [ab, ac, bc].map(|edge| edge.dot(edge));
    if squares[0] > squares[1].max(squares[2]) {
        ac.cross(bc)
    } else if squares[1] > squares[2] {
        ab.cross(bc)
    } else {
        ab.cross(ac)
    }
}

fn pixels_between(a: &Vertex, b: &Vertex) -> Vec2 {
    (b.pixel - a.pixel) + (b.rest - a.rest)
}

fn reference_index(v: &[Vertex; 4], kind: Kind) -> usize {
    let mut index = 0;
    if kind == Kind::Deep {
        for i in 1..4 {
            if v[i].eye.z > v[index].eye.z {
                index = i;
            }
        }
    }
    index
}

fn limited(x: Vec3) -> Vec3 {
    x.clamp(Vec3::splat(-STEEPEST), Vec3::splat(STEEPEST))
}

fn bounds(x: [f32; 4]) -> (f32, f32) {
    (x[0].min(x[1]).min(x[2].min(x[3])), x[0].max(x[1]).max(x[2].max(x[3])))
}
