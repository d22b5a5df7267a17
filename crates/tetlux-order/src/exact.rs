//! Signs of determinants: filtered in double precision, then exact.
//!
//! Exact sums are expansions of doubles that do not overlap (Shewchuk 1997, Adaptive precision floating-point
//! arithmetic). Coordinates of the mesh are single precision, so that a product of two is one double.

use glam::{DVec3, Vec3};

/// An eye in the mesh's own coordinates, taken as exact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Viewpoint {
    /// Where it is or, infinitely far away, the direction towards it.
    pub(crate) at: DVec3,
    /// Perspective.
    pub(crate) finite: bool,
}

impl Viewpoint {
    /// Components so small that an exact product could underflow count as zero; an eye so far away that one could
    /// overflow is infinitely far away.
    pub(crate) fn new(at: DVec3, finite: bool) -> Viewpoint {
        let largest = at.abs().max_element();
        let (at, finite) = if largest > 1e100 { (at / largest, false) } else { (at, finite) };
        let flush = |x: f64| if x.abs() < 1e-150 { 0.0 } else { x };
        Viewpoint { at: DVec3::new(flush(at.x), flush(at.y), flush(at.z)), finite }
    }

    /// From a point to the eye: exact if it is infinitely far away.
    pub(crate) fn from(&self, p: DVec3) -> DVec3 {
        if self.finite { self.at - p } else { self.at }
    }
}

/// A sign, 1, 0 or -1, and the arithmetic that it took.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Sign {
    pub(crate) value: i8,
    pub(crate) exact: bool,
}

/// Shewchuk's bound of the error of a 3 by 3 determinant of differences, over the sum of its products' magnitudes.
const DETERMINANT_ERROR: f64 = 7.8e-16;

/// Positive if the eye is on the side of the plane of `a`, `b`, `c` from which they run counter-clockwise.
pub(crate) fn plane_sign(a: Vec3, b: Vec3, c: Vec3, eye: &Viewpoint) -> Sign {
    let [p, q, r] = [a, b, c].map(|v| v.as_dvec3());
    let (u, v, w) = (q - p, r - p, eye.from(p));
    let product = |i: usize, j: usize, k: usize| w[i] * (u[j] * v[k]) - w[i] * (u[k] * v[j]);
    let size = |i: usize, j: usize, k: usize| w[i].abs() * ((u[j] * v[k]).abs() + (u[k] * v[j]).abs());
    let value = product(0, 1, 2) + product(1, 2, 0) + product(2, 0, 1);
    let permanent = size(0, 1, 2) + size(1, 2, 0) + size(2, 0, 1);
    // Differences are zero only where they are exactly, so a sum of zeros is one.
    if value.abs() > DETERMINANT_ERROR * permanent || permanent == 0.0 {
        return Sign { value: sign(value), exact: false };
    }
    let mut sum = Sum::default();
    for [p, q] in [[p, q], [q, r], [r, p]] {
        sum.add_triple(eye.at, p, q);
    }
    if eye.finite {
        for (i, j, k) in CYCLES {
            sum.add_product(-p[i], q[j] * r[k]);
            sum.add_product(p[i], q[k] * r[j]);
        }
    }
    Sign { value: sum.sign(), exact: true }
}

/// Exact sign of the determinant of the vectors from the origin of a ray to `a` and to `b`, and its direction.
///
/// The ray is one of perspective, from `origin`, or if `finite` is false a change of a parallel ray's determinant when
/// its origin moves by `origin`.
pub(crate) fn edge_sign(a: Vec3, b: Vec3, origin: DVec3, direction: DVec3, finite: bool) -> i8 {
    let (a, b) = (a.as_dvec3(), b.as_dvec3());
    let mut sum = Sum::default();
    if finite {
        sum.add_triple(direction, a, b);
    }
    for (i, j, k) in CYCLES {
        for (p, sign) in [(a, 1.0), (b, -1.0)] {
            sum.add_three(sign * direction[i], origin[j], p[k]);
            sum.add_three(-sign * direction[i], origin[k], p[j]);
        }
    }
    sum.sign()
}

const CYCLES: [(usize, usize, usize); 3] = [(0, 1, 2), (1, 2, 0), (2, 0, 1)];

fn sign(x: f64) -> i8 {
    i8::from(x > 0.0) - i8::from(x < 0.0)
}

/// An exact sum: parts that do not overlap, ascending in magnitude, none of them zero.
struct Sum {
    parts: [f64; MOST_TERMS],
    len: usize,
}

/// Of one sum here: [`edge_sign`]'s 12 of the edge's own and 48 of the ray's origin.
const MOST_TERMS: usize = 60;

impl Default for Sum {
    fn default() -> Sum {
        Sum { parts: [0.0; MOST_TERMS], len: 0 }
    }
}

impl Sum {
    fn add(&mut self, mut x: f64) {
        if x == 0.0 {
            return;
        }
        let mut len = 0;
        for i in 0..self.len {
            let (sum, error) = two_sum(x, self.parts[i]);
            if error != 0.0 {
                self.parts[len] = error;
                len += 1;
            }
            x = sum;
        }
        if x != 0.0 {
            self.parts[len] = x;
            len += 1;
        }
        self.len = len;
    }

    fn add_product(&mut self, x: f64, y: f64) {
        let (product, error) = two_product(x, y);
        self.add(error);
        self.add(product);
    }

    fn add_three(&mut self, x: f64, y: f64, z: f64) {
        let (product, error) = two_product(x, y);
        self.add_product(error, z);
        self.add_product(product, z);
    }

    /// Adds w . (p x q), with p and q of single precision.
    fn add_triple(&mut self, w: DVec3, p: DVec3, q: DVec3) {
        for (i, j, k) in CYCLES {
            self.add_product(w[i], p[j] * q[k]);
            self.add_product(-w[i], p[k] * q[j]);
        }
    }

    /// The largest part outweighs all others.
    fn sign(&self) -> i8 {
        if self.len == 0 { 0 } else { sign(self.parts[self.len - 1]) }
    }
}

fn two_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let b_part = sum - a;
    (sum, (a - (sum - b_part)) + (b - b_part))
}

fn two_product(a: f64, b: f64) -> (f64, f64) {
    let product = a * b;
    (product, a.mul_add(b, -product))
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// Small integers, so that determinants are exact in i128, scaled to reach many exponents.
    fn point() -> impl Strategy<Value = [i32; 3]> {
        prop::array::uniform3(-3000i32..3000)
    }

    fn vec3(p: [i32; 3]) -> Vec3 {
        Vec3::from(p.map(|x| x as f32))
    }

    fn det(a: [i128; 3], b: [i128; 3], c: [i128; 3]) -> i128 {
        a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0])
    }

    fn minus(a: [i32; 3], b: [i32; 3]) -> [i128; 3] {
        [0, 1, 2].map(|i| i128::from(a[i]) - i128::from(b[i]))
    }

    proptest! {
        #[test]
        fn planes_and_edges_have_the_signs_of_integers(
            a in point(), b in point(), c in point(), e in point(), d in point(), s in -2i32..3, t in -2i32..3,
        ) {
            // Also an eye in the plane of the face: e = a + s (b - a) + t (c - a).
            let inside = [0, 1, 2].map(|i| a[i] + s * (b[i] - a[i]) + t * (c[i] - a[i]));
            for e in [e, inside] {
                let (u, v) = (minus(b, a), minus(c, a));
                let eye = Viewpoint::new(vec3(e).as_dvec3(), true);
                let expected = det(minus(e, a), u, v).signum() as i8;
                prop_assert_eq!(plane_sign(vec3(a), vec3(b), vec3(c), &eye).value, expected);
                let far = Viewpoint::new(vec3(e).as_dvec3(), false);
                let expected = det(e.map(i128::from), u, v).signum() as i8;
                prop_assert_eq!(plane_sign(vec3(a), vec3(b), vec3(c), &far).value, expected);

                let edge = edge_sign(vec3(a), vec3(b), eye.at, vec3(d).as_dvec3(), true);
                prop_assert_eq!(edge, det(minus(a, e), minus(b, e), d.map(i128::from)).signum() as i8);
                prop_assert_eq!(edge, -edge_sign(vec3(b), vec3(a), eye.at, vec3(d).as_dvec3(), true));
                // Its change with the origin: d . (e x (a - b)).
                let moved = edge_sign(vec3(a), vec3(b), eye.at, vec3(d).as_dvec3(), false);
                prop_assert_eq!(moved, det(d.map(i128::from), e.map(i128::from), minus(a, b)).signum() as i8);
            }
        }
    }

    #[test]
    fn the_last_bit_decides() {
        let [a, b, c] = [Vec3::new(1e-3, 0.0, 7.0), Vec3::new(3e4, 1e-3, 7.0), Vec3::new(-1.0, 2e4, 7.0)];
        for (z, expected) in [(7.0f64, 0), (7.0f64.next_up(), 1), (7.0f64.next_down(), -1)] {
            let eye = Viewpoint::new(DVec3::new(0.1, 0.7, z), true);
            assert_eq!(plane_sign(a, b, c, &eye).value, expected);
        }
        let eye = Viewpoint::new(DVec3::new(0.1, 1e100, 1e-160), false);
        assert_eq!(plane_sign(a, b, c, &eye).value, 0, "a direction in the plane but for what underflows");
    }

    #[test]
    fn sums_cancel_exactly() {
        let mut sum = Sum::default();
        for x in [1e30, 1.0, -1e30, 1e-30] {
            sum.add(x);
        }
        sum.add(-1.0);
        assert_eq!(sum.sign(), 1);
        sum.add(-1e-30);
        assert_eq!(sum.sign(), 0);
        sum.add_three(0.1, 0.1, -1e-9);
        assert_eq!(sum.sign(), -1);
    }
}
