//! Weights of a few signals that explain another one, by instruments, with a prior.
//!
//! (sum z x' + L) w = sum z y + L w0, L = 1/s0^2 for a standard deviation s0 of the prior weights and a noise of one
//! count. The covariance of w is v M^-1 (sum z z' + L) M^-T, M = sum z x' + L, with v the variance of the residual,
//! but not below that count.

use nalgebra::{Matrix3, Vector3};

/// Smallest variance of what no weights explain: a count, which is in every error of whole pulses.
const COUNT: f64 = 1.0;
/// Smallest variance of the noise of a measurement: that of a whole count.
const ROUNDING: f64 = 1.0 / 12.0;

/// Sums over the samples.
#[derive(Clone, Copy, Debug)]
pub struct Regression {
    moment: Matrix3<f64>,
    instruments: Matrix3<f64>,
    target: Vector3<f64>,
    prior: Vector3<f64>,
}

impl Regression {
    /// Before the first sample; `variance` is that of each of the weights `prior`.
    pub fn new(prior: &[f64; 3], variance: f64) -> Self {
        let (known, prior) = (Matrix3::identity() * (COUNT / variance), Vector3::from(*prior));
        Self { moment: known, instruments: known, target: known * prior, prior }
    }

    /// Takes a sample: instruments, signals, and what they are to explain.
    pub fn add(&mut self, instruments: &[f64; 3], signals: &[f64; 3], explained: f64) {
        let (z, x) = (Vector3::from(*instruments), Vector3::from(*signals));
        self.moment += z * x.transpose();
        self.instruments += z * z.transpose();
        self.target += z * explained;
    }

    /// The weights; the prior ones where the samples show none.
    pub fn solve(&self) -> [f64; 3] {
        self.moment.try_inverse().map_or(self.prior, |inverse| inverse * self.target).into()
    }

    /// Covariance of the weights for a variance of what they leave.
    pub fn covariance(&self, variance: f64) -> [[f64; 3]; 3] {
        let inverse = self.moment.try_inverse().unwrap_or_else(Matrix3::zeros);
        (inverse * self.instruments * inverse.transpose() * variance.max(COUNT)).into()
    }

    /// Covariance of the weights for noise of a variance that comes into sum z u with these vectors, one for each sample.
    pub fn covariance_of(&self, variance: f64, vectors: impl Iterator<Item = [f64; 3]>) -> [[f64; 3]; 3] {
        let inverse = self.moment.try_inverse().unwrap_or_else(Matrix3::zeros);
        let sum = vectors.map(Vector3::from).fold(Matrix3::zeros(), |sum, vector| sum + vector * vector.transpose());
        (inverse * sum * variance.max(ROUNDING) * inverse.transpose()).into()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TRUE: [f64; 3] = [4.0, 5.0, -1.0];

    /// Numbers between -1 and 1 that look random, the same in every run.
    fn noise(k: usize) -> f64 {
        let mixed = (k as u64 + 1).wrapping_mul(0x9E37_79B9_7F4A_7C15);
        let mixed = (mixed ^ mixed >> 29).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        (mixed >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    /// Regression over signals of an amplitude whose measurements have noise, which is in what they explain as well.
    fn regression(amplitude: f64, noisy: f64, instruments: bool) -> Regression {
        let mut regression = Regression::new(&[3.0, 3.0, 0.0], 1.0);
        for k in 0..2000 {
            let clean: [f64; 3] = [0.05, 0.11, 0.23].map(|frequency| amplitude * (frequency * k as f64).sin());
            let read: [f64; 3] = std::array::from_fn(|i| clean[i] + noisy * noise(3 * k + i));
            let explained = clean.iter().zip(TRUE).map(|(x, w)| w * x).sum::<f64>() + noisy * noise(9000 + k);
            regression.add(if instruments { &clean } else { &read }, &read, explained);
        }
        regression
    }

    fn off(weights: [f64; 3]) -> f64 {
        (0..3).fold(0.0, |maximum: f64, i| maximum.max((weights[i] - TRUE[i]).abs()))
    }

    #[test]
    fn noise_of_the_signals_does_not_bend_the_weights_as_it_does_without_instruments() {
        let exact = regression(1e4, 0.0, true).solve();
        assert!(off(exact) < 1e-6, "{exact:?}");
        let (good, bent) = (regression(10.0, 10.0, true).solve(), regression(10.0, 10.0, false).solve());
        assert!(off(good) < 0.5 && off(bent) > 1.5, "{good:?} {bent:?}");
    }

    #[test]
    fn the_covariance_is_that_of_the_weights() {
        // noise of the signals times their weights, and that of what they explain
        let variance = 9.0 / 3.0 * (1.0 + 16.0 + 25.0 + 1.0);
        let sums = regression(100.0, 3.0, true);
        let covariance = sums.covariance(variance);
        // sums of 2000 squares of sines
        let expected = variance / (1000.0 * 100.0 * 100.0);
        for (i, row) in covariance.iter().enumerate() {
            assert!((row[i] / expected - 1.0).abs() < 0.02, "{covariance:?}");
        }
        assert!(off(sums.solve()) < 4.0 * expected.sqrt());
        // whole counts are never better than a count
        assert_eq!(sums.covariance(0.0), sums.covariance(1.0));
    }

    #[test]
    fn without_signals_the_weights_are_those_of_before_with_their_variance() {
        let sums = regression(0.0, 0.0, true);
        assert_eq!(sums.solve(), [3.0, 3.0, 0.0]);
        assert_eq!(sums.covariance(0.0), [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);
    }
}
