//! The CPU back end: cell projection in horizontal bands of the picture, one core a band.

use glam::{Vec2, Vec3};
use rayon::prelude::*;
use tetlux_optics::transfer_f32::{integrate, piece_at};

use crate::Job;
use crate::cell::{Cell, Kind, Reference, Vertex};
use crate::device_mesh::NEGATIVE;

/// Rows of pixels that one core draws at a time.
const BAND: usize = 8;

/// Cells are binned at most this many at a time: bounds the memory of the bands' lists.
const BATCH: usize = 1 << 20;

/// Pixels by which a cell's bounds are widened, for rounding.
const MARGIN: f32 = 0.03125;

/// A cell ready to be drawn.
struct Projected {
    cell: Cell,
    reference: Reference,
    /// First and last piece of the transfer function that the cell's scalars meet.
    pieces: [usize; 2],
    /// First and one past the last pixel, in x and in y.
    columns: [u32; 2],
    rows: [u32; 2],
}

/// A piece of one pixel's ray.
#[derive(Clone, Copy)]
struct Fragment {
    depth: f32,
    color: [f32; 4],
}

/// Draws a picture: premultiplied pixels, top row first.
///
/// If `sort_pixels`, every pixel's fragments are sorted by depth.
pub(crate) fn draw(job: &Job, sort_pixels: bool) -> Vec<[f32; 4]> {
    let width = job.size[0] as usize;
    let mut pixels = vec![[0.0; 4]; width * job.size[1] as usize];
    if sort_pixels {
        // All fragments of a pixel are needed at once.
        draw_batch(job, job.order, true, &mut pixels);
    } else {
        for batch in job.order.chunks(BATCH) {
            draw_batch(job, batch, false, &mut pixels);
        }
    }
    pixels
}

fn draw_batch(job: &Job, cells: &[u32], sort_pixels: bool, pixels: &mut [[f32; 4]]) {
    let projected: Vec<Option<Projected>> = cells.par_iter().map(|&c| project(job, c)).collect();
    let bands = bin(&projected, job.size[1] as usize);
    let width = job.size[0] as usize;
    pixels.par_chunks_mut(width * BAND).zip(bands).enumerate().for_each(|(band, (pixels, list))| {
        let cells = list.iter().filter_map(|&i| projected[i as usize].as_ref());
        let first_row = band * BAND;
        if sort_pixels {
            draw_sorted(job, cells, first_row, pixels);
        } else {
            draw_in_order(job, cells, first_row, pixels);
        }
    });
}

fn project(job: &Job, index: u32) -> Option<Projected> {
    let names = job.mesh.cells[index as usize];
    let parity = if names[0] & NEGATIVE == 0 { 1.0 } else { -1.0 };
    let points = names.map(|v| job.mesh.points[(v & !NEGATIVE) as usize]);
    let vertices: [Vertex; 4] = points.map(|[x, y, z, _]| job.lens.vertex(Vec3::new(x, y, z)));
    let scalars = match job.mesh.cell_scalars.get(index as usize) {
        Some(&s) => [s; 4],
        None => points.map(|p| p[3]),
    };
    let cell = job.lens.project_cell(&vertices, scalars, parity);
    if cell.kind == Kind::Hidden {
        return None;
    }
    let [low, high] = job.lens.pixel_bounds(&vertices, cell.kind);
    let span = |low: f32, high: f32, pixels: u32| {
        // The pixels whose centres, at i + 1/2, lie between the bounds. A conversion of a float saturates.
        let middle = pixels as f32 * 0.5;
        let first = (low - MARGIN + middle - 0.5).ceil().max(0.0) as u32;
        let end = ((high + MARGIN + middle - 0.5).floor() + 1.0).max(0.0) as u32;
        [first, end.min(pixels)]
    };
    let columns = span(low.x, high.x, job.size[0]);
    let rows = span(low.y, high.y, job.size[1]);
    let seen = columns[0] < columns[1] && rows[0] < rows[1];
    let reference = job.lens.cell_reference(&vertices, scalars, cell.kind);
    let pieces = reference.s.map(|s| piece_at(job.pieces, s));
    seen.then_some(Projected { cell, reference, pieces, columns, rows })
}

/// For each band the cells that reach into it, in their order.
fn bin(projected: &[Option<Projected>], height: usize) -> Vec<Vec<u32>> {
    let mut bands = vec![Vec::new(); height.div_ceil(BAND)];
    for (i, cell) in projected.iter().enumerate() {
        if let Some(cell) = cell {
            for band in cell.rows[0] as usize / BAND..=(cell.rows[1] as usize - 1) / BAND {
                bands[band].push(i as u32);
            }
        }
    }
    bands
}

/// Calls `f` with the column and the fragment of every pixel of a row that a cell covers.
#[inline]
fn for_each_fragment(job: &Job, projected: &Projected, row: usize, mut f: impl FnMut(usize, Fragment)) {
    let y = row as f32 + 0.5 - job.size[1] as f32 * 0.5;
    let middle = job.size[0] as f32 * 0.5;
    for column in projected.columns[0]..projected.columns[1] {
        let at = Vec2::new(column as f32 + 0.5 - middle, y);
        if let Some(segment) = job.lens.cell_segment(&projected.cell, &projected.reference, at) {
            let color =
                integrate(job.pieces, projected.pieces, job.weights, segment.s_front, segment.s_back, segment.length);
            f(column as usize, Fragment { depth: segment.depth, color });
        }
    }
}

fn rows_in(projected: &Projected, first_row: usize, rows: usize) -> std::ops::Range<usize> {
    (projected.rows[0] as usize).max(first_row)..(projected.rows[1] as usize).min(first_row + rows)
}

/// Composites cells as they come, nearest first.
fn draw_in_order<'a>(job: &Job, cells: impl Iterator<Item = &'a Projected>, first_row: usize, pixels: &mut [[f32; 4]]) {
    let width = job.size[0] as usize;
    for projected in cells {
        for row in rows_in(projected, first_row, pixels.len() / width) {
            let line = &mut pixels[(row - first_row) * width..][..width];
            for_each_fragment(job, projected, row, |column, fragment| under(&mut line[column], fragment.color));
        }
    }
}

/// Collects each row's fragments, sorts every pixel's by depth and composites them.
fn draw_sorted<'a>(
    job: &Job,
    cells: impl Iterator<Item = &'a Projected> + Clone,
    first_row: usize,
    pixels: &mut [[f32; 4]],
) {
    let width = job.size[0] as usize;
    let mut columns: Vec<Vec<Fragment>> = vec![Vec::new(); width];
    for (row, line) in pixels.chunks_mut(width).enumerate() {
        let row = first_row + row;
        for projected in cells.clone().filter(|p| (p.rows[0] as usize..p.rows[1] as usize).contains(&row)) {
            for_each_fragment(job, projected, row, |column, fragment| columns[column].push(fragment));
        }
        for (pixel, fragments) in line.iter_mut().zip(&mut columns) {
            // Nearly sorted as they come: a stable sort takes the runs there are.
            fragments.sort_by(|a, b| a.depth.total_cmp(&b.depth));
            fragments.iter().for_each(|fragment| under(pixel, fragment.color));
            fragments.clear();
        }
    }
}

/// Adds what lies behind a pixel's colour so far.
#[inline]
fn under(pixel: &mut [f32; 4], color: [f32; 4]) {
    let transmittance = 1.0 - pixel[3];
    for i in 0..4 {
        pixel[i] += transmittance * color[i];
    }
}
