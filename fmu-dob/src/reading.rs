//! Checks the inputs of a sample: usable values, and the reason why others are rejected.

use std::f64::consts::FRAC_PI_2;

use control_blocks::{Consecutive, Edge, Frozen, JumpGuard, Reach, is_plausible};
use serde::{Deserialize, Serialize};

use crate::interface::{Input, Parameters};
use crate::monitoring::recent::RecentReadings;

/// Maximum plausible position, m.
const POSITION_MAX: f64 = 1e3;
/// Maximum plausible spindle speed, rad/s.
const SPEED_MAX: f64 = 1e5;
/// A position within this many encoder steps has not changed; one of them is a toggling last bit.
const STEP: f64 = 1.5;
/// Fractions of `limits.frozen`: maximum motion without a change in evidence for a contact, and distance within which a
/// stage follows its reference.
const ALIVE: f64 = 1.0 / 3.0;
const WITH_IT: f64 = 4.0;
/// Maximum quarter revolution of a spindle for which a slow stage may be at rest, s.
const STANDSTILL: f64 = 1.5e-3;
/// A position is used in full up to this fraction of `limits.jump` from its prediction. A bad sample that is just
/// accepted then leaves the good ones after it within `limits.jump`: half of it, plus the effect of its velocity error
/// in a sample.
const COUNTS: f64 = 0.5;
/// Relative spread of the measured spindle speed, and its minimum, rad/s.
const SPEED_SPREAD: (f64, f64) = (0.02, 1.0);

/// Why there is no position.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Loss {
    /// The encoder reports it, or the value is no number.
    #[default]
    Invalid,
    /// It does not change although the stage must have moved.
    Frozen,
    /// The stage cannot be there.
    Jumps,
}

/// Prediction of the position of this sample by the model of the stage, towards the workpiece.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Expected {
    /// Motion since the last sample by the observer, m.
    pub motion: f64,
    /// The same where the position is lost and the observer is not corrected, m.
    pub bridged: f64,
    /// Unpredictable motion, m in a sample.
    pub unforeseen: f64,
    /// The reference until now, m.
    pub reference: f64,
    /// Motion of the reference since the last sample, m.
    pub requested: f64,
    /// Tolerated lag of the stage, m.
    pub lag: f64,
    /// Additional distance from the reference, m.
    pub diverged: f64,
    /// A stage ahead of its reference may be at rest until the reference has caught up.
    pub may_wait: bool,
    /// The spindle must be steady.
    pub steady_spindle: bool,
}

/// The usable part of the inputs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reading {
    /// Position towards the workpiece, m; none while it is lost.
    pub position: Option<f64>,
    /// Spindle speed, rad/s; the last good one if the input is not.
    pub spindle_speed: f64,
    /// `enable` is set.
    pub enabled: bool,
    /// Rising edge of `enable`.
    pub begin: bool,
    /// `commission` is set.
    pub commission: bool,
    /// Rising edge of `commission`.
    pub begin_commission: bool,
    /// `calibrate` is set.
    pub calibrate: bool,
    /// Rising edge of `calibrate`.
    pub begin_calibration: bool,
    /// Rising edge of `reset_fault`.
    pub reset: bool,
    /// The position is there for the first time, or again after too long.
    pub found: bool,
    /// Consecutive samples with a spindle speed that is no number or out of range.
    pub invalid: u32,
    /// Consecutive samples without a position.
    pub lost: u32,
    /// Why the last of them had none.
    pub loss: Loss,
    /// Delay of the jumped positions in samples, if the encoder repeats earlier values.
    pub late: Option<u32>,
    /// The position follows the motion of the reference.
    pub alive: bool,
    /// Consecutive positions that were used in full, without the lost samples between them.
    pub whole: u32,
    /// Consecutive samples with an implausible spindle speed.
    pub spindle_lost: u32,
}

/// State of the input checks between samples; the default is that before the first sample.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Reader {
    known: bool,
    lost: Consecutive,
    loss: Loss,
    /// a sample had no position since the last one
    gap: bool,
    invalid: Consecutive,
    whole: Consecutive,
    constant: Frozen,
    /// The last positions as measured.
    pub recent: RecentReadings,
    position: JumpGuard,
    spindle_speed: JumpGuard,
    started: bool,
    enable: Edge,
    commission: Edge,
    calibrate: Edge,
    reset_fault: Edge,
}

impl Parameters {
    /// Sign of the approach along the encoder axis, +1 or -1.
    pub fn direction(&self) -> f64 {
        f64::from(self.approach.direction)
    }
}

impl Reader {
    /// Checks one sample.
    pub fn read(&mut self, p: &Parameters, input: &Input, expected: &Expected) -> Reading {
        let position_good = is_plausible(input.position, POSITION_MAX);
        let speed_good = is_plausible(input.spindle_speed, SPEED_MAX);
        let given = (input.position_valid && position_good).then_some(p.direction() * input.position);
        let lost_too_long = self.lost.count() > p.limits.lost_samples.unsigned_abs();
        let position = self.accept(p, given, expected, lost_too_long);
        self.recent.update(given.unwrap_or(f64::NAN), self.position.doubted());
        let found = position.is_some() && (!self.known || lost_too_long);
        self.known |= position.is_some();
        let spindle_speed = self.spindle(p, if speed_good { input.spindle_speed } else { f64::NAN }, expected);
        let begin = self.enable.rises(input.enable) && self.started;
        let begin_commission = self.commission.rises(input.commission) && self.started;
        let begin_calibration = self.calibrate.rises(input.calibrate) && self.started;
        self.started = true;
        Reading {
            position,
            spindle_speed,
            enabled: input.enable,
            begin,
            commission: input.commission,
            begin_commission,
            calibrate: input.calibrate,
            begin_calibration,
            reset: self.reset_fault.rises(input.reset_fault),
            found,
            invalid: self.invalid.update(!speed_good),
            lost: self.lost.update(position.is_none()),
            loss: self.loss,
            late: self.recent.late(self.position.doubted()),
            alive: self.constant.unanswered() <= ALIVE * p.limits.frozen,
            whole: self.whole.count(),
            spindle_lost: self.spindle_speed.doubted(),
        }
    }

    /// Time (s) for which a flute or the unbalance may stop a slow stage: a quarter revolution of the spindle, at most
    /// [`STANDSTILL`].
    pub fn standstill(&self) -> f64 {
        let speed = self.spindle_speed.accepted().map_or(0.0, f64::abs);
        if speed > 0.0 { (FRAC_PI_2 / speed).min(STANDSTILL) } else { 0.0 }
    }

    /// Discards the motion without a change of the position, for example when the stage is no longer controlled.
    pub fn forgive(&mut self) {
        self.constant.clear();
    }

    /// The given position if the stage can be there, shifted towards its prediction if it is only partly used; after a
    /// long loss any position is accepted.
    fn accept(&mut self, p: &Parameters, given: Option<f64>, e: &Expected, restarted: bool) -> Option<f64> {
        if restarted {
            self.position.clear();
        }
        let jumped = self.position.doubted() > 0 && self.loss == Loss::Jumps;
        let constant_before = self.constant;
        if let Some(position) = given {
            self.constant.update(position, e.requested, STEP * p.stage.encoder_resolution);
        }
        let unanswered = self.constant.unanswered();
        let near = e.lag + e.diverged + WITH_IT * p.limits.frozen;
        let is_frozen = given.filter(|_| !jumped).is_some_and(|z| {
            let error = e.reference - z;
            // a stage off its reference may actually be at rest, as one ahead in a stroke until its reference has caught up;
            // and a position that jumped may pass its old value
            let ahead = (self.constant.missed() - error) * self.constant.missed().signum();
            let with_it = near + e.requested.abs() * (1.0 + f64::from(p.io_delay));
            let waits = if e.may_wait && ahead > with_it { ahead } else { 0.0 };
            unanswered > p.limits.frozen + e.lag + waits && error.abs() <= unanswered + near
        });
        self.gap |= given.is_none();
        self.position.shift(if self.gap { e.bridged } else { e.motion });
        let expected = self.position;
        let reach = Reach { motion: e.unforeseen, spread: p.limits.jump };
        let reading = self.position.update(given.filter(|_| !is_frozen).unwrap_or(f64::NAN), reach);
        if self.position.doubted() == 0 {
            self.gap = false;
            let maximum = e.unforeseen + COUNTS * p.limits.jump;
            let excess = expected.accepted().map_or(0.0, |z| (reading - z) - (reading - z).clamp(-maximum, maximum));
            self.position.shift(-excess);
            self.whole.update(excess == 0.0);
            return Some(reading - excess);
        }
        if !is_frozen {
            // where the stage cannot be, no reading can stand
            self.constant = constant_before;
        }
        self.loss = match given {
            None => Loss::Invalid,
            Some(_) if is_frozen => Loss::Frozen,
            Some(_) => Loss::Jumps,
        };
        None
    }

    /// The last plausible spindle speed; outside of a cycle every speed is plausible.
    fn spindle(&mut self, p: &Parameters, given: f64, expected: &Expected) -> f64 {
        if !expected.steady_spindle && given.is_finite() {
            self.spindle_speed.clear();
        }
        let spread = (SPEED_SPREAD.0 * given.abs()).max(SPEED_SPREAD.1);
        let reach = Reach { motion: p.limits.spindle_acceleration * p.sample_period, spread };
        self.spindle_speed.update(given, reach)
    }
}

#[cfg(test)]
mod tests;
