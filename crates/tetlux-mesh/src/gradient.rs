//! Gradients at the vertices, and second derivatives along them.

use glam::DVec3;

use crate::{Location, ScalarField, TetMesh};

impl TetMesh {
    /// The gradient of a scalar at every point, in scalar units per world length: the mean of the gradients in the
    /// cells around it, weighted by their volumes.
    ///
    /// Exact where the scalar is linear. Cell data are first averaged to the points with the same weights. Cells of no
    /// volume and cells with a missing value count for nothing; a point of none but such cells has gradient zero.
    pub fn vertex_gradients(&self, scalar: &ScalarField) -> Vec<DVec3> {
        let averaged;
        let values = match scalar.location {
            Location::Point => &scalar.values,
            Location::Cell => {
                averaged = self.cell_to_point(&scalar.values);
                &averaged
            }
        };
        self.point_gradients(values)
    }

    /// The second derivative of point data along their gradient g at every point, per world length squared, from the
    /// gradients there ([`vertex_gradients`](Self::vertex_gradients)): that of |g|, so that
    ///
    /// ```text
    /// s'' = grad |g| . g / |g|                     (Kindlmann and Durkin 1998)
    /// ```
    ///
    /// Finite everywhere: 0 where there is no gradient, or none of a cell with data. Exact inside the mesh where the
    /// magnitude of the gradient is linear; on its surface, where gradients are one-sided, off by as much as the second
    /// derivative itself.
    pub fn second_derivatives(&self, scalar: &ScalarField, gradients: &[DVec3]) -> Vec<f64> {
        // Points without a value have no gradient, which is not a gradient of 0.
        let known = |i: usize| scalar.location == Location::Cell || scalar.values.get(i).is_some_and(|s| s.is_finite());
        let length = |i: usize| gradients.get(i).map_or(f64::NAN, |g| g.length());
        let lengths: Vec<f64> = (0..self.points.len()).map(|i| if known(i) { length(i) } else { f64::NAN }).collect();
        let turns = self.point_gradients(&lengths);
        let along = |(g, (turn, length)): (&DVec3, (&DVec3, &f64))| {
            let second = turn.dot(*g / *length);
            if *length > 0.0 && second.is_finite() { second } else { 0.0 }
        };
        gradients.iter().zip(turns.iter().zip(&lengths)).map(along).collect()
    }

    /// Gradients of values at the points, as [`vertex_gradients`](Self::vertex_gradients) has them.
    fn point_gradients(&self, values: &[f64]) -> Vec<DVec3> {
        let mut sums = vec![(DVec3::ZERO, 0.0); self.points.len()];
        for cell in &self.cells {
            let s = cell.map(|v| values[v as usize]);
            let (volume, area) = self.volume_and_faces(cell);
            if volume > 0.0 && s.iter().all(|v| v.is_finite()) {
                // Gradient times six volumes: differences against one vertex, so that a constant gives exactly zero.
                let sum = area[0] * (s[1] - s[0]) + area[1] * (s[2] - s[0]) + area[2] * (s[3] - s[0]);
                for &v in cell {
                    let (gradient, weight) = &mut sums[v as usize];
                    *gradient += sum;
                    *weight += volume;
                }
            }
        }
        sums.into_iter().map(|(g, w)| if w > 0.0 { g / w } else { DVec3::ZERO }).collect()
    }

    /// Means at the points of values in the cells, weighted by volume; NaN where no cell has a value.
    fn cell_to_point(&self, values: &[f64]) -> Vec<f64> {
        let mut sums = vec![(0.0, 0.0); self.points.len()];
        for (cell, &value) in self.cells.iter().zip(values).filter(|(_, v)| v.is_finite()) {
            let (volume, _) = self.volume_and_faces(cell);
            for &v in cell {
                let (sum, weight) = &mut sums[v as usize];
                *sum += volume * value;
                *weight += volume;
            }
        }
        sums.into_iter().map(|(sum, weight)| if weight > 0.0 { sum / weight } else { f64::NAN }).collect()
    }

    /// Six times the volume, and the gradients of the barycentric coordinates of vertices 1 to 3 times that.
    fn volume_and_faces(&self, cell: &[u32; 4]) -> (f64, [DVec3; 3]) {
        let p = cell.map(|v| self.points[v as usize].as_dvec3());
        let [a, b, c] = [p[1] - p[0], p[2] - p[0], p[3] - p[0]];
        let faces = [b.cross(c), c.cross(a), a.cross(b)];
        (a.dot(faces[0]), faces)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::procedural::{self, Split};
    use crate::{Component, Field};

    fn mesh(f: impl FnMut(DVec3) -> f64) -> TetMesh {
        // Coordinates are multiples of 1/64: exact in single precision.
        let parts = procedural::grid([6, 5, 4], Split::Five, |u| {
            let k = |x: f64, n: f64| (x * n).round();
            DVec3::new(k(u.x, 6.0) + k(u.y, 5.0) / 8.0, k(u.y, 5.0) * 1.25, k(u.z, 4.0).powi(2) / 4.0)
        });
        let values = parts.sample(f);
        TetMesh::assemble(&parts.points, &parts.cells, vec![Field::point("s", 1, values)]).unwrap()
    }

    #[test]
    fn exact_for_linear_fields() {
        let g = DVec3::new(2.0, -3.0, 0.5);
        let mesh = mesh(|p| g.dot(p) + 7.0);
        let gradients = mesh.vertex_gradients(&mesh.scalar("s", Component::Magnitude).unwrap());
        // Sums of a few dozen terms of order ten.
        assert!(gradients.iter().all(|h| h.distance(g) < 1e-12), "{:?}", gradients[0]);
    }

    #[test]
    fn a_constant_has_none() {
        let mesh = mesh(|_| 1e9);
        let gradients = mesh.vertex_gradients(&mesh.scalar("s", Component::Magnitude).unwrap());
        assert!(gradients.iter().all(|&h| h == DVec3::ZERO));
    }

    #[test]
    fn converges_for_a_quadratic_inside() {
        // The mean over cells that are symmetric about a vertex of a uniform grid is second-order accurate.
        let parts = procedural::cuboid([8; 3], Split::Six, [DVec3::ZERO, DVec3::splat(8.0)]);
        let values = parts.sample(|p| p.x * p.x);
        let mesh = TetMesh::assemble(&parts.points, &parts.cells, vec![Field::point("s", 1, values)]).unwrap();
        let gradients = mesh.vertex_gradients(&mesh.scalar("s", Component::Magnitude).unwrap());
        for (i, g) in gradients.iter().enumerate() {
            let p = mesh.world(i as u32);
            if p.cmpgt(DVec3::ZERO).all() && p.cmplt(DVec3::splat(8.0)).all() {
                assert!(g.distance(DVec3::new(2.0 * p.x, 0.0, 0.0)) < 1e-12, "{g} at {p}");
            }
        }
    }

    #[test]
    fn missing_values_and_cell_data() {
        let mut mesh = mesh(|p| p.x);
        let whole = mesh.vertex_gradients(&mesh.scalar("s", Component::Magnitude).unwrap());
        mesh.fields[0].values[0] = f64::NAN;
        let without = mesh.vertex_gradients(&mesh.scalar("s", Component::Magnitude).unwrap());
        assert!(without.iter().all(|g| g.is_finite()));
        assert!((without[100] - whole[100]).length() < 1e-12);
        let cells = mesh.cells.len();
        mesh.fields.push(Field::cell("c", 1, vec![4.0; cells]));
        let constant = mesh.vertex_gradients(&mesh.scalar("c", Component::Magnitude).unwrap());
        // Averages of a constant are constant to rounding.
        assert!(constant.iter().all(|g| g.length() < 1e-12));
    }
    /// Distances from the lowest corner of a grid of unit steps, less its outer layer: there gradients are one-sided.
    fn inner(mesh: &TetMesh, steps: f64) -> impl Iterator<Item = (usize, DVec3)> {
        let points = (0..mesh.points.len()).map(|i| (i, mesh.world(i as u32)));
        points.filter(move |(_, p)| p.cmpge(DVec3::splat(2.0)).all() && p.cmple(DVec3::splat(steps - 2.0)).all())
    }

    fn second(mesh: &TetMesh) -> Vec<f64> {
        let scalar = mesh.scalar("s", Component::Magnitude).unwrap();
        mesh.second_derivatives(&scalar, &mesh.vertex_gradients(&scalar))
    }

    fn unit_grid(steps: usize, f: impl FnMut(DVec3) -> f64) -> TetMesh {
        let parts = procedural::cuboid([steps; 3], Split::Six, [DVec3::ZERO, DVec3::splat(steps as f64)]);
        let values = parts.sample(f);
        TetMesh::assemble(&parts.points, &parts.cells, vec![Field::point("s", 1, values)]).unwrap()
    }

    #[test]
    fn a_linear_field_does_not_bend() {
        let mesh = mesh(|p| 2.0 * p.x - 3.0 * p.y + 0.5 * p.z);
        // The gradients differ by roundings, over cells a quarter wide and more.
        assert!(second(&mesh).iter().all(|s| s.abs() < 1e-11));
    }

    #[test]
    fn a_parabola_bends_evenly() {
        // s = (a.p)^2 / 2 has the gradient (a.p) a, of the length |a.p| |a|, which changes by |a|^2 along its direction.
        let a = DVec3::new(0.5, 0.25, -0.125);
        let mesh = unit_grid(8, |p| 0.5 * (a.dot(p) + 4.0).powi(2));
        let found = second(&mesh);
        for (i, p) in inner(&mesh, 8.0) {
            assert!((found[i] - a.length_squared()).abs() < 1e-12, "{} at {p}", found[i]);
        }
    }

    #[test]
    fn second_derivatives_are_finite_around_missing_values_and_flat_stretches() {
        let a = DVec3::new(0.5, 0.25, -0.125);
        let mut bent = unit_grid(10, |p| 0.5 * (a.dot(p) + 4.0).powi(2));
        let (whole, gap) = (second(&bent), DVec3::splat(3.0));
        let hole = (0..bent.points.len()).find(|&i| bent.world(i as u32) == gap).unwrap();
        bent.fields[0].values[hole] = f64::NAN;
        let without = second(&bent);
        assert!(without.iter().all(|s| s.is_finite()) && without[hole] == 0.0);
        // Two steps away its absence is not felt.
        let far: Vec<usize> = inner(&bent, 10.0).filter(|(_, p)| p.distance(gap) > 3.5).map(|(i, _)| i).collect();
        assert!(far.len() > 100 && far.iter().all(|&i| (without[i] - whole[i]).abs() < 1e-12));
        assert!(second(&unit_grid(3, |_| 1e9)).iter().all(|&s| s == 0.0));
        assert!(second(&unit_grid(3, |p| p.x * 1e300)).iter().all(|s| s.is_finite()));
    }
}
