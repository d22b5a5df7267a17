//! On which side of every face the eye is, and what follows for every cell: the arrows across interior faces.

use rayon::prelude::*;
use tetlux_mesh::TetMesh;

use crate::Facts;
use crate::exact::{Viewpoint, plane_sign};
use crate::facts::{LANES, Planes};

/// State of a cell: bits 0 to 3, an arrow to the neighbour across that face.
pub(crate) const ARROWS: u8 = 0b1111;

/// Codes of faces. Shifted right by 1 for the cell that does not own the face, bit [`LEAVES`] is set if an arrow goes
/// from that cell across the face, and bit [`ENTERS`] if the eye sees the cell through it.
const LEAVES: u8 = 0b0001;
const ENTERS: u8 = 0b0100;

/// The eye is on the owner's side, or beyond the face.
const INSIDE: u8 = LEAVES | ENTERS << 1;
const OUTSIDE: u8 = LEAVES << 1 | ENTERS;

/// No arrows cross faces of the boundary.
const BOUNDARY: u8 = ENTERS | ENTERS << 1;

/// Signs that took more than single precision.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) struct Doubts {
    pub(crate) in_double: usize,
    pub(crate) exact: usize,
}

/// Work that one thread does in one go: blocks of faces, and cells.
const BLOCKS: usize = 1024;
const CELLS: usize = 8192;

/// Finds the code of every face; the codes are padded to whole blocks.
pub(crate) fn face_codes(mesh: &TetMesh, facts: &Facts, eye: &Viewpoint, codes: &mut Vec<u8>) -> Doubts {
    codes.resize(facts.planes.len() * LANES, 0);
    let filter = Filter::new(facts, eye);
    let chunks = codes.par_chunks_mut(BLOCKS * LANES).zip(facts.planes.par_chunks(BLOCKS)).enumerate();
    chunks
        .map(|(chunk, (codes, planes))| {
            let mut doubts = Doubts::default();
            for (block, (codes, planes)) in codes.as_chunks_mut::<LANES>().0.iter_mut().zip(planes).enumerate() {
                *codes = filter.codes(planes);
                let first = (chunk * BLOCKS + block) * LANES;
                if !codes.contains(&0) && first + LANES <= facts.interior {
                    continue;
                }
                for (lane, code) in codes.iter_mut().enumerate().take(facts.owners.len().saturating_sub(first)) {
                    let face = first + lane;
                    if *code == 0 {
                        *code = certain_code(mesh, facts, face, eye, &mut doubts);
                    }
                    if face >= facts.interior {
                        *code &= BOUNDARY;
                    }
                }
            }
            doubts
        })
        .reduce(Doubts::default, |a, b| Doubts { in_double: a.in_double + b.in_double, exact: a.exact + b.exact })
}

fn certain_code(mesh: &TetMesh, facts: &Facts, face: usize, eye: &Viewpoint, doubts: &mut Doubts) -> u8 {
    let (_, vertices) = facts.vertices(mesh, face);
    let [a, b, c] = vertices.map(|v| mesh.points()[v as usize]);
    let sign = plane_sign(a, b, c, eye);
    doubts.in_double += 1;
    doubts.exact += usize::from(sign.exact);
    match sign.value {
        1 => OUTSIDE,
        -1 => INSIDE,
        _ => 0,
    }
}

/// The eye in single precision, and how far from a plane it must be for its side to be certain.
struct Filter {
    eye: [f32; 4],
    bound: f32,
}

impl Filter {
    /// 24 roundings of the largest coordinate, M: with normals and offsets rounded, the eye rounded, and three
    /// products and sums of at most 2 sqrt(3) M, the error is under 14, and a normal of double precision adds at
    /// most 4 where it is trusted at all.
    fn new(facts: &Facts, eye: &Viewpoint) -> Filter {
        let at = eye.at.as_vec3();
        let largest = if eye.finite { at.abs().max_element().max(facts.reach) } else { at.abs().max_element() };
        // Near the ends of its range, single precision decides nothing.
        if !(1e-30..1e30).contains(&largest) {
            return Filter { eye: [0.0; 4], bound: 1.0 };
        }
        let bound = 24.0 * (f32::EPSILON / 2.0) * largest;
        Filter { eye: [at.x, at.y, at.z, if eye.finite { 1.0 } else { 0.0 }], bound }
    }

    fn codes(&self, planes: &Planes) -> [u8; LANES] {
        let ([x, y, z, d], [ex, ey, ez, w]) = (planes, self.eye);
        std::array::from_fn(|i| {
            let s = x[i] * ex + y[i] * ey + z[i] * ez + d[i] * w;
            u8::from(s > self.bound) * OUTSIDE + u8::from(s < -self.bound) * INSIDE
        })
    }
}

/// The eye sees the owner of a face of the boundary through it.
pub(crate) fn is_entry(code: u8) -> bool {
    code & ENTERS != 0
}

/// The eye is behind a face of the boundary.
pub(crate) fn is_exit(code: u8) -> bool {
    code & ENTERS << 1 != 0
}

/// Finds the arrows of every cell; whether the eye is in, or on, a cell.
pub(crate) fn cell_arrows(facts: &Facts, codes: &[u8], arrows: &mut Vec<u8>) -> bool {
    arrows.resize(facts.faces.len(), 0);
    arrows
        .par_chunks_mut(CELLS)
        .zip(facts.faces.par_chunks(CELLS))
        .map(|(arrows, faces)| {
            let mut inside = false;
            for (arrows, faces) in arrows.iter_mut().zip(faces) {
                let [a, b, c, d] = faces.map(|face| codes[(face >> 1) as usize] >> (face & 1));
                *arrows = (a & 1) | (b & 1) << 1 | (c & 1) << 2 | (d & 1) << 3;
                let any = a | b | c | d;
                inside |= any & ENTERS == 0 && any != 0;
            }
            inside
        })
        .reduce(|| false, |a, b| a | b)
}

#[cfg(test)]
mod tests;
