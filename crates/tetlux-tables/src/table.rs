//! A table: nodes, texels, and where they came from.

use serde::{Deserialize, Serialize};

use crate::axis::{Axis, unit};
use crate::spec::{SpecError, TableSpec};
use crate::{integral_tables, precision, preintegration, widget_tables};

/// Largest and mean error over a dense, adversarial set of points.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct MeasuredError {
    /// What is in error, in words.
    pub quantity: String,
    /// Largest absolute error.
    pub max: f64,
    /// Mean absolute error.
    pub mean: f64,
    /// Number of points.
    pub points: u64,
}

/// Values of a function at the nodes of its axes.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    spec: TableSpec,
    axes: Vec<Axis>,
    texels: Vec<f32>,
}

impl Table {
    /// Computes every texel, in parallel, and rounds it to the specification's precision.
    ///
    /// # Errors
    /// [`SpecError`] if the specification is not valid; nothing is allocated then.
    pub fn build(spec: &TableSpec) -> Result<Self, SpecError> {
        use crate::spec::TableKind as Kind;
        spec.validate()?;
        let axes = spec.axes();
        let mut texels = match &spec.kind {
            Kind::Psi => integral_tables::psi(&axes),
            Kind::Q { design } => integral_tables::q(&axes, *design),
            Kind::QPair => integral_tables::q_pair(&axes),
            Kind::FrontBack { .. } => integral_tables::front_back(&axes),
            Kind::Gaussian { .. } => widget_tables::gaussian(&axes),
            Kind::GaussianBounded { .. } => widget_tables::gaussian_bounded(&axes),
            Kind::Sine { .. } => widget_tables::sine(&axes),
            Kind::SineBounded => widget_tables::sine_bounded(&axes),
            Kind::Triangle { .. } => widget_tables::triangle(&axes),
            Kind::PreIntegrated { transfer, construction, .. } => {
                preintegration::pre_integrated(&axes, transfer, *construction)?
            }
            Kind::MeanExtinction { transfer } => preintegration::mean_extinction(&axes, transfer)?,
            Kind::ColorRatio { transfer } => preintegration::color_ratio(&axes, transfer)?,
        };
        precision::quantise(&mut texels, spec.channels().len(), spec.precision);
        Ok(Self { spec: spec.clone(), axes, texels })
    }

    /// A table from texels that are already there; `None` if their number is not what `spec` says.
    pub(crate) fn from_texels(spec: &TableSpec, texels: Vec<f32>) -> Option<Self> {
        let nodes: usize = spec.size.iter().map(|&nodes| nodes as usize).product();
        (texels.len() == nodes * spec.channels().len()).then(|| Self { spec: spec.clone(), axes: spec.axes(), texels })
    }

    /// What the table holds.
    pub fn spec(&self) -> &TableSpec {
        &self.spec
    }

    /// Two or three axes, the fastest first.
    pub fn axes(&self) -> &[Axis] {
        &self.axes
    }

    /// All values, f32, channels interleaved: value `c` of node (i, j, k) at `((k ny + j) nx + i) channels + c`.
    pub fn texels(&self) -> &[f32] {
        &self.texels
    }

    /// Bytes the table takes in its precision.
    pub fn bytes(&self) -> usize {
        self.texels.len() * self.spec.precision.bytes()
    }

    /// blake3 of the decoded texels (f32, little-endian, interleaved), as 64 hexadecimal digits.
    pub fn hash(&self) -> String {
        let mut hasher = blake3::Hasher::new();
        let mut bytes = Vec::with_capacity(1 << 16);
        for block in self.texels.chunks(1 << 14) {
            bytes.clear();
            bytes.extend(block.iter().flat_map(|value| value.to_le_bytes()));
            hasher.update(&bytes);
        }
        hasher.finalize().to_hex().to_string()
    }

    /// Largest difference from another table of the same size, as a share of the largest value of the channel;
    /// infinite if the sizes differ or a value is NaN.
    pub fn difference(&self, other: &Table) -> f64 {
        let channels = self.spec.channels().len();
        if (self.spec.size, channels) != (other.spec.size, other.spec.channels().len()) {
            return f64::INFINITY;
        }
        let of = |channel: usize| {
            let values = |table: &Table| {
                let values: Vec<f32> = table.texels.iter().skip(channel).step_by(channels).copied().collect();
                values
            };
            let (mine, theirs) = (values(self), values(other));
            let scale = mine.iter().map(|v| f64::from(v.abs())).fold(f64::MIN_POSITIVE, f64::max);
            let differences = mine.iter().zip(&theirs).map(|(a, b)| (f64::from(*a) - f64::from(*b)).abs());
            differences.fold(0.0, |max: f64, d| if d.is_nan() { f64::INFINITY } else { max.max(d) }) / scale
        };
        (0..channels).map(of).fold(0.0, f64::max)
    }

    /// Multilinear interpolation at coordinates in [0, 1] along each axis, from the nearest 4 or 8 texels, in f32 as a
    /// shader does it by hand. Unused channels are 0, and so is the third coordinate of a table of two axes.
    pub fn interpolate(&self, coordinates: [f32; 3]) -> [f32; 4] {
        let mut low = [0; 3];
        let mut high = [0; 3];
        let mut share = [0.0; 3];
        for axis in 0..self.axes.len() {
            let last = self.spec.size[axis] as usize - 1;
            let position = unit(coordinates[axis]) * last as f32;
            low[axis] = (position as usize).min(last - 1);
            high[axis] = low[axis] + 1;
            share[axis] = position - low[axis] as f32;
        }
        let plane = |k: usize| {
            let row = |j: usize| mix(self.texel(low[0], j, k), self.texel(high[0], j, k), share[0]);
            mix(row(low[1]), row(high[1]), share[1])
        };
        if self.axes.len() == 2 { plane(0) } else { mix(plane(low[2]), plane(high[2]), share[2]) }
    }

    /// The channels of node (i, j, k); unused ones are 0.
    pub(crate) fn texel(&self, i: usize, j: usize, k: usize) -> [f32; 4] {
        let [nx, ny, _] = self.spec.size.map(|nodes| nodes as usize);
        let channels = self.spec.channels().len();
        let at = ((k * ny + j) * nx + i) * channels;
        let mut values = [0.0; 4];
        for (value, texel) in values.iter_mut().zip(&self.texels[at..at + channels]) {
            *value = *texel;
        }
        values
    }
}

fn mix(low: [f32; 4], high: [f32; 4], share: f32) -> [f32; 4] {
    std::array::from_fn(|c| low[c] + (high[c] - low[c]) * share)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spec::TableKind;
    use crate::{Design, Precision};

    fn small(size: [u32; 3], kind: TableKind) -> TableSpec {
        TableSpec { id: "test".to_owned(), kind, size, precision: Precision::F32 }
    }

    #[test]
    fn interpolation_is_exact_for_a_multilinear_function() {
        let spec = small([3, 4, 5], TableKind::FrontBack { max_extinction: 1.0, max_length: 1.0 });
        let f = |x: f32, y: f32, z: f32| [1.0 + 2.0 * x - y + x * y * z, z - x];
        let mut texels = Vec::new();
        for k in 0..5 {
            for j in 0..4 {
                for i in 0..3 {
                    texels.extend(f(i as f32 / 2.0, j as f32 / 3.0, k as f32 / 4.0));
                }
            }
        }
        let table = Table::from_texels(&spec, texels).unwrap();
        for at in [[0.0, 0.0, 0.0], [1.0, 1.0, 1.0], [0.3, 0.9, 0.55], [0.5, 1.0 / 3.0, 0.25]] {
            let got = table.interpolate(at);
            let expected = f(at[0], at[1], at[2]);
            for c in 0..2 {
                assert!((got[c] - expected[c]).abs() < 1e-6, "{at:?}: {got:?} for {expected:?}");
            }
        }
        assert_eq!(table.interpolate([f32::NAN, -3.0, 9.0]), table.interpolate([0.0, 0.0, 1.0]));
    }

    #[test]
    fn the_hash_sees_a_single_bit() {
        let table = Table::build(&small([4, 4, 1], TableKind::Q { design: Design::Q })).unwrap();
        let mut texels = table.texels().to_vec();
        assert_eq!(Table::from_texels(table.spec(), texels.clone()).unwrap().hash(), table.hash());
        texels[7] = f32::from_bits(texels[7].to_bits() ^ 1);
        assert_ne!(Table::from_texels(table.spec(), texels).unwrap().hash(), table.hash());
    }

    #[test]
    fn the_difference_is_relative_to_the_largest_value_of_the_channel() {
        let spec = small([2, 2, 1], TableKind::QPair);
        let table = |texels: [f32; 8]| Table::from_texels(&spec, texels.to_vec()).unwrap();
        let a = table([1.0, 40.0, 4.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
        assert_eq!(a.difference(&a), 0.0);
        assert_eq!(a.difference(&table([1.0, 40.0, 3.0, 0.0, 0.0, 0.0, 0.0, 0.0])), 0.25);
        assert_eq!(a.difference(&table([1.0, 20.0, 4.0, 0.0, 0.0, 0.0, 0.0, 0.0])), 0.5);
        assert_eq!(a.difference(&table([f32::NAN, 40.0, 4.0, 0.0, 0.0, 0.0, 0.0, 0.0])), f64::INFINITY);
        assert_eq!(a.difference(&Table::build(&small([2, 2, 1], TableKind::Psi)).unwrap()), f64::INFINITY);
    }

    #[test]
    fn a_wrong_number_of_texels_is_no_table() {
        let spec = small([4, 4, 1], TableKind::Psi);
        assert!(Table::from_texels(&spec, vec![0.0; 15]).is_none());
        assert!(Table::from_texels(&spec, vec![0.0; 16]).is_some());
    }
}
