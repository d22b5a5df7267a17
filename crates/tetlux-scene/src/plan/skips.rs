//! The lines of the plan on what is not done.

use tetlux_mesh::TetMesh;

use crate::budget::Spending;
use crate::skip::Fate;
use crate::{Backend, CellProjection, Classification, Method, Order, Scene, Skip, SkipLine, Skips};

/// A line for every skip: what becomes of it in a picture by a method, all of it decided.
pub(super) fn lines(scene: &Scene, mesh: &TetMesh, method: &Method, spent: &Spending, skips: &Skips) -> Vec<SkipLine> {
    let line = |&skip: &Skip| {
        let (fate, why, cells) = fate(skip, scene, mesh, method, spent, skips);
        let kept = method.no_skip.contains(skip) && fate != Fate::Done;
        let (fate, why) = if kept { (Fate::Kept, "as asked".into()) } else { (fate, why) };
        SkipLine { skip, fate, why, cells }
    };
    Skip::ALL.iter().map(line).collect()
}

fn fate(
    skip: Skip,
    scene: &Scene,
    mesh: &TetMesh,
    method: &Method,
    spent: &Spending,
    skips: &Skips,
) -> (Fate, String, usize) {
    let gpu = method.backend == Backend::Gpu;
    let marches = gpu && method.projection == CellProjection::March;
    let tiles = gpu && method.projection == CellProjection::Tiles;
    let (kept, off) = (method.no_skip, |skip| method.no_skip.contains(skip));
    let skipped = |why: &str| (Fate::Skipped, why.to_string(), 0);
    let done = |why: &str| (Fate::Done, why.to_string(), 0);
    let later = |why: &str| (Fate::Later, why.to_string(), 0);
    let by_cells = |cells: usize, why: &str, none: &str| {
        let found = if cells > 0 || kept.contains(skip) { (Fate::Skipped, why) } else { (Fate::Done, none) };
        (found.0, found.1.to_string(), cells)
    };
    let searched = !matches!(method.order, Order::None | Order::Centroid | Order::Pixel | Order::Power);
    match skip {
        Skip::Transparent => by_cells(
            skips.transparent,
            "their opacity is zero on their whole range of scalars",
            "every cell has opacity somewhere in its range",
        ),
        Skip::Faint => by_cells(
            skips.faint,
            &format!("opacity {:.1e} and less, which all along a ray stays within a tenth of the budget", spent.faint),
            "no cell is so faint",
        ),
        Skip::Outside => by_cells(skips.outside, "no ray of the picture meets them", "every cell may be seen"),
        Skip::Opaque if gpu && !marches && !tiles => done("cells are drawn from back to front"),
        Skip::Opaque => {
            skipped(&format!("what lies behind pixels that hide all but {:.1e} of the light", spent.hidden))
        }
        Skip::Order if marches => done("the march finds the next cell itself"),
        Skip::Order if method.order == Order::None => match spent.order {
            Some(error) if scene.single_luminance().is_none() => {
                skipped(&format!("the volume is thin: no order changes a pixel by more than {error:.1e}"))
            }
            _ => skipped("one luminance throughout: the order does not matter"),
        },
        Skip::Order if off(Skip::Order) && scene.single_luminance().is_some() => skipped(""),
        Skip::Order => done("nearer cells hide those behind them"),
        Skip::LastOrder | Skip::Gaps | Skip::Components if !searched => done("no order is searched for"),
        Skip::LastOrder => later("the last order, if neither eye nor mesh has changed since"),
        Skip::Gaps if method.order != Order::Exact => done("this order does not look for gaps"),
        Skip::Gaps => later("no ray comes back, if the mesh is convex"),
        Skip::Components => later("no cells occlude one another, if the search for the order meets no cycle"),
        Skip::Cuts if !gpu && method.classification == Classification::Vertex => {
            done("what is classified at the vertices is linear in cells")
        }
        Skip::Cuts | Skip::Weights if scene.transfer().is_none() => done("the classification has no pieces"),
        Skip::Cuts if gpu => done("fragments find the pieces of their own segment"),
        Skip::Cuts => {
            let nodes = |transfer: &tetlux_optics::TransferFunction| transfer.control_points().len();
            match (&spent.transfer, scene.transfer()) {
                (Some((simple, error)), Some(transfer)) => skipped(&format!(
                    "in cells whose scalars hold no control point, and of {} control points {} are enough for an \
                     error of {error:.1e}",
                    nodes(transfer),
                    nodes(simple)
                )),
                _ => skipped("in cells whose scalars hold no control point"),
            }
        }
        Skip::Weights if gpu => done("fragments evaluate one integral for all pieces"),
        Skip::Weights if method.classification == Classification::Vertex => done("luminance is linear in cells"),
        Skip::Weights => {
            let flat = scene.transfer().map_or(0, |transfer| {
                transfer.pieces().iter().filter(|piece| piece.luminance[0] == piece.luminance[1]).count()
            });
            skipped(&format!("on the {} pieces of constant luminance opacity is all", flat + 2))
        }
        Skip::Gradients if scene.emphasis.is_some() => done("the emphasis takes them"),
        Skip::Gradients => match (scene.lighting.is_some(), scene.second.is_some()) {
            (true, _) => done("light takes them for normals"),
            (false, true) if super::of_gradients(scene).starts_with("computed") => {
                done("their magnitude is the second scalar")
            }
            _ => skipped(&format!("nothing asks for them at {} points", mesh.points().len())),
        },
        Skip::Tables if gpu && method.integrator.uses_table() => done("the integral is looked up"),
        Skip::Tables => skipped("the integral is evaluated directly"),
        Skip::Pipelines if gpu => skipped("only what this method uses is compiled, made and bound"),
        Skip::Pipelines => done("no graphics device is opened"),
        Skip::Uploads => later("the mesh of the last picture, if this one shows the same field of it"),
    }
}
