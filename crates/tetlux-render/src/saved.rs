//! Bytes that a picture does without.

use tetlux_mesh::TetMesh;
use tetlux_scene::{Backend, Fate, Plan, Scene, Skip, SkipLine};
use tetlux_tables::TableSpec;

use crate::device_mesh::Data;
use crate::gpu::variant::Variant;
use crate::tiles;

/// Bytes of memory, of the device's where the graphics back end draws, that a line of the plan saves.
pub fn bytes_saved(scene: &Scene, mesh: &TetMesh, plan: &Plan, line: &SkipLine) -> u64 {
    if !matches!(line.fate, Fate::Skipped | Fate::Later) {
        return 0;
    }
    let gpu = plan.backend == Backend::Gpu;
    let data = Data::of(&scene.scalar, &scene.seen_without_data());
    let of_mesh = |points: u64, cells: u64| points * mesh.points().len() as u64 + cells * mesh.cells().len() as u64;
    // Projected, where the CPU back end does so many at a time, and listed in the order.
    let projected = |cells: usize| {
        let cells = cells as u64;
        if gpu { cells * Variant::new(plan, data, None, false).geometry().bytes } else { tiles::bytes_set_up(cells) }
    };
    match line.skip {
        Skip::Transparent | Skip::Faint | Skip::Outside => {
            projected(plan.cells.len() + line.cells) - projected(plan.cells.len()) + 4 * line.cells as u64
        }
        Skip::Order => of_mesh(0, 4),
        // Three coordinates in double precision.
        Skip::Gradients => of_mesh(24, 0),
        // The default table.
        Skip::Tables => 4 * TableSpec::default_q().size.map(u64::from).iter().product::<u64>(),
        // Points; the cells' vertices for graphics adapters alone; the cells' own scalars.
        Skip::Uploads => of_mesh(16, if gpu { 16 } else { 0 } + if data == Data::Point { 0 } else { 4 }),
        _ => 0,
    }
}
