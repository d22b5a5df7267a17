use super::*;

/// The nearest point of a triangle is no farther than any of many spread over it, and is one of its own.
#[test]
fn the_nearest_point_of_a_triangle_is_in_it_and_nearest() {
    let triangle = [DVec3::new(0.0, 0.0, 1.0), DVec3::new(3.0, 0.5, 1.5), DVec3::new(1.0, 2.0, 0.0)];
    let [a, b, c] = triangle;
    for i in 0..1000u32 {
        // Points spread through a box round it.
        let p = DVec3::new(f64::from(i % 10) - 3.0, f64::from(i / 10 % 10) - 4.0, f64::from(i / 100) - 4.0) * 0.9;
        let q = closest(&triangle, p);
        let weights = [(b, c), (c, a), (a, b)].map(|(u, v)| (u - q).cross(v - q).length());
        // Areas of the parts sum to the whole only inside; both are rounded.
        assert!((weights.iter().sum::<f64>() - (b - a).cross(c - a).length()).abs() < 1e-12);
        for (u, v) in (0..=20u32).flat_map(|u| (0..=20 - u).map(move |v| (f64::from(u) / 20.0, f64::from(v) / 20.0))) {
            assert!(q.distance(p) <= (a + (b - a) * u + (c - a) * v).distance(p) + 1e-12);
        }
    }
}

#[test]
fn a_triangle_without_area_is_its_edges() {
    let flat = [DVec3::ZERO, DVec3::new(1.0, 0.0, 0.0), DVec3::new(3.0, 0.0, 0.0)];
    assert_eq!(closest(&flat, DVec3::new(2.0, 1.0, 0.0)), DVec3::new(2.0, 0.0, 0.0));
    assert_eq!(closest(&flat, DVec3::new(5.0, 1.0, 0.0)), DVec3::new(3.0, 0.0, 0.0));
}
