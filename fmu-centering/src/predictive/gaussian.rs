//! Estimate of one value: a mean and a standard deviation, updated by each measurement.

use serde::{Deserialize, Serialize};

/// Fraction of an innovation that may be a change of the value itself, so that it is learned again and not averaged.
const DRIFT: f64 = 0.3;

/// Gaussian estimate.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct GaussianEstimate {
    /// Most likely value.
    pub mean: f64,
    /// Standard deviation.
    pub sigma: f64,
}

impl GaussianEstimate {
    /// Estimate before any measurement.
    pub const fn new(mean: f64, sigma: f64) -> Self {
        Self { mean, sigma }
    }

    /// The estimate after a measurement with the standard deviation `sigma`.
    #[must_use]
    pub fn after(&self, measured: f64, sigma: f64) -> Self {
        let surprise = measured - self.mean;
        // a scalar kalman filter whose process noise grows with what is not explained
        let prior = self.sigma.powi(2) + (DRIFT * surprise).powi(2);
        if prior == 0.0 {
            return *self;
        }
        let gain = prior / (prior + sigma.powi(2));
        Self { mean: self.mean + gain * surprise, sigma: ((1.0 - gain) * prior).sqrt() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_equal_witnesses_meet_in_the_middle() {
        let belief = GaussianEstimate::new(1.0, 1.0).after(1.0 + 1e-9, 1.0);
        assert!((belief.mean - 1.0 - 0.5e-9).abs() < 1e-12);
        assert!((belief.sigma - 0.5_f64.sqrt()).abs() < 1e-9);
    }

    #[test]
    fn a_sharp_measurement_replaces_a_vague_belief() {
        let belief = GaussianEstimate::new(0.0, 10.0).after(3.0, 1e-3);
        assert!((belief.mean - 3.0).abs() < 1e-6 && belief.sigma < 1.1e-3);
    }

    #[test]
    fn a_number_that_has_changed_is_accepted_soon() {
        let mut belief = (0..100).fold(GaussianEstimate::new(0.0, 1.0), |belief, _| belief.after(0.0, 0.1));
        assert!(belief.sigma < 0.02);
        for _ in 0..3 {
            belief = belief.after(5.0, 0.1);
        }
        assert!((belief.mean - 5.0).abs() < 0.1, "{belief:?}");
    }

    #[test]
    fn certainty_without_doubt_stays() {
        let belief = GaussianEstimate::new(0.0, 0.0).after(0.0, 1.0);
        assert_eq!(belief, GaussianEstimate::new(0.0, 0.0));
    }
}
