//! A sheet of thin, wide cells seen aslant, dense enough to be seen: its thickness is a small difference of large depths,
//! and single precision leaves less of it the thinner it is. It was drawn wrong by a hundredth, and stated to be right.

use glam::DVec3;
use tetlux_mesh::procedural::{Split, cuboid};
use tetlux_tests::{Way, largest_error, mesh_of, orthographic, perspective, plan, reference, render, scene, white};

use crate::TOLERANCE;

#[test]
fn a_sheet_is_as_wrong_as_is_stated() {
    for exponent in [0, 3, 7, 10, 13, 17, 20] {
        let thickness = 2f64.powi(-exponent);
        let corners = [DVec3::new(-1.0, -1.0, 0.0), DVec3::new(1.0, 1.0, thickness)];
        let mesh = mesh_of(&cuboid([2, 2, 1], Split::Six, corners), |p| p.z / thickness);
        let eye = DVec3::new(1.5, 2.0, 2.5);
        for camera in [perspective(eye, DVec3::ZERO, 40.0), orthographic(eye, DVec3::ZERO, 1.0)] {
            let mut scene = scene(&mesh, white(&[[0.0, 1.0]]), camera, [32, 32]);
            scene.unit_distance = thickness;
            let truth = reference(&mesh, &scene);
            for way in Way::RIGHT {
                let plan = plan(&mesh, &scene, way);
                let stated = plan.stated.total().unwrap_or(f64::INFINITY);
                let error = largest_error(render(&mesh, &scene, way).pixels(), &truth);
                println!("sheet of 2^-{exponent}, {way:?}: {error:.1e}, stated {stated:.1e}");
                assert!(error <= stated, "2^-{exponent}, {way:?}: {error:.1e}, stated {stated:.1e}");
                // What is stated grows no faster than what is lost, and a budget that is not kept is told of.
                assert!(exponent > 7 || error < TOLERANCE);
                assert!(stated < 1e-4 + 4e-7 / thickness, "2^-{exponent}, {way:?}: {stated:.1e}");
                let told = plan.warnings.iter().any(|warning| warning.contains("may not be kept"));
                assert_eq!(told, stated > scene.method.max_error, "{:?}", plan.warnings);
            }
        }
    }
}
