//! Luminance and extinction that are linear in each cell, known before anything is drawn.

use rayon::prelude::*;
use tetlux_mesh::Location;
use tetlux_optics::no_data_f32::no_data;
use tetlux_scene::{Backend, Classification, Plan, Scene};

/// What luminance and optical depth per device unit are limited to: products with lengths stay finite.
const BRIGHTEST: f64 = 1e25;
const DENSEST: f64 = 1e15;

/// Luminance and, last, extinction per device unit.
#[derive(Debug)]
pub(crate) struct Attributes {
    /// Of the points, or of the cells.
    pub(crate) location: Location,
    /// One each; the last is that of cells without data.
    pub(crate) values: Vec<[f32; 4]>,
}

impl Attributes {
    /// Those that the plan has of an emphasis; else, for the CPU, the field classified where it has its values: a graphics
    /// adapter does that itself. None where the scalar is interpolated first. `extinction` is that of opacity 1 per device
    /// unit.
    pub(crate) fn new(scene: &Scene, plan: &Plan, extinction: f64) -> Option<Attributes> {
        let single = |[r, g, b, opacity]: [f64; 4]| {
            let [r, g, b] = [r, g, b].map(|l| l.min(BRIGHTEST) as f32);
            [r, g, b, (opacity * extinction).min(DENSEST) as f32]
        };
        let with_no_data = |mut values: Vec<[f32; 4]>| {
            values.push(no_data(&scene.no_data, extinction));
            values
        };
        if let Some(colors) = &plan.colors {
            let values = with_no_data(colors.par_iter().map(|&c| single(c)).collect());
            return Some(Attributes { location: Location::Point, values });
        }
        let transfer = scene
            .transfer()
            .filter(|_| plan.backend == Backend::Cpu && plan.classification == Classification::Vertex)?;
        let color = |&s: &f64| {
            if !s.is_finite() {
                return [0.0; 4];
            }
            let [r, g, b] = transfer.luminance(s);
            single([r, g, b, transfer.opacity(s)])
        };
        let values = with_no_data(scene.scalar.values.par_iter().map(color).collect());
        Some(Attributes { location: scene.scalar.location, values })
    }
}
