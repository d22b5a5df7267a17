//! Vectors in space, several at a time.

use std::ops::{Add, Mul, Sub};

use fearless_simd::{Simd, SimdBase, SimdFloat};

/// As many points or directions as a vector of doubles has lanes.
#[derive(Clone, Copy)]
pub(crate) struct Vector<S: Simd> {
    pub(crate) x: S::f64s,
    pub(crate) y: S::f64s,
    pub(crate) z: S::f64s,
}

impl<S: Simd> Add for Vector<S> {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Vector { x: self.x + other.x, y: self.y + other.y, z: self.z + other.z }
    }
}

impl<S: Simd> Sub for Vector<S> {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Vector { x: self.x - other.x, y: self.y - other.y, z: self.z - other.z }
    }
}

impl<S: Simd> Mul<S::f64s> for Vector<S> {
    type Output = Self;

    #[inline(always)]
    fn mul(self, factor: S::f64s) -> Self {
        Vector { x: self.x * factor, y: self.y * factor, z: self.z * factor }
    }
}

impl<S: Simd> Vector<S> {
    #[inline(always)]
    pub(crate) fn cross(self, other: Self) -> Self {
        Vector {
            x: self.y * other.z - self.z * other.y,
            y: self.z * other.x - self.x * other.z,
            z: self.x * other.y - self.y * other.x,
        }
    }

    /// The largest coordinate.
    #[inline(always)]
    pub(crate) fn reach(self) -> S::f64s {
        self.x.max(-self.x).max(self.y.max(-self.y)).max(self.z.max(-self.z))
    }
}

#[inline(always)]
pub(crate) fn dot<S: Simd>(a: Vector<S>, b: Vector<S>) -> S::f64s {
    a.x.mul_add(b.x, a.y.mul_add(b.y, a.z * b.z))
}
