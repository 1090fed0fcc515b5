//! Deviation of the force from its own past moving average, eq. 2: low-frequency noise of the magnetic poles.

use serde::{Deserialize, Serialize};

/// High-pass finite-impulse-response filter dF_k = F_k - (1/r) sum of the r forces before it.
///
/// The paper prints the factor 1/(T_s r) and r + 1 terms; a dimensionless mean of r terms is meant.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct MovingDeviation {
    past: Vec<f64>,
    next: usize,
    count: usize,
    sum: f64,
}

impl MovingDeviation {
    /// Filter over `window` samples, empty.
    pub fn new(window: usize) -> Self {
        Self { past: vec![0.0; window], next: 0, count: 0, sum: 0.0 }
    }

    /// Deviation (N) of the newest force (N); from the mean of what exists until the window is full.
    pub fn update(&mut self, force: f64) -> f64 {
        let deviation = if self.count == 0 { 0.0 } else { force - self.sum / self.count as f64 };
        self.sum += force - self.past[self.next];
        self.past[self.next] = force;
        self.count = usize::min(self.count + 1, self.past.len());
        self.next += 1;
        if self.next == self.past.len() {
            // exact sum once per cycle of the ring, so that rounding errors never add up
            self.next = 0;
            self.sum = self.past.iter().sum();
        }
        deviation
    }

    /// Discards all forces.
    pub fn clear(&mut self) {
        self.past.fill(0.0);
        (self.next, self.count, self.sum) = (0, 0, 0.0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn impulse_response_is_one_then_minus_one_over_r() {
        let mut filter = MovingDeviation::new(4);
        for _ in 0..4 {
            filter.update(0.0);
        }
        let response: Vec<f64> = [1.0, 0.0, 0.0, 0.0, 0.0, 0.0].iter().map(|f| filter.update(*f)).collect();
        assert_eq!(response, [1.0, -0.25, -0.25, -0.25, -0.25, 0.0]);
    }

    #[test]
    fn constant_force_has_no_deviation() {
        let mut filter = MovingDeviation::new(1000);
        for k in 0..5000 {
            assert!(filter.update(10.0).abs() < 1e-11, "tick {k}");
        }
    }

    #[test]
    fn a_cleared_filter_starts_again() {
        let mut filter = MovingDeviation::new(4);
        (0..9).for_each(|_| _ = filter.update(100.0));
        filter.clear();
        assert_eq!(filter.update(3.0), 0.0);
        assert_eq!(filter.update(5.0), 2.0);
        assert_eq!(filter.update(4.0), 0.0);
    }

    #[test]
    fn stays_exact_for_a_million_samples() {
        let window = 1000;
        let mut filter = MovingDeviation::new(window);
        let force = |k: usize| 1000.0 + ((k * 7919) % 10_007) as f64 * 1e-4;
        let last = (0..1_000_000).map(|k| filter.update(force(k))).last().unwrap();
        let k = 999_999;
        let mean = (k - window..k).map(force).sum::<f64>() / window as f64;
        assert!((last - (force(k) - mean)).abs() < 1e-9);
    }
}
