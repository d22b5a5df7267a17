//! Adaptive sampling (Moreland and Angel 2004, section 3.2): a cell is drawn once for every piece of the transfer function
//! that its scalars meet, in the order in which rays meet the pieces.

use glam::{DMat3, DVec3};
use rayon::prelude::*;
use tetlux_mesh::TetMesh;
use tetlux_optics::transfer_f32::{Piece, piece_at};
use tetlux_scene::View;

use crate::device_mesh::{DeviceMesh, NEGATIVE, ascending};

/// The cells of `order`, each as often as it meets pieces, and the piece of each: nearest first if `order` is.
///
/// The scalar is linear in a cell, so that rays from one eye all leave from one value, that of the scalar extrapolated
/// to the eye: along each of them scalars move away from it.
pub(crate) fn entries(
    mesh: &TetMesh,
    device: &DeviceMesh,
    pieces: &[Piece],
    view: &View,
    order: &[u32],
) -> (Vec<u32>, Vec<u32>) {
    let cut = |&cell: &u32| -> Vec<(u32, u32)> {
        let names = ascending(mesh.cells()[cell as usize]).map(|v| (v & !NEGATIVE) as usize);
        let scalars = match device.own_scalar(cell) {
            Some(s) => [s; 4],
            None => names.map(|v| device.points[v][3]),
        };
        let low = scalars.into_iter().fold(f32::INFINITY, f32::min);
        let high = scalars.into_iter().fold(f32::NEG_INFINITY, f32::max);
        let mut met: Vec<usize> = (piece_at(pieces, low)..=piece_at(pieces, high)).collect();
        if met.len() > 1 {
            let key = nearness(mesh, names, scalars.map(f64::from), view);
            met.sort_by(|&a, &b| key(pieces[a]).total_cmp(&key(pieces[b])));
        }
        met.into_iter().map(|piece| (cell, piece as u32)).collect()
    };
    let all: Vec<Vec<(u32, u32)>> = order.par_iter().map(cut).collect();
    all.into_iter().flatten().unzip()
}

/// A number of each piece that grows along rays.
fn nearness(mesh: &TetMesh, names: [usize; 4], s: [f64; 4], view: &View) -> impl Fn(Piece) -> f64 {
    let p = names.map(|v| mesh.points()[v].as_dvec3());
    // The rows are the edges from vertex 0: their products with the gradient are the differences of the scalar.
    let edges = DMat3::from_cols(p[1] - p[0], p[2] - p[0], p[3] - p[0]).transpose();
    let gradient = edges.inverse() * DVec3::new(s[1] - s[0], s[2] - s[0], s[3] - s[0]);
    let eye = view.eye - mesh.origin() - p[0];
    let (orthographic, slope) = (view.orthographic, gradient.dot(view.forward));
    let at_eye = s[0] + gradient.dot(eye);
    move |piece| {
        let [low, high] = [piece.s[0], piece.s[1]].map(f64::from);
        if orthographic {
            return if slope >= 0.0 { low } else { -high };
        }
        (low - at_eye).max(at_eye - high).max(0.0)
    }
}

#[cfg(test)]
mod tests {
    use tetlux_mesh::procedural::{self, Split};
    use tetlux_mesh::{Component, Field};
    use tetlux_optics::transfer::{ColorNode, OpacityNode, TransferFunction};
    use tetlux_optics::transfer_f32::pieces;
    use tetlux_scene::{Camera, Projection};

    use super::*;

    /// A cube of six cells with the scalar x from 0 to 1 and control points at 1/4, 1/2 and 3/4: every cell spans them all.
    #[test]
    fn a_cell_meets_every_piece_from_the_eye_on() {
        let parts = procedural::cuboid([1; 3], Split::Six, [DVec3::ZERO, DVec3::ONE]);
        let field = Field::point("x", 1, parts.sample(|p| p.x));
        let mesh = TetMesh::assemble(&parts.points, &parts.cells, vec![field]).unwrap();
        let scalar = mesh.scalar("x", Component::Magnitude).unwrap();
        let nodes = [0.25, 0.5, 0.75].map(|s| OpacityNode { s, opacity: s }).to_vec();
        let transfer = TransferFunction::new(vec![ColorNode { s: 0.0, rgb: [1.0; 3] }], nodes).unwrap();
        let pieces = pieces(&transfer, scalar.range, 1.0);
        assert_eq!(pieces.len(), 5, "below 0 (colour), 0 to 1/4, two between, above 3/4");
        let device = DeviceMesh::new(&mesh, &scalar, &[]);
        for (x, orthographic, expected) in [
            (-3.0, false, [1, 2, 3, 4]),
            (3.0, false, [4, 3, 2, 1]),
            (-3.0, true, [1, 2, 3, 4]),
            (3.0, true, [4, 3, 2, 1]),
        ] {
            let projection = if orthographic {
                Projection::Orthographic { parallel_scale: 1.0 }
            } else {
                Projection::Perspective { view_angle: 30.0 }
            };
            let position = DVec3::new(x, 0.4, 0.6);
            let focal_point = DVec3::splat(0.5);
            let camera = Camera { position, focal_point, view_up: DVec3::Z, projection, near: 0.0 };
            let view = camera.view([8, 8]).unwrap();
            let (cells, met) = entries(&mesh, &device, &pieces, &view, &[2, 5]);
            assert_eq!(cells, [2, 2, 2, 2, 5, 5, 5, 5]);
            assert_eq!(met, [expected, expected].concat(), "from {x}, orthographic {orthographic}");
        }
        // From inside, at x = 0.6, the piece of the eye comes first, then those on either side by distance.
        let camera = Camera {
            position: DVec3::new(0.6, 0.5, 0.5),
            focal_point: DVec3::new(1.0, 0.5, 0.5),
            view_up: DVec3::Z,
            projection: Projection::Perspective { view_angle: 60.0 },
            near: 0.0,
        };
        let (_, met) = entries(&mesh, &device, &pieces, &camera.view([8, 8]).unwrap(), &[0]);
        assert_eq!(met, [3, 2, 4, 1]);
    }
}
