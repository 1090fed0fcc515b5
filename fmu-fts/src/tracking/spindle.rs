//! Spindle: angle without wraps, and the speed from a phase-locked loop.
//!
//! The path uses the raw angle, so that it follows every irregularity of the spindle; only the speed is filtered.

use std::f64::consts::TAU;

use control_blocks::{SentCommands, Unwrapper};
use serde::{Deserialize, Serialize};

use crate::interface::Parameters;

/// Natural frequency (rad/s) of the loop that estimates the speed: 20 Hz, slow enough for the encoder steps, fast
/// enough for a ramp. The path uses the raw angle.
const BANDWIDTH: f64 = 20.0 * TAU;

/// Spindle angle and speed; by default nothing, before the first sample.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Spindle {
    samples: u8,
    unwrapper: Unwrapper,
    /// the last angles, the newest first, rad
    readings: SentCommands,
    /// Angle without wraps since the first sample, rad.
    pub angle: f64,
    /// Estimated speed, rad/s.
    pub speed: f64,
    locked_angle: f64,
}

impl Spindle {
    /// Takes the angle reading (rad, wrapped or not) of one sample; while it `begins` the last step alone is the speed.
    pub fn update(&mut self, p: &Parameters, raw: f64, begins: bool) {
        let step = self.unwrapper.step(raw).unwrap_or(0.0);
        self.angle += step;
        if self.samples == 0 {
            self.readings = SentCommands::resting(raw);
        }
        self.readings.send(raw);
        match self.samples {
            0 => self.locked_angle = self.angle,
            // the second sample gives the loop a speed to begin with
            samples if samples == 1 || begins => (self.locked_angle, self.speed) = (self.angle, step / p.sample_period),
            _ => self.follow(BANDWIDTH, p.sample_period),
        }
        self.samples = (self.samples + 1).min(2);
    }

    /// Critically damped second-order loop.
    fn follow(&mut self, omega: f64, dt: f64) {
        self.locked_angle += self.speed * dt;
        let innovation = self.angle - self.locked_angle;
        self.locked_angle += 2.0 * omega * dt * innovation;
        self.speed += omega * omega * dt * innovation;
    }

    /// Whether angle and speed are known: from the second sample on.
    pub fn known(&self) -> bool {
        self.samples == 2
    }

    /// The spindle angle as read when the arm was where it is read now, rad.
    pub fn raw(&self, p: &Parameters) -> f64 {
        self.readings.before(p.arm_delay as usize)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use control_blocks::ticks;
    use std::f64::consts::TAU;

    const QUANTUM: f64 = TAU / 1_048_576.0;

    fn rotated(speed: impl Fn(f64) -> f64, wrap: bool, time: f64) -> (Spindle, f64) {
        let p = Parameters::START;
        let (mut spindle, mut angle, dt) = (Spindle::default(), 5.0f64, p.sample_period);
        for k in 0..ticks(time, dt) {
            let read = if wrap { angle.rem_euclid(TAU) } else { angle };
            spindle.update(&p, (read / QUANTUM).round() * QUANTUM, false);
            angle += speed(f64::from(k) * dt) * dt;
        }
        (spindle, angle - 5.0)
    }

    #[test]
    fn the_speed_is_exact_at_constant_speed_both_ways() {
        for speed in [62.83, -251.3, 0.0] {
            for wrap in [false, true] {
                let (spindle, _) = rotated(|_| speed, wrap, 0.3);
                assert!((spindle.speed - speed).abs() < 2e-3, "{} rad/s", spindle.speed);
            }
        }
    }

    #[test]
    fn wrapped_and_unwrapped_angles_are_the_same() {
        let (wrapped, _) = rotated(|_| 62.83, true, 1.0);
        let (unwrapped, _) = rotated(|_| 62.83, false, 1.0);
        assert!((wrapped.angle - unwrapped.angle).abs() < 1.1 * QUANTUM);
    }

    #[test]
    fn a_ramp_lags_by_acceleration_over_bandwidth() {
        // 600 to 900 rpm in 1 s
        let (spindle, _) = rotated(|t| 62.83 + 31.4 * t, false, 0.5);
        let lag = 2.0 * 31.4 / BANDWIDTH;
        assert!((spindle.speed - (62.83 + 31.4 * 0.5) + lag).abs() < 0.02, "{}", spindle.speed);
    }

    #[test]
    fn an_arm_that_is_read_late_belongs_to_an_earlier_angle() {
        let (mut p, mut spindle) = (Parameters::START, Spindle::default());
        (0..=20).for_each(|k| spindle.update(&p, 0.01 * f64::from(k), false));
        for (delay, angle) in [(0, 0.2), (1, 0.19), (8, 0.12)] {
            p.arm_delay = delay;
            assert!((spindle.raw(&p) - angle).abs() < 1e-12);
        }
    }

    #[test]
    fn the_second_sample_gives_the_speed() {
        let p = Parameters::START;
        let mut spindle = Spindle::default();
        spindle.update(&p, 1.0, false);
        assert_eq!(spindle.speed, 0.0);
        spindle.update(&p, 1.0 + 6e-3, false);
        assert!((spindle.speed - 60.0).abs() < 1e-9);
        // the first was not where the spindle was
        spindle.update(&p, 1.0 + 16e-3, true);
        assert!((spindle.speed - 100.0).abs() < 1e-9);
    }
}
