//! Threshold by probability theory: mu + alpha sigma of the signal before contact, with fixed or automatic alpha.

use std::f64::consts::TAU;

use control_blocks::Welford;
use serde::{Deserialize, Serialize};

use crate::interface::{Parameters, Threshold, ThresholdMode, ThresholdOutput};

/// Smallest automatic alpha.
const ALPHA_MIN: f64 = 3.0;

/// Statistics of one signal before contact: of its values and of its steps from sample to sample.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub struct Statistics {
    values: Welford,
    steps: Welford,
    previous: Option<f64>,
}

impl Statistics {
    /// Takes one sample.
    pub fn push(&mut self, x: f64) {
        self.values.push(x);
        if let Some(previous) = self.previous.replace(x) {
            self.steps.push(x - previous);
        }
    }

    /// Rate of up-crossings of the mean, Hz (Rice): sd(a_k - a_{k-1}) / (2 pi T_s sd(a_k)); 0 for a constant signal.
    pub fn crossing_rate(&self, sample_period: f64) -> f64 {
        let sigma = self.values.sigma();
        if sigma > 0.0 { self.steps.sigma() / (TAU * sample_period * sigma) } else { 0.0 }
    }

    /// Threshold of this signal.
    pub fn threshold(&self, p: &Parameters) -> ThresholdOutput {
        let (mean, sigma) = (self.values.mean(), self.values.sigma());
        let crossing_rate = self.crossing_rate(p.sample_period);
        let alpha = alpha(&p.threshold, crossing_rate);
        ThresholdOutput { mean, sigma, value: mean + alpha * sigma, alpha_used: alpha, crossing_rate }
    }
}

/// Fixed alpha, or sqrt(2 ln(nu_0 T)) for one false alarm in the interval T (Rice).
fn alpha(p: &Threshold, crossing_rate: f64) -> f64 {
    match p.mode {
        ThresholdMode::Fixed => p.alpha,
        ThresholdMode::Automatic => {
            let crossings = crossing_rate * p.false_alarm_interval;
            (2.0 * crossings.max(1.0).ln()).sqrt().max(ALPHA_MIN)
        }
    }
}

impl ThresholdOutput {
    /// Whether the statistics can be noise: not zero, not above `sigma_max`, and around zero.
    pub fn plausible(&self, sigma_max: f64) -> bool {
        self.sigma > 0.0 && self.sigma <= sigma_max && self.mean.abs() <= 0.5 * self.sigma
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sine_crosses_its_mean_at_its_frequency() {
        let mut statistics = Statistics::default();
        for k in 0..10_000 {
            statistics.push((TAU * 100.0 * f64::from(k) * 1e-4).sin());
        }
        let rate = statistics.crossing_rate(1e-4);
        assert!((rate - 100.0).abs() < 0.1, "{rate} Hz");
    }

    #[test]
    fn what_never_changes_never_crosses() {
        let mut statistics = Statistics::default();
        (0..100).for_each(|_| statistics.push(3.0));
        assert_eq!(statistics.crossing_rate(1e-4), 0.0);
        assert_eq!(statistics.threshold(&Parameters::START).value, 3.0);
    }

    #[test]
    fn automatic_alpha_follows_rice() {
        let p = Parameters::START.threshold;
        let one = alpha(&p, 600.0);
        assert!((one - (2.0 * (600.0f64 * 36_000.0).ln()).sqrt()).abs() < 1e-12);
        assert_eq!(alpha(&p, 0.0), ALPHA_MIN);
    }

    #[test]
    fn only_noise_is_plausible() {
        let learned = |mean, sigma| ThresholdOutput { mean, sigma, ..ThresholdOutput::START };
        assert!(learned(0.3, 1.0).plausible(5.0));
        assert!(learned(0.9, 2.0).plausible(5.0));
        assert!(learned(0.0, 5.0).plausible(5.0));
        assert!(!learned(0.0, 0.0).plausible(5.0));
        assert!(!learned(0.0, 5.1).plausible(5.0));
        assert!(!learned(-0.6, 1.0).plausible(5.0));
        assert!(!learned(f64::NAN, 1.0).plausible(5.0));
    }

    #[test]
    fn fixed_alpha_is_the_parameter() {
        let mut statistics = Statistics::default();
        for k in 0..100 {
            statistics.push(f64::from(k % 2));
        }
        let threshold = statistics.threshold(&Parameters::PAPER);
        assert_eq!(threshold.alpha_used, 4.0);
        assert_eq!(threshold.value, threshold.mean + 4.0 * threshold.sigma);
    }
}
