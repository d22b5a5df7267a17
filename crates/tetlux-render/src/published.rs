//! The modes of Song et al. 2009 as they were published, with what they need of a picture.

use std::sync::Arc;

use tetlux_optics::image_f32::{self, Image};
use tetlux_optics::widget_f32::Widget;
use tetlux_optics::widgets_f32::{self, Integrated};
use tetlux_scene::{Integrator, Plan};
use tetlux_tables::Table;
use tetlux_tables::published::{WidgetTables, analytic, approximate};

/// Which, and its tables.
#[derive(Debug)]
pub(crate) enum Published {
    Analytic {
        gaussian: Arc<Table>,
        sine: Arc<Table>,
        triangle: Arc<Table>,
    },
    Approximate {
        table: Arc<Table>,
        pieces: u32,
        /// Length of the longest piece, in device units.
        unit: f32,
    },
}

impl Published {
    /// None if the plan has another integrator. `tables` are those of [`crate::table_specs`]; `longest` gives the longest
    /// segment, in device units.
    pub(crate) fn new(plan: &Plan, tables: &[Arc<Table>], longest: impl FnOnce() -> f64) -> Option<Published> {
        match (plan.integrator, tables) {
            (Integrator::Analytic, [gaussian, sine, triangle]) => {
                Some(Published::Analytic { gaussian: gaussian.clone(), sine: sine.clone(), triangle: triangle.clone() })
            }
            (Integrator::Approximate, [table]) => Some(Published::Approximate {
                table: table.clone(),
                pieces: plan.pieces,
                unit: (longest() / f64::from(plan.pieces)) as f32,
            }),
            _ => None,
        }
    }

    /// A segment of widgets; `emission` is unit distances per device unit.
    pub(crate) fn widgets(
        &self,
        widgets: &[Widget],
        front: [f32; 2],
        back: [f32; 2],
        length: f32,
        emission: f32,
    ) -> Integrated {
        match self {
            Published::Analytic { gaussian, sine, triangle } => {
                let tables = WidgetTables { gaussian, sine, triangle };
                Integrated { color: analytic(&tables, widgets, front, back, length, emission), pieces: 1 }
            }
            Published::Approximate { table, pieces, unit } => {
                let classify = |point| widgets_f32::classify(widgets, point);
                let color = approximate(table, classify, front, back, length, emission, *pieces, *unit);
                Integrated { color, pieces: *pieces }
            }
        }
    }

    /// A segment of an image, which has no analytic integrals: nothing, by those.
    pub(crate) fn image(
        &self,
        image: &Image,
        front: [f32; 2],
        back: [f32; 2],
        length: f32,
        emission: f32,
    ) -> Integrated {
        match self {
            Published::Analytic { .. } => Integrated::default(),
            Published::Approximate { table, pieces, unit } => {
                let classify = |point| image_f32::classify(image, point);
                let color = approximate(table, classify, front, back, length, emission, *pieces, *unit);
                Integrated { color, pieces: *pieces }
            }
        }
    }
}
