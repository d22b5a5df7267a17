//! Light with closed forms, and what a scene may hold.

use super::super::*;
use crate::testing::{Body, depth, fog, length_in_box, line, numbers, ray, transfer};
use tetlux_mesh::procedural::{Parts, Split, cuboid};

/// Rounding in sums along a ray of some hundred steps, for quantities of about unit size.
const ROUNDING: f64 = 1e-13;

fn block(corners: [[f64; 3]; 2], counts: [usize; 3]) -> Parts {
    cuboid(counts, Split::Six, corners.map(DVec3::from))
}

#[test]
fn a_constant_white_box_is_as_bright_as_opaque() {
    let corners = [[0.0; 3], [2.0, 3.0, 4.0]];
    let body = Body::by_point(&block(corners, [2, 3, 4]), |p| p.x);
    for opacity in [1e-12, 1e-3, 0.3, 10.0, 1e6] {
        let fog = fog(opacity);
        let oblique = ray([-1.0, 0.3, -2.0], [0.5, 0.4, 1.0]);
        let seen = body.caster(&fog).cast(&oblique);
        // alpha = 1 - exp(-tau d), and white light gathers to alpha.
        let expected = -(-opacity * length_in_box(&oblique, corners.map(DVec3::from))).exp_m1();
        // Relative, so that the thinnest fog is judged too.
        assert!((seen.alpha / expected - 1.0).abs() < ROUNDING, "{opacity}: {} for {expected}", seen.alpha);
        assert!((seen.color[1] - seen.alpha).abs() <= 1e-10_f64.min(1e-3 * expected));
    }
}

#[test]
fn a_unit_distance_divides_the_extinction() {
    let corners = [[0.0; 3], [1.0, 1.0, 2.0]];
    let body = Body::by_point(&block(corners, [1, 1, 1]), |_| 0.0);
    let fog = fog(0.75);
    let caster = Caster::new(Scene { unit_distance: 4.0, ..body.scene(&fog) }).unwrap();
    // 2 units of opacity 0.75 every 4 units.
    assert!((depth(caster.cast(&ray([0.5, 0.5, -1.0], [0.0, 0.0, 3.0]))) - 0.375).abs() < ROUNDING);
}

/// The error function by its power series, for arguments up to 2.
fn erf(x: f64) -> f64 {
    let mut term = x;
    let mut sum = x;
    for n in 1..60 {
        let n = f64::from(n);
        term *= -x * x / n;
        sum += term / (2.0 * n + 1.0);
    }
    sum * 2.0 / std::f64::consts::PI.sqrt()
}

#[test]
fn linear_extinction_has_a_gaussian_transmittance() {
    // s = z on [0, 2], tau = k z, so that the transmittance from the front is exp(-k z^2 / 2).
    let (k, d): (f64, f64) = (0.7, 2.0);
    // Four cells along z: their ends are exact in single precision, as the scalar there is.
    let body = Body::by_point(&block([[0.0; 3], [1.0, 1.0, d]], [3, 2, 4]), |p| p.z);
    let ramp = [[0.0, 0.0], [d, k * d]];
    let through = (-0.5 * k * d * d).exp();
    let into = ray([0.3, 0.4, -1.0], [0.0, 0.0, 1.0]);

    let constant = transfer(&ramp, &[[0.0, 0.8]]);
    let seen = body.caster(&constant).cast(&into);
    assert!((seen.alpha - (1.0 - through)).abs() < 1e-10);
    assert!((seen.color[0] - 0.8 * seen.alpha).abs() < 1e-10);

    // L = z: C = int z k z exp(-k z^2/2) dz = -d exp(-k d^2/2) + sqrt(pi/(2k)) erf(d sqrt(k/2)), by parts.
    let linear = transfer(&ramp, &[[0.0, 0.0], [d, d]]);
    let caster = body.caster(&linear);
    let normal = (std::f64::consts::FRAC_PI_2 / k).sqrt() * erf(d * (0.5 * k).sqrt());
    assert!((caster.cast(&into).color[2] - (normal - d * through)).abs() < 1e-10);

    // The same ray slanted: all lengths grow by 1/cos, z runs as before.
    let slanted = ray([0.0, 0.4, -1.0], [0.25, 0.0, 1.0]);
    let stretched = k * (1.0_f64 + 0.0625).sqrt();
    let through = (-0.5 * stretched * d * d).exp();
    let normal = (std::f64::consts::FRAC_PI_2 / stretched).sqrt() * erf(d * (0.5 * stretched).sqrt());
    assert!((caster.cast(&slanted).color[2] - (normal - d * through)).abs() < 1e-10);

    // From behind, with u = d - z the depth: tau = k (d - u), T = exp(-k (d u - u^2/2)). With v = z going down from d,
    // T = exp(-k (d^2 - v^2)/2) and C = int v k v T dv = d - exp(-k d^2/2) int_0^d exp(k v^2/2) dv, the last by series.
    let growth: f64 = (0..60)
        .scan(1.0, |term, n| {
            let now = *term / f64::from(2 * n + 1);
            *term *= 0.5 * k * d * d / f64::from(n + 1);
            Some(now)
        })
        .sum();
    let back = caster.cast(&ray([0.3, 0.4, 5.0], [0.0, 0.0, -1.0]));
    assert!((back.color[0] - (d - (-0.5 * k * d * d).exp() * d * growth)).abs() < 1e-10);
}

#[test]
fn rays_almost_along_faces_and_edges_see_the_scalar_where_they_are() {
    // A scalar linear over the whole mesh, s = x + 2y + 3z + 12 >= 0, and tau = s / 40: the optical depth is the mean of
    // tau at the ends times the length. Faces that nearly hold the ray are crossed at points that plain f64
    // determinants would place anywhere in them.
    let body = Body::by_point(&block([[-2.0; 3], [2.0; 3]], [8, 8, 8]), |p| p.x + 2.0 * p.y + 3.0 * p.z + 12.0);
    let ramp = transfer(&[[0.0, 0.0], [24.0, 0.6]], &[[0.0, 1.0]]);
    let caster = body.caster(&ramp);
    let lattice =
        [[0, 0, 1], [1, 0, 0], [1, 1, 0], [0, 1, 1], [1, 1, 1], [1, 2, 1]].map(|d| DVec3::from(d.map(f64::from)));
    let mut number = numbers(5);
    for (k, direction) in (0..30).flat_map(|k| lattice.map(|d| (k, d))) {
        let tiny = 10f64.powf(-8.0 - 0.3 * f64::from(k));
        let mut random = |scale: f64| DVec3::new(number() - 0.5, number() - 0.5, number() - 0.5) * scale;
        let slanted = direction + random(tiny);
        let through = DVec3::new(0.5, -0.5, 0.0) + random(tiny);
        let ray = line(through - 4.0 * slanted, slanted);
        let exact = {
            let corners = [DVec3::splat(-2.0), DVec3::splat(2.0)];
            let length = length_in_box(&ray, corners);
            // The middle of the ray's part in the box, from the length up to a cut half-way.
            let front = length_in_box(&Ray { end: 4.0, ..ray }, corners);
            let middle = through + slanted.normalize() * (0.5 * length - front);
            length * (middle.dot(DVec3::new(1.0, 2.0, 3.0)) + 12.0) / 40.0
        };
        let found = depth(caster.cast(&ray));
        assert!((found - exact).abs() < ROUNDING * exact.exp(), "{ray:?}: {found} for {exact}");
    }
}

#[test]
fn layers_are_composed_front_to_back() {
    // Cell data 0, 1, 2, 3 along z; opacity and luminance by value, with a clear layer among them.
    let parts = block([[0.0; 3], [1.0, 1.0, 4.0]], [1, 1, 4]);
    let layers = parts.cells.iter().map(|c| {
        let lowest = c.iter().map(|&v| parts.points[v as usize].z).fold(f64::INFINITY, f64::min);
        lowest.floor()
    });
    let body = Body::by_cell(&parts, layers.collect());
    let (tau, light) = ([0.5, 2.0, 0.0, 40.0], [0.2, 0.9, 5.0, 0.4]);
    let nodes = |values: [f64; 4]| [0, 1, 2, 3].map(|i| [i as f64, values[i]]);
    let functions = transfer(&nodes(tau), &nodes(light));
    let caster = body.caster(&functions);
    let compose = |order: [usize; 4]| {
        let (mut color, mut transmittance) = (0.0, 1.0);
        for i in order {
            let through = f64::exp(-tau[i]);
            color += transmittance * light[i] * (1.0 - through);
            transmittance *= through;
        }
        [color, 1.0 - transmittance]
    };
    for (z, order) in [(-1.0, [0, 1, 2, 3]), (9.0, [3, 2, 1, 0])] {
        let seen = caster.cast(&ray([0.4, 0.3, z], [0.0, 0.0, if z < 0.0 { 1.0 } else { -1.0 }]));
        let [color, alpha] = compose(order);
        assert!((seen.color[0] - color).abs() < 1e-10 && (seen.alpha - alpha).abs() < 1e-10);
    }
}

#[test]
fn a_cell_of_missing_data_has_the_look_that_it_is_given() {
    // Two cubes one behind the other; the nearer one has no data in its cells, or none at one of its far corners.
    let corners = [[0.0; 3], [1.0, 1.0, 2.0]];
    let parts = block(corners, [1, 1, 2]);
    let (near, far, opacity) = (0.4_f64, 0.3_f64, [0.25, 1.0, 3.0]);
    let no_data = NoData::new(opacity, near).unwrap();
    let fog = fog(far);
    let cells = (0..12).map(|c| if c < 6 { [f64::NAN, f64::INFINITY][c % 2] } else { 0.0 }).collect();
    for body in [
        Body::by_cell(&parts, cells),
        Body::by_point(&parts, |p| if p.z == 0.0 && p.x == p.y { f64::NEG_INFINITY } else { 0.0 }),
    ] {
        let caster = body.caster(&fog).with_no_data(no_data);
        let seen = caster.cast(&ray([0.45, 0.4, -1.0], [0.0, 0.0, 1.0]));
        let behind = (-near).exp() * -(-far).exp_m1();
        assert!((depth(seen) - near - far).abs() < ROUNDING);
        for channel in 0..3 {
            let expected = -(-near).exp_m1() * opacity[channel] + behind;
            assert!((seen.color[channel] - expected).abs() < 1e-10, "{:?}", seen.color);
        }
    }
}

#[test]
fn a_cell_of_missing_data_is_clear() {
    let parts = block([[0.0; 3], [1.0, 1.0, 2.0]], [1, 1, 2]);
    let fog = fog(1.0);
    let up = ray([0.3, 0.6, -1.0], [0.0, 0.0, 1.0]);
    // By cell: the six upper cells miss their value.
    let values = (0..12).map(|c| if c < 6 { 0.0 } else { f64::NAN }).collect();
    assert!((depth(Body::by_cell(&parts, values).caster(&fog).cast(&up)) - 1.0).abs() < ROUNDING);
    // By point: the top points are infinite, so every upper cell misses one.
    let body = Body::by_point(&parts, |p| if p.z > 1.5 { f64::INFINITY } else { 0.0 });
    let lower = depth(body.caster(&fog).cast(&up));
    assert!((lower - 1.0).abs() < ROUNDING, "{lower}");
}

#[test]
fn overlapping_bodies_add() {
    // Two boxes that share no vertex, one through the other: z in [0, 2] and in [1, 4].
    let mut parts = block([[0.0; 3], [1.0, 1.0, 2.0]], [1, 1, 1]);
    let first = parts.cells.len();
    parts.append(&block([[-0.5, -0.5, 1.0], [1.5, 1.5, 4.0]], [1, 1, 1]));
    let values = (0..parts.cells.len()).map(|c| if c < first { 1.0 } else { 3.0 }).collect();
    let body = Body::by_cell(&parts, values);
    let identity = transfer(&[[0.0, 0.0], [3.0, 3.0]], &[[0.0, 0.0], [3.0, 3.0]]);
    let caster = Caster::new(Scene { unit_distance: 4.0, ..body.scene(&identity) }).unwrap();
    let seen = caster.cast(&ray([0.4, 0.3, -1.0], [0.0, 0.0, 1.0]));
    // [0, 1]: tau 1/4, L 1. [1, 2]: tau 1, L (1 + 9)/4. [2, 4]: tau 3/4, L 3.
    let alpha = |depth: f64| -(-depth).exp_m1();
    let expected = alpha(0.25) + (-0.25_f64).exp() * (2.5 * alpha(1.0) + (-1.0_f64).exp() * 3.0 * alpha(1.5));
    assert!((seen.color[0] - expected).abs() < 1e-10, "{} for {expected}", seen.color[0]);
    assert!((depth(seen) - 2.75).abs() < ROUNDING * 2.75_f64.exp());
}

#[test]
fn what_does_not_fit_is_refused() {
    let body = Body::by_point(&block([[0.0; 3], [1.0; 3]], [1, 1, 1]), |p| p.x);
    let fog = fog(1.0);
    let mut foreign = body.scalar.clone();
    foreign.values.pop();
    let refused = |scene: Scene| Caster::new(scene).err().map(|e| e.to_string()).unwrap_or_default();
    let scene = body.scene(&fog);
    let length = refused(Scene { scalar: &foreign, ..scene });
    assert!(length.contains("\"s\" has 7 values for 8 points"), "{length}");
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert_eq!(refused(Scene { unit_distance: bad, ..scene }), ReferenceError::UnitDistance(bad).to_string());
        assert_eq!(refused(Scene { tolerance: bad, ..scene }), ReferenceError::Tolerance(bad).to_string());
    }
}

#[test]
fn rays_that_are_none_see_nothing() {
    let body = Body::by_point(&block([[0.0; 3], [1.0; 3]], [1, 1, 1]), |p| p.x);
    let fog = fog(1.0);
    let caster = body.caster(&fog);
    let good = line(DVec3::splat(0.5), DVec3::Z);
    assert!((depth(caster.cast(&good)) - 1.0).abs() < ROUNDING);
    for bad in [0.0, f64::NAN, f64::INFINITY, 1e-310] {
        assert_eq!(caster.cast(&Ray { direction: DVec3::new(bad, 0.0, 0.0), ..good }).alpha, 0.0, "{bad}");
    }
    for bad in [f64::NAN, f64::INFINITY, f64::MAX] {
        assert_eq!(caster.cast(&Ray { origin: DVec3::splat(bad), ..good }), Radiance::default(), "{bad}");
    }
    // Nothing lies between an end and a start after it.
    assert_eq!(caster.cast(&Ray { start: 0.2, end: -0.2, ..good }), Radiance::default());
}

#[test]
fn a_picture_is_its_rays_row_by_row_from_the_top() {
    let body = Body::by_point(&block([[0.0; 3], [1.0; 3]], [2, 2, 2]), |p| p.x + 2.0 * p.y);
    let functions = transfer(&[[0.0, 0.1], [3.0, 2.0]], &[[0.0, 0.3], [3.0, 1.0]]);
    let caster = body.caster(&functions);
    let (width, height) = (7, 5);
    let pixel = |x: u32, y: u32| {
        ray(
            [(f64::from(x) + 0.5) / f64::from(width), 1.0 - (f64::from(y) + 0.5) / f64::from(height), 3.0],
            [0.01, 0.02, -1.0],
        )
    };
    let rows = AtomicU32::new(0);
    let image = caster.render(width, height, pixel, |done| {
        rows.fetch_max(done, Ordering::Relaxed);
    });
    assert_eq!((image.len(), rows.into_inner()), (35, height));
    for y in 0..height {
        for x in 0..width {
            let seen = caster.cast(&pixel(x, y));
            let [r, g, b] = seen.color;
            assert_eq!(image[(y * width + x) as usize], [r, g, b, seen.alpha]);
        }
    }
    // The scalar grows to the right and upwards, and so does the opacity.
    assert!(image[6][3] > image[0][3] && image[0][3] > image[28][3]);
    assert!(caster.render(0, 3, pixel, |_| ()).is_empty());
}
