//! Minimum and median: the two numbers that mean something on a busy machine.

use serde::{Deserialize, Serialize};

/// Repeated measurements of one quantity.
#[derive(Clone, Default, Deserialize)]
pub struct Samples(pub Vec<f64>);

/// Statistics of repeated measurements.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Summary {
    /// The minimum: the measurement with the smallest disturbance.
    pub minimum: f64,
    /// The typical measurement.
    pub median: f64,
}

impl Samples {
    /// Minimum and median.
    pub fn summary(&self) -> Summary {
        let mut sorted = self.0.clone();
        sorted.sort_by(f64::total_cmp);
        let middle = sorted.len() / 2;
        let median = if sorted.len() % 2 == 1 { sorted[middle] } else { 0.5 * (sorted[middle - 1] + sorted[middle]) };
        Summary { minimum: sorted[0], median }
    }
}

impl Summary {
    /// A quantity that was measured once.
    pub fn once(value: f64) -> Self {
        Self { minimum: value, median: value }
    }

    /// The ratio to what was measured in turns with it.
    pub fn over(self, base: Self) -> Self {
        Self { minimum: self.minimum / base.minimum, median: self.median / base.median }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn minimum_and_median_of_odd_and_even_counts() {
        let odd = Samples(vec![3.0, 1.0, 10.0]).summary();
        assert_eq!(odd, Summary { minimum: 1.0, median: 3.0 });
        let even = Samples(vec![4.0, 1.0, 3.0, 2.0]).summary();
        assert_eq!(even, Summary { minimum: 1.0, median: 2.5 });
    }

    #[test]
    fn a_ratio_is_of_minima_and_of_medians() {
        let (slow, quick) = (Summary { minimum: 3.0, median: 8.0 }, Summary { minimum: 2.0, median: 2.0 });
        assert_eq!(slow.over(quick), Summary { minimum: 1.5, median: 4.0 });
    }
}
