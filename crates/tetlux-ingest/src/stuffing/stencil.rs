//! What is left of a lattice tetrahedron inside the surface.

/// Corners of a tetrahedron of the mesh: a node of the lattice's twice, or the ends of the edge that is cut there, the
/// one inside first.
pub(super) type Corner = [usize; 2];

/// Calls `emit` with the tetrahedra inside, positively oriented, of a lattice tetrahedron of which the edges 0-1 and
/// 2-3 are long; `signs` are 1 for nodes inside, 0 on the surface, -1 outside.
///
/// What is cut off at one corner leaves quadrilaterals, whose diagonal both sides must choose alike. It goes from the
/// cut of a long edge, if there is one; if both are short the long edge beside them has an even and an odd end, and
/// the diagonal goes from the even one (the parity rule of Labelle and Shewchuk 2007).
pub(super) fn tetrahedra(signs: [i32; 4], even: impl Fn(usize) -> bool, mut emit: impl FnMut([Corner; 4])) {
    let whole = |i: usize| [i, i];
    let of = |sign: i32| (0..4).filter(move |&i| signs[i] == sign);
    let (inside, outside) = (of(1).collect::<Vec<_>>(), of(-1).collect::<Vec<_>>());
    // Whether the diagonal of the quadrilateral between two nodes inside and their cuts towards a third goes from x.
    let from_first = |x: usize, y: usize, out: usize| match (is_long(x, out), is_long(y, out)) {
        (true, _) => false,
        (_, true) => true,
        _ => even(x),
    };
    match (inside.as_slice(), outside.as_slice()) {
        ([], _) => {}
        (_, []) => emit([0, 1, 2, 3].map(whole)),
        // A corner: the cuts take the place of the nodes outside.
        (&[x], _) => emit([0, 1, 2, 3].map(|i| if signs[i] < 0 { [x, i] } else { whole(i) })),
        // A pyramid on a quadrilateral, its tip on the surface.
        (&[x, y], &[out]) => {
            let (x, y) = if from_first(x, y, out) { (x, y) } else { (y, x) };
            let Some(tip) = of(0).next() else { return };
            emit(turned([whole(x), whole(y), [y, out], whole(tip)]));
            emit(turned([whole(x), [y, out], [x, out], whole(tip)]));
        }
        // A prism between two nodes with the cuts near them; a diagonal from the first node to the second's cut, or
        // the other way, for either cut. On the surface, where no neighbour is, what fits these.
        (&[x, y], &[out, other]) => {
            let nodes = [whole(x), whole(y)];
            let [near, far] = [out, other].map(|out| [[x, out], [y, out]]);
            let columns = match (from_first(x, y, out), from_first(x, y, other)) {
                (true, true) => [nodes, near, far],
                (true, false) => [far, nodes, near],
                (false, true) => [near, nodes, far],
                (false, false) => [near, far, nodes],
            };
            prism(columns, &mut emit);
        }
        // A prism between three nodes and their cuts.
        (&[a, b, c], &[out]) => {
            let mut nodes = [a, b, c];
            nodes.sort_unstable_by(|&x, &y| from_first(y, x, out).cmp(&from_first(x, y, out)));
            prism(nodes.map(|x| [whole(x), [x, out]]), &mut emit);
        }
        _ => {}
    }
}

/// Whether the edge between two nodes is long.
fn is_long(a: usize, b: usize) -> bool {
    a / 2 == b / 2
}

/// Three tetrahedra of a prism given as its three columns: each diagonal goes from the upper end of the earlier
/// column to the lower end of the later one.
fn prism(columns: [[Corner; 2]; 3], emit: &mut impl FnMut([Corner; 4])) {
    let [[a, d], [b, e], [c, f]] = columns;
    [[a, b, c, f], [a, b, e, f], [a, d, e, f]].into_iter().for_each(|corners| emit(turned(corners)));
}

/// A tetrahedron, turned round if it is negatively oriented. That does not depend on where the cuts are, so that it is
/// decided with all of them in the middle of their edges.
fn turned(mut corners: [Corner; 4]) -> [Corner; 4] {
    const NODES: [[i32; 3]; 4] = [[0, 0, 0], [2, 0, 0], [1, 1, 1], [1, -1, 1]];
    // Doubled, so that the middles are whole.
    let [a, b, c, d] = corners.map(|[i, j]| [0, 1, 2].map(|k| NODES[i][k] + NODES[j][k]));
    let from_a = |p: [i32; 3]| [0, 1, 2].map(|k| p[k] - a[k]);
    let ([bx, by, bz], [cx, cy, cz], [dx, dy, dz]) = (from_a(b), from_a(c), from_a(d));
    if (by * cz - bz * cy) * dx + (bz * cx - bx * cz) * dy + (bx * cy - by * cx) * dz < 0 {
        corners.swap(2, 3);
    }
    corners
}

#[cfg(test)]
pub(super) mod tests;
