//! What several test modules need.

use glam::DVec3;
use tetlux_mesh::procedural::Parts;
use tetlux_mesh::{Component, Field, ScalarField, TetMesh};
use tetlux_optics::{Classification, ColorNode, OpacityNode, TransferFunction};

use crate::{Caster, DEFAULT_TOLERANCE, Radiance, Ray, Scene};

/// A mesh and a scalar, on the points by position or on the cells.
pub(crate) struct Body {
    pub(crate) mesh: TetMesh,
    pub(crate) scalar: ScalarField,
}

impl Body {
    pub(crate) fn by_point(parts: &Parts, f: impl FnMut(DVec3) -> f64) -> Self {
        Self::new(parts, Field::point("s", 1, parts.sample(f)))
    }

    pub(crate) fn by_cell(parts: &Parts, values: Vec<f64>) -> Self {
        Self::new(parts, Field::cell("s", 1, values))
    }

    fn new(parts: &Parts, field: Field) -> Self {
        let mesh = TetMesh::assemble(&parts.points, &parts.cells, vec![field]).unwrap();
        let scalar = mesh.scalar("s", Component::Magnitude).unwrap();
        Self { mesh, scalar }
    }

    pub(crate) fn scene<'a>(&'a self, classification: &'a Classification) -> Scene<'a> {
        Scene {
            mesh: &self.mesh,
            scalar: &self.scalar,
            second: None,
            classification,
            lighting: None,
            colors: None,
            unit_distance: 1.0,
            tolerance: DEFAULT_TOLERANCE,
        }
    }

    pub(crate) fn caster<'a>(&'a self, classification: &'a Classification) -> Caster<'a> {
        Caster::new(self.scene(classification)).unwrap()
    }
}

/// Nodes of opacity and of one luminance component (the same in all channels).
pub(crate) fn transfer(opacity: &[[f64; 2]], luminance: &[[f64; 2]]) -> Classification {
    let nodes = TransferFunction::new(
        luminance.iter().map(|&[s, l]| ColorNode { s, rgb: [l; 3] }).collect(),
        opacity.iter().map(|&[s, opacity]| OpacityNode { s, opacity }).collect(),
    );
    Classification::OneField(nodes.unwrap())
}

/// White everywhere, of one opacity.
pub(crate) fn fog(opacity: f64) -> Classification {
    transfer(&[[0.0, opacity]], &[[0.0, 1.0]])
}

pub(crate) fn ray(origin: [f64; 3], direction: [f64; 3]) -> Ray {
    Ray { origin: origin.into(), direction: direction.into(), start: 0.0, end: f64::INFINITY }
}

/// The whole line of a ray.
pub(crate) fn line(origin: DVec3, direction: DVec3) -> Ray {
    Ray { origin, direction, start: f64::NEG_INFINITY, end: f64::INFINITY }
}

/// Optical depth back from alpha.
pub(crate) fn depth(seen: Radiance) -> f64 {
    -(-seen.alpha).ln_1p()
}

/// World length of a ray in an axis-aligned box.
pub(crate) fn length_in_box(ray: &Ray, [low, high]: [DVec3; 2]) -> f64 {
    let (mut from, mut to) = (ray.start, ray.end);
    for k in 0..3 {
        if ray.direction[k] == 0.0 {
            if !(low[k] < ray.origin[k] && ray.origin[k] < high[k]) {
                return 0.0;
            }
        } else {
            let a = (low[k] - ray.origin[k]) / ray.direction[k];
            let b = (high[k] - ray.origin[k]) / ray.direction[k];
            (from, to) = (from.max(a.min(b)), to.min(a.max(b)));
        }
    }
    (to - from).max(0.0) * ray.direction.length()
}

/// Numbers in [0, 1) from a seed (SplitMix64, Steele et al. 2014).
pub(crate) fn numbers(mut seed: u64) -> impl FnMut() -> f64 {
    move || {
        seed = seed.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = seed;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }
}
