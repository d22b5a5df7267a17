//! Order by power: the eye's with respect to the circumspheres of the cells (Edelsbrunner 1990, An acyclicity theorem
//! for cell complexes in d dimensions).

use glam::{DVec3, Vec3};
use rayon::prelude::*;
use tetlux_mesh::{FACES, NONE, TetMesh};

use crate::Facts;
use crate::exact::Viewpoint;

/// The circumspheres of a mesh's cells.
#[derive(Debug, Clone)]
pub(crate) struct Spheres {
    /// Centre c, and |c|^2 - R^2, of every cell's: bit for bit the same where neighbours share one exactly.
    spheres: Vec<[f64; 4]>,
    /// Some neighbours share one.
    pub(crate) shared: bool,
    /// No face's sphere holds the apex beyond it.
    pub(crate) locally_delaunay: bool,
}

impl Spheres {
    pub(crate) fn new(mesh: &TetMesh, facts: &Facts) -> Spheres {
        let at = |v: u32| mesh.points()[v as usize];
        let mut spheres: Vec<[f64; 4]> =
            mesh.cells().par_iter().map(|cell| circumsphere(cell.map(at)).unwrap_or([f64::NAN; 4])).collect();
        // The apex beyond each interior face: inside the sphere, on it, or neither.
        let insides: Vec<i8> = facts.owners[..facts.interior]
            .par_iter()
            .map(|&owner| {
                let (cell, face) = ((owner >> 2) as usize, (owner & 3) as usize);
                let neighbor = mesh.neighbors()[cell][face] as usize;
                if spheres[cell][3].is_nan() || spheres[neighbor][3].is_nan() {
                    return 0;
                }
                let on_face = FACES[face].map(|i| mesh.cells()[cell][i]);
                let apex = mesh.cells()[neighbor].into_iter().find(|v| !on_face.contains(v));
                apex.map_or(0, |apex| in_sphere(mesh.cells()[cell].map(at), at(apex)))
            })
            .collect();
        let shared = insides.contains(&0);
        if shared {
            share(mesh, facts, &insides, &mut spheres);
        }
        Spheres { spheres, shared, locally_delaunay: !insides.contains(&1) }
    }

    /// Sorts `cells` by the eye's power, ascending; cells of one sphere keep their order.
    pub(crate) fn sort(&self, eye: &Viewpoint, cells: &mut [u32]) {
        // The eye's own square adds the same to all, and infinitely far away only the centre's depth counts.
        let key = |cell: u32| {
            let [x, y, z, w] = self.spheres[cell as usize];
            let along = eye.at.dot(DVec3::new(x, y, z));
            if eye.finite { w - 2.0 * along } else { -along }
        };
        let mut keyed: Vec<(f64, u32)> = cells.par_iter().map(|&cell| (key(cell), cell)).collect();
        radsort::sort_by_key(&mut keyed, |&(key, _)| key);
        cells.iter_mut().zip(keyed).for_each(|(cell, (_, sorted))| *cell = sorted);
    }
}

/// Gives cells of one sphere, joined through faces, the same bits; flat cells have those of a neighbour.
fn share(mesh: &TetMesh, facts: &Facts, insides: &[i8], spheres: &mut [[f64; 4]]) {
    let same = |cell: usize, face: usize| {
        let number = (facts.faces[cell][face] >> 1) as usize;
        mesh.neighbors()[cell][face] != NONE && insides[number] == 0
    };
    let mut seen = vec![false; spheres.len()];
    let mut stack = Vec::new();
    // Cells with a sphere of their own first: flat ones join them.
    let whole = (0..spheres.len()).filter(|&cell| !spheres[cell][3].is_nan());
    for first in whole.collect::<Vec<_>>() {
        if std::mem::replace(&mut seen[first], true) {
            continue;
        }
        let sphere = spheres[first];
        stack.push(first);
        while let Some(cell) = stack.pop() {
            let flat = spheres[cell][3].is_nan();
            spheres[cell] = sphere;
            for face in 0..4 {
                if !same(cell, face) {
                    continue;
                }
                let next = mesh.neighbors()[cell][face] as usize;
                // Through a flat cell, spheres on its two sides are not shared.
                let joins = !flat || spheres[next][3].is_nan();
                if joins && !std::mem::replace(&mut seen[next], true) {
                    stack.push(next);
                }
            }
        }
    }
    for sphere in spheres.iter_mut().filter(|s| s[3].is_nan()) {
        *sphere = [0.0; 4];
    }
}

/// Centre and |centre|^2 - radius^2; `None` if the cell is flat, or so nearly that its centre is out of reach.
fn circumsphere(corners: [Vec3; 4]) -> Option<[f64; 4]> {
    let [a, b, c, d] = corners.map(|p| p.as_dvec3());
    let (u, v, w) = (b - a, c - a, d - a);
    let volume = 2.0 * u.dot(v.cross(w));
    let sum = v.cross(w) * u.length_squared() + w.cross(u) * v.length_squared() + u.cross(v) * w.length_squared();
    let to_center = sum / volume;
    let center = a + to_center;
    // |c|^2 - R^2 = |a|^2 + 2 a . (c - a), without the difference of two large squares.
    let weight = a.length_squared() + 2.0 * a.dot(to_center);
    (volume != 0.0 && center.is_finite() && weight.is_finite()).then_some([center.x, center.y, center.z, weight])
}

/// 1 if a point is inside the sphere of a positively oriented cell, 0 if exactly on it.
fn in_sphere(corners: [Vec3; 4], p: Vec3) -> i8 {
    let [a, b, c, d, p] = [corners[0], corners[1], corners[2], corners[3], p].map(|p| {
        let p = p.as_dvec3();
        robust::Coord3D { x: p.x, y: p.y, z: p.z }
    });
    // Positively oriented for `robust` is negatively for us.
    let inside = -robust::insphere(a, b, c, d, p);
    i8::from(inside > 0.0) - i8::from(inside < 0.0)
}

#[cfg(test)]
mod tests;
