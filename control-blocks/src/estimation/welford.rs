//! Running mean and variance without the cancellation of sum(x^2) - n mean^2 (Welford, 1962).
//!
//! With d = x_n - m_(n-1): m_n = m_(n-1) + d / n and S_n = S_(n-1) + d (x_n - m_n), where S is the sum of the squared
//! deviations from the mean; the variance is S_n / (n - 1).

use serde::{Deserialize, Serialize};

/// Running mean and variance; by default without samples.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Welford {
    count: f64,
    mean: f64,
    squares: f64,
}

impl Welford {
    /// Adds one sample.
    pub fn push(&mut self, x: f64) {
        self.count += 1.0;
        let deviation = x - self.mean;
        self.mean += deviation / self.count;
        self.squares += deviation * (x - self.mean);
    }

    /// Number of samples.
    pub fn count(&self) -> f64 {
        self.count
    }

    /// Mean of the samples, 0 without any.
    pub fn mean(&self) -> f64 {
        self.mean
    }

    /// Standard deviation of the samples, 0 with fewer than two.
    pub fn sigma(&self) -> f64 {
        // fewer have no squares; a branch around 0 / 0 would be computed speculatively and raise a floating-point flag
        (self.squares / (self.count - 1.0).max(1.0)).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(x: impl Iterator<Item = f64>) -> Welford {
        let mut welford = Welford::default();
        x.for_each(|x| welford.push(x));
        welford
    }

    #[test]
    fn matches_two_passes_on_a_large_offset() {
        for offset in [0.0, 5.0, 1e6] {
            let x: Vec<f64> =
                (0..20_000).map(|k| offset + (f64::from(k) * 1.7).sin() + (f64::from(k) * 0.3).cos()).collect();
            let welford = of(x.iter().copied());
            let mean = x.iter().sum::<f64>() / x.len() as f64;
            let sum: f64 = x.iter().map(|x| (x - mean).powi(2)).sum();
            let sigma = (sum / (x.len() - 1) as f64).sqrt();
            assert_eq!(welford.count(), 20_000.0);
            assert!((welford.mean() - mean).abs() < 1e-10 * (1.0 + offset), "{offset}: {}", welford.mean());
            assert!((welford.sigma() / sigma - 1.0).abs() < 1e-8, "{offset}: {}", welford.sigma());
        }
    }

    #[test]
    fn equal_steps_have_a_closed_form() {
        // variance of 1 to n is n (n + 1) / 12
        let welford = of((1..=1000).map(f64::from));
        assert!((welford.mean() - 500.5).abs() < 1e-10);
        assert!((welford.sigma() - (1000.0f64 * 1001.0 / 12.0).sqrt()).abs() < 1e-9);
    }

    #[test]
    fn too_few_samples_have_no_deviation() {
        assert_eq!((of([].into_iter()).mean(), of([].into_iter()).sigma()), (0.0, 0.0));
        assert_eq!((of([3.0].into_iter()).mean(), of([3.0].into_iter()).sigma()), (3.0, 0.0));
    }
}
