//! Which shaders a picture needs, and what they bind: its method as composition.

use tetlux_scene::{CellProjection, Classification, Integrator, Interpolation, Plan, Target};
use tetlux_shaders::{Choice, DEFAULTS, choose};

/// What makes one set of pipelines differ from another.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) struct Variant {
    pub(crate) orthographic: bool,
    pub(crate) cell_data: bool,
    pub(crate) projection: CellProjection,
    pub(crate) interpolation: Interpolation,
    pub(crate) integrator: Integrator,
    pub(crate) classification: Classification,
    pub(crate) target: Target,
}

/// What a draw call takes a cell.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Geometry {
    /// The compute stage that writes the projected cells, if there is one: its module, which is its entry point too.
    pub(crate) compute: Option<&'static str>,
    /// What that stage writes a cell.
    pub(crate) bytes: u64,
    /// Vertices a cell.
    pub(crate) vertices: u32,
    /// They are drawn by these indices, seen counter-clockwise from the front.
    pub(crate) indices: Option<&'static [u32]>,
}

/// Bytes of a projected cell: `Cell` of shaders/lib/cell.wgsl.
pub(crate) const CELL_BYTES: u64 = 80;

/// Bytes of a cell of balanced cell projection: `Balanced` of shaders/lib/balanced.wgsl.
pub(crate) const BALANCED_BYTES: u64 = 32;

/// The faces of a positively oriented cell, counter-clockwise from outside.
const FACES: [u32; 12] = [1, 2, 3, 0, 3, 2, 0, 1, 3, 0, 2, 1];

/// A buffer of bind group 0, numbered as its binding.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Binding {
    View = 0,
    Pieces = 1,
    Points = 2,
    Cells = 3,
    CellScalars = 4,
    Order = 5,
}

impl Variant {
    pub(crate) fn new(plan: &Plan, cell_data: bool) -> Variant {
        Variant {
            orthographic: plan.view.orthographic,
            cell_data,
            projection: plan.projection,
            interpolation: plan.interpolation,
            integrator: plan.integrator,
            classification: plan.classification,
            target: plan.target,
        }
    }

    /// The modules that stand for the axes of the shaders.
    pub(crate) fn choices(&self) -> Vec<Choice> {
        let (quantity, shading) = match self.classification {
            Classification::Vertex => ("quantity::color", "shading::vertex"),
            Classification::Auto | Classification::PostExact => ("quantity::scalar", "shading::post_exact"),
        };
        let weights = match self.integrator {
            Integrator::Average => "weights::average",
            Integrator::Linear => "weights::linear",
            Integrator::Auto | Integrator::Direct => "weights::direct",
            Integrator::Symmetric => "weights::symmetric",
        };
        let geometry = match (self.projection, self.interpolation) {
            (CellProjection::Balanced, _) => "geometry::balanced",
            (CellProjection::Vicp, _) => "geometry::vicp",
            (_, Interpolation::Auto | Interpolation::Ray) => "geometry::ray",
        };
        let data = if self.cell_data { "data::cell" } else { "data::point" };
        let output = if self.target == Target::Rgba8Dither { "output::dither" } else { "output::plain" };
        choose(
            DEFAULTS,
            &[
                ("data", data),
                ("geometry", geometry),
                ("output", output),
                ("quantity", quantity),
                ("shading", shading),
                ("weights", weights),
            ],
        )
    }

    pub(crate) fn geometry(&self) -> Geometry {
        let pt = Geometry { compute: Some("stages::project"), bytes: CELL_BYTES, vertices: 6, indices: None };
        match (self.projection, self.interpolation) {
            (CellProjection::Balanced, _) => {
                let compute = Some("stages::balance");
                Geometry { compute, bytes: BALANCED_BYTES, vertices: 4, indices: Some(&FACES) }
            }
            (CellProjection::Vicp, _) => Geometry { vertices: 12, ..pt },
            (_, Interpolation::Auto | Interpolation::Ray) => pt,
        }
    }

    /// The buffers of bind group 0 that the shaders read, ascending.
    pub(crate) fn bindings(&self) -> Vec<Binding> {
        let mut bindings = vec![Binding::View, Binding::Pieces, Binding::Points, Binding::Cells];
        if self.cell_data {
            bindings.push(Binding::CellScalars);
        }
        if self.projection != CellProjection::March {
            bindings.push(Binding::Order);
        }
        bindings
    }

    /// The format of the picture on the device.
    pub(crate) fn format(&self) -> wgpu::TextureFormat {
        match self.target {
            Target::Rgba8 | Target::Rgba8Dither => wgpu::TextureFormat::Rgba8Unorm,
            Target::Rgba16f => wgpu::TextureFormat::Rgba16Float,
            Target::Auto | Target::Rgba32f => wgpu::TextureFormat::Rgba32Float,
        }
    }
}
