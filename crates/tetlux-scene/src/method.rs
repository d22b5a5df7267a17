//! How to render: every axis by name.

#[cfg(test)]
mod tests;

use serde::{Deserialize, Serialize};

use crate::SkipSet;

/// Declares an enum whose values are spelt in kebab-case in scene files and on the command line.
macro_rules! named {
    ($(#[$outer:meta])* $name:ident { $($(#[$inner:meta])* $value:ident),+ $(,)? }) => {
        $(#[$outer])*
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
        #[serde(rename_all = "kebab-case")]
        pub enum $name { $($(#[$inner])* $value),+ }

        impl $name {
            /// Every value.
            pub const ALL: &'static [Self] = &[$(Self::$value),+];
        }

        impl std::fmt::Display for $name {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                self.serialize(f)
            }
        }

        impl std::str::FromStr for $name {
            type Err = UnknownName;
            fn from_str(name: &str) -> Result<Self, UnknownName> {
                parse_name(name)
            }
        }
    };
}

named! {
    /// What computes the picture.
    Backend {
        /// The plan chooses.
        #[default]
        Auto,
        /// wgpu.
        Gpu,
        /// The processor's cores.
        Cpu,
    }
}

named! {
    /// The order in which cells are composited.
    Order {
        /// The plan chooses.
        #[default]
        Auto,
        /// Any: exact where the picture does not depend on order.
        None,
        /// By the distance of the cells' centroids: fast, and wrong wherever centroids mislead.
        Centroid,
        /// By the eye's power to the cells' circumspheres: exact on Delaunay meshes alone.
        Power,
        /// Across the faces between cells: exact on convex meshes. Williams 1992.
        Mpvo,
        /// The same, begun at the farthest faces of the boundary: nearly right on meshes that are not convex. Williams 1992.
        Mpvonc,
        /// Across faces and across the gaps that the picture's own rays cross: exact on every mesh (Cook et al. 2004).
        /// Cells in a cycle, or that overlap, are sorted for every pixel.
        Exact,
        /// Every pixel's segments sorted along its ray: exact on meshes whose cells do not overlap. CPU only.
        Pixel,
    }
}

impl Order {
    /// Whether it takes the facts of the mesh that no view changes.
    pub fn needs_facts(self) -> bool {
        matches!(self, Order::Auto | Order::Power | Order::Mpvo | Order::Mpvonc | Order::Exact)
    }
}

named! {
    /// How cells become fragments on a graphics adapter.
    CellProjection {
        /// The plan chooses.
        #[default]
        Auto,
        /// Projected tetrahedra, a compute stage before the draw: Shirley and Tuchman 1990.
        Pt,
        /// The same in the vertex stage, one instance a tetrahedron: Wylie et al. 2002.
        Gator,
        /// View-independent cell projection: front faces drawn, the back end found in the fragment: Weiler, Kraus, Merz
        /// and Ertl 2003.
        Vicp,
        /// Distances to the faces and scalars there, found at the vertices and interpolated: Moreland and Angel 2004.
        Balanced,
        /// Every pixel walks along its ray from cell to cell; needs no order and no blending: Garrity 1990; Weiler, Kraus,
        /// Merz and Ertl 2003.
        March,
        /// Cells binned into tiles of the picture in their order, every tile composited front to back in registers: no
        /// blending.
        Tiles,
    }
}

named! {
    /// How a fragment comes by the two ends of its segment.
    Interpolation {
        /// The plan chooses.
        #[default]
        Auto,
        /// Each fragment finds its own segment from the planes of the cell's faces: exact whatever a rasteriser rounds.
        Ray,
        /// Over the triangles of the published decomposition, front and back with each their own depth: Kraus, Qiao and
        /// Ebert 2004, section 2.
        Perspective,
        /// Over the same triangles, linear in the picture: the artifact of the original algorithm.
        ScreenLinear,
    }
}

named! {
    /// The integral along a ray inside a cell.
    Integrator {
        /// The plan chooses.
        #[default]
        Auto,
        /// Mean luminance and extinction: opacity exact, colour off by up to half the opacity (Shirley and Tuchman 1990).
        Average,
        /// The linear closed form as published, which is not stable: Williams, Max and Stein 1998.
        Linear,
        /// Psi looked up in a table, 512 x 512 over x/(1+x), as published: Moreland and Angel 2004.
        Psi,
        /// The mean depth of the visible emission looked up, 128 x 128, opacity computed: error 4.7e-5.
        Q,
        /// Linear luminance and extinction, evaluated directly without a table: relative error 1e-5.
        Direct,
        /// The same without division: relative error 1e-5.
        Symmetric,
        /// Pre-integrated over both scalars and the thickness, equal steps: Röttger, Kraus and Ertl 2000.
        Preint,
        /// The same, the thickness in doubling steps: Kraus, Qiao and Ebert 2004, equation 1.
        PreintLog,
        /// Pre-integrated with exact opacity, colour / alpha stored.
        PreintQ,
        /// Widgets and images in as many pieces as the error allowed takes, opacity exact: the default for these.
        Adaptive,
        /// Widgets by the published analytic integrals and their tables: emission density, one peak a segment. Song et al.
        /// 2009, section 4.
        Analytic,
        /// Widgets and images in equal pieces, classified at their ends, with the tables of F and B: emission density.
        /// Song et al. 2009, section 5.
        Approximate,
    }
}

named! {
    /// Where scalars become luminance and extinction.
    Classification {
        /// The plan chooses.
        #[default]
        Auto,
        /// At the vertices: luminance and extinction are linear in the cell, and what the transfer function does between
        /// its vertices' scalars is lost.
        Vertex,
        /// After interpolation, split exactly at the transfer function's control points.
        PostExact,
        /// After interpolation, each cell clipped to every piece of the transfer function that it meets and drawn once a
        /// piece: Moreland and Angel 2004, section 3.2.
        PostClip,
    }
}

named! {
    /// The format of the texels of tables: Kraus, Qiao and Ebert 2004, section 3.
    TablePrecision {
        /// The plan chooses.
        #[default]
        Auto,
        /// 8 bits, scaled to the range of values.
        U8,
        /// 16 bits, scaled to the range of values.
        U16,
        /// Half precision.
        F16,
        /// Single precision.
        F32,
    }
}

named! {
    /// The format in which cells are composited.
    Target {
        /// The plan chooses.
        #[default]
        Auto,
        /// 8 bits a channel.
        Rgba8,
        /// 8 bits a channel, alpha rounded at random so that its mean is right: Kraus, Qiao and Ebert 2004, section 4.2.
        Rgba8Dither,
        /// Half precision: off by up to 5e-2 after a thousand cells.
        Rgba16f,
        /// Single precision.
        Rgba32f,
    }
}

/// A choice on every axis, and the error that is allowed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Method {
    /// What computes the picture.
    pub backend: Backend,
    /// The order of compositing.
    pub order: Order,
    /// How cells become fragments.
    pub projection: CellProjection,
    /// How a fragment comes by its segment.
    pub interpolation: Interpolation,
    /// The integral inside a cell.
    pub integrator: Integrator,
    /// Where scalars become luminance and extinction.
    pub classification: Classification,
    /// The format of tables, where the integral has one.
    pub table_precision: TablePrecision,
    /// The format of the picture while it is composited.
    pub target: Target,
    /// Equal pieces a segment of [`Integrator::Approximate`], 1 to [`Method::MOST_PIECES`]; none:
    /// [`Method::PUBLISHED_PIECES`].
    pub pieces: Option<u32>,
    /// Largest error of a pixel's colour or alpha, linear: what the plan chooses keeps to it, and `compare` checks it.
    pub max_error: f64,
    /// What is done though the scene does not need it, to measure what skipping saves.
    pub no_skip: SkipSet,
}

impl Default for Method {
    fn default() -> Self {
        Method {
            backend: Backend::Auto,
            order: Order::Auto,
            projection: CellProjection::Auto,
            interpolation: Interpolation::Auto,
            integrator: Integrator::Auto,
            classification: Classification::Auto,
            table_precision: TablePrecision::Auto,
            target: Target::Auto,
            pieces: None,
            // A quarter of an 8-bit step.
            max_error: 1e-3,
            no_skip: SkipSet::default(),
        }
    }
}

impl Integrator {
    /// Whether it looks values up in a table.
    pub fn uses_table(self) -> bool {
        matches!(self, Integrator::Psi | Integrator::Q) || self.is_pre_integrated() || self.is_published_bivariate()
    }

    /// Whether it is for widgets or images over two fields.
    pub fn is_for_two_fields(self) -> bool {
        self == Integrator::Adaptive || self.is_published_bivariate()
    }

    /// Whether it is one of Song et al. 2009, whose colours are an emission density: not multiplied by the extinction.
    pub fn is_published_bivariate(self) -> bool {
        matches!(self, Integrator::Analytic | Integrator::Approximate)
    }

    /// Whether its tables hold the transfer function.
    pub fn is_pre_integrated(self) -> bool {
        matches!(self, Integrator::Preint | Integrator::PreintLog | Integrator::PreintQ)
    }
}

impl Method {
    /// Pieces a segment of the approximate mode as it was published (Song et al. 2009, section 5).
    pub const PUBLISHED_PIECES: u32 = 10;

    /// Most pieces a segment that may be asked for.
    pub const MOST_PIECES: u32 = 1000;

    /// Why this combination cannot be, whatever the scene and the adapter; `None` if it can. `Auto` agrees with
    /// everything.
    pub fn refusal(&self) -> Option<String> {
        if self.projection == CellProjection::March
            && let Some(reason) = self.refusal_of_march()
        {
            return Some(reason);
        }
        if self.projection == CellProjection::Tiles
            && let Some(reason) = self.refusal_of_tiles()
        {
            return Some(reason);
        }
        if self.projection == CellProjection::Balanced
            && let Some(reason) = self.refusal_of_balanced()
        {
            return Some(reason);
        }
        if self.projection == CellProjection::Vicp
            && !matches!(self.interpolation, Interpolation::Auto | Interpolation::Ray)
        {
            return Some(format!(
                "projection \"vicp\" finds each end of a segment on the ray: leave out --interpolation {}",
                self.interpolation
            ));
        }
        if self.backend == Backend::Gpu && self.order == Order::Pixel {
            return Some(
                "order \"pixel\" sorts every pixel's segments, which only the CPU back end does: use --backend cpu, \
                 or --order exact"
                    .into(),
            );
        }
        if self.backend == Backend::Cpu
            && let Some(what) = self.gpu_only()
        {
            return Some(format!("{what} is a method of graphics adapters: use --backend gpu"));
        }
        if self.integrator.is_pre_integrated() && self.classification == Classification::Vertex {
            return Some(format!(
                "integrator \"{}\" looks up scalars, and classification \"vertex\" leaves none: use average, linear, psi, q, \
                 direct or symmetric",
                self.integrator
            ));
        }
        if self.integrator.is_pre_integrated() && self.classification == Classification::PostClip {
            return Some(format!(
                "integrator \"{}\" has every piece of the transfer function in its table: classification \"post-clip\" \
                 has nothing to clip; use post-exact",
                self.integrator
            ));
        }
        if self.projection == CellProjection::Gator && self.interpolation == Interpolation::Ray {
            return Some(
                "projection \"gator\" draws the triangles of the published decomposition, over which interpolation \
                 \"ray\" has nothing to interpolate: use perspective or screen-linear, or projection pt"
                    .into(),
            );
        }
        if let Some(reason) = self.refusal_of_pieces() {
            return Some(reason);
        }
        if self.integrator.is_for_two_fields()
            && !matches!(self.classification, Classification::Auto | Classification::PostExact)
        {
            return Some(format!(
                "integrator \"{}\" classifies two fields along the segment: leave out --classification {}",
                self.integrator, self.classification
            ));
        }
        if self.table_precision != TablePrecision::Auto
            && self.integrator != Integrator::Auto
            && !self.integrator.uses_table()
        {
            return Some(format!("integrator \"{}\" has no table: --table-precision says nothing", self.integrator));
        }
        if self.order == Order::Pixel
            && let Some(what) = self.gpu_only()
        {
            return Some(format!(
                "order \"pixel\" is a method of the CPU back end and {what} one of graphics adapters: keep one of them"
            ));
        }
        None
    }

    fn refusal_of_pieces(&self) -> Option<String> {
        let pieces = self.pieces?;
        if !(1..=Method::MOST_PIECES).contains(&pieces) {
            return Some(format!("{pieces} pieces a segment: give 1 to {}", Method::MOST_PIECES));
        }
        (self.integrator != Integrator::Approximate).then(|| {
            format!("integrator \"{}\" takes no number of pieces: --pieces is for approximate", self.integrator)
        })
    }

    fn refusal_of_march(&self) -> Option<String> {
        if !matches!(self.order, Order::Auto | Order::None) {
            return Some(format!(
                "projection \"march\" walks from cell to cell and needs no order: leave out --order {}",
                self.order
            ));
        }
        if self.interpolation != Interpolation::Auto {
            return Some(format!(
                "projection \"march\" draws no fragments that would come by their segments: leave out \
                 --interpolation {}",
                self.interpolation
            ));
        }
        if self.classification == Classification::PostClip {
            return Some(
                "projection \"march\" meets each cell once, and classification \"post-clip\" draws it once a piece: use \
                 post-exact"
                    .into(),
            );
        }
        if !matches!(self.target, Target::Auto | Target::Rgba32f) {
            return Some(format!(
                "projection \"march\" composites in single precision and blends into nothing: leave out --target {}",
                self.target
            ));
        }
        None
    }

    fn refusal_of_tiles(&self) -> Option<String> {
        if !matches!(self.interpolation, Interpolation::Auto | Interpolation::Ray) {
            return Some(format!(
                "projection \"tiles\" finds each segment on the ray and draws no triangles: leave out --interpolation {}",
                self.interpolation
            ));
        }
        if !matches!(self.target, Target::Auto | Target::Rgba32f) {
            return Some(format!(
                "projection \"tiles\" composites in single precision and blends into nothing: leave out --target {}",
                self.target
            ));
        }
        if self.integrator == Integrator::PreintQ {
            return Some(
                "projection \"tiles\" looks up one table in a workgroup, for there are drivers that fail with two (Mesa 22.3 in \
                 software), and integrator \"preint-q\" has two: use preint, preint-log or --projection pt"
                    .into(),
            );
        }
        None
    }

    fn refusal_of_balanced(&self) -> Option<String> {
        if self.interpolation != Interpolation::Auto {
            return Some(format!(
                "projection \"balanced\" interpolates segments in its own way: leave out --interpolation {}",
                self.interpolation
            ));
        }
        if self.classification == Classification::Vertex {
            return Some(
                "projection \"balanced\" carries one scalar a face, and colours classified at the vertices are four \
                 numbers: use --projection pt with --classification vertex"
                    .into(),
            );
        }
        None
    }

    /// Whether the march can be the projection.
    pub(crate) fn marches(&self) -> bool {
        matches!(self.projection, CellProjection::Auto | CellProjection::March) && self.refusal_of_march().is_none()
    }

    /// The first choice that only a graphics adapter's back end can follow, in words.
    pub(crate) fn gpu_only(&self) -> Option<String> {
        if !matches!(self.projection, CellProjection::Auto) {
            return Some(format!("projection \"{}\"", self.projection));
        }
        if !matches!(self.interpolation, Interpolation::Auto | Interpolation::Ray) {
            return Some(format!("interpolation \"{}\"", self.interpolation));
        }
        let both = matches!(self.integrator, Integrator::Auto | Integrator::Direct | Integrator::Average);
        if !both && !self.integrator.is_for_two_fields() {
            return Some(format!("integrator \"{}\"", self.integrator));
        }
        if self.classification == Classification::PostClip {
            return Some(format!("classification \"{}\"", self.classification));
        }
        if self.table_precision != TablePrecision::Auto {
            return Some(format!("table precision \"{}\"", self.table_precision));
        }
        if !matches!(self.target, Target::Auto | Target::Rgba32f) {
            return Some(format!("target \"{}\"", self.target));
        }
        None
    }

    /// The same with every axis decided that depends on the others alone: not those that depend on the adapter or the
    /// scene.
    pub(crate) fn decided(&self) -> Method {
        let mut method = *self;
        if method.interpolation == Interpolation::Auto {
            method.interpolation = match method.projection {
                CellProjection::Gator => Interpolation::Perspective,
                _ => Interpolation::Ray,
            };
        }
        if method.classification == Classification::Auto {
            method.classification = Classification::PostExact;
        }
        method
    }
}

/// A name that none of the values of an axis has.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct UnknownName(String);

/// The value of that name; the error lists the names there are.
pub fn parse_name<'de, T: Deserialize<'de>>(name: &'de str) -> Result<T, UnknownName> {
    use serde::de::{IntoDeserializer, value::Error};
    T::deserialize(IntoDeserializer::<Error>::into_deserializer(name)).map_err(|e| UnknownName(e.to_string()))
}
