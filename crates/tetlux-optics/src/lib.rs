//! Transfer functions and ray-segment integrals of the emission-absorption model.
//!
//! A ray crosses a tetrahedron in a segment along which the scalar is linear. A transfer function turns the scalar
//! into luminance L (linear RGB) and opacity; extinction, per world length, is opacity / unit distance. Light that
//! enters the back end (`b`) leaves the front end (`f`, the eye's side) as
//!
//! ```text
//! I = I_0 (1 - alpha) + L_b w_b + L_f w_f,    w_b + w_f = alpha
//! ```
//!
//! | module | gives |
//! |---|---|
//! | [`transfer`] | what a 1D transfer function is |
//! | [`preset`] | transfer functions from ParaView's preset files |
//! | [`segment`] | the weights and whole segments in f64, relative error below 1e-12 |
//! | [`emission`] | emission that is not multiplied by the extinction, and the average model, in f64 |
//! | [`published`] | the linear closed form as it was published, which is not stable, in f64 |
//! | [`widget`] | what a bivariate transfer function is: widgets over two scalars |
//! | [`image_function`] | the same painted as an image |
//! | [`classification`] | any of these over one or two scalars |
//! | [`no_data`], [`no_data_f32`] | what cells without a finite value look like |
//! | [`widget_integral`] | segments through widgets in f64, relative error below 1e-12 |
//! | [`segment_f32`] | the shader's arithmetic in f32, line by line |
//! | [`symmetric_f32`] | the same weights without division, in f32, as a shader has them |
//! | [`published_f32`] | the published form in f32, as a shader has it |
//! | [`transfer_f32`] | whole segments in the shader's arithmetic |
//! | [`light`], [`light_f32`] | shading by the gradient, silhouettes |
//! | [`lit_f32`] | segments lit to a stated error, in f32 |
//! | [`emphasis`] | opacity at the vertices, emphasised by first and second derivatives |
//! | [`vertex_f32`] | segments of what is classified at the vertices, in the shader's arithmetic |
//! | [`lit_linear_f32`] | lit segments of one or two fields' transfer functions, to a proved error, in f32 |
//! | [`erf_f32`] | the error function as a shader has it |
//! | [`widget_f32`], [`widgets_f32`] | widgets, and segments through any number of them to a stated error, in f32 |
//! | [`two_field_f32`] | colour of one scalar, opacity of another, exact, in f32 |
//! | [`image_f32`] | image functions to a stated error, in f32 |
//! | [`accuracy`] | inputs and measure of the stated f32 errors |
//! | [`color_space`] | the colour spaces in which presets are interpolated |
//!
//! ```
//! use tetlux_optics::segment::segment;
//! use tetlux_optics::transfer::{ColorNode, OpacityNode, TransferFunction};
//!
//! let ember = TransferFunction::new(
//!     vec![ColorNode { s: 0.0, rgb: [1.0, 0.2, 0.0] }],
//!     vec![OpacityNode { s: 0.0, opacity: 0.0 }, OpacityNode { s: 1.0, opacity: 2.0 }],
//! )?;
//! // Through the whole range over three world units: the mean opacity is 1, so the optical depth is 3.
//! let through = segment(&ember, 1.0, 0.0, 1.0, 3.0);
//! assert!((through.transmittance - (-3.0_f64).exp()).abs() < 1e-15);
//! assert!((through.color[0] - through.alpha).abs() < 1e-15);
//! # Ok::<(), tetlux_optics::transfer::TransferFunctionError>(())
//! ```

pub mod accuracy;
pub mod classification;
pub mod color_space;
pub mod emission;
pub mod emphasis;
pub mod erf_f32;
pub mod image_f32;
pub mod image_function;
pub mod light;
pub mod light_f32;
pub mod lit_f32;
pub mod lit_linear_f32;
pub mod no_data;
pub mod no_data_f32;
pub mod preset;
pub mod published;
pub mod published_f32;
mod quadrature;
pub mod segment;
pub mod segment_f32;
mod span;
pub mod symmetric_f32;
#[cfg(test)]
mod testing;
pub mod transfer;
pub mod transfer_f32;
pub mod two_field_f32;
pub mod vertex_f32;
pub mod widget;
pub mod widget_f32;
pub mod widget_integral;
pub mod widgets_f32;

pub use classification::Classification;
pub use emission::EmissionConvention;
pub use emphasis::{Emphasis, EmphasisError};
pub use image_function::{ImageFunction, ImageFunctionError};
pub use light::{Light, LightError};
pub use no_data::{NoData, NoDataError};
pub use preset::{Preset, PresetError, read_preset};
pub use transfer::{ColorNode, OpacityNode, Piece, TransferFunction, TransferFunctionError};
pub use widget::{BivariateFunction, Widget, WidgetError};
