//! What each choice of the plan means, in a line.

use crate::{CellProjection, Classification, Integrator, Interpolation, TablePrecision, Target};

pub(crate) fn of_projection(projection: CellProjection) -> &'static str {
    match projection {
        CellProjection::Auto | CellProjection::Pt => "a compute stage projects each cell once",
        CellProjection::Balanced => "distances and scalars found at vertices, and interpolated",
        CellProjection::March => "every pixel walks from cell to cell, without order or blending",
        CellProjection::Tiles => "cells binned into tiles in their order, composited in registers, without blending",
        CellProjection::Vicp => "front faces are drawn, fragments find the back end",
        CellProjection::Gator => "the vertex stage projects each cell, once for every vertex of its triangles",
    }
}

pub(crate) fn of_interpolation(interpolation: Interpolation) -> &'static str {
    match interpolation {
        Interpolation::Auto | Interpolation::Ray => "every fragment finds its own segment: exact",
        Interpolation::Perspective => "values over depth, over the triangles around the thick vertex",
        Interpolation::ScreenLinear => "linear in the picture: wrong where a cell's depth varies",
    }
}

pub(crate) fn of_integrator(integrator: Integrator) -> &'static str {
    match integrator {
        Integrator::Auto | Integrator::Direct => "linear luminance and extinction, relative error 1e-5, no table",
        Integrator::Average => "mean luminance and extinction: colour is approximate",
        Integrator::Linear => "linear luminance and extinction as published: not stable",
        Integrator::Psi => "psi from a table of 512 x 512: thin segments lose their digits",
        Integrator::Q => "q from a table of 128 x 128: error 4.7e-5 a segment",
        Integrator::Symmetric => "linear luminance and extinction, relative error 1e-5, no division",
        Integrator::Preint => "pre-integrated, 128 x 128 scalars x 64 equal thicknesses",
        Integrator::PreintLog => {
            "pre-integrated, 256 x 256 scalars x 16 doubling thicknesses: 6 % too much between them"
        }
        Integrator::Adaptive => "in pieces by the error allowed, opacity exact",
        Integrator::Analytic => {
            "as published, by tables: emission density, not the reference's model; a Gaussian ends at 3 sigma"
        }
        Integrator::Approximate => "as published, F and B by table: emission density, not the reference's model",
        Integrator::PreintQ => "pre-integrated mean extinction, 512 x 512, and colour / alpha, 128 x 128 x 32",
    }
}

pub(crate) fn of_classification(classification: Classification) -> &'static str {
    match classification {
        Classification::Auto | Classification::PostExact => "split at the function's control points",
        Classification::PostClip => "each cell clipped to every piece of the function that it meets",
        Classification::Vertex => "at the vertices: what lies between their scalars is lost",
    }
}

pub(crate) fn of_table_precision(precision: TablePrecision) -> &'static str {
    match precision {
        TablePrecision::Auto | TablePrecision::F32 => "24 significant bits",
        TablePrecision::U8 => "256 steps over the range of values",
        TablePrecision::U16 => "65536 steps over the range of values",
        TablePrecision::F16 => "11 significant bits",
    }
}

pub(crate) fn of_target(target: Target) -> &'static str {
    match target {
        Target::Auto | Target::Rgba32f => "off by 5e-7 after a thousand cells",
        Target::Rgba8 => "every cell is rounded to 1/255, and thin ones vanish",
        Target::Rgba8Dither => "every cell is rounded to 1/255 at random, right in the mean",
        Target::Rgba16f => "off by up to 5e-2 after a thousand cells",
    }
}
