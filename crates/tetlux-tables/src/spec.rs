//! What a table is to hold: plain data, validated before anything is built.

use serde::{Deserialize, Serialize};
use tetlux_optics::transfer::{ColorNode, OpacityNode, TransferFunction, TransferFunctionError};

use crate::axis::{Axis, AxisMap};
use crate::precision::Precision;

#[cfg(test)]
mod tests;

/// Largest number of nodes along an axis.
pub const MAX_NODES: u32 = 4096;

/// Largest number of texels of a table.
pub const MAX_TEXELS: u64 = 1 << 26;

/// Largest bound of a published table whose values grow as its exponential: e^80 is still finite in f32.
const MAX_EXPONENT: f64 = 80.0;

/// One table: what, how large, in which format.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TableSpec {
    /// Name in file names and on the command line: 1 to 40 of `a-z`, `0-9`, `-` and `_`.
    pub id: String,
    /// The function.
    pub kind: TableKind,
    /// Nodes along the axes, 2 to [`MAX_NODES`] each; the third is 1 for a table of two axes.
    pub size: [u32; 3],
    /// Texel format.
    pub precision: Precision,
}

/// A tabulated function. Symbols: a = `tau_b` D, b = `tau_f` D, X = (a + b)/2, rho = b/(a + b), alpha = 1 - exp(-X),
/// psi the mean transmittance to the front, q = `w_b`/alpha the mean depth of the visible emission.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", tag = "function", deny_unknown_fields)]
pub enum TableKind {
    /// psi over (gamma(a), gamma(b)), gamma(x) = x/(1 + x): Moreland and Angel 2004, equation 12. The error of the
    /// colour falls only as the square root of the texel size: psi ~ sqrt(pi/(2a)) where b is small and a large.
    Psi,
    /// q, as `design` stores it, over (g(X), sqrt rho).
    Q {
        /// Axis and stored quantity.
        design: Design,
    },
    /// q and `q_e` = `m_b`/psi over (1-(1+X)^(-1/4), sqrt rho): both emission conventions from two numbers.
    QPair,
    /// F = D `m_f` and B = D `m_b` over (`alpha_f`, `alpha_b`, D), linear axes: Song et al. 2009, equations 3 and 4.
    FrontBack {
        /// Largest extinction along the first two axes, above 0.
        max_extinction: f64,
        /// Largest length along the third axis, above 0.
        max_length: f64,
    },
    /// `int_0^t exp(-P erf y) dy` over (P, t), P in [0, `max_p`], t in [-`max_t`, `max_t`]: Song et al. 2009, 4.2.
    Gaussian {
        /// 1e-15 to 80, beyond which the values leave f32.
        max_p: f64,
        /// Above 0.
        max_t: f64,
    },
    /// U(P, t) = `int_t^inf [exp(-P (erf y - erf t)) - exp(-P erfc t)] dy` over (1-(1+P)^(-1/4), t), t in
    /// [-`max_t`, `max_t`]. Bounded for every P.
    GaussianBounded {
        /// Above 0; 4 leaves nothing beyond it.
        max_t: f64,
    },
    /// `int_0^x exp(M cos y) dy` over (x = k d in [0, pi], M = `a_max`/k in [0, `max_m`]): Song et al. 2009, 4.4.
    Sine {
        /// 1e-15 to 80, beyond which the values leave f32.
        max_m: f64,
    },
    /// V(M, t) = `int_t^pi exp(-M (cos t - cos y)) dy` over (1-(1+M)^(-1/4), t in [0, pi]). Within [0, pi].
    SineBounded,
    /// `int_0^l exp(-A (y - y^2/2)) dy` over (l in [0, 1], A in [0, `max_a`]), lengths in ramps: the falling ramp of a
    /// triangle wave, Song et al. 2009, 4.3, with A = `a_max` times the ramp's length.
    Triangle {
        /// 1e-15 to 80.
        max_a: f64,
    },
    /// Premultiplied colour and alpha of a segment over (`s_f`, `s_b`, l) through a 1D transfer function.
    PreIntegrated {
        /// The function and the domain.
        transfer: TransferSpec,
        /// Placement of the slices.
        thickness: Thickness,
        /// How the slices are computed.
        construction: Construction,
    },
    /// Mean extinction mu between two scalars, over (`s_f`, `s_b`): alpha = 1 - exp(-mu l) for every length l.
    MeanExtinction {
        /// The function and the domain.
        transfer: TransferSpec,
    },
    /// Colour / alpha over (`s_f`, `s_b`, 1-(1+mu l)^(-1/4)). The slice l = 0 is the extinction-weighted mean colour.
    ColorRatio {
        /// The function and the domain; the length has no bound here.
        transfer: TransferSpec,
    },
}

/// Designs of the q table, all over y = sqrt rho.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Design {
    /// g = 1-(1+X)^(-1/4), stores q.
    Q,
    /// g = 1-(1+X)^(-1/3), stores q (b + sqrt(b^2 + (8/pi) a + 16)), which is bounded away from 0.
    R,
    /// g as Q, stores as R.
    R4,
}

/// Placement of the slices of constant thickness.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Thickness {
    /// Equal steps.
    Uniform,
    /// Doubling steps: Kraus, Qiao and Ebert 2004, equation 1.
    Logarithmic,
}

/// How the slices of a pre-integrated table are computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Construction {
    /// Each texel by itself.
    Exact,
    /// The first slice by itself, every other composed of two thinner segments (after Weiler et al. 2003).
    Incremental,
}

/// A 1D transfer function and the domain of its tables, as plain data.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TransferSpec {
    /// Luminance nodes (s, r, g, b), s ascending.
    pub color: Vec<[f64; 4]>,
    /// Opacity nodes (s, opacity), s ascending.
    pub opacity: Vec<[f64; 2]>,
    /// The scalars at the ends of the axes, ascending.
    pub range: [f64; 2],
    /// Extinction is opacity / unit distance; above 0.
    pub unit_distance: f64,
    /// Largest thickness, above 0.
    pub max_length: f64,
}

impl TransferSpec {
    /// Describes `function` over `range`.
    pub fn new(function: &TransferFunction, range: [f64; 2], unit_distance: f64, max_length: f64) -> Self {
        let color = function.color_nodes().iter().map(|node| [node.s, node.rgb[0], node.rgb[1], node.rgb[2]]);
        let opacity = function.opacity_nodes().iter().map(|node| [node.s, node.opacity]);
        Self { color: color.collect(), opacity: opacity.collect(), range, unit_distance, max_length }
    }

    /// The transfer function.
    ///
    /// # Errors
    /// [`SpecError::Transfer`] names the node that makes it none.
    pub fn function(&self) -> Result<TransferFunction, SpecError> {
        let color = self.color.iter().map(|&[s, r, g, b]| ColorNode { s, rgb: [r, g, b] });
        let opacity = self.opacity.iter().map(|&[s, opacity]| OpacityNode { s, opacity });
        TransferFunction::new(color.collect(), opacity.collect()).map_err(SpecError::Transfer)
    }

    fn validate(&self) -> Result<(), SpecError> {
        self.function()?;
        positive("transfer.unit_distance", self.unit_distance)?;
        positive("transfer.max_length", self.max_length)?;
        let [low, high] = self.range;
        if low < high && (high - low).is_finite() {
            return Ok(());
        }
        Err(SpecError::field("transfer.range", format!("{low} to {high}"), "two finite values, ascending"))
    }
}

/// Why a specification is refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SpecError {
    /// A value outside its domain.
    #[error("table specification: {field} is {found}; it must be {expected}")]
    Field {
        /// The field.
        field: &'static str,
        /// The value found.
        found: String,
        /// What it must be.
        expected: String,
    },
    /// Node lists that make no transfer function.
    #[error("table specification: transfer: {0}")]
    Transfer(TransferFunctionError),
    /// No default table has this name.
    #[error("no table is called {id:?}; there are: {known}")]
    Unknown {
        /// The name asked for.
        id: String,
        /// The names of the default tables.
        known: String,
    },
}

impl SpecError {
    fn field(field: &'static str, found: impl ToString, expected: impl ToString) -> Self {
        Self::Field { field, found: found.to_string(), expected: expected.to_string() }
    }
}

impl TableSpec {
    /// Every table that `build-tables` makes unasked, in the order of the documentation.
    pub fn defaults() -> Vec<Self> {
        let [gaussian, sine, triangle] = Self::widgets();
        vec![
            Self::default_q(),
            Self::single("r", [192, 144, 1], TableKind::Q { design: Design::R }),
            Self::single("qe", [128, 128, 1], TableKind::QPair),
            Self::default_psi(),
            Self::front_back(),
            gaussian,
            Self::single("gaussian-bounded", [256, 256, 1], TableKind::GaussianBounded { max_t: 4.0 }),
            sine,
            Self::single("sine-bounded", [256, 256, 1], TableKind::SineBounded),
            triangle,
        ]
    }

    fn single(id: &str, size: [u32; 3], kind: TableKind) -> Self {
        Self { id: id.to_owned(), kind, size, precision: Precision::F32 }
    }

    /// The published tables of a Gaussian, a sine and a triangle wave: 256 x 256, f32 (Song et al. 2009).
    pub fn widgets() -> [Self; 3] {
        [
            Self::single("gaussian", [256, 256, 1], TableKind::Gaussian { max_p: 10.0, max_t: 4.0 }),
            Self::single("sine", [256, 256, 1], TableKind::Sine { max_m: 10.0 }),
            Self::single("triangle", [256, 256, 1], TableKind::Triangle { max_a: 10.0 }),
        ]
    }

    /// The published table of F and B: 64 x 64 x 64, f32 (Song et al. 2009).
    pub fn front_back() -> Self {
        Self::single("fb3d", [64, 64, 64], TableKind::FrontBack { max_extinction: 10.0, max_length: 1.0 })
    }

    /// The table a renderer takes unless told otherwise: q, design Q, 128 x 128, f32.
    pub fn default_q() -> Self {
        Self::single("q", [128, 128, 1], TableKind::Q { design: Design::Q })
    }

    /// The published table of psi: 512 x 512, f32 (Moreland and Angel 2004).
    pub fn default_psi() -> Self {
        Self::single("psi", [512, 512, 1], TableKind::Psi)
    }

    /// The default table called `id`.
    ///
    /// # Errors
    /// [`SpecError::Unknown`] lists the names there are.
    pub fn named(id: &str) -> Result<Self, SpecError> {
        let all = Self::defaults();
        let known = all.iter().map(|spec| spec.id.as_str()).collect::<Vec<_>>().join(", ");
        all.into_iter().find(|spec| spec.id == id).ok_or_else(|| SpecError::Unknown { id: id.to_owned(), known })
    }

    /// Checks every field.
    ///
    /// # Errors
    /// [`SpecError`] names the first field that is outside its domain.
    pub fn validate(&self) -> Result<(), SpecError> {
        let letters = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-' || c == '_';
        if self.id.is_empty() || self.id.len() > 40 || !self.id.chars().all(letters) {
            return Err(SpecError::field("id", format!("{:?}", self.id), "1 to 40 of a-z, 0-9, - and _"));
        }
        let size = || format!("{} x {} x {}", self.size[0], self.size[1], self.size[2]);
        let used = if self.kind.has_depth() { 3 } else { 2 };
        if !self.size[..used].iter().all(|nodes| (2..=MAX_NODES).contains(nodes))
            || self.size[used..] != [1][used - 2..]
        {
            let third = if used == 2 { "; the third 1 for a table of two axes" } else { "" };
            return Err(SpecError::field("size", size(), format!("2 to {MAX_NODES} nodes along each axis{third}")));
        }
        if self.size.iter().map(|&nodes| u64::from(nodes)).product::<u64>() > MAX_TEXELS {
            return Err(SpecError::field("size", size(), format!("at most {MAX_TEXELS} texels")));
        }
        match &self.kind {
            TableKind::Psi | TableKind::Q { .. } | TableKind::QPair | TableKind::SineBounded => Ok(()),
            TableKind::FrontBack { max_extinction, max_length } => {
                positive("max_extinction", *max_extinction)?;
                positive("max_length", *max_length)
            }
            TableKind::Gaussian { max_p, max_t } => exponent("max_p", *max_p).and(positive("max_t", *max_t)),
            TableKind::GaussianBounded { max_t } => positive("max_t", *max_t),
            TableKind::Sine { max_m } => exponent("max_m", *max_m),
            TableKind::Triangle { max_a } => exponent("max_a", *max_a),
            TableKind::PreIntegrated { transfer, construction, .. } => {
                // Slices are composed at scalars between the nodes of both axes: the axes must be one.
                if *construction == Construction::Incremental && self.size[0] != self.size[1] {
                    return Err(SpecError::field("size", size(), "n x n x m for the incremental construction"));
                }
                transfer.validate()
            }
            TableKind::MeanExtinction { transfer } | TableKind::ColorRatio { transfer } => transfer.validate(),
        }
    }

    /// The axes, one for each that the table has.
    pub fn axes(&self) -> Vec<Axis> {
        let [nx, ny, nz] = self.size;
        let linear = |min: f64, max: f64| AxisMap::Linear { min, max };
        let pi = std::f64::consts::PI;
        let scalars = |transfer: &TransferSpec| {
            let [low, high] = transfer.range;
            vec![Axis::new("s_f", nx, linear(low, high)), Axis::new("s_b", ny, linear(low, high))]
        };
        match &self.kind {
            TableKind::Psi => vec![Axis::new("a", nx, AxisMap::Ratio), Axis::new("b", ny, AxisMap::Ratio)],
            TableKind::Q { design } => {
                let map = if *design == Design::R { AxisMap::Third } else { AxisMap::Quarter };
                vec![Axis::new("X", nx, map), Axis::new("rho", ny, AxisMap::Root)]
            }
            TableKind::QPair => vec![Axis::new("X", nx, AxisMap::Quarter), Axis::new("rho", ny, AxisMap::Root)],
            TableKind::FrontBack { max_extinction, max_length } => vec![
                Axis::new("alpha_f", nx, linear(0.0, *max_extinction)),
                Axis::new("alpha_b", ny, linear(0.0, *max_extinction)),
                Axis::new("D", nz, linear(0.0, *max_length)),
            ],
            TableKind::Gaussian { max_p, max_t } => {
                vec![Axis::new("P", nx, linear(0.0, *max_p)), Axis::new("t", ny, linear(-max_t, *max_t))]
            }
            TableKind::GaussianBounded { max_t } => {
                vec![Axis::new("P", nx, AxisMap::Quarter), Axis::new("t", ny, linear(-max_t, *max_t))]
            }
            TableKind::Sine { max_m } => {
                vec![Axis::new("k d", nx, linear(0.0, pi)), Axis::new("M", ny, linear(0.0, *max_m))]
            }
            TableKind::SineBounded => {
                vec![Axis::new("M", nx, AxisMap::Quarter), Axis::new("t", ny, linear(0.0, pi))]
            }
            TableKind::Triangle { max_a } => {
                vec![Axis::new("l", nx, linear(0.0, 1.0)), Axis::new("A", ny, linear(0.0, *max_a))]
            }
            TableKind::MeanExtinction { transfer } => scalars(transfer),
            TableKind::ColorRatio { transfer } => {
                let mut axes = scalars(transfer);
                axes.push(Axis::new("mu l", nz, AxisMap::Quarter));
                axes
            }
            TableKind::PreIntegrated { transfer, thickness, .. } => {
                let mut axes = scalars(transfer);
                let max = transfer.max_length;
                axes.push(match thickness {
                    Thickness::Uniform => Axis::new("l", nz, linear(0.0, max)),
                    Thickness::Logarithmic => Axis::new("l", nz, AxisMap::Logarithm { max }),
                });
                axes
            }
        }
    }

    /// The names of the channels, in the order of the texels.
    pub fn channels(&self) -> &'static [&'static str] {
        match &self.kind {
            TableKind::Psi => &["psi"],
            TableKind::Q { .. } => &["q"],
            TableKind::QPair => &["q", "q_e"],
            TableKind::FrontBack { .. } => &["F", "B"],
            TableKind::Gaussian { .. } | TableKind::Sine { .. } | TableKind::Triangle { .. } => &["integral"],
            TableKind::GaussianBounded { .. } => &["U"],
            TableKind::SineBounded => &["V"],
            TableKind::PreIntegrated { .. } => &["R", "G", "B", "A"],
            TableKind::MeanExtinction { .. } => &["mu"],
            TableKind::ColorRatio { .. } => &["R", "G", "B"],
        }
    }
}

impl TableKind {
    /// Whether the table has a third axis.
    pub fn has_depth(&self) -> bool {
        matches!(self, Self::FrontBack { .. } | Self::PreIntegrated { .. } | Self::ColorRatio { .. })
    }
}

fn positive(field: &'static str, value: f64) -> Result<(), SpecError> {
    // Bounded so that products of two of them, and their f32 values, are finite and not 0.
    if (1e-15..=1e15).contains(&value) { Ok(()) } else { Err(SpecError::field(field, value, "from 1e-15 to 1e15")) }
}

fn exponent(field: &'static str, value: f64) -> Result<(), SpecError> {
    let allowed = 1e-15..=MAX_EXPONENT;
    if allowed.contains(&value) {
        Ok(())
    } else {
        Err(SpecError::field(field, value, format!("from 1e-15 to {MAX_EXPONENT}")))
    }
}
