//! Joins the pieces of a data set to one mesh.

use std::path::PathBuf;

use glam::DVec3;
use tetlux_mesh::{Field, Location};

use super::ghosts::{DUPLICATE, Ghosts, HIDDEN, HIDDEN_POINT, LeftOut};
use super::lattice::Extent;
use crate::{MixedMesh, StructuredGrid};

/// A piece.
pub(super) struct Part {
    pub(super) mesh: MixedMesh,
    /// Its place in a lattice, of which the mesh is one grid; `None`: it stands alone.
    pub(super) extent: Option<Extent>,
    pub(super) ghosts: Ghosts,
}

/// Joins all pieces: those that fill a lattice to one grid, so that it is split into tetrahedra as one.
pub(super) fn join(path: PathBuf, mut parts: Vec<Part>) -> MixedMesh {
    if let Some(whole) = filled(&parts) {
        parts = vec![fill(whole, parts)];
    }
    let (mut joined, mut left) = (None::<MixedMesh>, LeftOut::default());
    for Part { mut mesh, ghosts, .. } in parts {
        ghosts.apply(&mut mesh, &mut left);
        match &mut joined {
            None => joined = Some(mesh),
            Some(joined) => joined.append(mesh),
        }
    }
    let mut joined = MixedMesh { path, ..joined.unwrap_or_default() };
    left.note(&mut joined);
    joined
}

/// The extent of several pieces of a lattice that have points enough to fill it.
fn filled(parts: &[Part]) -> Option<Extent> {
    if parts.len() < 2 {
        return None;
    }
    let mut whole = parts[0].extent?;
    let mut points = 0u64;
    for part in parts {
        whole = whole.with(&part.extent?);
        points += part.mesh.points.len() as u64;
    }
    // Where they are too few, as for two pieces far apart, memory for the whole would be without bound.
    whole.points().filter(|&n| n <= points && n <= u64::from(u32::MAX))?;
    Some(whole)
}

/// One grid of all pieces. A cell that some pieces hold as another's counts where it is their own; what no piece holds
/// is hidden; a field that is not in every piece is left out.
fn fill(whole: Extent, parts: Vec<Part>) -> Part {
    let counts = whole.counts().map(|n| n as usize);
    let grid = StructuredGrid { first_point: 0, counts, blanked: None };
    let (points, cells) = (counts.iter().product::<usize>(), grid.hexahedra());
    let mut mesh = MixedMesh { points: vec![DVec3::ZERO; points], grids: vec![grid], ..MixedMesh::default() };
    let [mut point_marks, mut cell_marks] = [vec![HIDDEN_POINT; points], vec![HIDDEN; cells]];

    let same = |a: &Field, b: &Field| a.name == b.name && a.location == b.location && a.components == b.components;
    let everywhere = |f: &Field| parts.iter().all(|part| part.mesh.fields.iter().any(|g| same(f, g)));
    let mut alone = Vec::new();
    for field in parts.iter().flat_map(|part| &part.mesh.fields) {
        if mesh.fields.iter().any(|f| same(f, field)) || alone.contains(&field.name) {
            continue;
        }
        if !everywhere(field) {
            alone.push(field.name.clone());
            continue;
        }
        let tuples = if field.location == Location::Point { points } else { cells };
        mesh.fields.push(Field { values: vec![f64::NAN; tuples * field.components], ..field.clone() });
    }

    for Part { mesh: part, extent, ghosts } in parts {
        let Some(extent) = extent else { continue };
        whole.for_each_row(&extent, 0, |to, from, n| {
            mesh.points[to..to + n].copy_from_slice(&part.points[from..from + n]);
            match &ghosts.points {
                Some(marks) => point_marks[to..to + n].copy_from_slice(&marks[from..from + n]),
                None => point_marks[to..to + n].fill(0),
            }
        });
        let own = |c: usize| ghosts.cells.as_ref().is_none_or(|marks| marks[c] & DUPLICATE == 0);
        whole.for_each_row(&extent, 1, |to, from, n| {
            for i in (0..n).filter(|i| own(from + i)) {
                cell_marks[to + i] = ghosts.cells.as_ref().map_or(0, |marks| marks[from + i]);
            }
        });
        for field in &mut mesh.fields {
            let Some(values) = part.fields.iter().find(|f| same(f, field)).map(|f| &f.values) else { continue };
            let (c, cell) = (field.components, field.location == Location::Cell);
            whole.for_each_row(&extent, u64::from(cell), |to, from, n| {
                for i in (0..n).filter(|i| !cell || own(from + i)) {
                    let (to, from) = ((to + i) * c, (from + i) * c);
                    field.values[to..to + c].copy_from_slice(&values[from..from + c]);
                }
            });
        }
        part.notes.into_iter().for_each(|note| mesh.note(note));
    }
    for name in alone {
        mesh.note(format!("field \"{name}\" is not in every piece: it is left out"));
    }
    Part { mesh, extent: Some(whole), ghosts: Ghosts { cells: Some(cell_marks), points: Some(point_marks) } }
}
