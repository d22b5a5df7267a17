//! What is seen where a field has no value.

/// The look of cells without data, those with a value that is NaN or infinite: the same throughout each of them, unlit.
///
/// ParaView's NaN colour and NaN opacity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NoData {
    luminance: [f64; 3],
    opacity: f64,
}

/// A luminance or an opacity that cannot be.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum NoDataError {
    /// A component of the luminance that is negative or not finite.
    #[error("{0:?} must be three finite numbers of at least 0: red, green, blue")]
    Luminance([f64; 3]),
    /// An opacity that is negative or not finite.
    #[error("{0} must be finite and at least 0: 0 leaves cells without data out")]
    Opacity(f64),
}

impl NoData {
    /// ParaView's colour where neither scene nor preset gives one: yellow.
    pub const LUMINANCE: [f64; 3] = [1.0, 1.0, 0.0];

    /// Linear RGB luminance, each at least 0, and opacity (extinction times the unit distance), which may exceed 1.
    ///
    /// # Errors
    ///
    /// A number that is negative or not finite.
    pub fn new(luminance: [f64; 3], opacity: f64) -> Result<NoData, NoDataError> {
        let fits = |value: f64| value >= 0.0 && value.is_finite();
        if !luminance.into_iter().all(fits) {
            return Err(NoDataError::Luminance(luminance));
        }
        if fits(opacity) { Ok(NoData { luminance, opacity }) } else { Err(NoDataError::Opacity(opacity)) }
    }

    /// Linear RGB luminance.
    pub fn luminance(&self) -> [f64; 3] {
        self.luminance
    }

    /// Extinction times the unit distance.
    pub fn opacity(&self) -> f64 {
        self.opacity
    }

    /// Whether cells without data are seen at all.
    pub fn is_visible(&self) -> bool {
        self.opacity > 0.0
    }
}

/// Cells without data are left out.
impl Default for NoData {
    fn default() -> NoData {
        NoData { luminance: NoData::LUMINANCE, opacity: 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_cannot_be_is_refused() {
        let white = [1.0; 3];
        assert!(NoData::new(white, 0.0).is_ok_and(|none| !none.is_visible()));
        assert!(NoData::new([0.0, 7.0, 0.5], 1e300).is_ok_and(|some| some.is_visible()));
        for bad in [-1.0, f64::NAN, f64::INFINITY] {
            assert!(NoData::new(white, bad).unwrap_err().to_string().contains("at least 0"));
            assert!(matches!(NoData::new([1.0, bad, 1.0], 1.0), Err(NoDataError::Luminance(_))));
        }
        assert!(!NoData::default().is_visible());
    }
}
