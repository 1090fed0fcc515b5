//! Velocity into whole pulses; what is left over is carried to the next sample.

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use crate::interface::Parameters;

/// The part of a pulse that was not yet sent, in pulses.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Remainder {
    left: Vector3<f64>,
    /// all that were sent
    counts: Vector3<i32>,
}

impl Remainder {
    /// Nothing left over.
    pub fn new() -> Self {
        Self { left: Vector3::zeros(), counts: Vector3::zeros() }
    }

    /// The pulses of one sample with the velocity `velocity` (m/s).
    pub fn step(&mut self, p: &Parameters, velocity: &Vector3<f64>) -> Vector3<i32> {
        let exact = self.left + velocity * (p.sample_period / p.pulses_size);
        // halves are always rounded up: at rest the pulses do not alternate between -1 and 1
        let sent = exact.map(|pulses| (pulses + 0.5).floor());
        self.left = exact - sent;
        let pulses = sent.map(|count| count as i32);
        self.counts = self.counts.zip_map(&pulses, i32::wrapping_add);
        pulses
    }

    /// Pulses that were sent since the beginning.
    pub fn counts(&self) -> Vector3<i32> {
        self.counts
    }
}

impl Default for Remainder {
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_a_pulse_left_over_stays_at_rest() {
        let p = Parameters::START;
        let mut remainder = Remainder::new();
        for velocity in [0.5e-3, -0.5e-3, 1.5e-3] {
            remainder.step(&p, &Vector3::new(0.0, 0.0, velocity));
            for _ in 0..5 {
                assert_eq!(remainder.step(&p, &Vector3::zeros()), Vector3::zeros());
            }
        }
    }

    #[test]
    fn no_way_is_lost_however_slow() {
        let p = Parameters::START;
        let velocity = Vector3::new(1.234e-5, -4.9e-2, 3.3e-4);
        let mut remainder = Remainder::new();
        let mut sum = Vector3::<i32>::zeros();
        for _ in 0..10_000 {
            sum += remainder.step(&p, &velocity);
        }
        let error = sum.map(f64::from) * p.pulses_size - velocity * 10.0;
        assert!(error.amax() <= 0.5 * p.pulses_size * 1.001, "{error}");
        assert_eq!(remainder.counts(), sum);
    }
}
