//! How narrow the bands of a wave may be on a mesh.

/// Highest frequencies, in bands per unit of a field, at which no cell holds more than one band.
///
/// The published analytic form allows one peak along a ray in a cell (Song et al. 2009, section 6.3): the phase may grow
/// by one period at most over a cell's range of the field. Cells of constant value allow any.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FrequencyLimits {
    /// For every cell.
    pub all: f64,
    /// For 99 of 100 cells.
    pub most: f64,
    /// For half of the cells.
    pub half: f64,
}

/// The limits from the range of every cell; cells without data do not count. None where every cell is constant.
pub fn frequency_limits(ranges: &[[f64; 2]]) -> Option<FrequencyLimits> {
    let mut widths: Vec<f64> = ranges.iter().map(|[low, high]| high - low).filter(|width| width.is_finite()).collect();
    widths.sort_unstable_by(f64::total_cmp);
    let last = widths.len().checked_sub(1)?;
    let at = |share: f64| 1.0 / widths[(share * last as f64).ceil() as usize];
    (widths[last] > 0.0).then(|| FrequencyLimits { all: at(1.0), most: at(0.99), half: at(0.5) })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_widest_cell_decides() {
        let mut ranges: Vec<[f64; 2]> = (0..=100).map(|k| [2.0, 2.0 + 0.01 * f64::from(k)]).collect();
        let limits = frequency_limits(&ranges).unwrap();
        let close = |a: f64, b: f64| (a / b - 1.0).abs() < 1e-12;
        assert!(close(limits.all, 1.0) && close(limits.most, 1.0 / 0.99) && close(limits.half, 2.0), "{limits:?}");
        // A missing value, and one wide cell more.
        ranges.extend([[f64::NAN; 2], [0.0, 4.0]]);
        assert!(close(frequency_limits(&ranges).unwrap().all, 0.25));
        assert_eq!(frequency_limits(&[[3.0; 2]; 5]), None);
        assert_eq!(frequency_limits(&[]), None);
    }
}
