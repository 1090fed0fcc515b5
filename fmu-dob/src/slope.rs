//! Time variation of the force deviation by least squares, eq. 3, in constant time per sample.

use serde::{Deserialize, Serialize};

/// Least-squares slope a_k over the last N samples.
///
/// With t_j = j T_s, j = 0 (oldest) .. N-1, eq. 3 (with the product its numerator lacks in print) is
/// a_k = 12 / (T_s N (N^2 - 1)) (S1 - (N-1)/2 S0), where S0 = sum y_j and S1 = sum j y_j.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct RunningSlope {
    past: Vec<f64>,
    next: usize,
    sum: f64,
    moment: f64,
    scale: f64,
}

impl RunningSlope {
    /// Fit over `window` samples of `sample_period` s, all zero at first.
    pub fn new(window: usize, sample_period: f64) -> Self {
        let n = window as f64;
        Self {
            past: vec![0.0; window],
            next: 0,
            sum: 0.0,
            moment: 0.0,
            scale: 12.0 / (sample_period * n * (n * n - 1.0)),
        }
    }

    /// Slope in units of `y` per second after taking the newest sample.
    pub fn update(&mut self, y: f64) -> f64 {
        let last = self.past.len() as f64 - 1.0;
        let oldest = std::mem::replace(&mut self.past[self.next], y);
        // every kept sample moves one place towards the past: the moment first, then the sum
        self.moment += last * y - (self.sum - oldest);
        self.sum += y - oldest;
        self.next += 1;
        if self.next == self.past.len() {
            self.next = 0;
            self.sum_again();
        }
        self.scale * (self.moment - 0.5 * last * self.sum)
    }

    /// Exact sums once per turn of the ring, where it lies in time order, so that rounding errors never add up.
    fn sum_again(&mut self) {
        (self.sum, self.moment) = (0.0, 0.0);
        for (j, y) in self.past.iter().enumerate() {
            self.sum += y;
            self.moment += j as f64 * y;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const DT: f64 = 1e-4;

    /// Repeatable noise in +-1.
    fn noise(k: u64) -> f64 {
        let x = k.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        ((x ^ (x >> 29)) % 20_011) as f64 / 10_005.0 - 1.0
    }

    /// Two-pass least squares around the means.
    fn batch(y: &[f64]) -> f64 {
        let n = y.len() as f64;
        let (t_mean, y_mean) = ((n - 1.0) / 2.0, y.iter().sum::<f64>() / n);
        let (mut ty, mut tt) = (0.0, 0.0);
        for (j, y) in y.iter().enumerate() {
            let t = j as f64 - t_mean;
            ty += t * (y - y_mean);
            tt += t * t;
        }
        ty / (tt * DT)
    }

    fn compare_with_batch(offset: f64) {
        for window in [20, 50, 200] {
            let mut slope = RunningSlope::new(window, DT);
            let samples = 1_000_000 + window as u64 / 2;
            let force = |k: u64| offset + 0.01 * noise(k);
            let last = (0..samples).map(|k| slope.update(force(k))).last().unwrap();
            let recent: Vec<f64> = (samples - window as u64..samples).map(force).collect();
            let error = (last - batch(&recent)).abs();
            assert!(error < 1e-9, "window {window}: error {error} N/s");
        }
    }

    #[test]
    fn equals_batch_least_squares_after_a_million_samples() {
        compare_with_batch(0.0);
    }

    #[test]
    fn equals_batch_least_squares_on_ten_newtons() {
        compare_with_batch(10.0);
    }

    #[test]
    fn ramp_gives_its_slope() {
        let mut slope = RunningSlope::new(50, DT);
        let a = (0..77).map(|k| slope.update(20.0 * f64::from(k) * DT)).last().unwrap();
        assert!((a - 20.0).abs() < 1e-10);
    }
}
