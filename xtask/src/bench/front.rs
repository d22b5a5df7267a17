//! The Pareto front: what nothing else beats in time and error both.

/// Of pairs of which less is better in both, whether no other is at least as good in both and better in one.
pub(crate) fn front(points: &[[f64; 2]]) -> Vec<bool> {
    let beats = |a: &[f64; 2], b: &[f64; 2]| a[0] <= b[0] && a[1] <= b[1] && a != b;
    points.iter().map(|point| !points.iter().any(|other| beats(other, point))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_beaten_is_not_on_it() {
        // Fast and wrong, slow and right, in between; slower than that at the same error; beaten in both; equal to another.
        let points = [[1.0, 9.0], [9.0, 1.0], [5.0, 5.0], [6.0, 5.0], [9.5, 9.5], [1.0, 9.0]];
        assert_eq!(front(&points), [true, true, true, false, false, true]);
        assert!(front(&[]).is_empty());
    }
}
