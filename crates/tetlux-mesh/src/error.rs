//! What can be wrong with a mesh.

/// Why a mesh could not be made, or a field not be had.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum MeshError {
    /// No cell is left to render.
    #[error("the mesh has no cells ({dropped} were dropped for repeated vertices): nothing can be rendered")]
    Empty {
        /// Cells dropped because two of their vertices are one point.
        dropped: usize,
    },
    /// More points or cells than 32-bit indices can name.
    #[error("the mesh has {count} {what}; at most {limit} can be indexed: split the data set")]
    TooLarge {
        /// "points" or "cells".
        what: &'static str,
        /// How many there are.
        count: usize,
        /// How many there may be.
        limit: usize,
    },
    /// A coordinate is NaN, infinite, or beyond single precision after recentring.
    #[error("point {point} is at ({}, {}, {}): coordinates must be finite and the mesh narrower than 1e38", at[0], at[1], at[2])]
    Point {
        /// Index of the point as given.
        point: usize,
        /// Its coordinates.
        at: [f64; 3],
    },
    /// A cell names a point that does not exist.
    #[error("cell {cell} names point {index}, but there are {points} points (0 to {})", points.saturating_sub(1))]
    Index {
        /// Index of the cell as given.
        cell: usize,
        /// The vertex index found.
        index: u32,
        /// Number of points.
        points: usize,
    },
    /// A field's length does not fit the mesh.
    #[error(
        "field \"{name}\" has {found} values; {expected} are needed ({tuples} {location} x {components} components)"
    )]
    FieldLength {
        /// Name of the field.
        name: String,
        /// Values given.
        found: usize,
        /// Values needed.
        expected: usize,
        /// Points or cells.
        tuples: usize,
        /// "points" or "cells".
        location: &'static str,
        /// Components of each.
        components: usize,
    },
    /// No field of that name.
    #[error("there is no field \"{name}\"; the mesh has: {available}")]
    NoField {
        /// The name asked for.
        name: String,
        /// The names there are, with their place and components.
        available: String,
    },
    /// The field has no such component.
    #[error("field \"{name}\" has {components} component(s), numbered from 0: component {component} does not exist")]
    NoComponent {
        /// Name of the field.
        name: String,
        /// Components it has.
        components: usize,
        /// The component asked for.
        component: usize,
    },
    /// Every value is NaN or infinite.
    #[error("field \"{name}\" holds no finite value (all {count} are NaN or infinite): choose another of {available}")]
    NoData {
        /// Name of the field.
        name: String,
        /// Number of values.
        count: usize,
        /// The fields there are.
        available: String,
    },
}
