//! Shaders on the real driver against their twins in Rust, and pictures against themselves.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a test's helpers fail and tell like the test")]

mod combinations;
mod device;
mod functions;
mod lookups;
mod methods;
mod outlines;
mod pictures;
mod published;
mod thick;
mod triangle;
mod two_fields;
