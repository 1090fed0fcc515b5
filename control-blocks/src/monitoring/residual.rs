//! A residual that should be noise and is not: two-sided cumulative sum (Page, 1954).
//!
//! With the residual r in units of its standard deviation: up' = max(0, up + r - k), down' = max(0, down - r - k); found
//! when one is larger than h. A lasting shift of d > k is found after about h / (d - k) samples. Without a shift the
//! mean number of samples to an alarm is, by Siegmund's approximation with b = h + 1.166,
//! L = (exp(2 k b) - 2 k b - 1) / (2 k^2) on one side, and half of it with two.

use serde::{Deserialize, Serialize};

/// Siegmund's correction for the overshoot over the limit in discrete time.
const OVERSHOOT: f64 = 1.166;

/// The two sums.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Residual {
    up: f64,
    down: f64,
}

impl Residual {
    /// Takes a residual in standard deviations, with the `drift` k; the larger sum, to be held against the limit.
    pub fn update(&mut self, residual: f64, drift: f64) -> f64 {
        self.up = (self.up + residual - drift).max(0.0);
        self.down = (self.down - residual - drift).max(0.0);
        self.up.max(self.down)
    }
}

/// Samples between two false alarms, with white normal residuals.
pub fn false_alarm_interval(limit: f64, drift: f64) -> f64 {
    let exponent = 2.0 * drift * (limit + OVERSHOOT);
    0.5 * (exponent.exp_m1() - exponent) / (2.0 * drift * drift)
}

/// The limit h for which false alarms come every `interval` samples, by bisection.
pub fn residual_limit(interval: f64, drift: f64) -> f64 {
    let (mut low, mut high) = (0.0, 500.0 / drift);
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if false_alarm_interval(middle, drift) < interval { low = middle } else { high = middle }
    }
    high
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Normal numbers by Box and Muller from a linear congruential generator.
    fn normal(seed: u64) -> impl FnMut() -> f64 {
        let mut state = seed;
        let mut uniform = move || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            ((state >> 11) as f64 + 0.5) / (1u64 << 53) as f64
        };
        move || (-2.0 * uniform().ln()).sqrt() * (std::f64::consts::TAU * uniform()).cos()
    }

    #[test]
    fn the_interval_between_false_alarms_is_that_of_the_limit() {
        let (drift, wanted) = (0.5, 2000.0);
        let limit = residual_limit(wanted, drift);
        assert!((false_alarm_interval(limit, drift) / wanted - 1.0).abs() < 1e-9);
        let mut noise = normal(11);
        let (samples, mut alarms, mut residual) = (2_000_000, 0.0, Residual::default());
        for _ in 0..samples {
            if residual.update(noise(), drift) > limit {
                alarms += 1.0;
                residual = Residual::default();
            }
        }
        let measured = f64::from(samples) / alarms;
        // 1000 alarms: 3 % of chance, and the approximation
        assert!((measured / wanted - 1.0).abs() < 0.12, "{measured}");
    }

    #[test]
    fn a_shift_is_found_after_the_limit_over_what_it_has_too_much() {
        for shift in [2.0, -2.0, 5.0] {
            let mut residual = Residual::default();
            let found = (1..).find(|_| residual.update(shift, 0.5) > 9.0);
            assert_eq!(found, Some((9.0 / (shift.abs() - 0.5)).floor() as i32 + 1));
        }
    }

    #[test]
    fn a_shift_below_the_drift_is_never_found() {
        let mut residual = Residual::default();
        assert!((0..100_000).all(|_| residual.update(0.49, 0.5) == 0.0));
    }
}
