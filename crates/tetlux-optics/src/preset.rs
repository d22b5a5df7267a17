//! Presets of ParaView (JSON, and the older XML) as transfer functions.
//!
//! The components of a preset's colours are taken as they are, as linear luminance. Between its points a colour map is
//! interpolated in the colour space that it names; spaces that are not linear in RGB, and logarithmic scales, are cut into
//! linear pieces by halving, until they keep [`SUBDIVISION_TOLERANCE`].

mod parse;
#[cfg(test)]
mod tests;

use crate::color_space::ColorSpace;
use crate::transfer::{ColorNode, OpacityNode, TransferFunction, TransferFunctionError};
use parse::RawPreset;

/// Largest difference of a colour component between a preset's own interpolation and its linear pieces.
///
/// Not kept across the jumps which Diverging makes beside an unsaturated point (VTK gives such a point the hue of its
/// neighbour): there a piece of 1/4096 of the interval bridges the jump.
pub const SUBDIVISION_TOLERANCE: f64 = 1e-3;

/// Intervals are halved at most this often, which bounds the nodes that a hostile file can make.
const MAX_HALVINGS: u32 = 12;

/// VTK keeps midpoints this far from the ends of their interval.
const MIDPOINT_MARGIN: f64 = 1e-5;

/// A preset, already in nodes that are linear in between.
#[derive(Clone, Debug, PartialEq)]
pub struct Preset {
    /// The preset's name; empty if it has none.
    pub name: String,
    /// Colour for values that are not numbers.
    pub nan_color: Option<[f64; 3]>,
    /// Opacity for values that are not numbers.
    pub nan_opacity: Option<f64>,
    /// Luminance nodes over the preset's own range; at least one.
    pub color: Vec<ColorNode>,
    /// Opacity nodes; a ramp from 0 to 1 over the colours' range where the file has none.
    pub opacity: Vec<OpacityNode>,
    /// Whether the scalar axis is logarithmic: rescaling then keeps ratios.
    pub log_scale: bool,
}

/// Why a preset cannot be read or used. `preset` is its name, `point` counts from 0 in ascending order of the scalar.
#[derive(Debug, thiserror::Error)]
pub enum PresetError {
    /// The text is not JSON of the expected shape.
    #[error("not a ParaView JSON preset: {0}")]
    Json(#[from] serde_json::Error),
    /// The text is not XML of the expected shape.
    #[error("not a ParaView XML color map, byte {position}: {reason}")]
    Xml {
        /// Byte offset in the text.
        position: u64,
        /// What is wrong there.
        reason: String,
    },
    /// No preset in the file.
    #[error("the file holds no preset")]
    Empty,
    /// Several presets and no name to choose by.
    #[error("the file holds several presets, name one of: {}", names.join(", "))]
    Ambiguous {
        /// The names in the file.
        names: Vec<String>,
    },
    /// No preset of the wanted name.
    #[error("no preset {wanted:?} in the file, which holds: {}", names.join(", "))]
    Unknown {
        /// The wanted name.
        wanted: String,
        /// The names in the file.
        names: Vec<String>,
    },
    /// A list of numbers that does not divide into points.
    #[error("preset {preset:?}: {field} holds {length} numbers, which is not one or more groups of {group}")]
    Length {
        /// The preset.
        preset: String,
        /// The list's name in the file.
        field: &'static str,
        /// Its length.
        length: usize,
        /// Numbers in a point.
        group: usize,
    },
    /// A list of colours without positions, made for categories.
    #[error("preset {preset:?} is categorical (indexed colors): only color maps over a range can be used")]
    Categorical {
        /// The preset.
        preset: String,
    },
    /// A colour space that is not supported.
    #[error("preset {preset:?}: color space {space:?} is not supported, use RGB, HSV, Lab, Diverging or Step")]
    ColorSpace {
        /// The preset.
        preset: String,
        /// The space's name in the file.
        space: String,
    },
    /// An opacity curve that straight pieces cannot represent.
    #[error(
        "preset {preset:?}, opacity point {point}: midpoint {midpoint}, sharpness {sharpness}: \
         use a midpoint in [0, 1] and sharpness 0 (linear) or 1 (step)"
    )]
    Curve {
        /// The preset.
        preset: String,
        /// The opacity point.
        point: usize,
        /// Its midpoint.
        midpoint: f64,
        /// Its sharpness.
        sharpness: f64,
    },
    /// A logarithmic scale over values that have no logarithm.
    #[error("preset {preset:?}: a logarithmic scale needs positive scalars, found {s}")]
    Log {
        /// The preset.
        preset: String,
        /// The offending scalar.
        s: f64,
    },
    /// A target range that is empty, reversed or not finite.
    #[error("preset {preset:?}: cannot rescale to [{low}, {high}]: give a finite range, lower end first")]
    Range {
        /// The preset.
        preset: String,
        /// Lower end of the range asked for.
        low: f64,
        /// Upper end of the range asked for.
        high: f64,
    },
    /// The nodes make no transfer function.
    #[error("preset {preset:?}: {source}")]
    Nodes {
        /// The preset.
        preset: String,
        /// Which node, and why.
        source: TransferFunctionError,
    },
}

/// Reads the preset called `name`, or the only one, from the text of a ParaView preset file, JSON or XML.
///
/// JSON: `Name`, `ColorSpace` (RGB if absent), `RGBPoints` (s r g b)*, and optionally `Points` (s opacity midpoint
/// sharpness)*, `NanColor`, `HSVWrap`, `UseLogScale`. XML: `<ColorMap name space>` with `<Point x o r g b/>` and
/// `<NaN r g b/>`. ParaView writes `o="1"` at every XML point and ignores it on reading; opacity is taken from `o` only
/// if it varies.
///
/// # Errors
///
/// Says what cannot be read or represented, and where.
pub fn read_preset(text: &str, name: Option<&str>) -> Result<Preset, PresetError> {
    let mut presets = parse::parse(text)?;
    let names = || presets.iter().map(|preset| preset.name.clone()).collect();
    let index = match name {
        Some(wanted) => presets
            .iter()
            .position(|preset| preset.name == wanted)
            .ok_or_else(|| PresetError::Unknown { wanted: wanted.to_owned(), names: names() })?,
        None if presets.is_empty() => return Err(PresetError::Empty),
        None if presets.len() > 1 => return Err(PresetError::Ambiguous { names: names() }),
        None => 0,
    };
    interpret(presets.swap_remove(index).preset?)
}

impl Preset {
    /// The transfer function over the preset's own range, or with it moved to `range` (lower end first).
    ///
    /// As in ParaView, colour and opacity are each rescaled from their own first and last node, and on a logarithmic
    /// scale by ratios.
    ///
    /// # Errors
    ///
    /// If the range is empty or not finite, or (logarithmic scale) not positive.
    pub fn transfer_function(&self, range: Option<[f64; 2]>) -> Result<TransferFunction, PresetError> {
        let (mut color, mut opacity) = (self.color.clone(), self.opacity.clone());
        if let Some(range) = range {
            self.rescale(&mut color, |node| &mut node.s, range)?;
            self.rescale(&mut opacity, |node| &mut node.s, range)?;
        }
        TransferFunction::new(color, opacity).map_err(|source| PresetError::Nodes { preset: self.name.clone(), source })
    }

    fn rescale<N>(
        &self,
        nodes: &mut [N],
        position: impl Fn(&mut N) -> &mut f64,
        [low, high]: [f64; 2],
    ) -> Result<(), PresetError> {
        if !(low < high && (high - low).is_finite()) {
            return Err(PresetError::Range { preset: self.name.clone(), low, high });
        }
        if self.log_scale && low <= 0.0 {
            return Err(PresetError::Log { preset: self.name.clone(), s: low });
        }
        let axis = |s: f64| if self.log_scale { s.ln() } else { s };
        let ends = [nodes.first_mut().map(|node| *position(node)), nodes.last_mut().map(|node| *position(node))];
        let [first, last] = ends.map(|s| axis(s.unwrap_or(low)));
        for node in nodes {
            let s = position(node);
            // A single point has no range of its own: it goes to the lower end.
            let t = if first < last { (axis(*s) - first) / (last - first) } else { 0.0 };
            *s = along(low, high, t, self.log_scale);
        }
        Ok(())
    }
}

fn interpret(mut raw: RawPreset) -> Result<Preset, PresetError> {
    let preset = raw.name.clone();
    raw.color.sort_by(|a, b| a[0].total_cmp(&b[0]));
    raw.opacity.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let all = raw.color.iter().chain(&raw.opacity);
    if let Some(point) = all.filter(|_| raw.log_scale).find(|point| point[0].is_nan() || point[0] <= 0.0) {
        return Err(PresetError::Log { preset, s: point[0] });
    }
    let color = color_nodes(&raw, color_space(&raw)?);
    let opacity = if raw.opacity.is_empty() {
        // `parse` leaves no preset without colour points, and `color_nodes` none without nodes.
        let ends = [color.first(), color.last()].map(|node| node.map_or(0.0, |node| node.s));
        vec![OpacityNode { s: ends[0], opacity: 0.0 }, OpacityNode { s: ends[1], opacity: 1.0 }]
    } else {
        opacity_nodes(&raw)?
    };
    let RawPreset { nan_color, nan_opacity, log_scale, .. } = raw;
    let preset = Preset { name: preset, nan_color, nan_opacity, color, opacity, log_scale };
    preset.transfer_function(None)?;
    Ok(preset)
}

fn color_space(raw: &RawPreset) -> Result<ColorSpace, PresetError> {
    match raw.space.as_str() {
        "RGB" => Ok(ColorSpace::Rgb),
        "HSV" => Ok(ColorSpace::Hsv { wrap: raw.hsv_wrap }),
        // The XML files' name for HSV with wrap.
        "Wrapped" => Ok(ColorSpace::Hsv { wrap: true }),
        "Lab" => Ok(ColorSpace::Lab),
        "Diverging" => Ok(ColorSpace::Diverging),
        "Step" => Ok(ColorSpace::Step),
        _ => Err(PresetError::ColorSpace { preset: raw.name.clone(), space: raw.space.clone() }),
    }
}

fn color_nodes(raw: &RawPreset, space: ColorSpace) -> Vec<ColorNode> {
    let mut nodes = Vec::new();
    let split = |&[s, r, g, b]: &[f64; 4]| (s, [r, g, b]);
    if let Some((s, rgb)) = raw.color.first().map(split) {
        push(&mut nodes, ColorNode { s, rgb });
    }
    for pair in raw.color.windows(2) {
        let ((low, from), (high, to)) = (split(&pair[0]), split(&pair[1]));
        if low == high {
            // Two points at one scalar are a step; of three, the middle one covers nothing.
            continue;
        }
        let first = if space == ColorSpace::Step { to } else { from };
        let curve = |t: f64| ColorNode { s: along(low, high, t, raw.log_scale), rgb: space.interpolate(from, to, t) };
        push(&mut nodes, ColorNode { s: low, rgb: first });
        let ends = [(0.0, ColorNode { s: low, rgb: first }), (1.0, ColorNode { s: high, rgb: to })];
        subdivide(&mut nodes, &curve, ends, MAX_HALVINGS);
        push(&mut nodes, ColorNode { s: high, rgb: to });
    }
    if let Some((s, rgb)) = raw.color.last().map(split) {
        push(&mut nodes, ColorNode { s, rgb });
    }
    nodes
}

/// Adds nodes between the two `ends` of a piece (each with its parameter) until a straight line follows `curve`.
fn subdivide(
    nodes: &mut Vec<ColorNode>,
    curve: &impl Fn(f64) -> ColorNode,
    ends: [(f64, ColorNode); 2],
    halvings: u32,
) {
    let [(t0, from), (t1, to)] = ends;
    // Seven samples: the hue circle has six corners. Half the tolerance: a corner between samples strays further.
    let strays = (1..8).map(|i| curve(t0 + (t1 - t0) * f64::from(i) / 8.0)).any(|node| {
        let w = (node.s - from.s) / (to.s - from.s);
        let line = |c: usize| from.rgb[c] * (1.0 - w) + to.rgb[c] * w;
        (0..3).any(|c| (line(c) - node.rgb[c]).abs() > 0.5 * SUBDIVISION_TOLERANCE)
    });
    let t = 0.5 * (t0 + t1);
    let middle = curve(t);
    if halvings > 0 && strays && from.s < middle.s && middle.s < to.s {
        subdivide(nodes, curve, [(t0, from), (t, middle)], halvings - 1);
        push(nodes, middle);
        subdivide(nodes, curve, [(t, middle), (t1, to)], halvings - 1);
    }
}

/// Adds a node unless it repeats the last.
fn push<N: PartialEq>(nodes: &mut Vec<N>, node: N) {
    if nodes.last() != Some(&node) {
        nodes.push(node);
    }
}

fn opacity_nodes(raw: &RawPreset) -> Result<Vec<OpacityNode>, PresetError> {
    let mut nodes = Vec::new();
    let mut add = |s: f64, opacity: f64| push(&mut nodes, OpacityNode { s, opacity });
    if let Some(&[s, value, ..]) = raw.opacity.first() {
        add(s, value);
    }
    for (point, pair) in raw.opacity.windows(2).enumerate() {
        let ([low, from, midpoint, sharpness], [high, to, ..]) = (pair[0], pair[1]);
        let step = sharpness == 1.0;
        if !(0.0..=1.0).contains(&midpoint) || !(step || sharpness == 0.0) {
            let preset = raw.name.clone();
            return Err(PresetError::Curve { preset, point, midpoint, sharpness });
        }
        if low == high {
            continue;
        }
        add(low, from);
        // The midpoint is where the curve has come half the way.
        let middle = low + (high - low) * midpoint.clamp(MIDPOINT_MARGIN, 1.0 - MIDPOINT_MARGIN);
        if step {
            add(middle, from);
            add(middle, to);
        } else if midpoint != 0.5 {
            add(middle, 0.5 * (from + to));
        }
        add(high, to);
    }
    if let Some(&[s, value, ..]) = raw.opacity.last() {
        add(s, value);
    }
    Ok(nodes)
}

/// The scalar at `t` in [0, 1] of an interval, evenly by value or by ratio; its ends exactly at 0 and 1.
fn along(low: f64, high: f64, t: f64, log_scale: bool) -> f64 {
    if log_scale { low.powf(1.0 - t) * high.powf(t) } else { low * (1.0 - t) + high * t }
}
