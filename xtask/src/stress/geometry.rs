//! Cases of geometry.

mod cells;
mod crowds;
mod eye;
mod places;

use anyhow::Result;
use glam::DVec3;
use tetlux_mesh::Field;
use tetlux_mesh::procedural::Parts;
use tetlux_scene::{Camera, Projection};

use super::case::Case;
use crate::input::Input;
use crate::testbed::meshes::{FIELD, Specimen, transfer};

macro_rules! cases {
    ($($name:literal, $what:literal, $input:expr;)+) => {
        &[$(Case { name: $name, what: $what, input: $input }),+]
    };
}

pub(super) use cases;

pub(crate) const CASES: &[Case] = cases! {
    "cube", "nothing: what the others are measured by", cells::cube;
    "flat-cells", "layers 1e-12 to 1 thick across a box 2 wide", cells::flat;
    "flat-cells-aslant", "layers 1e-5 to 0.5 thick, turned so that no coordinate is alike", cells::flat_aslant;
    "zero-volume", "cells of no volume in faces and on edges, vertices on a line", cells::zero_volume;
    "thin-sheet", "20 layers in a hundredth of the width, opaque, the field changing from one to the next", cells::thin_sheet;
    "film", "four layers in a ten-thousandth of half the width, opaque, the field changing from one to the next", cells::film;
    "long-cells", "edges of one cell from 1e-6 to 1", cells::long;
    "graded-cells", "edges from 1e-6 to 1 in one mesh", cells::graded;
    "one-far-cell", "a cell 3000 times longer than the others, far away", cells::one_far;
    "co-spherical", "every vertex on one of five spheres, poles and seam merged", cells::co_spherical;
    "co-planar", "every face in a plane of the grid or its diagonals, rays along them", cells::co_planar;
    "every-other-block", "hexahedra that touch at edges and vertices alone", cells::every_other;
    "cycle", "thirteen cells that hide one another in a ring", cells::cycle;
    "tiny-mesh", "1e-12 wide", |short| places::cube(short, 0.0, 1e-12);
    "huge-mesh", "1e12 wide", |short| places::cube(short, 0.0, 1e12);
    "mesh-far-out", "1 wide, 1e9 from the origin", |short| places::cube(short, 1e9, 1.0);
    "small-mesh-far-out", "1e-3 wide, 1e9 from the origin", |short| places::cube(short, -1e9, 1.0 / 1024.0);
    "seen-from-afar", "a million widths away, through an angle of 1e-4 degrees", places::from_afar;
    "rays-on-edges", "orthographic, pixel centres on vertices and edges", places::on_edges;
    "eye-on-vertex", "the eye on a vertex inside", |short| eye::at(short, DVec3::new(1.0, 2.0, 1.0));
    "eye-on-edge", "the eye on an edge inside", |short| eye::at(short, DVec3::new(1.5, 1.0, 2.0));
    "eye-on-face", "the eye in a face inside, two more planes of faces through it", |short| eye::at(short, DVec3::new(1.25, 1.625, 2.0));
    "eye-in-cell", "the eye in a cell", |short| eye::at(short, DVec3::new(1.3, 1.55, 1.21));
    "eye-beside-vertex", "the eye 1e-6 from a vertex inside", |short| eye::at(short, DVec3::new(1.000_001, 1.999_999, 1.000_000_5));
    "eye-in-smallest-cell", "the eye in a cell of 1e-4 among others up to 1, as opaque as they are small", eye::in_smallest;
    "eye-on-surface", "the eye on the mesh's surface, looking in", |short| eye::at(short, DVec3::new(0.0, 1.5, 1.5));
    "eye-on-corner", "the eye on the mesh's corner, looking along its edge", eye::on_corner;
    "eye-in-plane", "the eye outside, in the planes of inner faces", eye::in_plane;
    "parallel-eye-inside", "parallel rays that begin inside", eye::parallel;
    "near-plane", "a near plane that cuts cells", |short| eye::near(short, 0.3);
    "near-plane-on-vertices", "a near plane through vertices", |short| eye::near(short, 1.0);
    "view-of-170", "a view 170 degrees high, from inside", |short| eye::wide(short, 170.0);
    "view-of-179-9", "a view 179.9 degrees high, from inside", |short| eye::wide(short, 179.9);
    "view-of-179-99", "a view 179.99 degrees high, from inside", |short| eye::wide(short, 179.99);
    "view-of-180", "a view 180 degrees high, which no camera has", |short| eye::wide(short, 180.0);
    "cell-round-eye", "one cell that fills the picture, the eye in it", crowds::round_eye;
    "cell-fills-picture", "one face through which all of the picture is seen, from a millionth of its width", crowds::fills;
    "million-in-a-pixel", "a million cells in one pixel (short: ten thousand)", crowds::in_a_pixel;
    "deep-stack", "10 000 layers one behind the other (short: 1000)", crowds::stack;
    "deep-stack-aside", "the same, seen from aside", crowds::stack_aside;
};

/// Colours and opacities over 0 to 1 that tell orders, ends and places of segments apart.
pub(super) const COLOR: [[f64; 4]; 4] =
    [[0.0, 1.0, 0.6, 0.1], [0.35, 0.9, 0.2, 0.3], [0.7, 0.1, 0.5, 1.0], [1.0, 0.2, 1.0, 0.4]];
pub(super) const OPACITY: [[f64; 2]; 5] = [[0.0, 0.4], [0.3, 1.6], [0.45, 0.1], [0.7, 2.0], [1.0, 0.6]];

/// A mesh with a field between 0 and 1, seen in these.
pub(super) fn specimen(parts: Parts, field: impl FnMut(DVec3) -> f64, camera: Camera, short: bool) -> Result<Specimen> {
    Ok(Specimen {
        field: Field::point(FIELD, 1, parts.sample(field)),
        parts,
        transfer: transfer(&COLOR, &OPACITY)?,
        unit_distance: 1.0,
        camera,
        size: if short { [24, 20] } else { [64, 56] },
    })
}

/// The same at once.
fn input(parts: Parts, field: impl FnMut(DVec3) -> f64, camera: Camera, short: bool) -> Result<Input> {
    specimen(parts, field, camera, short)?.input("stress", "")
}

fn camera(position: DVec3, focal_point: DVec3, projection: Projection) -> Camera {
    // Upright is the axis most nearly perpendicular to the view: no direction is refused.
    let along = (focal_point - position).abs();
    let view_up = if along.z <= along.x.max(along.y) { DVec3::Z } else { DVec3::Y };
    Camera { position, focal_point, view_up, projection, near: 0.0 }
}

pub(super) fn perspective(position: DVec3, focal_point: DVec3, view_angle: f64) -> Camera {
    camera(position, focal_point, Projection::Perspective { view_angle })
}

fn orthographic(position: DVec3, focal_point: DVec3, parallel_scale: f64) -> Camera {
    camera(position, focal_point, Projection::Orthographic { parallel_scale })
}

/// So many cells a side in full, or in short.
pub(super) fn count(short: bool, full: usize, few: usize) -> usize {
    if short { few } else { full }
}
