//! What a point of the volume looks like by its one or two scalars.

#[cfg(test)]
mod tests;

use crate::image_function::ImageFunction;
use crate::transfer::TransferFunction;
use crate::widget::{BivariateFunction, Rectangle};

/// How scalars become luminance and opacity. A point is (x, y); y is not looked at where one field is enough.
#[derive(Clone, Debug, PartialEq)]
pub enum Classification {
    /// Luminance and opacity of x.
    OneField(TransferFunction),
    /// Luminance of x, opacity of y: each has its own nodes in the transfer function.
    TwoFields(TransferFunction),
    /// Widgets over (x, y): y is a second field or the magnitude of x's gradient (Song et al. 2009).
    Widgets(BivariateFunction),
    /// An image over (x, y).
    Image(ImageFunction),
}

impl Classification {
    /// Whether the second scalar counts.
    pub fn is_bivariate(&self) -> bool {
        !matches!(self, Self::OneField(_))
    }

    /// Opacity (extinction times the unit distance) at (x, y); at a step of a transfer function the value from above.
    pub fn opacity(&self, point: [f64; 2]) -> f64 {
        match self {
            Self::OneField(transfer) => transfer.opacity(point[0]),
            Self::TwoFields(transfer) => transfer.opacity(point[1]),
            Self::Widgets(function) => function.opacity(point),
            Self::Image(image) => image.at(point)[3],
        }
    }

    /// Linear RGB luminance at (x, y).
    pub fn luminance(&self, point: [f64; 2]) -> [f64; 3] {
        match self {
            Self::OneField(transfer) | Self::TwoFields(transfer) => transfer.luminance(point[0]),
            Self::Widgets(function) => function.luminance(point),
            Self::Image(image) => {
                let [r, g, b, _] = image.at(point);
                [r, g, b]
            }
        }
    }

    /// Whether anything may be seen where x and y stay in a rectangle: no means that the opacity is 0 there, or, of
    /// Gaussians, below [`crate::widget::GAUSSIAN_TAIL`] of their peaks.
    pub fn is_visible_over(&self, range: &Rectangle) -> bool {
        match self {
            Self::OneField(transfer) => transfer.max_opacity(range.s) > 0.0,
            Self::TwoFields(transfer) => transfer.max_opacity(range.g) > 0.0,
            Self::Widgets(function) => function.is_visible_over(range),
            Self::Image(image) => image.max_opacity_over(range) > 0.0,
        }
    }

    /// The luminance, if it is the same wherever something is seen: then the order of segments along a ray does not
    /// matter. Black where nothing is.
    pub fn single_luminance(&self) -> Option<[f64; 3]> {
        match self {
            Self::OneField(transfer) => transfer.single_luminance(),
            Self::TwoFields(transfer) => {
                let first = transfer.color_nodes()[0].rgb;
                transfer.color_nodes().iter().all(|node| node.rgb == first).then_some(first)
            }
            Self::Widgets(function) => function.single_color(),
            // Texels of opacity 0 count too: between two nodes their luminance shows.
            Self::Image(image) => {
                let [r, g, b, _] = image.texels()[0];
                let same = image.texels().iter().all(|texel| texel[..3] == [r, g, b]);
                same.then_some([r, g, b].map(f64::from))
            }
        }
    }

    /// The largest component of any luminance.
    pub fn brightest(&self) -> f64 {
        let largest = |values: &mut dyn Iterator<Item = f64>| values.fold(0.0, f64::max);
        match self {
            Self::OneField(transfer) | Self::TwoFields(transfer) => {
                largest(&mut transfer.color_nodes().iter().flat_map(|node| node.rgb))
            }
            Self::Widgets(function) => largest(&mut function.widgets.iter().flat_map(|widget| widget.color())),
            Self::Image(image) => largest(&mut image.texels().iter().flat_map(|t| [t[0], t[1], t[2]]).map(f64::from)),
        }
    }
}
