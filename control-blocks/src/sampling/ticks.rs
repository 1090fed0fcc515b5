//! Times in whole samples.

/// Whole samples of `period` s (positive) in `time` s, rounded; 0 for a negative time.
pub fn ticks(time: f64, period: f64) -> u32 {
    // half up, by a cast that cuts off and keeps to the range: `round` would be a call in every sample
    (time / period + 0.5) as u32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_restored_from_their_samples() {
        for period in [1e-4, 1e-3, 0.01, 1.0 / 3.0] {
            for count in [0, 1, 3, 7, 1000, 36_000_001] {
                assert_eq!(ticks(f64::from(count) * period, period), count);
            }
        }
    }

    #[test]
    fn the_nearest_sample_counts() {
        assert_eq!((ticks(0.0149, 0.01), ticks(0.0151, 0.01)), (1, 2));
        assert_eq!((ticks(-1.0, 0.01), ticks(1e300, 0.01)), (0, u32::MAX));
    }
}
