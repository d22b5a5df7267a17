//! Which tables of integrals a picture needs.

use tetlux_mesh::TetMesh;
use tetlux_scene::{Integrator, Plan, Scene};
use tetlux_tables::{Construction, Precision, TableKind, TableSpec, Thickness, TransferSpec};

/// The tables that [`crate::Renderer::render_with`] wants for this plan, in single precision: none for most. Those of psi
/// and q and those of Song et al. are the same for every scene; pre-integrated ones hold the scene's transfer function and
/// the largest thickness of the plan's cells.
pub fn table_specs(scene: &Scene, mesh: &TetMesh, plan: &Plan) -> Vec<TableSpec> {
    match plan.integrator {
        Integrator::Analytic => return TableSpec::widgets().to_vec(),
        Integrator::Approximate => return vec![TableSpec::front_back()],
        _ => {}
    }
    let Some(transfer) = scene.transfer() else { return Vec::new() };
    let table = |id: &str, size, kind| TableSpec { id: id.into(), kind, size, precision: Precision::F32 };
    let transfer_spec = || {
        let [low, high] = scene.scalar.range;
        // A constant field has one value, at the lower end: what lies above does not matter.
        let range = if low < high { [low, high] } else { [low, low + low.abs().max(1.0)] };
        TransferSpec::new(transfer, range, scene.unit_distance, largest_thickness(mesh, &plan.cells))
    };
    let pre_integrated = |thickness| TableKind::PreIntegrated {
        transfer: transfer_spec(),
        thickness,
        construction: Construction::Exact,
    };
    match plan.integrator {
        Integrator::Psi => vec![TableSpec::default_psi()],
        Integrator::Q => vec![TableSpec::default_q()],
        Integrator::Preint => vec![table("preint", [128, 128, 64], pre_integrated(Thickness::Uniform))],
        Integrator::PreintLog => vec![table("preint-log", [256, 256, 16], pre_integrated(Thickness::Logarithmic))],
        Integrator::PreintQ => vec![
            table("mean-extinction", [512, 512, 1], TableKind::MeanExtinction { transfer: transfer_spec() }),
            table("color-ratio", [128, 128, 32], TableKind::ColorRatio { transfer: transfer_spec() }),
        ],
        _ => Vec::new(),
    }
}

/// The longest edge of the cells, in world units: no segment is longer. 1 if there is none.
pub(crate) fn largest_thickness(mesh: &TetMesh, cells: &[u32]) -> f64 {
    let mut largest = 0.0f64;
    for &cell in cells {
        let p = mesh.cells()[cell as usize].map(|v| mesh.points()[v as usize].as_dvec3());
        for i in 1..4 {
            for j in 0..i {
                largest = largest.max(p[i].distance_squared(p[j]));
            }
        }
    }
    if largest > 0.0 { largest.sqrt() } else { 1.0 }
}
