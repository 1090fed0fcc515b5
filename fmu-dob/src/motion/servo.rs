//! Position servo: proportional-derivative control of the acceleration over the disturbance observer.

use control_blocks::{Consecutive, Reversals, SentCommands, Trajectory, ticks};
use serde::{Deserialize, Serialize};

use crate::interface::{Parameters, Servo};

/// Commanded acceleration (m/s2): reference acceleration and PD control of position and velocity.
pub fn acceleration(servo: &Servo, reference: &Trajectory, position: f64, velocity: f64) -> f64 {
    let omega = servo.bandwidth;
    reference.acceleration
        + omega * omega * (reference.position - position)
        + 2.0 * servo.damping * omega * (reference.velocity - velocity)
}

/// Two reversals within this time belong together, s: an unstable loop oscillates faster.
pub const OSCILLATION_TIME: f64 = 0.05;

/// Smallest step of the current command, A.
pub fn current_step(p: &Parameters) -> f64 {
    2.0 * p.stage.current_max / 2f64.powi(p.stage.current_bits)
}

/// The current (A) that is sent to the amplifier: limited, then rounded to its `step`.
fn quantise(current: f64, limit: f64, step: f64) -> f64 {
    (current.clamp(-limit, limit) / step).round() * step
}

/// Integral action instead of the disturbance compensation; it is held while the current is limited.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Integrator {
    acceleration: f64,
}

impl Integrator {
    /// Adds one sample of the error (m) and gives the acceleration (m/s2).
    pub fn update(&mut self, p: &Parameters, error: f64, limited: bool) -> f64 {
        if !limited {
            self.acceleration += p.servo.integral_gain * error * p.sample_period;
        }
        self.acceleration
    }

    /// The same force from a drive with another thrust constant: `ratio` is the new one over the one before.
    pub fn scale(&mut self, ratio: f64) {
        self.acceleration *= ratio;
    }
}

/// Stores the commanded currents, and the time at the limit.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Amplifier {
    /// smallest step, limit, and what is sent there, A
    step: f64,
    limit: f64,
    maximum: f64,
    /// samples of an oscillation
    oscillation: u32,
    sent: SentCommands,
    limited: Consecutive,
    reversals: Reversals,
    oscillations: u32,
}

impl Amplifier {
    /// No current was sent so far.
    pub fn new(p: &Parameters) -> Self {
        let (limit, step) = (p.stage.current_max, current_step(p));
        Self {
            step,
            limit,
            maximum: quantise(limit, limit, step),
            oscillation: ticks(OSCILLATION_TIME, p.sample_period),
            sent: SentCommands::default(),
            limited: Consecutive::NONE,
            reversals: Reversals::default(),
            oscillations: 0,
        }
    }

    /// The quantized and limited current (A) that acted during the last sample, `io_delay` samples late.
    pub fn acted(&self, p: &Parameters) -> f64 {
        self.sent.before(p.io_delay as usize)
    }

    /// Sends a current (A) to the amplifier; returns what it will do.
    pub fn send(&mut self, current: f64) -> f64 {
        let sent = quantise(current, self.limit, self.step);
        self.sent.send(sent);
        self.limited.update(sent.abs() >= self.maximum);
        self.oscillations = self.reversals.update(sent, self.maximum, self.oscillation);
        sent
    }

    /// Consecutive reversals of the current from limit to limit.
    pub fn reversals(&self) -> u32 {
        self.oscillations
    }

    /// Discards the history of the current at its limits.
    pub fn forget(&mut self) {
        (self.limited, self.reversals, self.oscillations) = (Consecutive::NONE, Reversals::default(), 0);
    }

    /// Consecutive samples with the current at its limit.
    pub fn limited(&self) -> u32 {
        self.limited.count()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sixteen_bits_over_ten_amperes() {
        let p = Parameters::START;
        let step = current_step(&p);
        assert!((step - 152.587890625e-6).abs() < 1e-15);
        let quantise = |current| quantise(current, 5.0, step);
        assert_eq!(quantise(0.4 * step), 0.0);
        assert_eq!(quantise(0.6 * step), step);
        assert_eq!(quantise(-3.4 * step), -3.0 * step);
        assert_eq!(quantise(7.0), 5.0);
        assert_eq!(quantise(-7.0), -5.0);
    }

    #[test]
    fn a_stage_that_lags_is_pushed() {
        let mut p = Parameters::START;
        (p.servo.bandwidth, p.servo.damping) = (100.0, 0.7);
        let reference = Trajectory { position: 1e-6, velocity: 1e-4, acceleration: 0.05 };
        // 1e4 * 0.4 um and 140 * 20 um/s
        let a = acceleration(&p.servo, &reference, 0.6e-6, 8e-5);
        assert!((a - (0.05 + 4e-3 + 2.8e-3)).abs() < 1e-12, "{a}");
    }

    #[test]
    fn acted_current_is_late_by_the_delay() {
        for delay in 0..4 {
            let mut p = Parameters::START;
            p.io_delay = delay;
            let mut amplifier = Amplifier::new(&p);
            let mut acted = Vec::new();
            for k in 0..6 {
                acted.push(amplifier.acted(&p));
                amplifier.send(f64::from(k + 1) * 100.0 * current_step(&p));
            }
            let first = acted.iter().position(|i| *i > 0.0).unwrap();
            assert_eq!(first as i32, delay + 1);
        }
    }

    #[test]
    fn samples_at_the_limit_are_counted_consecutively() {
        let p = Parameters::START;
        let mut amplifier = Amplifier::new(&p);
        let limited = [9.0, 5.0, -9.0, 4.9, 9.0].map(|current| {
            amplifier.send(current);
            amplifier.limited()
        });
        assert_eq!(limited, [1, 2, 3, 0, 1]);
    }

    #[test]
    fn oscillations_from_limit_to_limit_are_counted_until_they_are_discarded() {
        let p = Parameters::START;
        let mut amplifier = Amplifier::new(&p);
        assert_eq!(amplifier.reversals(), 0);
        let oscillations = [9.0, -9.0, 0.0, 9.0, -9.0].map(|current| {
            amplifier.send(current);
            amplifier.reversals()
        });
        assert_eq!(oscillations, [0, 1, 1, 2, 3]);
        amplifier.forget();
        assert_eq!((amplifier.reversals(), amplifier.limited()), (0, 0));
    }

    #[test]
    fn integrator_is_held_at_the_limit() {
        let p = Parameters::START;
        let mut integrator = Integrator::default();
        let a = integrator.update(&p, 1e-6, false);
        assert!((a - 2e6 * 1e-6 * 1e-4).abs() < 1e-18);
        assert_eq!(integrator.update(&p, 1e-6, true), a);
    }
}
