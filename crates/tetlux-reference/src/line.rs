//! A line in space and the side on which it passes an edge, without ties.

use glam::DVec3;
use robust::{Coord3D, orient3d};

use crate::double;
use crate::walk::Values;

/// Mutually orthogonal directions, none along a grid's axis or diagonal: the auxiliary directions are two of them.
const FRAME: [DVec3; 3] =
    [DVec3::new(0.25, 0.375, 0.75), DVec3::new(0.375, -0.75, 0.25), DVec3::new(0.75, 0.25, -0.375)];

/// A determinant above this share of its factors' lengths is taken as computed: its sign is right and its relative
/// error below 1e-9. Below, the sign comes from exact arithmetic and the value from twice the digits.
const CLEAR: f64 = 1.0 / (1u64 << 20) as f64;

/// A mesh vertex as a line sees it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Vertex {
    pub(crate) index: u32,
    pub(crate) position: DVec3,
    /// Parameter of the vertex's foot on the line.
    pub(crate) t: f64,
    pub(crate) values: Values,
}

/// How a line passes a directed edge.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Side {
    /// Volume of the parallelepiped of direction and edge: 0 where they meet.
    pub(crate) value: f64,
    /// Its sign, never tied.
    pub(crate) positive: bool,
}

/// The line through two points.
///
/// A tie is broken by simulation of simplicity (Edelsbrunner and Muecke 1990), applied to the line instead of the
/// mesh: its direction d becomes d + e f_1 + e^2 f_2 and then its origin o becomes o + h f_1 + h^2 f_2, for
/// infinitesimal e and h, h far below any power of e, and fixed f_1, f_2 independent of d. All edges see one and the
/// same line in general position, hence every tetrahedron is entered and left through exactly one face or missed.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Line {
    origin: DVec3,
    /// The origin moved by the direction and by f_1 and f_2.
    through: [DVec3; 3],
    direction: DVec3,
    per_length_squared: f64,
    clear_squared: f64,
}

impl Line {
    /// The line through `origin` and `origin + direction` (as rounded); both of about unit size, no component below
    /// 1e-30 but 0: then neither products underflow nor does rounding make the auxiliary directions dependent.
    pub(crate) fn new(origin: DVec3, direction: DVec3) -> Self {
        let along = FRAME.map(|f| f.dot(direction).abs());
        let dropped = (0..3).fold(0, |best, k| if along[k] > along[best] { k } else { best });
        let [first, second] = [FRAME[(dropped + 1) % 3], FRAME[(dropped + 2) % 3]];
        let through = [direction, first, second].map(|d| origin + d);
        let direction = through[0] - origin;
        Self {
            origin,
            through,
            direction,
            per_length_squared: 1.0 / direction.length_squared(),
            clear_squared: CLEAR * CLEAR * direction.length_squared(),
        }
    }

    pub(crate) fn origin(&self) -> DVec3 {
        self.origin
    }

    pub(crate) fn direction(&self) -> DVec3 {
        self.direction
    }

    /// Parameter of a point's foot on the line, in units of the direction.
    pub(crate) fn parameter(&self, point: DVec3) -> f64 {
        (point - self.origin).dot(self.direction) * self.per_length_squared
    }

    /// The side on which the line passes the edge from `a` to `b`; changes sign with the edge's direction.
    pub(crate) fn side(&self, a: &Vertex, b: &Vertex) -> Side {
        if a.index < b.index {
            self.ordered_side(a.position, b.position)
        } else {
            let Side { value, positive } = self.ordered_side(b.position, a.position);
            Side { value: -value, positive: !positive }
        }
    }

    fn ordered_side(&self, a: DVec3, b: DVec3) -> Side {
        let (edge, arm) = (a - b, self.origin - b);
        let value = self.direction.dot(edge.cross(arm));
        if value * value > self.clear_squared * edge.length_squared() * arm.length_squared() {
            return Side { value, positive: value > 0.0 };
        }
        let positive = self.exact_sign(a, b);
        let value = double::determinant(self.origin, self.through[0], a, b);
        Side { value: if (value > 0.0) == positive { value } else { 0.0 }, positive }
    }

    /// Whether det(d, a - b, o - b) is positive for the perturbed line.
    fn exact_sign(&self, a: DVec3, b: DVec3) -> bool {
        let orientation = |p: DVec3, q: DVec3, r: DVec3, s: DVec3| {
            let coord = |v: DVec3| Coord3D { x: v.x, y: v.y, z: v.z };
            orient3d(coord(p), coord(q), coord(r), coord(s))
        };
        let o = self.origin;
        // Powers 0, 1 and 2 of e.
        for q in self.through {
            let sign = orientation(o, q, a, b);
            if sign != 0.0 {
                return sign > 0.0;
            }
        }
        // Directions that span space all gave 0: the edge's line passes through o. Then a - b = c (w - o) for an end w
        // other than o, and moving o by f gives det(f, d, a - b) = c det(f, d, w - o). The orders are h, h e^2, h^2.
        let w = if a != o { a } else { b };
        let Some(axis) = (0..3).find(|&k| a[k] != b[k]) else { return true };
        let same_way = (a[axis] > b[axis]) == (w[axis] > o[axis]);
        for [f, d] in [[1, 0], [1, 2], [2, 0]] {
            let sign = orientation(self.through[f], self.through[d], w, o);
            if sign != 0.0 {
                return (sign > 0.0) == same_way;
            }
        }
        // Only for a = b, which assembling a mesh rules out.
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use tetlux_mesh::FACES;

    fn vertices(points: [DVec3; 4]) -> [Vertex; 4] {
        let mut index = 0;
        points.map(|position| {
            index += 1;
            Vertex { index, position, t: 0.0, values: Values::default() }
        })
    }

    /// Faces that the line enters and leaves.
    fn crossings(line: &Line, points: [DVec3; 4]) -> [usize; 2] {
        let v = vertices(points);
        let mut count = [0; 2];
        for [a, b, c] in FACES {
            let sides = [(a, b), (b, c), (c, a)].map(|(i, j)| line.side(&v[i], &v[j]).positive);
            if sides == [true; 3] {
                count[0] += 1;
            } else if sides == [false; 3] {
                count[1] += 1;
            }
        }
        count
    }

    fn lattice() -> impl Strategy<Value = DVec3> {
        // Few values, so that coincidences of every kind are common.
        (-1..=1i32, -1..=1i32, -1..=1i32).prop_map(|(x, y, z)| DVec3::new(x.into(), y.into(), z.into()))
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(20_000))]
        #[test]
        fn a_tetrahedron_is_entered_and_left_once_or_missed(
            // Coincident points never form a cell; flat cells do, and hold the same property.
            points in [lattice(), lattice(), lattice(), lattice()]
                .prop_filter("distinct points", |p| (0..4).all(|i| (0..i).all(|j| p[i] != p[j]))),
            origin in lattice(),
            direction in lattice().prop_filter("a direction", |d| *d != DVec3::ZERO),
        ) {
            let [entered, left] = crossings(&Line::new(origin, direction), points);
            prop_assert!(entered == left && entered <= 1, "entered {entered}, left {left}");
        }
    }

    #[test]
    fn a_line_enters_from_outside_and_the_value_is_the_determinant() {
        let points = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
        let line = Line::new(DVec3::new(0.25, 0.25, -1.0), DVec3::Z);
        assert_eq!(crossings(&line, points), [1, 1]);
        let [a, b, c, _] = vertices(points);
        // The base face, outward order a c b; det(d, a - c, o - c) with d = z: the plane cross product of (0,-1) and
        // (0.25,-0.75).
        assert_eq!(line.side(&a, &c).value, 0.25);
        assert_eq!(line.side(&c, &a).value, -0.25);
        // The three add up to twice the base's area times |d|.
        assert_eq!(line.side(&a, &c).value + line.side(&c, &b).value + line.side(&b, &a).value, 1.0);
    }

    #[test]
    fn a_line_that_misses_enters_nothing() {
        let points = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
        assert_eq!(crossings(&Line::new(DVec3::new(0.6, 0.6, -1.0), DVec3::Z), points), [0, 0]);
    }
}
