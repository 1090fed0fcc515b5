//! Minimum and median: the two numbers that mean something on a busy machine.

use serde::Deserialize;

/// Repeated measurements of one quantity.
#[derive(Deserialize)]
pub struct Samples(pub Vec<f64>);

impl Samples {
    /// The least disturbed measurement.
    pub fn minimum(&self) -> f64 {
        self.0.iter().copied().fold(f64::INFINITY, f64::min)
    }

    /// The typical measurement.
    pub fn median(&self) -> f64 {
        let mut sorted = self.0.clone();
        sorted.sort_by(f64::total_cmp);
        let middle = sorted.len() / 2;
        if sorted.len() % 2 == 1 { sorted[middle] } else { 0.5 * (sorted[middle - 1] + sorted[middle]) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn minimum_and_median_of_odd_and_even_counts() {
        let odd = Samples(vec![3.0, 1.0, 10.0]);
        assert_eq!((odd.minimum(), odd.median()), (1.0, 3.0));
        let even = Samples(vec![4.0, 1.0, 3.0, 2.0]);
        assert_eq!((even.minimum(), even.median()), (1.0, 2.5));
    }
}
