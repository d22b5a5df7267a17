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

/// The planes of the faces and the gradient of the scalar.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Cell {
    pub(crate) planes: [Vec4; 4],
    pub(crate) gradient: Vec3,
    pub(crate) kind: Kind,
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

    fn face_plane(&self, [a, b, c]: [&Vertex; 3], inward: f32, depth: f32, origin: &Vertex) -> Vec4 {
        let normal = face_normal(a.position, b.position, c.position);
        let n = self.rotated(normal);
        let ([side, terms], scale, rise) = if self.orthographic {
            let scale = n.x.abs() + n.y.abs();
            ([n.z, scale], scale, self.view.pixel)
        } else {
            let reach = a.eye.abs().max(b.eye.abs()).max(c.eye.abs()).max_element();
            (self.side_of_eye([a, b, c], normal, n), n.abs().element_sum() * reach, depth * self.view.pixel)
        };
        let edge_on = side.abs() <= EDGE_ON * terms;
        let divisor = (if edge_on { 1e-12 * scale } else { side.abs() }).max(1e-30);
        let toward = if side >= 0.0 { 1.0 } else { -1.0 };
        let limit = |x: f32| x.clamp(-STEEPEST, STEEPEST);
        let slope = (n.truncate() * (rise * toward / divisor)).map(limit);
        let aside = (if edge_on { NUDGE } else { Vec2::ZERO }) - origin.rest;
        let offset = normal.dot(origin.position - a.position) * toward / divisor + slope.dot(aside);
        Vec4::new(slope.x, slope.y, limit(offset), toward * inward)
    }

    pub(crate) fn project_cell(&self, v: &[Vertex; 4], s: [f32; 4], parity: f32) -> Cell {
        let z = v.map(|vertex| vertex.eye.z);
        let kind = self.cell_kind(z);
        if kind == Kind::Hidden {
            return Cell { planes: [Vec4::ZERO; 4], gradient: Vec3::ZERO, kind };
        }
        let reference = if kind == Kind::Deep { &v[farthest_vertex(z)] } else { &v[0] };
        let depth = reference.eye.z;
        let mut planes = [
            self.face_plane([&v[1], &v[2], &v[3]], -parity, depth, if kind == Kind::Deep { reference } else { &v[1] }),
            self.face_plane([&v[0], &v[2], &v[3]], parity, depth, reference),
            self.face_plane([&v[0], &v[1], &v[3]], -parity, depth, reference),
            self.face_plane([&v[0], &v[1], &v[2]], parity, depth, reference),
        ];
        if kind == Kind::Plain {
            let step = self.deeper(&v[1], &v[0]);
            planes[0].z += if self.orthographic { step } else { step / v[1].eye.z };
        }
        let e: [Vec3; 3] = std::array::from_fn(|i| v[i + 1].position - v[0].position);
        let volume = e[0].dot(e[1].cross(e[2]));
        let inverse = (if volume >= 0.0 { 1.0 } else { -1.0 }) / volume.abs().max(1e-30);
        let sum =
            (s[1] - s[0]) * e[1].cross(e[2]) + (s[2] - s[0]) * e[2].cross(e[0]) + (s[3] - s[0]) * e[0].cross(e[1]);
        let gradient = self.rotated(sum * inverse).clamp(Vec3::splat(-STEEPEST), Vec3::splat(STEEPEST));
        Cell { planes, gradient, kind }
    }

    pub(crate) fn cell_reference(&self, v: &[Vertex; 4], s: [f32; 4], kind: Kind) -> Reference {
        let far = farthest_vertex(v.map(|vertex| vertex.eye.z));
        let (index, other) = if kind == Kind::Deep { (far, far) } else { (0, 1) };
        let r = &v[index];
        let (farthest, nearest) = bounds(v.map(|vertex| self.deeper(&vertex, r)));
        let w = [farthest, nearest.min(r.eye.z - self.view.near)]
            .map(|z| if self.orthographic { z } else { z / (r.eye.z - z).max(self.view.near) });
        let (low, high) = bounds(s);
        Reference {
            origins: [v[index].pixel, v[other].pixel],
            rest: r.rest,
            depth: r.eye.z,
            level: r.frame.z,
            scalar: s[index],
            w,
            s: [low, high],
        }
    }

    /// The segment of the ray through `at`, in pixels from the picture's middle; `None` where it misses the cell.
    #[inline]
    pub(crate) fn cell_segment(&self, cell: &Cell, reference: &Reference, at: Vec2) -> Option<Segment> {
        let from = reference.origins.map(|origin| at - origin);
        let [mut back, mut front] = reference.w;
        for (i, plane) in cell.planes.iter().enumerate() {
            let from = from[usize::from(i == 0)];
            let w = plane.x * from.x + plane.y * from.y + plane.z;
            if plane.w > 0.0 {
                front = front.min(w);
            } else {
                back = back.max(w);
            }
        }
        // Also where either is NaN.
        if front.partial_cmp(&back) != Some(std::cmp::Ordering::Greater) {
            return None;
        }
        let across = from[0] * self.view.pixel;
        let gradient = cell.gradient;
        let rounded_by = gradient.truncate().dot(reference.rest) * self.view.pixel;
        let rounded_by = rounded_by * if self.orthographic { 1.0 } else { reference.depth };
        let scalar = reference.scalar - rounded_by;
        let in_plane = gradient.truncate().dot(across);
        let (length, s, depth) = if self.orthographic {
            let s = [front, back].map(|w| scalar + in_plane - w * gradient.z);
            (front - back, s, reference.level - 0.5 * (front + back))
        } else {
            let direction = (at * self.view.pixel).extend(1.0);
            let along = gradient.dot(direction);
            let s = [front, back].map(|w| scalar + reference.depth * (in_plane - w / (1.0 + w) * along));
            let closer = front / (1.0 + front) + back / (1.0 + back);
            let length = direction.length() * reference.depth * (front - back) / ((1.0 + front) * (1.0 + back));
            (length, s, reference.level - 0.5 * reference.depth * closer)
        };
        let [s_front, s_back] = s.map(|s| s.clamp(reference.s[0], reference.s[1]));
        Some(Segment { s_front, s_back, length, depth })
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

fn face_normal(a: Vec3, b: Vec3, c: Vec3) -> Vec3 {
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

fn farthest_vertex(z: [f32; 4]) -> usize {
    let mut far = 0;
    for i in 1..4 {
        if z[i] > z[far] {
            far = i;
        }
    }
    far
}

fn bounds(x: [f32; 4]) -> (f32, f32) {
    (x[0].min(x[1]).min(x[2].min(x[3])), x[0].max(x[1]).max(x[2].max(x[3])))
}
