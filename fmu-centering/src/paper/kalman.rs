//! Scalar Kalman filter of the collected surface, eq. 19 to 23.

use serde::{Deserialize, Serialize};

/// Standard deviation sqrt(Q) of the change of the surface from one measurement to the next, m (paper).
const PROCESS_NOISE: f64 = 0.015e-6;
/// Standard deviation sqrt(R) of one measurement, m (paper).
const MEASUREMENT_NOISE: f64 = 0.03e-6;

/// Estimate of a value with a random walk; by default unknown.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ScalarKalman {
    estimate: Option<f64>,
    variance: f64,
}

impl ScalarKalman {
    /// Filtered value after the measurement `z`; the first one is taken as it is.
    pub fn update(&mut self, z: f64) -> f64 {
        let (q, r) = (PROCESS_NOISE.powi(2), MEASUREMENT_NOISE.powi(2));
        let Some(before) = self.estimate else {
            (self.estimate, self.variance) = (Some(z), r);
            return z;
        };
        // 19, 20: predict
        let predicted = self.variance + q;
        // 21: gain
        let gain = predicted / (predicted + r);
        // 22, 23: correct
        let estimate = before + gain * (z - before);
        self.variance = (1.0 - gain) * predicted;
        self.estimate = Some(estimate);
        estimate
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Steady gain K of the filter.
    fn steady_gain() -> f64 {
        let ratio = (PROCESS_NOISE / MEASUREMENT_NOISE).powi(2);
        // P-/R solves x^2 - ratio x - ratio = 0
        let predicted = 0.5 * (ratio + (ratio * ratio + 4.0 * ratio).sqrt());
        predicted / (predicted + 1.0)
    }

    /// Filter after it has seen 100 zeros.
    fn settled() -> ScalarKalman {
        let mut filter = ScalarKalman::default();
        for _ in 0..100 {
            filter.update(0.0);
        }
        filter
    }

    #[test]
    fn the_first_value_is_taken_as_it_is() {
        assert_eq!(ScalarKalman::default().update(0.7), 0.7);
    }

    #[test]
    fn gain_settles_where_the_riccati_equation_says() {
        // Q/R = 1/4: P-/R = 0.640, K = 0.390
        let gain = settled().update(1.0);
        assert!((gain - 0.3904).abs() < 1e-4, "{gain}");
        assert!((gain - steady_gain()).abs() < 1e-12);
    }

    #[test]
    fn a_ramp_lags_by_one_and_a_half_samples() {
        // (1 - K) / K = 1.56 samples: 2.8 deg at 20 rpm and 66 Hz
        let mut filter = settled();
        let lag = (1..1000).map(|k| f64::from(k) - filter.update(f64::from(k))).last().unwrap();
        let gain = steady_gain();
        assert!((lag - (1.0 - gain) / gain).abs() < 1e-9 && (lag - 1.56).abs() < 0.01, "{lag}");
        let degrees = lag / 66.0 * 120.0;
        assert!((degrees - 2.84).abs() < 0.01, "{degrees}");
    }
}
