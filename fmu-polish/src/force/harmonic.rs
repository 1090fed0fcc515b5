//! Cancels one harmonic of a force ripple, and stops if the ripple grows.

use control_blocks::{Canceller, Consecutive};
use nalgebra::Complex;
use serde::{Deserialize, Serialize};

/// Highest frequency that is canceled, part of the sample rate.
pub const FREQUENCY_RATIO: f64 = 0.2;
/// Fraction of the maximum amplitude that is treated as the limit.
const LIMITED: f64 = 0.99;
/// Growth of a ripple from its first amplitude that ends the cancellation.
const GROWTH: f64 = 1.5;
/// Growth of a ripple in N that stops its cancellation: far more than noise adds to an amplitude.
const GROWTH_MAX: f64 = 0.3;
/// Consecutive windows that have grown too far.
const BAD_WINDOWS: u32 = 2;

/// Canceller of a harmonic with its evaluation; nothing is learned by default.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Harmonic {
    canceller: Canceller,
    /// sum over the window of the force error times the conjugate carrier, N
    sum: Complex<f64>,
    /// first amplitude, N
    first: Option<f64>,
    /// consecutive windows that have grown
    bad: Consecutive,
    /// it made the ripple worse
    ended: bool,
}

impl Harmonic {
    /// Takes the force error (N) of a sample for the evaluation.
    pub fn observe(&mut self, carrier: Complex<f64>, error: f64) {
        self.sum += carrier.conj() * error;
    }

    /// Learns from the force error `error` (N) of a sample, `size` of it, by the response of the error to the output; the
    /// amplitude stays below `maximum` (unit of the output).
    pub fn learn(&mut self, size: f64, response: Complex<f64>, carrier: Complex<f64>, error: f64, maximum: f64) {
        if !self.ended {
            // the output that would have made this error is taken back
            self.canceller.take_back(size, response, carrier, error);
            self.canceller.limit(maximum);
        }
    }

    /// Output at the phasor `carrier`.
    pub fn output(&self, carrier: Complex<f64>) -> f64 {
        self.canceller.output(carrier)
    }

    /// Evaluates a window of `samples`, in which the cause of the ripple is `raised` times as large as configured; true
    /// when the cancellation stops because the ripple has grown.
    pub fn evaluate(&mut self, samples: u32, raised: f64, maximum: f64) -> bool {
        let amplitude = 2.0 * self.sum.norm() / f64::from(samples) / raised;
        self.sum = Complex::ZERO;
        if self.ended {
            return false;
        }
        let first = *self.first.get_or_insert(amplitude);
        // at its limit it cannot grow any more
        let limited = self.canceller.amplitude() > LIMITED * maximum;
        let grown = amplitude > GROWTH * first + if limited { 0.0 } else { GROWTH_MAX };
        if self.bad.update(grown) < BAD_WINDOWS {
            return false;
        }
        *self = Self { ended: true, ..Self::default() };
        true
    }

    /// First amplitude of the ripple, N; none before the first window.
    #[cfg(test)]
    pub fn first(&self) -> Option<f64> {
        self.first
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Samples of a window, and the largest output.
    const WINDOW: u32 = 100;
    const LIMIT: f64 = 1e-3;

    /// Which of windows with ripples of `sizes` N ends the harmonic, where what makes them is `raised` times as large
    /// as configured and an output of `learned` was learned.
    fn ends(sizes: &[f64], raised: f64, learned: f64) -> Vec<bool> {
        let mut harmonic = Harmonic::default();
        harmonic.learn(1.0, Complex::ONE, Complex::ONE, -learned, LIMIT);
        let mut window = |&size: &f64| {
            for k in 0..WINDOW {
                let carrier = Complex::cis(std::f64::consts::TAU * f64::from(k) / 20.0);
                harmonic.observe(carrier, size * carrier.re);
            }
            harmonic.evaluate(WINDOW, raised, LIMIT)
        };
        sizes.iter().map(&mut window).collect()
    }

    #[test]
    fn two_consecutive_windows_that_have_grown_end_it_once() {
        let maximum = GROWTH * 0.2 + GROWTH_MAX;
        let (below, above) = (0.99 * maximum, 1.01 * maximum);
        for raised in [1.0, 1.7] {
            let ends = |sizes: &[f64]| ends(&sizes.iter().map(|size| raised * size).collect::<Vec<_>>(), raised, 0.0);
            assert_eq!(ends(&[0.2, below, below, below]), [false; 4]);
            assert_eq!(ends(&[0.2, above, below, above, below]), [false; 5]);
            assert_eq!(ends(&[0.2, above, above, above, above]), [false, false, true, false, false]);
        }
    }

    #[test]
    fn at_its_limit_it_may_grow_by_its_factor_alone() {
        let grown = [0.2, 1.01 * GROWTH * 0.2, 1.01 * GROWTH * 0.2];
        assert_eq!(ends(&grown, 1.0, 2.0 * LIMIT), [false, false, true]);
        assert_eq!(ends(&grown, 1.0, 0.9 * LIMIT), [false; 3]);
    }

    #[test]
    fn it_learns_and_gives_nothing_after_its_end() {
        let mut harmonic = Harmonic { ended: true, ..Harmonic::default() };
        harmonic.learn(1.0, Complex::ONE, Complex::ONE, 1.0, LIMIT);
        assert_eq!(harmonic.output(Complex::ONE), 0.0);
    }
}
