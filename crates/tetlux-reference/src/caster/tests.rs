//! Rays through meshes of known shape and light.

mod geometry;
mod radiance;
