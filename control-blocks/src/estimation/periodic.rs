//! Spectral lines of two signals of a machine that is excited periodically, and their variances.
//!
//! Over each whole period of n samples the complex amplitude of harmonic h is
//!
//! ```text
//! X = 2/n sum_k x_k exp(-j 2 pi h k / n).
//! ```
//!
//! The repeating part is the response to the excitation, the difference from period to period is noise. So the mean
//! over P periods is the estimate, and the scatter of the periods over P (P - 1) its variance, for both signals and
//! between them: in a closed loop the noise is in both (sample maximum likelihood: Pintelon and Schoukens, System
//! Identification, 2012, chapter 12). An offset, and any line at another harmonic, has no effect.

use std::f64::consts::TAU;

use num_complex::Complex;
use serde::{Deserialize, Serialize};

use crate::commission::multisine::{HARMONICS, TONES};

/// One harmonic: mean of both signals over the periods, and the variances of these means.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SpectralLine {
    /// Complex amplitude of the input.
    pub input: Complex<f64>,
    /// Complex amplitude of the output.
    pub output: Complex<f64>,
    /// Variance of `input`.
    pub input_variance: f64,
    /// Variance of `output`.
    pub output_variance: f64,
    /// Covariance of `output` and the conjugate of `input`.
    pub covariance: Complex<f64>,
}

/// Running mean and scatter of one harmonic (Welford).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
struct Scatter {
    mean: [Complex<f64>; 2],
    squares: [f64; 2],
    product: Complex<f64>,
}

/// Sums of the present period, and the mean of the periods before.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PeriodicSpectra {
    sample: u32,
    periods: u32,
    sums: [[Complex<f64>; 2]; TONES],
    lines: [Scatter; TONES],
}

impl PeriodicSpectra {
    /// Adds one sample of input and output; `period` in samples.
    pub fn update(&mut self, period: u32, input: f64, output: f64) {
        let period = period.max(1);
        for (sum, harmonic) in self.sums.iter_mut().zip(HARMONICS) {
            let revolutions = f64::from(harmonic * self.sample % period) / f64::from(period);
            let rotation = Complex::cis(-TAU * revolutions);
            sum[0] += rotation * input;
            sum[1] += rotation * output;
        }
        self.sample += 1;
        if self.sample >= period {
            self.close(period);
        }
    }

    /// Whole periods so far.
    pub fn periods(&self) -> u32 {
        self.periods
    }

    /// Line of the tone `i`; of fewer than two periods the variances are 0.
    pub fn line(&self, i: usize) -> SpectralLine {
        let Scatter { mean, squares, product } = self.lines[i];
        let factor = (f64::from(self.periods) * f64::from(self.periods.max(2) - 1)).max(1.0).recip();
        SpectralLine {
            input: mean[0],
            output: mean[1],
            input_variance: factor * squares[0],
            output_variance: factor * squares[1],
            covariance: product * factor,
        }
    }

    fn close(&mut self, period: u32) {
        self.periods += 1;
        let count = f64::from(self.periods);
        for (line, sum) in self.lines.iter_mut().zip(&mut self.sums) {
            let amplitude = std::mem::take(sum).map(|x| x * (2.0 / f64::from(period)));
            let before = [0, 1].map(|i| amplitude[i] - line.mean[i]);
            (0..2).for_each(|i| line.mean[i] += before[i] / count);
            let after = [0, 1].map(|i| amplitude[i] - line.mean[i]);
            (0..2).for_each(|i| line.squares[i] += (before[i] * after[i].conj()).re);
            line.product += before[1] * after[0].conj();
        }
        self.sample = 0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PERIOD: u32 = 500;

    /// Uniform noise from -1 to 1, of the variance 1/3: a linear congruence.
    fn noise(seed: &mut u64) -> f64 {
        *seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (*seed >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }

    fn spectra(periods: u32, mut signals: impl FnMut(u32) -> [f64; 2]) -> PeriodicSpectra {
        let mut spectra = PeriodicSpectra::default();
        for k in 0..periods * PERIOD {
            let [input, output] = signals(k);
            spectra.update(PERIOD, input, output);
        }
        spectra
    }

    /// Angle of a harmonic at sample `k`.
    fn angle(harmonic: u32, k: u32) -> f64 {
        TAU * f64::from(harmonic * k % PERIOD) / f64::from(PERIOD)
    }

    #[test]
    fn each_tone_is_distinguished_from_the_others_and_from_an_offset() {
        let found = spectra(3, |k| {
            let input: f64 = HARMONICS.iter().map(|h| (angle(*h, k) + 0.1).cos() * f64::from(*h)).sum();
            [5.0 + input, -7.0 + 0.5 * angle(7, k).sin() + angle(4, k).cos()]
        });
        for (i, harmonic) in HARMONICS.into_iter().enumerate() {
            let line = found.line(i);
            assert!((line.input - Complex::from_polar(f64::from(harmonic), 0.1)).norm() < 1e-10);
            let expected = if harmonic == 7 { Complex::new(0.0, -0.5) } else { Complex::ZERO };
            assert!((line.output - expected).norm() < 1e-12);
            assert!(line.input_variance < 1e-20 && line.output_variance < 1e-20);
        }
    }

    #[test]
    fn the_variance_is_that_of_white_noise() {
        // an amplitude has 4/n of the variance of a sample, its mean 1/P of that
        let mut seed = 11;
        let found = spectra(400, |_| {
            let input = noise(&mut seed);
            [input, 3.0 * input + noise(&mut seed)]
        });
        let expected = 4.0 / 3.0 / f64::from(PERIOD) / 400.0;
        for i in 0..TONES {
            let line = found.line(i);
            assert!((line.input_variance / expected - 1.0).abs() < 0.25, "{}", line.input_variance / expected);
            assert!((line.output_variance / expected - 10.0).abs() < 2.5, "{}", line.output_variance / expected);
            assert!((line.covariance / expected - 3.0).norm() < 1.0, "{}", line.covariance / expected);
        }
    }

    #[test]
    fn one_period_shows_nothing_of_the_noise() {
        let found = spectra(1, |k| [f64::from(k % 7), f64::from(k % 3)]);
        assert_eq!(found.periods(), 1);
        assert_eq!((found.line(0).input_variance, found.line(0).output_variance), (0.0, 0.0));
    }
}
