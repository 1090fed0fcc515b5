//! A periodic sum of sines that excites a machine at several frequencies simultaneously.
//!
//! x(t) = a sum_i h_i^(-1/2) sin(h_i w t + phi_i) with the harmonics h_i of one base frequency w. The amplitude falls
//! with the root of the frequency, and the force on a mass grows with its power of 3/2: slow tones identify springs and
//! friction, quick ones mass and delay. The harmonics 1, 2, 3, 5, 7, 11, 17, 25 are spread like a logarithm. Phases of
//! pi i^2 / n (Schroeder, 1970) keep the tones from peaking together; |x| <= a sum_i h_i^(-1/2) in any case.

use std::f64::consts::{PI, TAU};

use serde::{Deserialize, Serialize};

use crate::motion::trajectory::Trajectory;

/// Tones of an excitation.
pub const TONES: usize = 8;
/// Harmonics of the base frequency.
pub const HARMONICS: [u32; TONES] = [1, 2, 3, 5, 7, 11, 17, 25];

/// A multisine over whole samples.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Multisine {
    /// Amplitude a of the tone at the base frequency, unit of the reference.
    pub amplitude: f64,
    /// Samples of a period of the base frequency.
    pub period: u32,
    /// Sample period, s.
    pub sample_period: f64,
}

impl Multisine {
    /// Frequencies of the tones, rad/s.
    pub fn frequencies(&self) -> [f64; TONES] {
        HARMONICS.map(|harmonic| f64::from(harmonic) * self.base())
    }

    /// Position, velocity and acceleration at sample `k` of the excitation.
    pub fn at(&self, k: u64) -> Trajectory {
        let k = (k % u64::from(self.period.max(1))) as u32;
        let mut sum = Trajectory::default();
        for (i, omega) in self.frequencies().into_iter().enumerate() {
            // whole numbers first: every period is bit-identical
            let revolutions = f64::from(HARMONICS[i] * k % self.period.max(1)) / f64::from(self.period.max(1));
            let (sine, cosine) = (TAU * revolutions + PI * (i * i) as f64 / TONES as f64).sin_cos();
            let amplitude = self.amplitude / f64::from(HARMONICS[i]).sqrt();
            sum.position += amplitude * sine;
            sum.velocity += amplitude * omega * cosine;
            sum.acceleration -= amplitude * omega * omega * sine;
        }
        sum
    }

    /// Upper bound of the position, unit of the reference.
    pub fn reach(&self) -> f64 {
        self.amplitude * sum(|harmonic| harmonic.sqrt().recip())
    }

    /// Upper bound of the velocity, unit of the reference in 1 s.
    pub fn velocity_max(&self) -> f64 {
        self.amplitude * sum(f64::sqrt) * self.base()
    }

    /// Upper bound of the acceleration, unit of the reference in 1 s2.
    pub fn acceleration_max(&self) -> f64 {
        self.amplitude * sum(|harmonic| harmonic.powf(1.5)) * self.base() * self.base()
    }

    fn base(&self) -> f64 {
        TAU / (f64::from(self.period.max(1)) * self.sample_period)
    }
}

/// Sum over the harmonics.
fn sum(of: impl Fn(f64) -> f64) -> f64 {
    HARMONICS.iter().map(|harmonic| of(f64::from(*harmonic))).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    const SINES: Multisine = Multisine { amplitude: 1e-5, period: 5000, sample_period: 1e-4 };

    #[test]
    fn the_tones_are_harmonics_of_two_hertz() {
        let hertz = SINES.frequencies().map(|omega| (omega / TAU).round());
        assert_eq!(hertz, [2.0, 4.0, 6.0, 10.0, 14.0, 22.0, 34.0, 50.0]);
    }

    #[test]
    fn a_period_repeats_to_the_last_bit() {
        for k in [0, 17, 4999] {
            assert_eq!(SINES.at(k), SINES.at(k + 5000));
            assert_eq!(SINES.at(k), SINES.at(k + 5000 * 1_000_000));
        }
    }

    #[test]
    fn velocity_and_acceleration_are_the_derivatives() {
        let dt = SINES.sample_period;
        for k in 1..4999 {
            let [before, now, after] = [k - 1, k, k + 1].map(|k| SINES.at(k));
            let velocity = (after.position - before.position) / (2.0 * dt);
            let acceleration = (after.velocity - before.velocity) / (2.0 * dt);
            // 50 Hz over 0.2 ms: (omega dt)^2 / 6
            assert!((velocity - now.velocity).abs() < 2e-4 * SINES.velocity_max());
            assert!((acceleration - now.acceleration).abs() < 2e-4 * SINES.acceleration_max());
        }
    }

    #[test]
    fn the_limits_hold_and_are_no_wider_than_they_must() {
        let largest = |of: fn(&Trajectory) -> f64| (0..5000).map(|k| of(&SINES.at(k)).abs()).fold(0.0, f64::max);
        let fractions = [
            largest(|x| x.position) / SINES.reach(),
            largest(|x| x.velocity) / SINES.velocity_max(),
            largest(|x| x.acceleration) / SINES.acceleration_max(),
        ];
        assert!(fractions.iter().all(|fraction| (0.5..=1.0).contains(fraction)), "{fractions:?}");
    }
}
