//! A cycle without progress.
//!
//! Two limits. The cycle has a budget of samples that no change of state restores. And the quantity to be reduced must
//! fall below its smallest value so far by a fraction within a number of samples.

use serde::{Deserialize, Serialize};

/// Samples of a cycle, and its best value so far.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Progress {
    samples: u64,
    best: Option<f64>,
    since: u64,
}

impl Progress {
    /// A new cycle.
    pub fn restart(&mut self) {
        *self = Self::default();
    }

    /// Counts one sample of the cycle.
    pub fn count(&mut self) {
        self.samples = self.samples.saturating_add(1);
        self.since = self.since.saturating_add(1);
    }

    /// Adds the quantity to be reduced; it improves when it is below `1 - ratio` of the best so far.
    pub fn measure(&mut self, left: f64, ratio: f64) {
        if self.best.is_none_or(|best| left < (1.0 - ratio) * best) {
            (self.best, self.since) = (Some(left), 0);
        }
    }

    /// Samples since the start of the cycle.
    pub fn samples(&self) -> u64 {
        self.samples
    }

    /// Samples since the last improvement, or since the start.
    pub fn stagnant(&self) -> u64 {
        self.since
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cycle_that_converges_is_never_stagnant_for_long() {
        let mut progress = Progress::default();
        let mut left = 1.0;
        for k in 0..1000u64 {
            progress.count();
            left *= 0.99;
            progress.measure(left, 0.1);
            // ln 0.9 / ln 0.99 = 10.5
            assert!(progress.stagnant() <= 10, "{k}");
        }
        assert_eq!(progress.samples(), 1000);
    }

    #[test]
    fn better_by_less_than_the_ratio_is_stagnant() {
        let mut progress = Progress::default();
        for k in 0..100 {
            progress.count();
            progress.measure(1.0 - 5e-4 * f64::from(k), 0.1);
        }
        assert_eq!(progress.stagnant(), 99);
    }

    #[test]
    fn without_a_measure_the_whole_cycle_is_stagnant() {
        let mut progress = Progress::default();
        (0..7).for_each(|_| progress.count());
        assert_eq!((progress.samples(), progress.stagnant()), (7, 7));
        progress.restart();
        assert_eq!((progress.samples(), progress.stagnant()), (0, 0));
    }
}
