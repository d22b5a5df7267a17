//! The two file formats of ParaView's presets, read into points without meaning.

use quick_xml::Reader;
use quick_xml::events::{BytesStart, Event};
use serde::Deserialize;

use super::PresetError;

/// A preset as the file states it.
#[derive(Debug, Default)]
pub(super) struct RawPreset {
    pub(super) name: String,
    pub(super) space: String,
    pub(super) hsv_wrap: bool,
    pub(super) log_scale: bool,
    pub(super) nan_color: Option<[f64; 3]>,
    pub(super) nan_opacity: Option<f64>,
    /// (s, r, g, b); at least one.
    pub(super) color: Vec<[f64; 4]>,
    /// (s, opacity, midpoint, sharpness); may be empty.
    pub(super) opacity: Vec<[f64; 4]>,
}

/// A file's presets; whether a preset is usable is known only for the one that is asked for.
pub(super) struct Named {
    pub(super) name: String,
    pub(super) preset: Result<RawPreset, PresetError>,
}

/// All presets of a file.
pub(super) fn parse(text: &str) -> Result<Vec<Named>, PresetError> {
    let content = text.trim_start_matches('\u{feff}').trim_start();
    if content.starts_with('<') { parse_xml(content, text.len() - content.len()) } else { parse_json(content) }
}

#[derive(Deserialize)]
#[serde(rename_all = "PascalCase")]
struct JsonPreset {
    #[serde(default)]
    name: String,
    color_space: Option<String>,
    #[serde(rename = "RGBPoints")]
    rgb_points: Option<Vec<f64>>,
    points: Option<Vec<f64>>,
    nan_color: Option<[f64; 3]>,
    nan_opacity: Option<f64>,
    indexed_colors: Option<serde_json::Value>,
    #[serde(rename = "HSVWrap", default)]
    hsv_wrap: Flag,
    #[serde(default)]
    use_log_scale: Flag,
}

/// ParaView writes 0 and 1, people write false and true.
#[derive(Default, Deserialize)]
#[serde(untagged)]
enum Flag {
    #[default]
    Absent,
    Boolean(bool),
    Number(f64),
}

impl Flag {
    fn is_set(&self) -> bool {
        match *self {
            Self::Absent => false,
            Self::Boolean(value) => value,
            Self::Number(value) => value != 0.0,
        }
    }
}

fn parse_json(text: &str) -> Result<Vec<Named>, PresetError> {
    let presets = if text.starts_with('[') {
        serde_json::from_str::<Vec<JsonPreset>>(text)?
    } else {
        vec![serde_json::from_str::<JsonPreset>(text)?]
    };
    Ok(presets.into_iter().map(|json| Named { name: json.name.clone(), preset: json.into_raw() }).collect())
}

impl JsonPreset {
    fn into_raw(self) -> Result<RawPreset, PresetError> {
        if self.indexed_colors.is_some() && self.rgb_points.is_none() {
            return Err(PresetError::Categorical { preset: self.name });
        }
        let color = groups(&self.name, "RGBPoints", &self.rgb_points.unwrap_or_default())?;
        let opacity = self.points.map_or(Ok(Vec::new()), |points| groups(&self.name, "Points", &points))?;
        Ok(RawPreset {
            space: self.color_space.unwrap_or_else(|| "RGB".to_owned()),
            hsv_wrap: self.hsv_wrap.is_set(),
            log_scale: self.use_log_scale.is_set(),
            nan_color: self.nan_color,
            nan_opacity: self.nan_opacity,
            name: self.name,
            color,
            opacity,
        })
    }
}

fn groups(preset: &str, field: &'static str, numbers: &[f64]) -> Result<Vec<[f64; 4]>, PresetError> {
    let (points, rest) = numbers.as_chunks::<4>();
    if points.is_empty() || !rest.is_empty() {
        let preset = preset.to_owned();
        return Err(PresetError::Length { preset, field, length: numbers.len(), group: 4 });
    }
    Ok(points.to_vec())
}

/// `skipped` bytes precede `text` in the file.
fn parse_xml(text: &str, skipped: usize) -> Result<Vec<Named>, PresetError> {
    let mut reader = Reader::from_str(text);
    let mut presets = Vec::new();
    let mut current: Option<XmlPreset> = None;
    loop {
        let position = skipped as u64 + reader.buffer_position();
        let fail = |reason: String| PresetError::Xml { position, reason };
        let event = reader.read_event().map_err(|error| fail(error.to_string()))?;
        let closed = matches!(event, Event::Empty(_));
        match event {
            Event::Start(element) | Event::Empty(element) => match (element.name().as_ref(), &mut current) {
                ("ColorMap", _) => {
                    let map = XmlPreset::new(&element).map_err(fail)?;
                    if closed { presets.push(map.finish()) } else { current = Some(map) }
                }
                ("Point", Some(map)) => map.point(&element).map_err(fail)?,
                ("NaN", Some(map)) => {
                    map.raw.nan_color = Some(rgb(&element).map_err(fail)?);
                    map.raw.nan_opacity = number(&element, "o").map_err(fail)?;
                }
                _ => {}
            },
            Event::End(element) if element.name().as_ref() == "ColorMap" => {
                presets.extend(current.take().map(XmlPreset::finish));
            }
            Event::Eof if current.is_some() => return Err(fail("the file ends within <ColorMap>".to_owned())),
            Event::Eof => return Ok(presets),
            _ => {}
        }
    }
}

struct XmlPreset {
    raw: RawPreset,
    categorical: bool,
}

impl XmlPreset {
    fn new(element: &BytesStart<'_>) -> Result<Self, String> {
        let raw = RawPreset {
            name: attribute(element, "name")?.unwrap_or_default(),
            space: attribute(element, "space")?.unwrap_or_else(|| "RGB".to_owned()),
            ..RawPreset::default()
        };
        let indexed = attribute(element, "indexedLookup")?.unwrap_or_default();
        Ok(Self { raw, categorical: indexed == "1" || indexed == "true" })
    }

    fn point(&mut self, element: &BytesStart<'_>) -> Result<(), String> {
        if self.categorical {
            return Ok(());
        }
        let x = number(element, "x")?.ok_or("<Point> without x")?;
        let [r, g, b] = rgb(element)?;
        self.raw.color.push([x, r, g, b]);
        if let Some(opacity) = number(element, "o")? {
            self.raw.opacity.push([x, opacity, 0.5, 0.0]);
        }
        Ok(())
    }

    fn finish(mut self) -> Named {
        let name = self.raw.name.clone();
        // ParaView's writer fills in a constant.
        if self.raw.opacity.windows(2).all(|pair| pair[0][1] == pair[1][1]) {
            self.raw.opacity.clear();
        }
        let preset = if self.categorical {
            Err(PresetError::Categorical { preset: name.clone() })
        } else if self.raw.color.is_empty() {
            Err(PresetError::Length { preset: name.clone(), field: "Point", length: 0, group: 4 })
        } else {
            Ok(self.raw)
        };
        Named { name, preset }
    }
}

fn rgb(element: &BytesStart<'_>) -> Result<[f64; 3], String> {
    let mut rgb = [0.0; 3];
    for (channel, name) in rgb.iter_mut().zip(["r", "g", "b"]) {
        let tag = element.name().as_ref().to_owned();
        *channel = number(element, name)?.ok_or_else(|| format!("<{tag}> without {name}"))?;
    }
    Ok(rgb)
}

fn number(element: &BytesStart<'_>, name: &str) -> Result<Option<f64>, String> {
    let Some(text) = attribute(element, name)? else { return Ok(None) };
    text.trim().parse().map(Some).map_err(|_| format!("attribute {name} is {text:?}, not a number"))
}

fn attribute(element: &BytesStart<'_>, name: &str) -> Result<Option<String>, String> {
    let attribute = element.try_get_attribute(name).map_err(|error| error.to_string())?;
    let value = attribute.map(|attribute| attribute.normalized_value(quick_xml::XmlVersion::Implicit1_0));
    value.transpose().map(|value| value.map(Into::into)).map_err(|error| error.to_string())
}
