//! Checks the inputs of a sample: what can be used, and what is wrong with the rest.

use std::f64::consts::FRAC_PI_2;

use control_blocks::{Consecutive, Edge, Frozen, JumpGuard, Reach, believable};
use serde::{Deserialize, Serialize};

use crate::interface::{Input, Parameters};
use crate::monitoring::recent::RecentReadings;

/// No machine has a longer axis, m.
const POSITION_MAX: f64 = 1e3;
/// No spindle is faster, rad/s.
const SPEED_MAX: f64 = 1e5;
/// A reading stands while it is within this many steps of the encoder, one of them a last bit that flickers.
const STANDS: f64 = 1.5;
/// Shares of `limits.frozen`: what a reading may leave unanswered to prove a contact, and how far a stage follows its reference.
const ALIVE: f64 = 1.0 / 3.0;
const WITH_IT: f64 = 4.0;
/// Longest quarter turn of a spindle for which a slow stage may stand, s.
const STANDSTILL: f64 = 1.5e-3;
/// A reading counts up to this share of `limits.jump` from where it is expected, so that a bad sample that is just believed
/// leaves the good ones after it within `limits.jump`: 0.5 of it, and what the velocity that it makes adds in a sample.
const COUNTS: f64 = 0.5;
/// Share of a spindle's speed within which readings of it may differ, and the least such difference, rad/s.
const SPEED_SPREAD: (f64, f64) = (0.02, 1.0);

/// Why there is no position.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Loss {
    /// The encoder says so, or the number is none.
    #[default]
    Invalid,
    /// It stands although the stage must have moved.
    Frozen,
    /// The stage cannot be there.
    Jumps,
}

/// What the model of the stage says about the position of this sample, towards the workpiece.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Expected {
    /// Motion since the last sample by the observer, m.
    pub motion: f64,
    /// The same where a reading is lost, and none has corrected the observer, m.
    pub bridged: f64,
    /// What it cannot foresee, m in a sample.
    pub unforeseen: f64,
    /// The reference until now, m.
    pub reference: f64,
    /// Motion of the reference since the last sample, m.
    pub asked: f64,
    /// By how much the stage may be behind the reference, m.
    pub behind: f64,
    /// How far besides it may be from it, m.
    pub diverged: f64,
    /// A stage that was ahead of its reference may stand until that has come by.
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
    /// Samples in a row with a spindle speed that is no number, or out of any plausible range.
    pub invalid: u32,
    /// Samples in a row without a position.
    pub lost: u32,
    /// Why the last of them had none.
    pub loss: Loss,
    /// By how many samples those that jumped are late, if the encoder says again what it has said.
    pub late: Option<u32>,
    /// The position answers the motion of the reference.
    pub alive: bool,
    /// Believed positions in a row, lost samples between them left out, that counted in full.
    pub whole: u32,
    /// Samples in a row with a spindle speed that cannot be.
    pub spindle_lost: u32,
}

/// Remembers what one reading needs from the ones before; by default nothing, before the first sample.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Reader {
    known: bool,
    lost: Consecutive,
    loss: Loss,
    /// a sample had no reading since the last position
    gap: bool,
    invalid: Consecutive,
    whole: Consecutive,
    standing: Frozen,
    /// The last readings as they came.
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
    /// Reads one sample.
    pub fn read(&mut self, p: &Parameters, input: &Input, expected: &Expected) -> Reading {
        let position_good = believable(input.position, POSITION_MAX);
        let speed_good = believable(input.spindle_speed, SPEED_MAX);
        let given = (input.position_valid && position_good).then_some(p.direction() * input.position);
        let lost_too_long = self.lost.count() > p.limits.lost_samples.unsigned_abs();
        let position = self.believe(p, given, expected, lost_too_long);
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
            alive: self.standing.unanswered() <= ALIVE * p.limits.frozen,
            whole: self.whole.count(),
            spindle_lost: self.spindle_speed.doubted(),
        }
    }

    /// How long (s) a slow stage may stand that a flute or the unbalance has stopped: a quarter turn of the spindle, at most [`STANDSTILL`].
    pub fn standstill(&self) -> f64 {
        let speed = self.spindle_speed.believed().map_or(0.0, f64::abs);
        if speed > 0.0 { (FRAC_PI_2 / speed).min(STANDSTILL) } else { 0.0 }
    }

    /// The motion that the position has not answered is forgotten, when it is no longer controlled for instance.
    pub fn forgive(&mut self) {
        self.standing.clear();
    }

    /// The given position if the stage can be there, nearer to where it is expected if it counts only in part; after too
    /// long without one any is taken.
    fn believe(&mut self, p: &Parameters, given: Option<f64>, e: &Expected, anew: bool) -> Option<f64> {
        if anew {
            self.position.clear();
        }
        let jumped = self.position.doubted() > 0 && self.loss == Loss::Jumps;
        let standing_before = self.standing;
        if let Some(position) = given {
            self.standing.update(position, e.asked, STANDS * p.stage.encoder_resolution);
        }
        let unanswered = self.standing.unanswered();
        let near = e.behind + e.diverged + WITH_IT * p.limits.frozen;
        let stands = given.filter(|_| !jumped).is_some_and(|z| {
            let error = e.reference - z;
            // a stage that was diverged may truly stand, as one that was ahead in a stroke does until its reference has come by;
            // and what has jumped may come by where it was
            let ahead = (self.standing.missed() - error) * self.standing.missed().signum();
            let with_it = near + e.asked.abs() * (1.0 + f64::from(p.io_delay));
            let waits = if e.may_wait && ahead > with_it { ahead } else { 0.0 };
            unanswered > p.limits.frozen + e.behind + waits && error.abs() <= unanswered + near
        });
        self.gap |= given.is_none();
        self.position.shift(if self.gap { e.bridged } else { e.motion });
        let expected = self.position;
        let reach = Reach { motion: e.unforeseen, spread: p.limits.jump };
        let reading = self.position.update(given.filter(|_| !stands).unwrap_or(f64::NAN), reach);
        if self.position.doubted() == 0 {
            self.gap = false;
            let most = e.unforeseen + COUNTS * p.limits.jump;
            let excess = expected.believed().map_or(0.0, |z| (reading - z) - (reading - z).clamp(-most, most));
            self.position.shift(-excess);
            self.whole.update(excess == 0.0);
            return Some(reading - excess);
        }
        if !stands {
            // where the stage cannot be, no reading can stand
            self.standing = standing_before;
        }
        self.loss = match given {
            None => Loss::Invalid,
            Some(_) if stands => Loss::Frozen,
            Some(_) => Loss::Jumps,
        };
        None
    }

    /// The last spindle speed that can be; at any other time than a job every speed can.
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
