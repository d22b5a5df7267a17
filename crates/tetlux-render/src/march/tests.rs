use super::*;

fn corner(name: u32, x: f32, y: f32) -> Corner {
    Corner { name, offset: Vec2::new(x, y), depth: x + 2.0 * y }
}

#[test]
fn a_ray_passes_an_edge_on_one_side() {
    // On the edge, at its end, and beside it by less than rounding: never both, never neither.
    for (a, b) in
        [([1.0, 1.0], [-2.0, -2.0]), ([0.0, 0.0], [3.0, 1.0]), ([0.1, 0.3], [-0.3, -0.9]), ([0.0; 2], [0.0; 2])]
    {
        let (a, b) = (corner(4, a[0], a[1]), corner(9, b[0], b[1]));
        assert_ne!(turns(&a, &b), turns(&b, &a));
    }
    let (right, down) = (corner(1, 1.0, 0.0), corner(0, 0.0, 1.0));
    assert!(turns(&right, &down) && !turns(&down, &right), "from x towards y");
}

#[test]
fn crossings_are_where_the_offsets_balance() {
    // The origin is 1/2 a + 1/4 b + 1/4 c.
    let [a, b, c] = [corner(0, -1.0, 0.0), corner(1, 1.0, -2.0), corner(2, 1.0, 2.0)];
    assert_eq!(crossing(&a, &b, &c), Vec2::splat(0.25));
    assert_eq!(opposite_longest(&a, &b, &c), 0);
    // Depths are linear in the offsets: at the origin none, from whichever vertex.
    assert_eq!([depth_of(&a, &b, &c), depth_of(&b, &c, &a), depth_of(&c, &a, &b)], [0.0; 3]);
    // Seen edge-on there is no balance to find.
    let flat = corner(3, 3.0, 0.0);
    assert_eq!(crossing(&a, &flat, &a), Vec2::splat(1.0 / 3.0));
}

#[test]
fn a_ray_on_a_vertex_crosses_one_of_the_triangles_around_it() {
    // A vertex on the ray among others on the rows, columns and diagonals of a grid.
    let middle = corner(5, 0.0, 0.0);
    let ring = [[1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [-1.0, 1.0], [-1.0, 0.0], [-1.0, -1.0], [0.0, -1.0], [1.0, -1.0]];
    for first in 0..8 {
        // Whatever the names.
        let corners: Vec<Corner> =
            (0..8).map(|i| corner((i * 3 + first) % 8 + 6, ring[i as usize][0], ring[i as usize][1])).collect();
        let crossed = (0..8).filter(|&i| {
            let (a, b) = (&corners[i], &corners[(i + 1) % 8]);
            turns(&middle, a) && turns(a, b) && turns(b, &middle)
        });
        assert_eq!(crossed.count(), 1);
    }
}
