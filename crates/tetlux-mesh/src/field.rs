//! Data on points and cells.

/// Where a field's values live.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Location {
    /// One tuple a point: linear inside each tetrahedron.
    Point,
    /// One tuple a cell: constant inside it.
    Cell,
}

impl Location {
    /// "points" or "cells".
    pub fn plural(self) -> &'static str {
        match self {
            Location::Point => "points",
            Location::Cell => "cells",
        }
    }
}

/// A named array of tuples on the points or on the cells.
#[derive(Debug, Clone, PartialEq)]
pub struct Field {
    /// Name, as in the file.
    pub name: String,
    /// Points or cells.
    pub location: Location,
    /// Values in each tuple, at least 1.
    pub components: usize,
    /// Tuples one after another. May hold NaN where data are missing.
    pub values: Vec<f64>,
}

impl Field {
    /// A field on the points.
    pub fn point(name: impl Into<String>, components: usize, values: Vec<f64>) -> Self {
        Field { name: name.into(), location: Location::Point, components, values }
    }

    /// A field on the cells.
    pub fn cell(name: impl Into<String>, components: usize, values: Vec<f64>) -> Self {
        Field { name: name.into(), location: Location::Cell, components, values }
    }

    /// Smallest and largest finite value of a component; `None` if there is none, or no such component.
    pub fn range(&self, component: Component) -> Option<[f64; 2]> {
        finite_range(self.scalars(component))
    }

    /// The scalar of each tuple.
    pub(crate) fn scalars(&self, component: Component) -> impl Iterator<Item = f64> + '_ {
        self.values.chunks_exact(self.components.max(1)).map(move |tuple| match (component, tuple) {
            (Component::Magnitude, [value]) => *value,
            (Component::Magnitude, tuple) => magnitude(tuple),
            (Component::Index(i), tuple) => tuple.get(i).copied().unwrap_or(f64::NAN),
        })
    }
}

/// Euclidean norm, scaled so that squares neither overflow nor vanish.
fn magnitude(tuple: &[f64]) -> f64 {
    let largest = tuple.iter().fold(0.0f64, |m, x| if x.is_nan() { f64::NAN } else { m.max(x.abs()) });
    if largest == 0.0 || !largest.is_finite() {
        return largest;
    }
    largest * tuple.iter().map(|x| (x / largest) * (x / largest)).sum::<f64>().sqrt()
}

/// Which scalar to take of a tuple.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Component {
    /// Euclidean norm; of one component the value itself, sign and all.
    #[default]
    Magnitude,
    /// One component, numbered from 0.
    Index(usize),
}

/// One scalar a point or a cell, ready to be classified.
#[derive(Debug, Clone, PartialEq)]
pub struct ScalarField {
    /// Name of the field it was taken from.
    pub name: String,
    /// Points or cells.
    pub location: Location,
    /// One value each; not finite where data are missing.
    pub values: Vec<f64>,
    /// Smallest and largest finite value.
    pub range: [f64; 2],
    /// Values that are NaN or infinite.
    pub missing: usize,
}

impl ScalarField {
    /// Whether another has the same values in the same places, bit for bit: missing ones are equal to themselves.
    pub fn is_same(&self, other: &ScalarField) -> bool {
        self.location == other.location
            && self.values.len() == other.values.len()
            && self.values.iter().zip(&other.values).all(|(a, b)| a.to_bits() == b.to_bits())
    }
}

pub(crate) fn finite_range(values: impl Iterator<Item = f64>) -> Option<[f64; 2]> {
    let mut range: Option<[f64; 2]> = None;
    for v in values.filter(|v| v.is_finite()) {
        let [lo, hi] = range.unwrap_or([v, v]);
        range = Some([lo.min(v), hi.max(v)]);
    }
    range
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn magnitude_neither_overflows_nor_vanishes() {
        assert_eq!(magnitude(&[3.0, 4.0]), 5.0);
        // Scaling by the largest component keeps the result within a few roundings of exact.
        for scale in [1e200, 1e-200] {
            assert!((magnitude(&[3.0 * scale, 4.0 * scale]) / (5.0 * scale) - 1.0).abs() < 4.0 * f64::EPSILON);
        }
        assert!(magnitude(&[f64::NAN, 1.0]).is_nan());
        assert!(magnitude(&[1.0, f64::NAN]).is_nan());
    }

    #[test]
    fn a_field_is_the_same_bit_for_bit() {
        let field = |values: Vec<f64>, location| ScalarField {
            name: "f".into(),
            location,
            values,
            range: [0.0, 1.0],
            missing: 1,
        };
        let one = field(vec![0.0, 1.0, f64::NAN], Location::Point);
        assert!(one.is_same(&ScalarField { name: "g".into(), ..one.clone() }));
        assert!(!one.is_same(&field(vec![-0.0, 1.0, f64::NAN], Location::Point)));
        assert!(!one.is_same(&field(one.values.clone(), Location::Cell)));
        assert!(!one.is_same(&field(vec![0.0, 1.0], Location::Point)));
    }

    #[test]
    fn ranges_pass_over_missing_values() {
        let field = Field::point("p", 2, vec![1.0, f64::NAN, 3.0, 4.0, f64::INFINITY, 0.0]);
        assert_eq!(field.range(Component::Index(0)), Some([1.0, 3.0]));
        assert_eq!(field.range(Component::Magnitude), Some([5.0, 5.0]));
        assert_eq!(field.range(Component::Index(2)), None);
        let signed = Field::point("q", 1, vec![-2.0, 1.0]);
        assert_eq!(signed.range(Component::Magnitude), Some([-2.0, 1.0]));
        assert_eq!(signed.range(Component::Index(1)), None);
        assert_eq!(Field::cell("c", 1, vec![f64::NAN]).range(Component::Magnitude), None);
    }
}
