//! Joins the blocks of a file to one mesh.

use tetlux_mesh::{Field, Location};

use super::{MixedCells, MixedMesh};
use crate::cell_type::POLYHEDRON;

/// A joined mesh has no more fields nor notes than this, so that many small blocks with a field each of their own do
/// not fill the memory with missing values.
const MOST_FIELDS: usize = 1000;

impl MixedMesh {
    /// Adds the points, cells and fields of another block, and what was noted of it. Points and cells are numbered on
    /// from those there are. A field that only one of the two has is missing (NaN) on the other, with a note; so is
    /// one that has another number of components there, under a name of its own.
    pub fn append(&mut self, other: MixedMesh) {
        let (points, listed, tuples) = (self.points.len(), self.cells.types.len(), self.cell_tuples());
        let (other_points, other_listed, other_tuples) =
            (other.points.len(), other.cells.types.len(), other.cell_tuples());
        self.points.extend(other.points);
        // More points than 32 bits can name are refused when the mesh is checked.
        self.cells.append(other.cells, points as u32);
        self.grids.extend(other.grids.into_iter().map(|mut grid| {
            grid.first_point = grid.first_point.saturating_add(points);
            grid
        }));

        let mut theirs: Vec<Option<Field>> = other.fields.into_iter().map(Some).collect();
        let mut names = Vec::new();
        for field in &mut self.fields {
            let same =
                |f: &Field| f.name == field.name && f.location == field.location && f.components == field.components;
            let partner = theirs.iter_mut().find(|f| f.as_ref().is_some_and(same)).and_then(Option::take);
            let (mine, added) = if field.location == Location::Point {
                ([points, 0], [other_points, 0])
            } else {
                ([listed, tuples - listed], [other_listed, other_tuples - other_listed])
            };
            if partner.is_none() && added != [0, 0] {
                names.push(field.name.clone());
            }
            join(field, mine, partner, added);
        }
        for field in theirs.into_iter().flatten() {
            let (mine, added) = if field.location == Location::Point {
                ([points, 0], [other_points, 0])
            } else {
                ([listed, tuples - listed], [other_listed, other_tuples - other_listed])
            };
            if self.fields.len() >= MOST_FIELDS {
                self.note(format!("field \"{}\" and perhaps others are left out: {MOST_FIELDS} are read", field.name));
                break;
            }
            if mine != [0, 0] {
                names.push(field.name.clone());
            }
            let mut name = field.name.clone();
            while self.fields.iter().any(|f| f.name == name && f.location == field.location) {
                name.push('\'');
            }
            let nothing = vec![f64::NAN; (mine[0] + mine[1]).saturating_mul(field.components)];
            let mut joined = Field { name, location: field.location, components: field.components, values: nothing };
            join(&mut joined, mine, Some(field), added);
            self.fields.push(joined);
        }
        for name in names {
            self.note(format!("field \"{name}\" is not on every block: it is missing (NaN) on the others"));
        }
        for note in other.notes {
            self.note(note);
        }
    }

    /// Adds a note that is not there yet.
    pub(crate) fn note(&mut self, note: String) {
        if self.notes.len() < MOST_FIELDS && !self.notes.contains(&note) {
            self.notes.push(note);
        }
    }
}

/// Puts the values of another block, NaN if it has none, behind those of the field; of each block the values of
/// `[points, 0]` or of `[listed cells, hexahedra of grids]`, the listed cells of both before the hexahedra of both.
fn join(field: &mut Field, mine: [usize; 2], other: Option<Field>, added: [usize; 2]) {
    let n = field.components;
    let mut values = other.map_or_else(Vec::new, |other| other.values);
    values.resize((added[0] + added[1]).saturating_mul(n), f64::NAN);
    field.values.resize((mine[0] + mine[1]).saturating_mul(n), f64::NAN);
    let rest = values.split_off(added[0] * n);
    if mine[1] == 0 {
        field.values.append(&mut values);
    } else {
        field.values.splice(mine[0] * n..mine[0] * n, values);
    }
    field.values.extend(rest);
}

impl MixedCells {
    /// Adds other cells, their points numbered on from `first_point`.
    fn append(&mut self, other: MixedCells, first_point: u32) {
        let (cells, indices, stream) = (self.types.len(), self.connectivity.len(), self.face_stream.len());
        if !other.face_offsets.is_empty() && self.face_offsets.is_empty() {
            self.face_offsets.resize(cells, Self::NO_FACES);
        }
        if !self.face_offsets.is_empty() && other.face_offsets.is_empty() {
            self.face_offsets.resize(cells + other.types.len(), Self::NO_FACES);
        }
        let shifted =
            other.face_offsets.iter().zip(&other.types).map(|(&start, &number)| {
                if number == POLYHEDRON { start.saturating_add(stream) } else { Self::NO_FACES }
            });
        self.face_offsets.extend(shifted);
        self.face_stream.extend(shift(other.face_stream, first_point));
        self.types.extend(other.types);
        self.connectivity.extend(other.connectivity.iter().map(|v| v.wrapping_add(first_point)));
        self.offsets.extend(other.offsets.iter().map(|end| end.saturating_add(indices)));
    }
}

/// The face stream with its point indices, not its counts, raised; from where on it makes no sense it stays as it is.
fn shift(mut stream: Vec<u32>, by: u32) -> Vec<u32> {
    let mut at = 0;
    while let Some(&faces) = stream.get(at) {
        at += 1;
        for _ in 0..faces {
            let Some(&length) = stream.get(at) else { return stream };
            let Some(face) = stream.get_mut(at + 1..).and_then(|rest| rest.get_mut(..length as usize)) else {
                return stream;
            };
            face.iter_mut().for_each(|v| *v = v.wrapping_add(by));
            at += 1 + length as usize;
        }
    }
    stream
}

#[cfg(test)]
mod tests;
