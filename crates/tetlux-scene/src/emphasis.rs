//! Luminance and opacity at the vertices, emphasised: what is linear in each cell in place of the scalar.

use std::sync::Arc;

use glam::DVec3;
use rayon::prelude::*;
use tetlux_mesh::{Location, ScalarField, TetMesh};
use tetlux_optics::TransferFunction;
use tetlux_optics::emphasis::{Derivatives, Emphasis, Fitted, Scales};

use crate::{SceneError, View};

/// A field classified at the vertices, its opacity emphasised there.
#[derive(Debug, Clone)]
pub struct Emphasized {
    emphasis: Fitted,
    /// Linear RGB and opacity at every point, but for the silhouette; nothing where there is no value.
    colors: Arc<[[f64; 4]]>,
    /// The gradient at every point, if there is a silhouette.
    gradients: Vec<DVec3>,
}

impl Emphasized {
    /// Classifies a field at the points of its mesh.
    ///
    /// # Errors
    ///
    /// Cell data, which have no derivatives at the vertices; impossible numbers.
    pub fn new(
        emphasis: &Emphasis,
        transfer: &TransferFunction,
        mesh: &TetMesh,
        scalar: &ScalarField,
    ) -> Result<Emphasized, SceneError> {
        if scalar.location != Location::Point {
            return Err(SceneError::Method(format!(
                "an emphasis takes the derivatives of point data, and \"{}\" is constant in each cell: leave out \
                 [emphasis], or take a field of the points",
                scalar.name
            )));
        }
        let gradients = mesh.vertex_gradients(scalar);
        let seconds = mesh.second_derivatives(scalar, &gradients);
        let lengths: Vec<f64> = gradients.iter().map(|g| g.length()).collect();
        let largest = |values: &[f64]| values.iter().filter(|v| v.is_finite()).fold(0.0, |m: f64, v| m.max(v.abs()));
        let [low, high] = mesh.local_bounds();
        let scales = Scales { gradient: largest(&lengths), second: largest(&seconds), diagonal: low.distance(high) };
        let emphasis = emphasis.fit(&scales)?;
        let color = |(&value, (&gradient, &second)): (&f64, (&f64, &f64))| {
            if !value.is_finite() {
                return [0.0; 4];
            }
            let [r, g, b] = transfer.luminance(value);
            [r, g, b, transfer.opacity(value) * emphasis.factor(&Derivatives { value, gradient, second })]
        };
        let colors = scalar.values.par_iter().zip(lengths.par_iter().zip(&seconds)).map(color).collect();
        let gradients = if emphasis.silhouette().is_some() { gradients } else { Vec::new() };
        Ok(Emphasized { emphasis, colors, gradients })
    }

    /// What is emphasised, every scale known.
    pub fn emphasis(&self) -> &Fitted {
        &self.emphasis
    }

    /// Linear RGB and opacity at every point of the mesh, as seen: the same from everywhere without a silhouette, and not
    /// computed anew then.
    pub fn seen(&self, mesh: &TetMesh, view: &View) -> Arc<[[f64; 4]]> {
        if self.gradients.is_empty() {
            return self.colors.clone();
        }
        let from_eye = mesh.origin() - view.eye;
        let seen = |(color, (gradient, point)): (&[f64; 4], (&DVec3, &glam::Vec3))| {
            let ray = if view.orthographic { view.forward } else { point.as_dvec3() + from_eye };
            let toward_eye = (-ray).normalize_or_zero();
            let [r, g, b, opacity] = *color;
            [r, g, b, opacity * self.emphasis.silhouette_factor(gradient.to_array(), toward_eye.to_array())]
        };
        self.colors.par_iter().zip(self.gradients.par_iter().zip(mesh.points())).map(seen).collect()
    }
}
