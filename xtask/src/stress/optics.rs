//! Cases of optics: what is hard about the transfer function or the data, on a plain cube.

use anyhow::Result;
use glam::DVec3;
use tetlux_mesh::Field;
use tetlux_mesh::procedural::{Parts, Split, cuboid};
use tetlux_optics::NoData;
use tetlux_optics::accuracy::Random;

use super::case::Case;
use super::geometry::{self, COLOR, OPACITY, cases, perspective};
use crate::input::Input;
use crate::testbed::meshes::{FIELD, Specimen, transfer};

pub(crate) const CASES: &[Case] = cases! {
    "depth-1e-12", "optical depth 1e-12 a cell", |short| depth(short, 1e-12);
    "depth-1e-6", "optical depth 1e-6 a cell", |short| depth(short, 1e-6);
    "depth-1e-3", "optical depth 1e-3 a cell", |short| depth(short, 1e-3);
    "depth-1e3", "optical depth 1e3 a cell", |short| depth(short, 1e3);
    "depth-1e12", "optical depth 1e12 a cell", |short| depth(short, 1e12);
    "equal-extinctions", "the same extinction at both ends of every segment", |short| extinctions(short, [1.0, 1.0]);
    "nearly-equal-extinctions", "extinctions that differ by 1e-7 over the field", |short| extinctions(short, [1.0, 1.0 + 1e-7]);
    "unequal-extinctions", "extinctions from 0 to an optical depth of 1e12 a cell", |short| extinctions(short, [0.0, 1e12]);
    "steps", "two control points at one scalar, of colour and of opacity", steps;
    "steps-on-vertices", "the same at the scalars of whole layers of vertices", steps_on_vertices;
    "peak-1e-3", "peaks 1e-3 of the range wide, inside cells", |short| peaks(short, 1e-3);
    "peak-1e-6", "peaks 1e-6 of the range wide, inside cells", |short| peaks(short, 1e-6);
    "peak-1e-9", "peaks 1e-9 of the range wide, which single precision does not tell from a point", |short| peaks(short, 1e-9);
    "nothing", "opacity zero everywhere", |short| input(short, radius, &COLOR, &[[0.0, 0.0], [1.0, 0.0]]);
    "thousand-nodes", "a thousand control points of random colour and opacity (short: a hundred)", thousand_nodes;
    "wide-function", "control points from a million ranges below the data to a million above", wide_function;
    "constant-field", "one value everywhere, on a ramp", |short| values(short, |_| 7.25, [-10.0, 30.0]);
    "range-1e-30", "a field from 0 to 1e-30", |short| values(short, |u| 1e-30 * u, [0.0, 1e-30]);
    "range-1e30", "a field from -1e30 to 1e30", |short| values(short, |u| 2e30 * (u - 0.5), [-1e30, 1e30]);
    "range-on-1e9", "a field from 1e9 to 1e9 + 1", |short| values(short, |u| 1e9 + u, [1e9, 1e9 + 1.0]);
    "range-subnormal", "a field from 0 to 1e-310", |short| values(short, |u| 1e-310 * u, [0.0, 1e-310]);
    "range-widest", "a field over all of double precision", |short| values(short, |u| 1.7e308 * (2.0 * u - 1.0), [-8e307, 8e307]);
    "no-data-points", "NaN and infinities at one point in 50, in a colour of their own", |short| no_data(short, false, 0.8);
    "no-data-cells", "NaN and infinities in one cell in 20, in a colour of their own", |short| no_data(short, true, 0.8);
    "no-data-left-out", "NaN and infinities at one point in 50, left out", |short| no_data(short, false, 0.0);
};

/// The distance from the middle of a cube from -1 to 1; 1 at its corners.
fn radius(p: DVec3) -> f64 {
    p.length() / 3f64.sqrt()
}

/// Hexahedra a side.
fn count(short: bool) -> usize {
    geometry::count(short, 12, 4)
}

fn cube(short: bool) -> Parts {
    cuboid([count(short); 3], Split::Six, [DVec3::NEG_ONE, DVec3::ONE])
}

/// The cube with a field, seen whole and aslant.
fn specimen(short: bool, field: impl FnMut(DVec3) -> f64) -> Result<Specimen> {
    let camera = perspective(DVec3::new(2.2, -5.4, 1.7), DVec3::ZERO, 30.0);
    geometry::specimen(cube(short), field, camera, short)
}

fn input(short: bool, field: fn(DVec3) -> f64, color: &[[f64; 4]], opacity: &[[f64; 2]]) -> Result<Input> {
    Specimen { transfer: transfer(color, opacity)?, ..specimen(short, field)? }.input("stress", "")
}

/// Ramps of so much optical depth along a cell's edge.
fn depth(short: bool, depth: f64) -> Result<Input> {
    let per_length = depth * count(short) as f64 / 2.0;
    input(short, radius, &COLOR, &OPACITY.map(|[s, opacity]| [s, opacity * per_length]))
}

/// A ramp between two optical depths along a cell's edge.
fn extinctions(short: bool, ends: [f64; 2]) -> Result<Input> {
    let [low, high] = ends.map(|depth| depth * count(short) as f64 / 2.0);
    input(short, radius, &COLOR, &[[0.2, low], [0.9, high]])
}

/// Steps of both functions.
fn steps(short: bool) -> Result<Input> {
    let color = [
        [0.3, 1.0, 0.1, 0.1],
        [0.3, 0.1, 1.0, 0.2],
        [0.55, 0.3, 0.9, 0.2],
        [0.55, 0.1, 0.3, 1.0],
        [0.8, 0.8, 0.2, 1.0],
        [0.8, 1.0, 1.0, 0.1],
    ];
    let opacity = [[0.25, 0.0], [0.25, 2.0], [0.5, 0.5], [0.5, 0.1], [0.75, 3.0], [0.75, 0.2]];
    // Planes of one scalar that no ray runs along.
    input(short, |p| 0.5 + 0.31 * p.x + 0.13 * p.y + 0.05 * p.z, &color, &opacity)
}

fn steps_on_vertices(short: bool) -> Result<Input> {
    let color = [[0.25, 1.0, 0.1, 0.1], [0.25, 0.1, 1.0, 0.2], [0.75, 0.3, 0.2, 1.0], [0.75, 1.0, 1.0, 0.1]];
    let opacity = [[0.25, 0.2], [0.25, 2.0], [0.5, 0.5], [0.5, 0.0], [0.75, 0.0], [0.75, 3.0]];
    input(short, |p| 0.5 + 0.5 * p.z, &color, &opacity)
}

/// Peaks of area 0.02 each, between the scalars of vertices. In few cells: where a face lies in a peak it is known by scalars of
/// single precision, 6e-8 of the range, which is a part of a peak that narrow.
fn peaks(short: bool, width: f64) -> Result<Input> {
    let half = 0.5 * width;
    let peak = |s: f64| [[s - half, 0.0], [s, 0.04 / width], [s + half, 0.0]];
    let opacity: Vec<_> = [0.2345, 0.4567, 0.6789].into_iter().flat_map(peak).collect();
    let parts = cuboid([2; 3], Split::Six, [DVec3::NEG_ONE, DVec3::ONE]);
    let field = Field::point(FIELD, 1, parts.sample(|p| 0.5 + 0.25 * p.x + 0.17 * p.y + 0.08 * p.z));
    let transfer = transfer(&COLOR, &opacity)?;
    Specimen { parts, field, transfer, ..specimen(short, radius)? }.input("stress", "")
}

fn thousand_nodes(short: bool) -> Result<Input> {
    let mut random = Random::new(9);
    let nodes = geometry::count(short, 1000, 100);
    let place = |i: usize| i as f64 / (nodes - 1) as f64;
    let color: Vec<_> = (0..nodes).map(|i| [place(i), random.unit(), random.unit(), random.unit()]).collect();
    let opacity: Vec<_> = (0..nodes).map(|i| [place(i), 3.0 * random.unit()]).collect();
    input(short, radius, &color, &opacity)
}

fn wide_function(short: bool) -> Result<Input> {
    let far = 1e6;
    let color = [[-far, 0.0, 1.0, 1.0], [0.4, 1.0, 0.2, 0.1], [far, 7.0, 0.0, 1.0]];
    input(short, radius, &color, &[[-far, 9.0], [0.6, 0.2], [far, 1e6]])
}

/// A field with a value for each radius, on nodes that span some scalars.
fn values(short: bool, value: fn(f64) -> f64, [low, high]: [f64; 2]) -> Result<Input> {
    let place = |s: f64| low * (1.0 - s) + high * s;
    let color = COLOR.map(|[s, r, g, b]| [place(s), r, g, b]);
    let opacity = OPACITY.map(|[s, opacity]| [place(s), opacity]);
    Specimen { transfer: transfer(&color, &opacity)?, ..specimen(short, |p| value(radius(p)))? }.input("stress", "")
}

/// The radius with values that are not finite sprinkled over points or cells, seen with an opacity.
fn no_data(short: bool, by_cell: bool, opacity: f64) -> Result<Input> {
    let parts = cube(short);
    let middle = |cell: &[u32; 4]| cell.iter().map(|&v| parts.points[v as usize]).sum::<DVec3>() / 4.0;
    let mut values: Vec<f64> =
        if by_cell { parts.cells.iter().map(|cell| radius(middle(cell))).collect() } else { parts.sample(radius) };
    let mut random = Random::new(11);
    for value in &mut values {
        let chance = random.unit() * if by_cell { 20.0 } else { 50.0 };
        if chance < 1.0 {
            *value = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY][(chance * 3.0) as usize];
        }
    }
    let field = if by_cell { Field::cell(FIELD, 1, values) } else { Field::point(FIELD, 1, values) };
    let mut input = Specimen { field, ..specimen(short, radius)? }.input("stress", "")?;
    input.scene.no_data = NoData::new([1.0, 0.0, 1.0], opacity)?;
    Ok(input)
}
