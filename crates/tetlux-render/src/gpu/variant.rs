//! Which shaders a picture needs, and what they bind: its method as composition.

use tetlux_scene::{CellProjection, Classification, Integrator, Interpolation, Plan, Target};
use tetlux_shaders::{Choice, DEFAULTS, choose};

use super::look::LookVariant;
use crate::device_mesh::Data;

/// What makes one set of pipelines differ from another.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) struct Variant {
    /// It draws cells without an order among themselves, sorted for every pixel.
    pub(crate) group: bool,
    pub(crate) orthographic: bool,
    pub(crate) data: Data,
    /// What there is beyond one field's transfer function.
    pub(crate) look: Option<LookVariant>,
    /// Luminance and extinction of the vertices are given.
    pub(crate) given: bool,
    pub(crate) projection: CellProjection,
    pub(crate) interpolation: Interpolation,
    pub(crate) integrator: Integrator,
    pub(crate) classification: Classification,
    pub(crate) target: Target,
    /// Opaque surfaces end rays.
    pub(crate) surfaces: bool,
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
    /// Cells are instances of one draw, rather than all vertices numbered through.
    pub(crate) instanced: bool,
    /// They are drawn by these indices, seen counter-clockwise from the front.
    pub(crate) indices: Option<&'static [u32]>,
}

/// Bytes of a projected cell: `Cell` of shaders/lib/cell.wgsl.
pub(crate) const CELL_BYTES: u64 = 80;

/// Bytes of a cell that is ready to be composited by tiles: `Ready` of shaders/lib/ready.wgsl.
pub(crate) const READY_BYTES: u64 = 272;

/// Bytes of a cell of balanced cell projection: `Balanced` of shaders/lib/balanced.wgsl.
pub(crate) const BALANCED_BYTES: u64 = 32;

/// The faces of a positively oriented cell, counter-clockwise from outside. Each has a first vertex of its own, which speaks
/// for it (shaders/geometry/balanced.wgsl).
const FACES: [u32; 12] = [1, 2, 3, 3, 2, 0, 0, 1, 3, 2, 1, 0];

/// A buffer of bind group 0, numbered as its binding.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Binding {
    View = 0,
    Pieces = 1,
    Points = 2,
    Cells = 3,
    CellScalars = 4,
    Order = 5,
    EntryPieces = 6,
    Attributes = 7,
    Seconds = 8,
    Gradients = 9,
    Look = 10,
    Widgets = 11,
    Texels = 12,
    Spent = 13,
    Seen = 14,
    GroupEnds = 15,
}

impl Binding {
    pub(crate) fn is_storage(self) -> bool {
        self.kind() != wgpu::BufferBindingType::Uniform
    }

    pub(crate) fn kind(self) -> wgpu::BufferBindingType {
        match self {
            // A look is none: Mesa's software driver makes the values of uniforms that alone decide a branch part of the
            // shader, and compiles that anew for every picture.
            Binding::View => wgpu::BufferBindingType::Uniform,
            other => wgpu::BufferBindingType::Storage { read_only: other != Binding::Spent },
        }
    }
}

impl Variant {
    pub(crate) fn new(plan: &Plan, data: Data, look: Option<LookVariant>, surfaces: bool) -> Variant {
        Variant {
            group: false,
            orthographic: plan.view.orthographic,
            data,
            look,
            given: plan.colors.is_some(),
            projection: plan.projection,
            interpolation: plan.interpolation,
            integrator: plan.integrator,
            classification: plan.classification,
            target: plan.target,
            surfaces,
        }
    }

    /// The same for groups: whatever the projection, each pixel finds its own segments.
    pub(crate) fn of_groups(self) -> Variant {
        match self.projection {
            // Tiles sort them as they come to them.
            CellProjection::Tiles => Variant { group: true, ..self },
            _ => Variant { group: true, projection: CellProjection::Pt, interpolation: Interpolation::Ray, ..self },
        }
    }

    /// The stage that makes the picture.
    pub(crate) fn stage(&self) -> &'static str {
        match (self.projection, self.group) {
            (CellProjection::Tiles, _) => "stages::tiles",
            (_, true) => "stages::group",
            (_, false) => "stages::draw",
        }
    }

    /// The modules that stand for the axes of the shaders.
    pub(crate) fn choices(&self) -> Vec<Choice> {
        let quantity = match self.classification {
            Classification::Vertex => "quantity::color",
            _ => "quantity::scalar",
        };
        let shading = match (self.integrator, self.classification) {
            (Integrator::Preint, _) => "shading::preint",
            (Integrator::PreintLog, _) => "shading::preint_log",
            (Integrator::PreintQ, _) => "shading::preint_q",
            (_, Classification::Vertex) => "shading::vertex",
            (_, Classification::PostClip) => "shading::post_clip",
            (_, Classification::Auto | Classification::PostExact) => "shading::post_exact",
        };
        let weights = match self.integrator {
            Integrator::Average => "weights::average",
            Integrator::Linear => "weights::linear",
            Integrator::Psi => "weights::psi",
            Integrator::Q => "weights::q",
            Integrator::Symmetric => "weights::symmetric",
            // Pre-integrated shading asks for no weights.
            _ => "weights::direct",
        };
        let interpolation = match self.interpolation {
            Interpolation::ScreenLinear => "interpolation::screen_linear",
            _ => "interpolation::perspective",
        };
        let geometry = match (self.projection, self.interpolation) {
            (CellProjection::Balanced, _) => "geometry::balanced",
            (CellProjection::Vicp, _) => "geometry::vicp",
            (_, Interpolation::Auto | Interpolation::Ray) => "geometry::ray",
            (_, Interpolation::Perspective | Interpolation::ScreenLinear) => "geometry::thick",
        };
        let source = match self.projection {
            CellProjection::Gator => "source::computed",
            _ => "source::stored",
        };
        let grouping = if self.group { "grouping::sorted" } else { "grouping::none" };
        let attributes = if self.given { "attributes::given" } else { "attributes::classified" };
        let data = match self.data {
            Data::Point => "data::point",
            Data::Cell => "data::cell",
            Data::Mixed => "data::mixed",
        };
        let surface = if self.surfaces { "surface::opaque" } else { "surface::none" };
        let output = match self.target {
            Target::Rgba8 => "output::straight",
            Target::Rgba8Dither => "output::dither",
            Target::Auto | Target::Rgba16f | Target::Rgba32f => "output::plain",
        };
        let choices = choose(
            DEFAULTS,
            &[
                ("attributes", attributes),
                ("data", data),
                ("geometry", geometry),
                ("grouping", grouping),
                ("interpolation", interpolation),
                ("output", output),
                ("quantity", quantity),
                ("shading", shading),
                ("source", source),
                ("surface", surface),
                ("weights", weights),
            ],
        );
        match self.look {
            Some(look) => choose(&choices, &look.choices()),
            None => choices,
        }
    }

    pub(crate) fn geometry(&self) -> Geometry {
        let pt = Geometry {
            compute: Some("stages::project"),
            bytes: CELL_BYTES,
            vertices: 6,
            instanced: false,
            indices: None,
        };
        match (self.projection, self.interpolation) {
            (CellProjection::Balanced, _) => {
                let compute = Some("stages::balance");
                Geometry { compute, bytes: BALANCED_BYTES, vertices: 4, indices: Some(&FACES), ..pt }
            }
            (CellProjection::Gator, _) => Geometry { compute: None, vertices: 12, instanced: true, ..pt },
            (CellProjection::Vicp, _) => Geometry { vertices: 12, ..pt },
            (_, Interpolation::Auto | Interpolation::Ray) => pt,
            (_, Interpolation::Perspective | Interpolation::ScreenLinear) => {
                Geometry { compute: Some("stages::decompose"), vertices: 12, ..pt }
            }
        }
    }

    /// The buffers of bind group 0 that the shaders read, ascending.
    pub(crate) fn bindings(&self) -> Vec<Binding> {
        let mut bindings = vec![Binding::View];
        if !self.integrator.is_pre_integrated() && !self.given && self.look.is_none_or(|look| look.has_pieces()) {
            bindings.push(Binding::Pieces);
        }
        bindings.extend([Binding::Points, Binding::Cells]);
        if self.data != Data::Point {
            bindings.push(Binding::CellScalars);
        }
        if self.projection != CellProjection::March {
            bindings.push(Binding::Order);
        }
        if self.classification == Classification::PostClip {
            bindings.push(Binding::EntryPieces);
        }
        if self.given {
            bindings.push(Binding::Attributes);
        }
        bindings.extend(self.look.iter().flat_map(LookVariant::bindings));
        if self.projection != CellProjection::March {
            bindings.push(Binding::Seen);
        }
        if self.projection == CellProjection::Tiles && self.group {
            bindings.push(Binding::GroupEnds);
        }
        bindings
    }

    /// The axes of the tables that are bound, beside their `Lookup`; none: bind group 2 is not there.
    pub(crate) fn tables(&self) -> &'static [wgpu::TextureViewDimension] {
        use wgpu::TextureViewDimension::{D2, D2Array, D3};
        match self.integrator {
            Integrator::Psi | Integrator::Q => &[D2],
            Integrator::Preint | Integrator::PreintLog | Integrator::Approximate => &[D3],
            Integrator::Analytic => &[D2Array],
            Integrator::PreintQ => &[D2, D3],
            _ => &[],
        }
    }

    /// The format of the picture on the device.
    pub(crate) fn format(&self) -> wgpu::TextureFormat {
        match self.target {
            Target::Rgba8 | Target::Rgba8Dither => wgpu::TextureFormat::Rgba8Unorm,
            Target::Rgba16f => wgpu::TextureFormat::Rgba16Float,
            Target::Auto | Target::Rgba32f => wgpu::TextureFormat::Rgba32Float,
        }
    }

    /// How fragments are composited: colour is multiplied by alpha in the shader, or, for targets of 8 bits, here.
    pub(crate) fn blend(&self) -> wgpu::BlendState {
        let premultiplied = wgpu::BlendState::PREMULTIPLIED_ALPHA_BLENDING;
        match self.target {
            Target::Rgba8 | Target::Rgba8Dither => wgpu::BlendState {
                color: wgpu::BlendComponent { src_factor: wgpu::BlendFactor::SrcAlpha, ..premultiplied.color },
                ..premultiplied
            },
            Target::Auto | Target::Rgba16f | Target::Rgba32f => premultiplied,
        }
    }
}

#[cfg(test)]
mod tests {
    use naga::valid::{Capabilities, ValidationFlags, Validator};
    use tetlux_scene::Method;

    use super::super::look::Classified;
    use super::*;

    const DATA: [Data; 3] = [Data::Point, Data::Cell, Data::Mixed];

    /// Every variant that a method which is not refused can have.
    fn variants() -> Vec<Variant> {
        let mut variants = Vec::new();
        for &projection in CellProjection::ALL {
            for &interpolation in Interpolation::ALL {
                for &integrator in Integrator::ALL {
                    for &classification in Classification::ALL {
                        let method =
                            Method { projection, interpolation, integrator, classification, ..Method::default() };
                        let decided = projection != CellProjection::Auto
                            && interpolation != Interpolation::Auto
                            && integrator != Integrator::Auto
                            && classification != Classification::Auto;
                        if decided && !integrator.is_for_two_fields() && method.refusal().is_none() {
                            let target = Target::ALL[variants.len() % Target::ALL.len()];
                            let orthographic = variants.len() % 2 != 0;
                            let variant = Variant {
                                group: false,
                                orthographic,
                                data: DATA[variants.len() % DATA.len()],
                                look: None,
                                given: false,
                                projection,
                                interpolation,
                                integrator,
                                classification,
                                target,
                                surfaces: variants.len() & 4 != 0,
                            };
                            variants.push(variant);
                            if classification == Classification::Vertex {
                                let data = [Data::Point, Data::Mixed][variants.len() % 2];
                                variants.push(Variant { given: true, data, ..variant });
                            }
                        }
                    }
                }
            }
        }
        variants
    }

    /// Every look, each with the geometries that draw it.
    fn looks() -> Vec<Variant> {
        let mut looks = Vec::new();
        for (function, integrator) in [
            (Classified::OneField, Integrator::Direct),
            (Classified::TwoFields, Integrator::Direct),
            (Classified::Widgets, Integrator::Adaptive),
            (Classified::Image, Integrator::Adaptive),
            (Classified::Analytic, Integrator::Analytic),
            (Classified::ApproximateWidgets, Integrator::Approximate),
            (Classified::ApproximateImage, Integrator::Approximate),
        ] {
            for (lit, second_by_cell) in [(false, false), (false, true), (true, false), (true, true)] {
                // Neither is drawn: one field without light is no look, and the published modes have none.
                let plain = function == Classified::OneField && (!lit || second_by_cell)
                    || lit && integrator.is_published_bivariate();
                for projection in [CellProjection::Pt, CellProjection::Vicp] {
                    let variant = Variant {
                        group: false,
                        orthographic: false,
                        data: DATA[looks.len() % DATA.len()],
                        look: Some(LookVariant { function, second_by_cell, lit }),
                        given: false,
                        surfaces: looks.len() % 2 == 0,
                        projection,
                        interpolation: Interpolation::Ray,
                        integrator,
                        classification: Classification::PostExact,
                        target: Target::Rgba32f,
                    };
                    looks.extend((!plain).then_some(variant));
                }
            }
        }
        looks
    }

    /// The module as naga has it; it names the resources that are there, used or not.
    fn validated(name: &str, variant: &Variant) -> naga::Module {
        let source = tetlux_shaders::compose(name, &variant.choices()).unwrap_or_else(|e| panic!("{variant:?}: {e}"));
        let module = naga::front::wgsl::parse_str(&source)
            .unwrap_or_else(|e| panic!("{name} of {variant:?}: {}", e.emit_to_string(&source)));
        Validator::new(ValidationFlags::all(), Capabilities::empty())
            .validate(&module)
            .unwrap_or_else(|e| panic!("{name} of {variant:?}: {}", e.emit_to_string(&source)));
        module
    }

    #[test]
    fn every_march_composes_and_binds_what_its_shader_names() {
        let mut judged = 0;
        for (&integrator, &classification) in
            Integrator::ALL.iter().flat_map(|i| Classification::ALL.iter().map(move |c| (i, c)))
        {
            let projection = CellProjection::March;
            let method = Method { projection, integrator, classification, ..Method::default() };
            let decided = integrator != Integrator::Auto && classification != Classification::Auto;
            if !decided || integrator.is_for_two_fields() || method.refusal().is_some() {
                continue;
            }
            for data in DATA {
                let variant = Variant {
                    group: false,
                    orthographic: data == Data::Cell,
                    data,
                    look: None,
                    given: false,
                    surfaces: data != Data::Cell,
                    projection,
                    interpolation: Interpolation::Ray,
                    integrator,
                    classification,
                    target: Target::Rgba32f,
                };
                let module = validated("stages::march", &variant);
                let named = module.global_variables.iter().filter_map(|(_, v)| v.binding);
                let mut named: Vec<(u32, u32)> = named.map(|b| (b.group, b.binding)).collect();
                named.sort_unstable();
                let mut bound: Vec<(u32, u32)> = variant.bindings().into_iter().map(|b| (0, b as u32)).collect();
                bound.extend((0..5).map(|binding| (1, binding)));
                bound.extend(tables_of(&variant));
                bound.extend(variant.surfaces.then_some((3, 0)));
                assert_eq!(named, bound, "{variant:?}");
                judged += 1;
            }
        }
        assert!(judged > 20);
    }

    /// The bindings of group 2.
    fn tables_of(variant: &Variant) -> Vec<(u32, u32)> {
        let tables = variant.tables();
        let textures = tables.iter().map(|&axes| (2, if axes == wgpu::TextureViewDimension::D2 { 1 } else { 2 }));
        textures
            .chain((!tables.is_empty()).then_some((2, 0)))
            .collect::<std::collections::BTreeSet<_>>()
            .into_iter()
            .collect()
    }

    #[test]
    fn every_variant_composes_and_binds_what_its_shaders_name() {
        let mut variants = variants();
        assert!(variants.len() > 100);
        variants.extend(looks());
        // Pieces of cells are never in groups.
        let whole = variants.iter().filter(|v| v.classification != Classification::PostClip);
        let of_groups: Vec<Variant> = whole.map(|v| v.of_groups()).collect();
        for variant in variants.iter().chain(&of_groups) {
            let tiles = variant.projection == CellProjection::Tiles;
            let binning = ["stages::count", "stages::fill"].into_iter().filter(|_| tiles);
            let stages = [variant.stage()].into_iter().chain(variant.geometry().compute).chain(binning);
            let mut named: Vec<(u32, u32)> = stages
                .flat_map(|stage| {
                    let module = validated(stage, variant);
                    let bindings = module.global_variables.iter().filter_map(|(_, v)| v.binding);
                    bindings.map(|b| (b.group, b.binding)).collect::<Vec<_>>()
                })
                .collect();
            named.sort_unstable();
            named.dedup();
            let mut bound: Vec<(u32, u32)> = variant.bindings().into_iter().map(|b| (0, b as u32)).collect();
            bound.push((1, 0));
            bound.extend(variant.geometry().compute.map(|_| (1, 1)));
            bound.extend((2..=6).filter(|_| tiles).map(|binding| (1, binding)));
            bound.extend(tables_of(variant));
            bound.extend(variant.surfaces.then_some((3, 0)));
            assert_eq!(named, bound, "{variant:?}");
        }
    }

    #[test]
    fn a_march_of_every_look_binds_what_its_shader_names() {
        for variant in looks()
            .into_iter()
            .filter(|v| !v.integrator.uses_table())
            .map(|v| Variant { projection: CellProjection::March, ..v })
        {
            let module = validated("stages::march", &variant);
            let bindings = module.global_variables.iter().filter_map(|(_, v)| v.binding);
            let mut named: Vec<u32> = bindings.filter(|b| b.group == 0).map(|b| b.binding).collect();
            named.sort_unstable();
            let bound: Vec<u32> = variant.bindings().into_iter().map(|b| b as u32).collect();
            assert_eq!(named, bound, "{variant:?}");
        }
    }

    /// What no scene of one field without light may hold.
    const OF_LOOKS: [&str; 18] = [
        "function::",
        "lib::erf",
        "lib::further",
        "lib::gradients",
        "lib::image",
        "lib::integrated",
        "lib::light",
        "lib::lit_linear",
        "lib::look\n",
        "lib::spent",
        "lib::two_fields",
        "lib::widget",
        "lit::",
        "quantity::lit",
        "quantity::pair",
        "sample::",
        "second::",
        "shading::two_scalars",
    ];

    fn modules_of_looks(variant: &Variant) -> Vec<&'static str> {
        let stages = [variant.stage()].into_iter().chain(variant.geometry().compute);
        let composed = |stage| tetlux_shaders::compose(stage, &variant.choices()).unwrap();
        let source: String = stages.map(composed).collect();
        OF_LOOKS.into_iter().filter(|module| source.contains(&format!("// ---- {module}"))).collect()
    }

    #[test]
    fn a_scene_of_one_field_compiles_and_binds_nothing_of_the_others() {
        for variant in variants() {
            assert_eq!(modules_of_looks(&variant), [""; 0], "{variant:?}");
            let plain = |&binding: &Binding| binding == Binding::Seen || (binding as u32) < Binding::Seconds as u32;
            assert!(variant.bindings().iter().all(plain));
        }
        // Each is found where it is.
        let mut found: Vec<&str> = looks().iter().flat_map(modules_of_looks).collect();
        found.sort_unstable();
        found.dedup();
        assert_eq!(found, OF_LOOKS);
    }
}
