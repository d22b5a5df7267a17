//! The order in which a picture's cells are composited.

use std::sync::{Mutex, PoisonError};

use tetlux_order::{Method, Order, Orderer, Sampling, Thorough};
use tetlux_scene::{Backend, Order as Asked, Plan, Skip, View};

use crate::gpu::LARGEST_GROUP;
use crate::{Model, Stages};

/// The cells that the plan keeps, nearest first; as they come if the device sorts them.
pub(crate) fn order(
    orderer: &Mutex<Orderer>,
    model: &Model,
    plan: &Plan,
    on_device: bool,
    stages: &mut Stages,
) -> Order {
    let method = match plan.order {
        Asked::None => return Order { cells: plan.cells.clone(), ..Order::default() },
        Asked::Centroid if on_device => {
            let report = tetlux_order::OrderReport { method: Method::Centroid, ..Default::default() };
            return Order { cells: plan.cells.clone(), report, ..Order::default() };
        }
        Asked::Centroid | Asked::Pixel => {
            // Of the cells that are drawn alone: no other cell decides their places.
            let eye = sampling(&plan.view).eye();
            let cells = stages.run("order", || tetlux_order::centroid(model.mesh(), eye, &plan.cells));
            let end = cells.len() as u32;
            // Pixels are sorted the faster the better they are sorted already.
            let all = std::iter::once(0..end);
            let groups = all.filter(|group| plan.order == Asked::Pixel && group.len() > 1).collect();
            let report = tetlux_order::OrderReport { method: Method::Centroid, ..Default::default() };
            return Order { cells, groups, report };
        }
        Asked::Power => Method::Power,
        Asked::Mpvo => Method::Mpvo,
        Asked::Mpvonc => Method::Mpvonc,
        Asked::Exact | Asked::Auto => Method::Exact,
    };
    stages.run("facts", || model.facts());
    stages.run("order", || {
        let mut drawn = vec![false; model.mesh().cells().len()];
        plan.cells.iter().for_each(|&cell| drawn[cell as usize] = true);
        // An orderer that panicked is as good as a new one: it finds the whole order again.
        let mut orderer = orderer.lock().unwrap_or_else(PoisonError::into_inner);
        let [again, gaps, components] =
            [Skip::LastOrder, Skip::Gaps, Skip::Components].map(|skip| plan.kept.contains(skip));
        orderer.set_thorough(Thorough { again, gaps, components });
        let order = orderer.order(model.mesh(), model.facts(), &sampling(&plan.view), method);
        order.filter(|cell| drawn[cell as usize])
    })
}

/// Where an order that should be exact is not, and what is done there.
pub(crate) fn doubts(order: &Order, plan: &Plan) -> Vec<String> {
    let report = &order.report;
    let mut doubts = Vec::new();
    if report.overlap_pixels > 0 {
        doubts.push(format!(
            "cells overlap on the rays of {} pixels ({} cells of the boundary), where no order is right: their segments \
             are composited by the depths of their middles",
            report.overlap_pixels, report.overlap_cells
        ));
    }
    if report.folded_faces > 0 {
        doubts.push(format!(
            "{} faces have both their cells on one side: cells overlap there, and no order is right",
            report.folded_faces
        ));
    }
    let unsorted: u32 = order.groups.iter().map(|g| g.end - g.start).filter(|&cells| cells > LARGEST_GROUP).sum();
    if plan.backend == Backend::Gpu && unsorted > 0 {
        doubts.push(format!(
            "{unsorted} cells are in cycles of more than {LARGEST_GROUP}, too many to sort for every pixel here: they are \
             in centroid order; --backend cpu sorts any number"
        ));
    }
    doubts
}

/// The rays of a view, for [`tetlux_order`].
pub fn sampling(view: &View) -> Sampling {
    let View { eye, right, down, forward, size, pixel, orthographic, near } = *view;
    Sampling { eye, right, down, forward, pixel, size, near, orthographic }
}
