//! Rays through meshes of known shape and light.

mod bivariate;
mod geometry;
mod radiance;
mod surfaces;
