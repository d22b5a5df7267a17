//! Why a scene cannot be cast.

/// What is wrong with a [`Scene`](crate::Scene).
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ReferenceError {
    /// The scalar does not belong to the mesh.
    #[error("scalar \"{name}\" has {found} values for {expected} {location}: take it from this mesh")]
    ScalarLength {
        /// Name of the scalar.
        name: String,
        /// Values it has.
        found: usize,
        /// Points or cells of the mesh.
        expected: usize,
        /// "points" or "cells".
        location: &'static str,
    },
    /// A classification by two scalars has one.
    #[error("the classification takes two scalars: give the second too")]
    SecondScalar,
    /// The gradients do not belong to the mesh.
    #[error("there are {found} gradients for {expected} points: take them from this mesh")]
    Gradients {
        /// Gradients there are.
        found: usize,
        /// Points of the mesh.
        expected: usize,
    },
    /// The colours do not belong to the mesh.
    #[error("there are {found} colours for {expected} points: take them from this mesh")]
    Colors {
        /// Colours there are.
        found: usize,
        /// Points of the mesh.
        expected: usize,
    },
    /// A colour is none.
    #[error("the colour {0:?} of a point must be finite and at least 0")]
    Color([f64; 4]),
    /// A surface whose triangles or positions cannot be.
    #[error("surface {surface}: {what}")]
    Surface {
        /// Which, from 0.
        surface: usize,
        /// What is wrong, and the value found.
        what: String,
    },
    /// The unit distance is not a length.
    #[error("the unit distance is {0}: it must be finite and above 0, in world units")]
    UnitDistance(f64),
    /// The tolerance is not a bound.
    #[error("the tolerance is {0}: it must be finite and above 0, such as 1e-10")]
    Tolerance(f64),
}
