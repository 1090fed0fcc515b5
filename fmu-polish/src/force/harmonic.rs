//! One harmonic of a force ripple, cancelled; it ends itself where that makes the ripple worse.

use control_blocks::{Canceller, Consecutive};
use nalgebra::Complex;
use serde::{Deserialize, Serialize};

use crate::interface::Parameters;

/// Highest frequency that is cancelled, part of the sample rate.
pub const FREQUENCY_SHARE: f64 = 0.2;
/// Part of the largest amplitude that counts as the limit.
const LIMITED: f64 = 0.99;
/// Growth of a ripple from its first amplitude that ends the cancellation.
const GROWTH: f64 = 1.5;
/// Windows in a row that have grown too far.
const BAD_WINDOWS: u32 = 2;

/// What cancels the harmonic and judges it; by default nothing is learned.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Harmonic {
    canceller: Canceller,
    /// sum over the window of the force error times the conjugate carrier, N
    sum: Complex<f64>,
    /// first amplitude, N
    first: Option<f64>,
    /// windows in a row that have grown
    bad: Consecutive,
    /// it made the ripple worse
    ended: bool,
}

impl Harmonic {
    /// Takes the force error (N) of a sample for the judgement.
    pub fn observe(&mut self, carrier: Complex<f64>, error: f64) {
        self.sum += carrier.conj() * error;
    }

    /// Learns from the force error `error` (N) of a sample, `size` of it, by the response of the error to the output; the
    /// amplitude stays below `most` (unit of the output).
    pub fn learn(&mut self, size: f64, response: Complex<f64>, carrier: Complex<f64>, error: f64, most: f64) {
        if !self.ended {
            // the output that would have made this error is taken back
            self.canceller.take_back(size, response, carrier, error);
            self.canceller.limit(most);
        }
    }

    /// Output at the phasor `carrier`.
    pub fn output(&self, carrier: Complex<f64>) -> f64 {
        self.canceller.output(carrier)
    }

    /// Judges a window of `samples`; true when the harmonic ends because it makes the ripple worse.
    pub fn judge(&mut self, p: &Parameters, samples: u32, most: f64) -> bool {
        let amplitude = 2.0 * self.sum.norm() / f64::from(samples);
        self.sum = Complex::ZERO;
        if self.ended {
            return false;
        }
        let first = *self.first.get_or_insert(amplitude);
        // at its limit it cannot grow any more
        let limited = self.canceller.amplitude() > LIMITED * most;
        let grown = amplitude > GROWTH * first + if limited { 0.0 } else { p.ripple.growth_max };
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
