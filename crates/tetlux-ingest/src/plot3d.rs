//! PLOT3D: one whole 3-D grid and its solution, in C binary and single precision.
//!
//! The grid file holds three 32-bit dimensions, then all x, all y and all z, i fastest, then perhaps an integer
//! "iblank" for each point, 0 where the point is blanked. The solution (q) file holds the same dimensions, four numbers
//! of the flow (Mach number, angle of attack, Reynolds number, time), then density, the three components of momentum
//! and the stagnation energy (Walatka, Buning, Pierce and Elson, PLOT3D User's Manual, NASA TM-101067, 1990).
//! Neither file says its byte order or whether it has iblank; the length of the grid file does.

use std::path::Path;

use glam::DVec3;
use tetlux_mesh::Field;

use crate::source::{ByteOrder, Source, numbers};
use crate::{IngestError, MixedMesh, Place, StructuredGrid};

/// Bytes of the three dimensions.
const HEADER: u64 = 12;
/// Bytes of the four numbers of the flow.
const FLOW: u64 = 16;
const REMEDY: &str = "read are whole single 3-D grids in single precision C binary, without Fortran record marks: \
                      write it so";

/// What the length of a grid file tells.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Layout {
    order: ByteOrder,
    dimensions: [i32; 3],
    points: u64,
    iblank: bool,
}

/// Whether the dimensions in these bytes, in either byte order, ask for just their length.
pub(crate) fn recognizes(bytes: &[u8]) -> bool {
    layout(bytes).is_some()
}

fn layout(bytes: &[u8]) -> Option<Layout> {
    let length = bytes.len() as u64;
    [ByteOrder::Little, ByteOrder::Big].into_iter().find_map(|order| {
        let dimensions = dimensions(bytes, order)?;
        let points = point_count(dimensions)?;
        let iblank = [false, true].into_iter().find(|&iblank| file_length(points, iblank) == Some(length))?;
        Some(Layout { order, dimensions, points, iblank })
    })
}

fn dimensions(bytes: &[u8], order: ByteOrder) -> Option<[i32; 3]> {
    let numbers: Vec<i32> = numbers!(i32, bytes.get(..HEADER as usize)?, order, |v| v);
    numbers.try_into().ok()
}

/// Number of points, if no dimension is below 1 and 32 bits can name every point.
fn point_count(dimensions: [i32; 3]) -> Option<u64> {
    let mut points = 1u64;
    for n in dimensions {
        points = points.checked_mul(u64::try_from(n).ok()?)?;
    }
    (1..u64::from(u32::MAX)).contains(&points).then_some(points)
}

fn file_length(points: u64, iblank: bool) -> Option<u64> {
    points.checked_mul(if iblank { 16 } else { 12 })?.checked_add(HEADER)
}

/// Reads a grid and, if it is given, its solution.
pub(crate) fn read(source: Source, solution: Option<&Path>) -> Result<MixedMesh, IngestError> {
    let layout = layout(&source.bytes).ok_or_else(|| misfit(&source))?;
    let Layout { order, dimensions, points, iblank } = layout;
    let coordinate = |axis: u64| -> Result<Vec<f32>, IngestError> {
        let bytes = source.section("the coordinates", HEADER + 4 * axis * points, points, 4)?;
        Ok(numbers!(f32, bytes, order, |v| v))
    };
    let (x, y, z) = (coordinate(0)?, coordinate(1)?, coordinate(2)?);
    let positions = x.iter().zip(&y).zip(&z).map(|((&x, &y), &z)| DVec3::new(x.into(), y.into(), z.into()));
    let mut mesh = MixedMesh { points: positions.collect(), path: source.path.clone(), ..MixedMesh::default() };
    drop((x, y, z));
    let blanked = if iblank {
        let bytes = source.section("iblank", HEADER + 12 * points, points, 4)?;
        Some(numbers!(i32, bytes, order, |v| v == 0))
    } else {
        None
    };
    drop(source);
    // The dimensions are at least 1 and their product fits 32 bits.
    let grid = StructuredGrid { counts: dimensions.map(|n| n as usize), blanked };
    mesh.grid = Some(grid);
    note_blanked(&mut mesh);
    if let Some(solution) = solution {
        add_solution(&mut mesh, Source::open(solution)?, layout)?;
    }
    Ok(mesh)
}

fn note_blanked(mesh: &mut MixedMesh) {
    let Some(grid) = &mesh.grid else { return };
    let visible: usize = mesh.cell_counts().iter().map(|&(_, count)| count).sum();
    let blanked = grid.hexahedra() - visible;
    if blanked > 0 {
        mesh.notes.push(format!("{blanked} hexahedra have a blanked corner (iblank 0): they are left out"));
    }
}

/// Why a file is no grid: too short even for the dimensions, dimensions that make no sense, or a length that is not theirs.
fn misfit(source: &Source) -> IngestError {
    let length = source.bytes.len() as u64;
    if let Err(truncated) = source.section("the dimensions of a PLOT3D grid", 0, 3, 4) {
        return truncated;
    }
    // In the wrong byte order small dimensions become huge: the smaller product is likelier meant.
    let candidates = [ByteOrder::Little, ByteOrder::Big].into_iter().filter_map(|o| dimensions(&source.bytes, o));
    let likely = candidates.clone().filter_map(|d| Some((point_count(d)?, d))).min();
    match likely {
        Some((points, [ni, nj, nk])) => {
            let needed = [false, true].map(|iblank| file_length(points, iblank).unwrap_or(u64::MAX));
            if length < needed[0] {
                let what = format!("a PLOT3D grid of {ni} x {nj} x {nk} points");
                return IngestError::Truncated {
                    path: source.path.clone(),
                    what,
                    offset: 0,
                    needed: needed[0],
                    found: length,
                };
            }
            let what = format!(
                "a PLOT3D grid of {ni} x {nj} x {nk} points has {} bytes, or {} with iblank",
                needed[0], needed[1]
            );
            source.malformed(Place::File, what, format!("{length} bytes"), REMEDY)
        }
        None => {
            let found: Vec<String> = candidates.map(|[ni, nj, nk]| format!("{ni} x {nj} x {nk}")).collect();
            let what = "the dimensions of a PLOT3D grid (little-endian, or big-endian)";
            source.malformed(Place::Byte(0), what, found.join(", or "), REMEDY)
        }
    }
}

fn add_solution(mesh: &mut MixedMesh, solution: Source, grid: Layout) -> Result<(), IngestError> {
    let points = grid.points;
    solution.section("the dimensions of a PLOT3D solution", 0, 3, 4)?;
    let other = if grid.order == ByteOrder::Big { ByteOrder::Little } else { ByteOrder::Big };
    let Some(order) =
        [grid.order, other].into_iter().find(|&o| dimensions(&solution.bytes, o) == Some(grid.dimensions))
    else {
        return Err(IngestError::SolutionDiffers {
            path: mesh.path.clone(),
            found: dimensions(&solution.bytes, grid.order).unwrap_or_default(),
            solution: solution.path,
            expected: grid.dimensions,
        });
    };
    let start = HEADER + FLOW;
    let variable = |name: &str, index: u64| -> Result<Vec<f64>, IngestError> {
        let bytes = solution.section(name, start + 4 * index * points, points, 4)?;
        Ok(numbers!(f32, bytes, order, f64::from))
    };
    let density = variable("Density", 0)?;
    let momentum = [variable("Momentum, i", 1)?, variable("Momentum, j", 2)?, variable("Momentum, k", 3)?];
    let energy = variable("StagnationEnergy", 4)?;
    let momentum = (0..density.len()).flat_map(|p| [momentum[0][p], momentum[1][p], momentum[2][p]]).collect();
    mesh.fields = vec![
        Field::point("Density", 1, density),
        Field::point("Momentum", 3, momentum),
        Field::point("StagnationEnergy", 1, energy),
    ];
    let rest = solution.bytes.len() as u64 - (start + 20 * points);
    if rest > 0 {
        mesh.notes.push(format!("{}: the last {rest} bytes are no data of the solution", solution.path.display()));
    }
    Ok(())
}
