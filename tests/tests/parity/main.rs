//! Shaders on the real driver against their twins in Rust, and pictures against themselves.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a test's helpers fail and tell like the test")]

mod device;
mod functions;
mod lookups;
mod methods;
mod pictures;
mod published;
mod thick;
mod two_fields;
