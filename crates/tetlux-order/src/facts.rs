//! What no view changes.

mod bytes;
mod convex;
mod surface;
#[cfg(test)]
mod tests;

use std::sync::OnceLock;
use std::sync::atomic::{AtomicU64, Ordering};

use glam::{DVec3, Vec3};
use rayon::prelude::*;
use tetlux_mesh::{FACES, NONE, TetMesh};

pub(crate) use self::surface::Surface;
use crate::power::Spheres;

/// Faces whose planes lie together.
pub(crate) const LANES: usize = 8;

/// So many cells may have one neighbour out of reach of a step.
const FAR_SHARE: usize = 32;

/// Planes of [`LANES`] faces: the unit normals' x, y and z, and the offsets.
pub(crate) type Planes = [[f32; LANES]; 4];

/// What ordering needs to know of a mesh, found once for all views.
#[derive(Debug, Clone)]
pub struct Facts {
    /// The same for these facts and their clones alone.
    pub(crate) id: u64,
    pub(crate) points: usize,
    /// Faces between two cells: the first ones.
    pub(crate) interior: usize,
    /// n . x + d is the signed distance of x, positive outside the cell that owns the face; all zero where the face
    /// is too near to a line for its normal to be trusted.
    pub(crate) planes: Vec<Planes>,
    /// For each face the cell that owns it, times 4, plus its place in that cell.
    pub(crate) owners: Vec<u32>,
    /// For each cell its faces, times 2, plus 1 where its neighbour owns them.
    pub(crate) faces: Vec<[u32; 4]>,
    /// Largest coordinate, relative to the mesh's origin.
    pub(crate) reach: f32,
    pub(crate) known: Known,
    /// Found when first asked for, as is what follows.
    pub(crate) surface: OnceLock<Surface>,
    pub(crate) steps: OnceLock<Option<Vec<[i16; 4]>>>,
    pub(crate) spheres: OnceLock<Spheres>,
}

/// Counts, and whether the mesh is convex.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) struct Known {
    pub(crate) components: usize,
    pub(crate) quads_split_both_ways: usize,
    pub(crate) folded_faces: usize,
    pub(crate) non_manifold_faces: usize,
    pub(crate) convex: bool,
}

fn fresh_id() -> u64 {
    static NEXT: AtomicU64 = AtomicU64::new(1);
    NEXT.fetch_add(1, Ordering::Relaxed)
}

impl Facts {
    /// Finds the facts of a mesh.
    pub fn new(mesh: &TetMesh) -> Facts {
        let (interior, owners, faces) = number_faces(mesh);
        let reach = mesh.points().par_iter().map(|p| p.abs().max_element()).reduce(|| 0.0, f32::max);
        let assembly = mesh.assembly();
        let mut facts = Facts {
            id: fresh_id(),
            points: mesh.points().len(),
            interior,
            planes: planes(mesh, &owners),
            owners,
            faces,
            reach,
            known: Known {
                components: mesh.components(),
                quads_split_both_ways: mesh.quads_split_both_ways(),
                folded_faces: assembly.faces_folded,
                non_manifold_faces: assembly.faces_non_manifold,
                convex: false,
            },
            surface: OnceLock::new(),
            steps: OnceLock::new(),
            spheres: OnceLock::new(),
        };
        facts.known.convex = facts.known.components == 1 && convex::is_convex(mesh, &facts);
        facts
    }

    /// Cells of the mesh.
    pub fn cells(&self) -> usize {
        self.faces.len()
    }

    /// Faces with a cell on one side only.
    pub fn boundary_faces(&self) -> usize {
        self.owners.len() - self.interior
    }

    /// The mesh fills a convex body once, certainly: no ray leaves it and comes back.
    pub fn convex(&self) -> bool {
        self.known.convex
    }

    /// Sets of cells connected through faces.
    pub fn components(&self) -> usize {
        self.known.components
    }

    /// Quadrilaterals of the boundary split along both diagonals: there the cells do not conform.
    pub fn quads_split_both_ways(&self) -> usize {
        self.known.quads_split_both_ways
    }

    /// Faces whose two cells lie on one side of them: no order exists there.
    pub fn folded_faces(&self) -> usize {
        self.known.folded_faces
    }

    /// Faces that three or more cells share.
    pub fn non_manifold_faces(&self) -> usize {
        self.known.non_manifold_faces
    }

    /// No face has the apex of the cell beyond it inside the circumsphere of the cell before it, and the mesh is
    /// convex: `power` orders it exactly. Found when first asked for.
    pub fn delaunay(&self, mesh: &TetMesh) -> bool {
        self.known.convex && self.spheres(mesh).locally_delaunay
    }

    pub(crate) fn surface(&self, mesh: &TetMesh) -> &Surface {
        self.surface.get_or_init(|| Surface::new(mesh, self))
    }

    /// For each cell the way to the neighbours, as differences of indices; zero where there is none or it is too far.
    /// `None` if that is the case for more than a few: then they are no shortcut.
    pub(crate) fn steps(&self, mesh: &TetMesh) -> Option<&[[i16; 4]]> {
        let find = || {
            let step = |cell: usize, neighbor: u32| i16::try_from(i64::from(neighbor) - cell as i64).unwrap_or(0);
            let around = mesh.neighbors().par_iter().enumerate();
            let steps: Vec<[i16; 4]> = around.map(|(c, around)| around.map(|n| step(c, n))).collect();
            let far = steps.par_iter().map(|steps| steps.iter().filter(|&&step| step == 0).count()).sum::<usize>();
            (far.saturating_sub(self.boundary_faces()) <= self.cells() / FAR_SHARE).then_some(steps)
        };
        self.steps.get_or_init(find).as_deref()
    }

    pub(crate) fn spheres(&self, mesh: &TetMesh) -> &Spheres {
        self.spheres.get_or_init(|| Spheres::new(mesh, self))
    }

    /// Bytes in memory, without what is found only when first asked for.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.planes[..]) + size_of_val(&self.owners[..]) + size_of_val(&self.faces[..])
    }

    /// The cell that owns a face, and the face's vertices counter-clockwise seen from outside it.
    pub(crate) fn vertices(&self, mesh: &TetMesh, face: usize) -> (u32, [u32; 3]) {
        owned(mesh, self.owners[face])
    }
}

fn owned(mesh: &TetMesh, owner: u32) -> (u32, [u32; 3]) {
    let cell = owner >> 2;
    (cell, FACES[(owner & 3) as usize].map(|i| mesh.cells()[cell as usize][i]))
}

/// Numbers the faces, interior ones first, each owned by the first of its cells: how many are interior, the owners,
/// and every cell's faces.
fn number_faces(mesh: &TetMesh) -> (usize, Vec<u32>, Vec<[u32; 4]>) {
    let (cells, neighbors) = (mesh.cells(), mesh.neighbors());
    let boundary: usize = neighbors.par_iter().map(|around| around.iter().filter(|&&n| n == NONE).count()).sum();
    let interior = (4 * cells.len() - boundary) / 2;
    let mut owners = vec![0u32; interior + boundary];
    let mut faces = vec![[0u32; 4]; cells.len()];
    let (mut next, mut next_outer) = (0, interior);
    for (c, around) in neighbors.iter().enumerate() {
        for (f, &neighbor) in around.iter().enumerate() {
            let face = if neighbor == NONE {
                &mut next_outer
            } else if (c as u32) < neighbor {
                let place = place_in_neighbor(mesh, c, f);
                faces[neighbor as usize][place] = (next as u32) << 1 | 1;
                &mut next
            } else {
                continue;
            };
            owners[*face] = (c as u32) << 2 | f as u32;
            faces[c][f] = (*face as u32) << 1;
            *face += 1;
        }
    }
    (interior, owners, faces)
}

/// The place that a cell's face has in the neighbour across it.
fn place_in_neighbor(mesh: &TetMesh, cell: usize, face: usize) -> usize {
    let neighbor = mesh.neighbors()[cell][face] as usize;
    let around = mesh.neighbors()[neighbor];
    let mut places = (0..4).filter(|&i| around[i] == cell as u32);
    match (places.next(), places.next()) {
        (Some(place), None) => place,
        // Flat cells can share several faces: the vertex opposite this one is not on it.
        _ => {
            let on_face = FACES[face].map(|i| mesh.cells()[cell][i]);
            (0..4)
                .find(|&i| around[i] == cell as u32 && !on_face.contains(&mesh.cells()[neighbor][i]))
                .unwrap_or_default()
        }
    }
}

fn planes(mesh: &TetMesh, owners: &[u32]) -> Vec<Planes> {
    owners
        .par_chunks(LANES)
        .map(|owners| {
            let mut planes = [[0.0; LANES]; 4];
            for (lane, &owner) in owners.iter().enumerate() {
                let (_, vertices) = owned(mesh, owner);
                let plane = plane(vertices.map(|v| mesh.points()[v as usize]));
                for (row, value) in planes.iter_mut().zip(plane) {
                    row[lane] = value;
                }
            }
            planes
        })
        .collect()
}

/// Sine of the angle between two edges of a face below which its normal, in double precision, may err by more than
/// single precision does.
const NEAR_COLLINEAR: f64 = 1e-8;

/// Unit normal and offset; zeros if the three points are nearly on a line.
fn plane([a, b, c]: [Vec3; 3]) -> [f32; 4] {
    let [a, b, c]: [DVec3; 3] = [a, b, c].map(|p| p.as_dvec3());
    let (u, v) = (b - a, c - a);
    let normal = u.cross(v);
    let square = normal.length_squared();
    if square <= NEAR_COLLINEAR * NEAR_COLLINEAR * (u.length_squared() * v.length_squared()) {
        return [0.0; 4];
    }
    let n = normal * (1.0 / square.sqrt());
    [n.x as f32, n.y as f32, n.z as f32, -n.dot(a) as f32]
}
