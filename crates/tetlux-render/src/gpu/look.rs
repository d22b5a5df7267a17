//! Scenes of two fields or with light on the device: the shaders that they take, and what these bind. Other scenes take
//! none of it.

use tetlux_mesh::Location;
use tetlux_optics::transfer_f32::Piece;
use tetlux_optics::widget_f32::Widget;
use tetlux_shaders::Choice;

use super::variant::Binding;
use crate::look::{Function, Look};
use crate::published::Published;

/// What of a look makes one set of pipelines differ from another.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) struct LookVariant {
    pub(crate) function: Classified,
    /// The second scalar belongs to cells.
    pub(crate) second_by_cell: bool,
    pub(crate) lit: bool,
}

/// The kind of a look's function.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) enum Classified {
    OneField,
    TwoFields,
    Widgets,
    Image,
    Analytic,
    ApproximateWidgets,
    ApproximateImage,
}

impl LookVariant {
    pub(crate) fn new(look: &Look) -> LookVariant {
        let function = match (&look.function, &look.published) {
            // What is classified at the vertices has no look here: the plan sees to it.
            (Function::OneField(..) | Function::Vertex(_), _) => Classified::OneField,
            (Function::TwoFields(_), _) => Classified::TwoFields,
            (Function::Widgets(_), None) => Classified::Widgets,
            (Function::Widgets(_), Some(Published::Analytic { .. })) => Classified::Analytic,
            (Function::Widgets(_), Some(Published::Approximate { .. })) => Classified::ApproximateWidgets,
            (Function::Image(_), None) => Classified::Image,
            // An image has no analytic integrals: the plan sees to it.
            (Function::Image(_), Some(_)) => Classified::ApproximateImage,
        };
        let second = look.further.first().filter(|_| look.has_second);
        let second_by_cell = second.is_some_and(|second| second.location == Location::Cell);
        LookVariant { function, second_by_cell, lit: look.light.is_some() }
    }

    /// The modules that stand for the axes of the shaders.
    pub(crate) fn choices(&self) -> [Choice; 6] {
        let function = match self.function {
            Classified::TwoFields => "function::two_fields",
            // One field is lit, and light knows its pieces.
            Classified::OneField | Classified::Widgets => "function::widgets",
            Classified::Image => "function::image",
            Classified::Analytic => "function::analytic",
            Classified::ApproximateWidgets | Classified::ApproximateImage => "function::approximate",
        };
        let lit = match self.function {
            Classified::OneField => "lit::one_field",
            Classified::TwoFields => "lit::two_fields",
            _ => "lit::turns",
        };
        let sample = match self.function {
            Classified::ApproximateImage => "sample::image",
            _ => "sample::widgets",
        };
        let (quantity, shading) =
            if self.lit { ("quantity::lit", "shading::lit") } else { ("quantity::pair", "shading::two_scalars") };
        let second = match (self.function, self.second_by_cell) {
            (Classified::OneField, _) => "second::none",
            (_, false) => "second::point",
            (_, true) => "second::cell",
        };
        [
            ("function", function),
            ("lit", lit),
            ("quantity", quantity),
            ("sample", sample),
            ("second", second),
            ("shading", shading),
        ]
    }

    fn has_widgets(&self) -> bool {
        matches!(self.function, Classified::Widgets | Classified::Analytic | Classified::ApproximateWidgets)
    }

    /// Whether its function is one of pieces.
    pub(crate) fn has_pieces(&self) -> bool {
        matches!(self.function, Classified::OneField | Classified::TwoFields)
    }

    /// The buffers that it adds, ascending.
    pub(crate) fn bindings(&self) -> impl Iterator<Item = Binding> {
        [
            (Binding::Seconds, self.function != Classified::OneField),
            (Binding::Gradients, self.lit),
            (Binding::Look, true),
            (Binding::Widgets, self.has_widgets()),
            (Binding::Texels, matches!(self.function, Classified::Image | Classified::ApproximateImage)),
            (Binding::Spent, true),
        ]
        .into_iter()
        .filter_map(|(binding, bound)| bound.then_some(binding))
    }
}

/// Laid out as the shader's `Look` (shaders/lib/look.wgsl), where its members are explained.
#[derive(Debug, Clone, Copy, Default, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub(crate) struct LookBlock {
    pub(crate) shares: [f32; 4],
    pub(crate) direction: [f32; 3],
    pub(crate) silhouette: f32,
    pub(crate) errors: [f32; 2],
    pub(crate) slope: f32,
    pub(crate) curvature: f32,
    pub(crate) scale: [f32; 2],
    pub(crate) origin: [f32; 2],
    pub(crate) size: [u32; 2],
    pub(crate) color_pieces: u32,
    pub(crate) pieces: u32,
    pub(crate) emission: f32,
    pub(crate) unit: f32,
    pub(crate) unused: [f32; 2],
    pub(crate) no_data: [f32; 4],
}

impl LookBlock {
    fn new(look: &Look) -> LookBlock {
        let mut block = LookBlock {
            errors: [look.color_error, 0.0],
            emission: look.emission,
            no_data: look.no_data,
            ..LookBlock::default()
        };
        if let Some(Published::Approximate { pieces, unit, .. }) = look.published {
            (block.pieces, block.unit) = (pieces, unit);
        }
        if let Some((light, turning)) = &look.light {
            (block.shares, block.direction, block.silhouette) = (light.shares, light.direction, light.silhouette);
            (block.errors[1], block.slope, block.curvature) = (turning.error, turning.slope, turning.curvature);
        }
        match &look.function {
            Function::OneField(..) | Function::Vertex(_) | Function::Widgets(_) => {}
            Function::TwoFields([color, _]) => block.color_pieces = color.len() as u32,
            Function::Image(image) => {
                (block.scale, block.origin, block.size) = (image.scale, image.origin, image.size);
            }
        }
        block
    }
}

/// The pieces of two fields, those of the colour first.
pub(super) fn pieces(look: &Look) -> Option<Vec<Piece>> {
    match &look.function {
        Function::TwoFields(lists) => Some(lists.concat()),
        _ => None,
    }
}

/// Bytes of its largest buffer.
pub(super) fn largest(look: &Look) -> u64 {
    let rows = if look.light.is_some() { 16 } else { 4 };
    let points = look.further.iter().map(|field| field.values.len() as u64 * rows).max();
    let function = match &look.function {
        Function::OneField(pieces, _) => size_of_val(&pieces[..]),
        Function::Vertex(_) => 0,
        Function::TwoFields(lists) => lists.iter().map(|pieces| size_of_val(&pieces[..])).sum(),
        Function::Widgets(widgets) => size_of_val(&widgets[..]),
        Function::Image(image) => size_of_val(&image.texels[..]),
    };
    points.unwrap_or(0).max(function as u64)
}

/// What each of its buffers holds; empty for those of other looks.
pub(super) fn contents(look: &Look, binding: Binding) -> Vec<u8> {
    let singles = |values: &[f64]| -> Vec<f32> { values.iter().map(|&v| v as f32).collect() };
    let (second, gradient) = look.further.split_at(usize::from(look.has_second));
    match (binding, &look.function) {
        (Binding::Seconds, _) => {
            second.first().map_or(Vec::new(), |s| bytemuck::cast_slice(&singles(&s.values)).into())
        }
        (Binding::Gradients, _) => {
            let [x, y, z] = gradient else { return Vec::new() };
            let rows = x.values.iter().zip(&y.values).zip(&z.values);
            let rows: Vec<[f32; 4]> = rows.map(|((&x, &y), &z)| [x as f32, y as f32, z as f32, 0.0]).collect();
            bytemuck::cast_slice(&rows).into()
        }
        (Binding::Look, _) => bytemuck::bytes_of(&LookBlock::new(look)).into(),
        (Binding::Widgets, Function::Widgets(widgets)) => {
            let bits = |v: [f32; 4]| v.map(f32::to_bits);
            // One that is not seen if there is none: bindings may not be empty.
            let none = [Widget::default()];
            let widgets = if widgets.is_empty() { &none[..] } else { widgets };
            let rows: Vec<[[u32; 4]; 4]> =
                widgets.iter().map(|w| [bits(w.color), bits(w.support), bits(w.shape), w.kind]).collect();
            bytemuck::cast_slice(&rows).into()
        }
        (Binding::Texels, Function::Image(image)) => bytemuck::cast_slice(&image.texels).into(),
        _ => Vec::new(),
    }
}
