//! One axis compared with the model of its loop.
//!
//! The loop makes of reference and compensation the position T (r + c), with T of the nominal drive. The rest of the
//! measured position is unexplained: at rest zero, in motion the error of the gain times the lag V/Kp of the servo
//! without patterns. The limit is therefore `error_max` + 0.5 V/Kp for drives of 0.7 to 2 times their gain, with
//! learned, foreign or no patterns. A pattern that grows is explained by the model and is found by its error:
//! `error_max` + V/Kp. The error of a servo without patterns and half its gain is twice V/Kp.
//!
//! An exceeded limit starts the search for the cause: a frozen position, a command that oscillates, sign and strength
//! of the response.

mod answer;
mod lag;
mod slips;
#[cfg(test)]
mod tests;
mod unanswered;

use control_blocks::Consecutive;
use serde::{Deserialize, Serialize};

use crate::interface::{Fault, Parameters};
use crate::learning::nominal::{LoopState, Nominal};
use crate::monitoring::axis::answer::{Answer, EXCITED};
use crate::monitoring::axis::lag::Lag;
use crate::monitoring::axis::slips::Slips;
use crate::monitoring::axis::unanswered::Unanswered;
use crate::monitoring::finding::{Finding, Numbers};

/// Difference from the model in lags of the bare servo.
const MISMATCH: f64 = 0.5;
/// Error in lags of the bare servo.
const BARE: f64 = 2.0;
/// Error in lags of the bare servo from which a learned pattern is harmful.
const GROWN: f64 = 1.0;
/// Counts that the model may have to go where its axis rests, and the time until the axis does, in 1/Kp.
const LAST: f64 = 2.5;
const COMES_TO_REST: f64 = 4.0;

/// Model of the loop of one axis, and the checks of the axis against it.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct AxisMonitor {
    nominal: Nominal,
    model: LoopState,
    lag: Lag,
    answer: Answer,
    unanswered: Unanswered,
    slips: Slips,
    unexplained: Consecutive,
    far: Consecutive,
    off: Consecutive,
    /// samples since the model had more than the last counts to go
    calm: u32,
}

/// Measurement, command and control error of one axis in a sample, rad or m.
#[derive(Clone, Copy, Debug)]
pub struct Motion {
    /// Encoder measurement.
    pub position: f64,
    /// Motion that was commanded for the sample that ends now.
    pub commanded: f64,
    /// Control error.
    pub error: f64,
}

/// Which limits hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Expectation {
    /// The bare servo.
    Bare,
    /// Patterns that are being learned: an error that grows ends the repetition.
    Learned,
    /// Patterns that were learned.
    Compensated,
}

/// Result of monitoring an axis, or all axes, in a sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Outcome {
    /// All values are within their limits.
    Good,
    /// The control error with a pattern that is being learned exceeds its limit: the repetition ends.
    Grown,
    /// A fault.
    Wrong(Finding),
}

impl AxisMonitor {
    /// At rest at zero; `axis` from 0.
    pub fn new(p: &Parameters, axis: usize) -> Self {
        Self {
            nominal: Nominal::new(p, axis),
            model: LoopState::default(),
            lag: Lag::default(),
            answer: Answer::default(),
            unanswered: Unanswered::resting(0.0),
            slips: Slips::default(),
            unexplained: Consecutive::NONE,
            far: Consecutive::NONE,
            off: Consecutive::NONE,
            calm: 0,
        }
    }

    /// The loop closes at rest at a position (rad or m); `pulse` is that of the encoder.
    pub fn restart(&mut self, position: f64, pulse: f64) {
        let counts = (position / pulse).round();
        self.model = LoopState::resting(counts);
        (self.lag, self.answer) = (Lag::resting(counts * pulse), Answer::resting(position));
        self.unanswered = Unanswered::resting(position);
        self.forget_slips();
        (self.unexplained, self.far, self.off) = (Consecutive::NONE, Consecutive::NONE, Consecutive::NONE);
        self.calm = 0;
    }

    /// Begins to count again what the encoder loses.
    pub fn forget_slips(&mut self) {
        self.slips.restart();
    }

    /// Position beyond that of the model, rad or m.
    pub fn residual(&self, position: f64, pulse: f64) -> f64 {
        position - self.model(pulse)
    }

    /// How far the position may be from the model in the rest after a run, because the drive is slow, rad or m.
    pub fn allowance(&self) -> f64 {
        MISMATCH * self.lag.tail
    }

    /// Position of the model, rad or m.
    pub fn model(&self, pulse: f64) -> f64 {
        self.model.position() * pulse
    }

    /// Whether the axis `axis` (from 0) rests except the last counts of its patterns, for as long as it takes.
    pub fn rests(&self, p: &Parameters, axis: usize) -> bool {
        p.servo_gain[axis] * p.sample_period * f64::from(self.calm) > COMES_TO_REST
    }

    /// Takes what was sent: reference and compensation in counts, and the velocity command (rad/s or m/s).
    pub fn command(&mut self, p: &Parameters, axis: usize, reference: f64, compensation: f64, velocity: f64) {
        let previous = self.nominal.step(&mut self.model, reference + compensation);
        let left = reference + compensation - self.model.position();
        let moves = (self.model.position() - previous).abs().max(p.servo_gain[axis] * p.sample_period * left.abs());
        self.unanswered.expect(p, moves);
        let calm = moves < LAST * p.servo_gain[axis] * p.sample_period;
        self.calm = if calm { self.calm.saturating_add(1) } else { 0 };
        self.lag.command(p, axis, reference * p.axis[axis].pulse);
        self.answer.command(p, axis, velocity);
    }

    /// Looks at the axis `axis` (from 0) in a sample in which its loop is closed.
    pub fn look(&mut self, p: &Parameters, axis: usize, motion: &Motion, expected: Expectation) -> Outcome {
        let Motion { position, commanded, error } = *motion;
        let (pulse, limits) = (p.axis[axis].pulse, &p.limits.axis[axis]);
        self.unanswered.update(p, axis, position, commanded);
        self.answer.update(position, commanded);
        let slipped = self.slips.update(p, axis, position, commanded);
        let unanswered = self.unanswered.motion();
        if self.unanswered.stopped(p) && unanswered > limits.error_max {
            return self.wrong(axis, Fault::FollowingError, unanswered, limits.error_max, p);
        }
        let bridged = p.limits.lost_samples.unsigned_abs();
        let residual = self.residual(position, pulse).abs();
        let maximum = limits.error_max + MISMATCH * self.lag.peak;
        if self.unexplained.update(residual > maximum) > bridged {
            return self.wrong(axis, Fault::FollowingError, residual, maximum, p);
        }
        let lags = if expected == Expectation::Learned { GROWN } else { BARE };
        let maximum = limits.error_max + lags * self.lag.peak;
        if self.far.update(error.abs() > maximum) > bridged {
            return match expected {
                Expectation::Learned => Outcome::Grown,
                _ => self.wrong(axis, Fault::FollowingError, error.abs(), maximum, p),
            };
        }
        let maximum = limits.pattern_error;
        if self.off.update(expected == Expectation::Compensated && error.abs() > maximum) > bridged {
            // no drive of another gain is off like this: it is not the pattern
            let explained = residual <= maximum + MISMATCH * self.lag.peak;
            let consequence = if explained { Fault::PatternMismatch } else { Fault::FollowingError };
            return self.wrong(axis, consequence, error.abs(), maximum, p);
        }
        if slipped.is_fault() { Outcome::Wrong(slipped) } else { Outcome::Good }
    }

    fn wrong(&self, axis: usize, consequence: Fault, value: f64, limit: f64, p: &Parameters) -> Outcome {
        let pulse = p.axis[axis].pulse;
        let explained = self.unanswered.explained();
        let cause = match self.unanswered.motion() > EXCITED * pulse {
            _ if !self.unanswered.stopped(p) => self.answer.cause(pulse),
            // it rests where the command compensates an offset
            _ if explained => None,
            true => Some(Fault::PositionFrozen),
            false => self.answer.cause(pulse),
        };
        let ratio = self.answer.ratio(pulse).or((cause == Some(Fault::PositionFrozen)).then_some(0.0));
        let numbers = Numbers { axis: axis as i32 + 1, value, limit, ratio };
        Outcome::Wrong(Finding { fault: cause.unwrap_or(consequence), numbers })
    }
}
