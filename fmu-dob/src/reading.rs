//! Checks the inputs of a sample: what can be used, and what is wrong with the rest.

use std::f64::consts::FRAC_PI_2;

use control_blocks::{Consecutive, Edge, Frozen, JumpGuard, Reach, believable};
use serde::{Deserialize, Serialize};

use crate::interface::{Input, Parameters};
use crate::monitoring::heard::Heard;

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
    Told,
    /// It stands although the stage must have moved.
    Stands,
    /// The stage cannot be there.
    Jumps,
}

/// What the model of the stage says about the position of this sample, towards the workpiece.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Expected {
    /// Motion since the last sample by the observer, m.
    pub motion: f64,
    /// What it cannot foresee, m in a sample.
    pub unforeseen: f64,
    /// The reference until now, m.
    pub reference: f64,
    /// Motion of the reference since the last sample, m.
    pub asked: f64,
    /// By how much the stage may be behind the reference, m.
    pub behind: f64,
    /// How far besides it may be from it, m.
    pub astray: f64,
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
    /// `teach` is set.
    pub teach: bool,
    /// Rising edge of `teach`.
    pub begin_teaching: bool,
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
    invalid: Consecutive,
    whole: Consecutive,
    standing: Frozen,
    /// The last readings as they came.
    pub heard: Heard,
    position: JumpGuard,
    spindle_speed: JumpGuard,
    started: bool,
    enable: Edge,
    commission: Edge,
    teach: Edge,
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
        self.heard.update(given.unwrap_or(f64::NAN), self.position.doubted());
        let found = position.is_some() && (!self.known || lost_too_long);
        self.known |= position.is_some();
        let spindle_speed = self.spindle(p, if speed_good { input.spindle_speed } else { f64::NAN }, expected);
        let begin = self.enable.rises(input.enable) && self.started;
        let begin_commission = self.commission.rises(input.commission) && self.started;
        let begin_teaching = self.teach.rises(input.teach) && self.started;
        self.started = true;
        Reading {
            position,
            spindle_speed,
            enabled: input.enable,
            begin,
            commission: input.commission,
            begin_commission,
            teach: input.teach,
            begin_teaching,
            reset: self.reset_fault.rises(input.reset_fault),
            found,
            invalid: self.invalid.update(!speed_good),
            lost: self.lost.update(position.is_none()),
            loss: self.loss,
            late: self.heard.late(self.position.doubted()),
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
        let near = e.behind + e.astray + WITH_IT * p.limits.frozen;
        let stands = given.filter(|_| !jumped).is_some_and(|z| {
            let error = e.reference - z;
            // a stage that was astray may truly stand, as one that was ahead in a stroke does until its reference has come by;
            // and what has jumped may come by where it was
            let ahead = (self.standing.missed() - error) * self.standing.missed().signum();
            let with_it = near + e.asked.abs() * (1.0 + f64::from(p.io_delay));
            let waits = if e.may_wait && ahead > with_it { ahead } else { 0.0 };
            unanswered > p.limits.frozen + e.behind + waits && error.abs() <= unanswered + near
        });
        self.position.shift(e.motion);
        let expected = self.position;
        let reach = Reach { motion: e.unforeseen, spread: p.limits.jump };
        let reading = self.position.update(given.filter(|_| !stands).unwrap_or(f64::NAN), reach);
        if self.position.doubted() == 0 {
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
            None => Loss::Told,
            Some(_) if stands => Loss::Stands,
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
mod tests {
    use std::f64::consts::PI;

    use super::*;

    const LOST: Input = Input { position_valid: false, ..Input::START };
    const RESTING: Expected = Expected {
        motion: 0.0,
        unforeseen: 0.0,
        reference: 0.0,
        asked: 0.0,
        behind: 0.0,
        astray: 0.0,
        may_wait: true,
        steady_spindle: true,
    };
    /// 10 nm in a sample
    const CRUISING: Expected = Expected { motion: 1e-8, reference: 1e-6, asked: 1e-8, ..RESTING };

    fn at(position: f64) -> Input {
        Input { position, ..Input::START }
    }

    fn read(reader: &mut Reader, input: &Input) -> Reading {
        reader.read(&Parameters::START, input, &RESTING)
    }

    /// A reader that has followed 100 samples of 10 nm.
    fn cruising() -> Reader {
        let mut reader = Reader::default();
        for k in 0..100 {
            let reading = reader.read(&Parameters::START, &at(1e-8 * f64::from(k)), &CRUISING);
            assert!(reading.position.is_some() && reading.alive);
        }
        reader
    }

    #[test]
    fn a_position_is_found_at_first_and_after_more_than_the_bridged_samples() {
        let mut reader = Reader::default();
        assert!(read(&mut reader, &at(0.1)).found);
        assert!(!read(&mut reader, &at(0.1)).found);
        for k in 1..=3 {
            assert_eq!(read(&mut reader, &LOST).lost, k);
        }
        assert!(!read(&mut reader.clone(), &at(0.1)).found);
        assert_eq!(read(&mut reader, &LOST).lost, 4);
        // wherever it is then
        let reading = read(&mut reader, &at(0.2));
        assert_eq!((reading.found, reading.position), (true, Some(0.2)));
    }

    #[test]
    fn a_sample_where_the_stage_cannot_be_is_lost() {
        for jump in [-1e-3, -1.3e-8, 1.1e-8, 1e-3] {
            let mut reader = cruising();
            let bad = reader.read(&Parameters::START, &at(1e-6 + jump), &CRUISING);
            assert_eq!((bad.position, bad.lost, bad.loss), (None, 1, Loss::Jumps));
            let good = reader.read(&Parameters::START, &at(1.01e-6), &CRUISING);
            assert_eq!((good.position, good.lost), (Some(1.01e-6), 0));
        }
        let near = cruising().read(&Parameters::START, &at(1e-6 + 0.9e-8), &CRUISING);
        assert!(near.position.is_some());
    }

    #[test]
    fn a_position_that_stands_while_it_should_move_is_lost_even_with_a_last_bit_that_flickers() {
        for flicker in [0.0, 1e-9] {
            let mut reader = cruising();
            let stuck = (0..4u32).map(|k| {
                let input = at(99e-8 + flicker * f64::from(k % 2));
                reader.read(&Parameters::START, &input, &CRUISING)
            });
            let seen: Vec<_> = stuck.map(|reading| (reading.position, reading.lost, reading.loss)).collect();
            assert_eq!(seen, [1, 2, 3, 4].map(|lost| (None, lost, Loss::Stands)));
        }
    }

    #[test]
    fn a_stage_that_is_astray_may_stand() {
        let mut reader = cruising();
        // 100 nm behind its reference, and braked to a stop
        let astray = Expected { motion: 0.0, reference: 1.1e-6, ..CRUISING };
        for _ in 0..4 {
            assert!(reader.read(&Parameters::START, &at(99e-8), &astray).position.is_some());
        }
    }

    #[test]
    fn a_stage_may_be_behind_its_reference_by_what_it_is_late() {
        let mut reader = cruising();
        let late = Expected { motion: 0.0, behind: 1e-8, ..CRUISING };
        let reading = reader.read(&Parameters::START, &at(99e-8), &late);
        assert!(reading.position.is_some() && !reading.alive);
    }

    #[test]
    fn a_quarter_turn_is_that_of_the_spindle_and_no_longer_than_what_is_waited_for() {
        for (spindle_speed, expected) in [(0.0, 0.0), (-2000.0, 0.25e-3 * PI), (1100.0, PI / 2200.0), (900.0, 1.5e-3)] {
            let mut reader = Reader::default();
            read(&mut reader, &Input { spindle_speed, ..at(0.1) });
            assert!((reader.standstill() - expected).abs() < 1e-18, "{spindle_speed}");
        }
    }

    #[test]
    fn a_spindle_cannot_change_its_speed_at_once_while_it_must_be_steady() {
        let turning = |spindle_speed| Input { spindle_speed, ..at(0.1) };
        let mut reader = Reader::default();
        assert_eq!(read(&mut reader, &turning(3000.0)).spindle_lost, 0);
        assert_eq!(read(&mut reader, &turning(3015.0)).spindle_lost, 0);
        for k in 1..=5 {
            let reading = read(&mut reader, &turning(0.0));
            assert_eq!((reading.spindle_speed, reading.spindle_lost), (3015.0, k));
        }
        let before_a_job = Expected { steady_spindle: false, ..RESTING };
        let reading = reader.read(&Parameters::START, &turning(0.0), &before_a_job);
        assert_eq!((reading.spindle_speed, reading.spindle_lost), (0.0, 0));
    }

    #[test]
    fn nonsense_is_lost_or_invalid_and_never_used() {
        for nonsense in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1.1e3] {
            let mut reader = Reader::default();
            read(&mut reader, &at(0.1));
            for k in 1..=3 {
                let reading = read(&mut reader, &at(nonsense));
                assert_eq!((reading.position, reading.lost, reading.loss, reading.invalid), (None, k, Loss::Told, 0));
            }
        }
        for nonsense in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1.1e5] {
            let mut reader = Reader::default();
            read(&mut reader, &Input { spindle_speed: 3000.0, ..at(0.1) });
            for k in 1..=3 {
                let reading = read(&mut reader, &Input { spindle_speed: nonsense, ..at(0.1) });
                assert_eq!((reading.spindle_speed, reading.invalid, reading.lost), (3000.0, k, 0));
            }
            assert_eq!(read(&mut reader, &Input { spindle_speed: 3000.0, ..at(0.1) }).invalid, 0);
        }
    }

    #[test]
    fn what_is_far_from_where_it_should_be_counts_only_in_part_and_is_no_proof_for_a_while() {
        let mut reader = cruising();
        let next = |reader: &mut Reader, k: u32, error: f64| {
            let reading = reader.read(&Parameters::START, &at(1e-8 * f64::from(k) + error), &CRUISING);
            (reading.position.map(|z| (1e12 * (z - 1e-8 * f64::from(k))).round()), reading.whole)
        };
        let whole = next(&mut reader, 100, 0.0).1;
        assert_eq!(next(&mut reader, 101, 4.9e-9), (Some(4900.0), whole + 1));
        // 5 nm of the 8 that are missing
        assert_eq!(next(&mut reader, 102, -3.1e-9), (Some(-100.0), 0));
        assert_eq!(next(&mut reader, 103, -3.1e-9), (Some(-3100.0), 1));
    }

    #[test]
    fn enable_and_reset_count_on_their_edges_and_enable_not_at_first() {
        let mut reader = Reader::default();
        let both = Input { enable: true, reset_fault: true, ..Input::START };
        let edges: Vec<_> = [&both, &both, &Input::START, &both]
            .map(|input| read(&mut reader, input))
            .map(|reading| (reading.enabled, reading.begin, reading.reset))
            .into();
        assert_eq!(edges, [(true, false, true), (true, false, false), (false, false, false), (true, true, true)]);
    }

    #[test]
    fn direction_turns_the_axis() {
        let mut p = Parameters::START;
        p.approach.direction = -1;
        assert_eq!(Reader::default().read(&p, &at(0.2), &RESTING).position, Some(-0.2));
    }

    #[test]
    fn a_stage_that_was_hardly_astray_may_not_stand() {
        let mut reader = cruising();
        // 20 nm behind its reference, within the 10 nm that are unanswered and four times the 7.5 nm
        let near = Expected { motion: 0.0, reference: 1.01e-6, ..CRUISING };
        let stuck = reader.read(&Parameters::START, &at(99e-8), &near);
        assert_eq!((stuck.position, stuck.loss), (None, Loss::Stands));
    }

    #[test]
    fn a_reading_stands_beyond_its_limit_unless_the_stage_is_farther_astray_than_that_explains() {
        let mut p = Parameters::START;
        let unit = 2f64.powi(-28);
        p.limits.frozen = unit;
        let stands = |samples: u32, astray: f64| {
            let mut reader = Reader::default();
            let expected = Expected { asked: unit, behind: 2.0 * unit, reference: astray * unit, ..RESTING };
            let last = (0..=samples).map(|_| reader.read(&p, &at(0.0), &expected)).last().unwrap();
            last.position.is_none() && last.loss == Loss::Stands
        };
        // one of `limits.frozen` and two that the stage may be behind
        assert_eq!([stands(3, 0.0), stands(4, 0.0)], [false, true]);
        // four unanswered, two behind, four times `limits.frozen`
        assert_eq!([stands(4, 10.0), stands(4, 11.0)], [true, false]);
    }

    #[test]
    fn a_stage_that_was_ahead_stands_until_its_reference_has_come_by() {
        let mut p = Parameters::START;
        let unit = 2f64.powi(-28);
        p.limits.frozen = unit;
        let frozen = |samples: u32, ahead: f64, may_wait: bool| {
            let mut reader = Reader::default();
            let last = (0..=samples).map(|k| {
                let reference = (f64::from(k) - ahead) * unit;
                let expected = Expected { asked: unit, behind: 2.0 * unit, reference, may_wait, ..RESTING };
                reader.read(&p, &at(0.0), &expected)
            });
            let last = last.last().unwrap();
            last.position.is_none() && last.loss == Loss::Stands
        };
        let stands = |samples: u32, ahead: f64| frozen(samples, ahead, true);
        // two that it may be behind, two samples and four times `limits.frozen` are with the reference
        assert_eq!([stands(3, 8.0), stands(4, 8.0)], [false, true]);
        assert_eq!([stands(12, 9.0), stands(13, 9.0)], [false, true]);
        assert_eq!([stands(23, 20.0), stands(24, 20.0)], [false, true]);
        // elsewhere none waits
        assert_eq!([frozen(12, 9.0, false), frozen(15, 20.0, false)], [true, true]);
    }
}
