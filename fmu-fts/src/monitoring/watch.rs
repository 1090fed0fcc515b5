//! All monitors of the closed loop, and the fault that they find.

use control_blocks::{Reversals, ticks};
use serde::{Deserialize, Serialize};

use crate::interface::{Fault, Parameters};
use crate::monitoring::drive::DriveWatch;
use crate::monitoring::growth::GrowthWatch;
use crate::monitoring::life::LifeWatch;
use crate::monitoring::numbers::Numbers;

/// Below this ratio the arm accelerates against the torque.
const AGAINST: f64 = -0.2;
/// Below this one of the last milliseconds, too; a drive that is just off is taken for up to -0.4.
const REVERSED: f64 = -0.6;
/// Time over which the samples at the limit are averaged, s: a revolution at 600 rpm.
const SATURATION_MEAN: f64 = 0.1;
/// Time within which the torque of an unstable loop turns, s: 100 Hz and more.
const REVERSAL: f64 = 5e-3;
/// Number of changes; accelerating and braking is one.
pub const REVERSALS: u32 = 8;
/// Time constants of the cancellation within which its error becomes small: also after the tool has gone into the part.
pub const SETTLED: f64 = 8.0;

/// One sample of the closed loop.
#[derive(Clone, Copy, Debug)]
pub struct Sample {
    /// Where the hub should be, rad.
    pub reference: f64,
    /// Where its encoder says it is, rad.
    pub arm_angle: f64,
    /// Torque command, N.m.
    pub torque: f64,
    /// The oscillation of an identification lags its reference.
    pub oscillating: bool,
    /// The cancellation learns.
    pub learning: bool,
    /// Error of the last revolution, root mean square, m.
    pub rms: f64,
    /// Speed of the spindle, rad/s.
    pub spindle_speed: f64,
}

/// The monitors; by default before the first sample of a closed loop.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Watch {
    drive: DriveWatch,
    life: LifeWatch,
    reversals: Reversals,
    reversal_count: u32,
    saturated: f64,
    /// samples that the cancellation has learned with too large an error
    poor: u32,
    growth: GrowthWatch,
    following_error: f64,
}

impl Watch {
    /// Takes one sample; `length` is that of the arm, m.
    pub fn update(&mut self, p: &Parameters, length: f64, sample: &Sample) {
        let (dt, limit) = (p.sample_period, p.servo.torque_max);
        self.drive.update(p, sample.arm_angle, sample.torque);
        // an oscillation of the identification is monitored by the drive gain only: the arm responds late, or hardly
        if sample.oscillating {
            self.life = LifeWatch::default();
        }
        self.life.update(p, sample.reference, sample.arm_angle, sample.torque);
        self.reversal_count = self.reversals.update(sample.torque, limit, ticks(REVERSAL, dt));
        let full = f64::from(u8::from(sample.torque.abs() >= limit));
        self.saturated += (full - self.saturated) * (dt / SATURATION_MEAN);
        self.growth.update(sample.rms, sample.spindle_speed);
        // a sample without learning neither counts nor forgives
        if sample.rms <= p.limits.tracking_error {
            self.poor = 0;
        } else if sample.learning {
            self.poor = self.poor.saturating_add(1);
        }
        self.following_error = length * (sample.reference - sample.arm_angle);
    }

    /// The cause of what is wrong, if something is.
    pub fn find(&self, p: &Parameters, length: f64) -> Option<Fault> {
        let ratio = self.drive.ratio(p);
        // an arm that turns late stands for a moment, too
        let constant = i64::from(self.life.still()) > i64::from(p.limits.lost_samples);
        let frozen = constant && self.life.unanswered(p, length) > 1.0;
        let lag = self.following_error.abs() > p.limits.following_error;
        let poor = f64::from(self.poor) * p.sample_period > SETTLED * p.afc.tau;
        let left = self.drive.moving(p).is_some_and(|moving| moving.abs() < p.limits.drive_gain_ratio);
        frozen
            .then_some(if left { Fault::WeakDrive } else { Fault::PositionFrozen })
            .or(ratio.and_then(|ratio| self.drive_fault(p, ratio)))
            .or((self.reversal_count >= REVERSALS).then_some(Fault::Oscillation))
            .or(lag.then(|| self.lagging(p)))
            .or((self.saturated > p.limits.saturated_ratio).then_some(Fault::Saturation))
            .or(self.growth.grows(p).then_some(Fault::Divergence))
            .or(poor.then_some(Fault::NoProgress))
    }

    /// Where the arm is against where it should be, at the tool, m.
    pub fn following_error(&self) -> f64 {
        self.following_error
    }

    /// Numbers of what it finds.
    pub fn numbers(&self) -> Numbers {
        let (revolutions, begin) = self.growth.rise();
        Numbers { saturated: self.saturated, revolutions, begin, ..Numbers::START }
    }

    /// Acceleration of the arm over that of the torque, if the torque is large enough.
    pub fn ratio(&self, p: &Parameters) -> Option<f64> {
        self.drive.ratio(p)
    }

    /// Known response of the arm to a torque: 1 if the drive responded when last observed, without a contradiction since;
    /// -1 if it is reversed; 0 if neither is certain.
    pub fn answer(&self, p: &Parameters) -> f64 {
        let obeys = |ratio: f64| ratio >= p.limits.drive_gain_ratio;
        if self.drive.cause(p).is_some_and(|ratio| ratio < REVERSED) {
            return -1.0;
        }
        f64::from(u8::from(self.drive.seen().is_some_and(obeys) && self.drive.latest(p).is_none_or(obeys)))
    }

    /// The ratio for the message of a drive fault: that of 10 ms, or the latest if it is less.
    pub fn minimum_ratio(&self, p: &Parameters) -> f64 {
        [self.drive.ratio(p), self.drive.latest(p)].into_iter().flatten().reduce(f64::min).unwrap_or(1.0)
    }

    /// Cause of a following error: a fast path leaves its limit before a whole `MEMORY` has evaluated the drive.
    fn lagging(&self, p: &Parameters) -> Fault {
        match self.drive.cause(p).filter(|ratio| *ratio < p.limits.drive_gain_ratio) {
            None => Fault::FollowingError,
            Some(_) if p.limits.drive_gain_ratio == 0.0 => Fault::FollowingError,
            Some(ratio) if ratio < REVERSED => Fault::DriveSign,
            Some(_) => Fault::WeakDrive,
        }
    }

    /// Fault of a drive with this ratio.
    fn drive_fault(&self, p: &Parameters, ratio: f64) -> Option<Fault> {
        if p.limits.drive_gain_ratio == 0.0 || ratio >= p.limits.drive_gain_ratio {
            return None;
        }
        let constant = ratio.abs() < 0.1 && f64::from(self.life.still()) * p.sample_period > 5e-3;
        Some(if ratio < AGAINST || self.drive.cause(p).is_some_and(|cause| cause < REVERSED) {
            Fault::DriveSign
        } else if constant {
            Fault::PositionFrozen
        } else {
            Fault::WeakDrive
        })
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use control_blocks::Reaction;

    use super::*;

    const REST: Sample = Sample {
        reference: 0.0,
        arm_angle: 0.0,
        torque: 0.0,
        oscillating: false,
        learning: false,
        rms: 0.0,
        spindle_speed: 0.0,
    };

    /// Fault after 0.5 s at full torque, of an arm that lags its reference by `lag` (rad).
    fn at_full_torque(lag: f64) -> Option<Fault> {
        let (p, length, mut watch) = (Parameters::START, 0.08, Watch::default());
        for k in 0..5000 {
            let arm_angle = 1e-3 * f64::from(k);
            let (reference, torque) = (arm_angle + lag, p.servo.torque_max);
            watch.update(&p, length, &Sample { reference, arm_angle, torque, ..REST });
        }
        watch.find(&p, length)
    }

    #[test]
    fn an_arm_that_full_torque_leaves_behind_does_not_follow() {
        assert_eq!(at_full_torque(0.02), Some(Fault::FollowingError));
        assert_eq!(at_full_torque(0.001), Some(Fault::Saturation));
    }

    /// Fault after `time` s of learning in all samples except every `pause`th, with an error of `rms` (m) per revolution.
    fn learned(time: f64, pause: u32, rms: impl Fn(f64) -> f64) -> Option<Fault> {
        let (p, mut watch) = (Parameters::START, Watch::default());
        for k in 0..ticks(time, p.sample_period) {
            let (learning, rms) = (k % pause != 0, rms(f64::from(k) * p.sample_period));
            watch.update(&p, 0.08, &Sample { learning, rms, ..REST });
        }
        watch.find(&p, 0.08)
    }

    #[test]
    fn what_is_learned_in_vain_for_eight_time_constants_makes_no_progress() {
        assert_eq!(learned(2.35, 1000, |_| 21e-6), None);
        assert_eq!(learned(2.45, 1000, |_| 21e-6), Some(Fault::NoProgress));
        assert_eq!(learned(10.0, 1000, |_| 19e-6), None);
        // good in between, or nothing learned at all
        assert_eq!(learned(4.0, 1000, |t| if t < 2.0 { 21e-6 } else { 19e-6 }), None);
        assert_eq!(learned(4.0, 1, |_| 21e-6), None);
    }

    #[test]
    fn eight_time_constants_themselves_are_not_too_long() {
        let (mut p, mut watch) = (Parameters::START, Watch::default());
        p.afc.tau = 1000.0 * p.sample_period / 8.0;
        let rms = 2.0 * p.limits.tracking_error;
        let mut found = |samples: u32| {
            (0..samples).for_each(|_| watch.update(&p, 0.08, &Sample { learning: true, rms, ..REST }));
            watch.find(&p, 0.08)
        };
        assert_eq!((found(1000), found(1)), (None, Some(Fault::NoProgress)));
    }

    #[test]
    fn a_torque_that_turns_again_and_again_is_an_oscillation() {
        let found = |reversals: u32, every: u32| {
            let (p, mut watch) = (Parameters::START, Watch::default());
            for k in 0..reversals * every {
                let torque = if (k / every).is_multiple_of(2) { p.servo.torque_max } else { -p.servo.torque_max };
                watch.reversal_count =
                    watch.reversals.update(torque, p.servo.torque_max, ticks(REVERSAL, p.sample_period));
            }
            watch.find(&p, 0.08)
        };
        assert_eq!(found(8, 10), None);
        assert_eq!(found(9, 10), Some(Fault::Oscillation));
        // slower than 100 Hz
        assert_eq!(found(20, 60), None);
    }

    #[test]
    fn a_growing_error_is_reported_with_its_revolutions_and_its_start() {
        let (p, mut watch) = (Parameters::START, Watch::default());
        for revolution in 0..6 {
            let rms = 5e-6 * 1.5_f64.powi(revolution);
            watch.update(&p, 0.08, &Sample { rms, spindle_speed: 62.8, ..REST });
        }
        assert_eq!(watch.find(&p, 0.08), Some(Fault::Divergence));
        let Numbers { revolutions, begin, saturated, .. } = watch.numbers();
        assert_eq!((revolutions, begin, saturated), (5, 5e-6, 0.0));
    }

    #[test]
    fn nothing_goes_on_at_full_torque() {
        for lag in [0.02, 0.001] {
            assert_eq!(at_full_torque(lag).map(Fault::reaction), Some(Reaction::DriveOff));
        }
    }

    /// The monitors at the time `until` s, of a rigid arm whose drive does `gain` (of the time) of a torque of 6 N.m at
    /// 80 Hz.
    fn watched(p: &Parameters, gain: impl Fn(f64) -> f64, until: f64) -> Watch {
        let (dt, mut watch) = (p.sample_period, Watch::default());
        let (mut angle, mut velocity, mut before) = (0.0, 0.0, 0.0);
        for k in 0..ticks(until, dt) {
            let time = dt * f64::from(k);
            let torque = 6.0 * (TAU * 80.0 * time).cos();
            watch.update(p, 0.08, &Sample { reference: angle, arm_angle: angle, torque, ..REST });
            let acceleration = gain(time) * before / p.servo.inertia;
            angle += dt * (velocity + 0.5 * dt * acceleration);
            velocity += dt * acceleration;
            before = torque;
        }
        watch
    }

    /// The same of a drive that is good until `after` s before the end.
    fn reversed(p: &Parameters, gain: f64, after: f64) -> Watch {
        watched(p, |time| if time < 0.1 { 1.0 } else { gain }, 0.1 + after)
    }

    fn driven(gain: f64) -> Option<Fault> {
        watched(&Parameters::START, |_| gain, 0.1).find(&Parameters::START, 0.08)
    }

    #[test]
    fn a_weak_drive_is_weak_and_one_that_has_just_turned_has_the_wrong_sign() {
        assert_eq!([1.0, 0.3, -1.0].map(driven), [None, Some(Fault::WeakDrive), Some(Fault::DriveSign)]);
        // half of the stored motion is from before
        let p = Parameters::START;
        let first = (1..100).find_map(|k| reversed(&p, -1.0, 1e-4 * f64::from(k)).find(&p, 0.08));
        assert_eq!(first, Some(Fault::DriveSign));
    }

    /// First fault of an arm at rest, with a torque of 3 N.m at 80 Hz, whose measured angle is `seen` (rad) of time (s)
    /// and actual angle, and whose drive is `lost` in the middle of a stroke; friction brakes with 900 rad/s2.
    fn standing(lost: bool, seen: impl Fn(f64, f64) -> f64) -> Option<Fault> {
        let (mut p, dt, mut watch) = (Parameters::START, Parameters::START.sample_period, Watch::default());
        p.limits.following_error = 1.0;
        let (mut angle, mut velocity, mut before) = (0.0, 0.0f64, 0.0);
        (0..2000).find_map(|k| {
            let time = dt * f64::from(k);
            let torque = 3.0 * (TAU * 80.0 * time).cos();
            let reference = (3.0 - torque) / (p.servo.inertia * (TAU * 80.0).powi(2));
            watch.update(&p, 0.08, &Sample { reference, arm_angle: seen(time, angle), torque, ..REST });
            let free = velocity + dt * before / p.servo.inertia;
            let coasting = velocity.signum() * (velocity.abs() - 900.0 * dt).max(0.0);
            velocity = if lost && time > 0.103 { coasting } else { free };
            angle += dt * velocity;
            before = torque;
            watch.find(&p, 0.08)
        })
    }

    #[test]
    fn a_fast_path_that_leaves_its_limit_names_the_drive_by_the_last_milliseconds() {
        let mut p = Parameters::START;
        for after in [2e-3, 7e-3] {
            let found = [1.0, 0.7, 0.1, -1.0].map(|gain| reversed(&p, gain, after).lagging(&p));
            assert_eq!(found, [Fault::FollowingError, Fault::FollowingError, Fault::WeakDrive, Fault::DriveSign]);
        }
        // where the drive is not watched
        p.limits.drive_gain_ratio = 0.0;
        assert_eq!([0.1, -1.0].map(|gain| reversed(&p, gain, 7e-3).lagging(&p)), [Fault::FollowingError; 2]);
    }

    #[test]
    fn a_torque_does_what_it_was_last_seen_to_do() {
        let p = Parameters::START;
        let answer = |gain: f64, after: f64| reversed(&p, gain, after).answer(&p);
        for k in 15..200 {
            let after = 1e-4 * f64::from(k);
            // where the torque turns, too
            assert_eq!([1.0, 0.6].map(|gain| answer(gain, after)), [1.0; 2], "{after} s");
            assert_eq!([0.0, -0.3].map(|gain| answer(gain, after)), [0.0; 2], "{after} s");
            assert!(answer(-1.0, after) <= 0.0, "{after} s");
        }
        assert_eq!([0.003, 0.007].map(|after| answer(-1.0, after)), [-1.0; 2]);
        // the message shows the smallest ratio
        let reported = reversed(&p, -1.0, 2e-3).minimum_ratio(&p);
        assert!(
            reported < REVERSED && reversed(&p, -1.0, 2e-3).ratio(&p).is_some_and(|ratio| ratio > 0.4),
            "{reported}"
        );
        assert_eq!(Watch::default().minimum_ratio(&p), 1.0);
    }

    #[test]
    fn what_was_seen_of_a_drive_counts_for_ten_milliseconds() {
        let p = Parameters::START;
        // a torque that turns each millisecond, then none
        let answer = |rest: u32| {
            let (dt, mut watch) = (p.sample_period, Watch::default());
            let (mut angle, mut velocity, mut before) = (0.0, 0.0, 0.0);
            for k in 0..200 + rest {
                let torque = if k >= 200 { 0.0 } else { 5.0 * f64::from(1 - 2 * ((k / 10) as i32 % 2)) };
                watch.update(&p, 0.08, &Sample { reference: angle, arm_angle: angle, torque, ..REST });
                angle += dt * velocity + 0.5 * dt * dt * before / p.servo.inertia;
                velocity += dt * before / p.servo.inertia;
                before = torque;
            }
            watch.answer(&p)
        };
        assert_eq!([1, 60, 130].map(answer), [1.0, 1.0, 0.0]);
    }

    #[test]
    fn an_arm_that_its_drive_has_left_comes_to_rest_and_an_encoder_freezes_in_motion() {
        assert_eq!(standing(false, |_, angle| angle), None);
        assert_eq!(standing(true, |_, angle| angle), Some(Fault::WeakDrive));
        let held = std::cell::Cell::new(0.0);
        let frozen = |time: f64, angle: f64| {
            if time < 0.103 {
                held.set(angle);
            }
            held.get()
        };
        assert_eq!(standing(false, frozen), Some(Fault::PositionFrozen));
    }

    #[test]
    fn a_ratio_of_zero_is_a_frozen_position_if_the_angle_does_not_change() {
        let p = Parameters::START;
        for (speed, ratio, fault) in [
            (0.0, 0.05, Fault::PositionFrozen),
            (0.0, -0.05, Fault::PositionFrozen),
            (0.0, 0.15, Fault::WeakDrive),
            (1e-3, 0.05, Fault::WeakDrive),
            (0.0, -0.25, Fault::DriveSign),
        ] {
            let mut watch = Watch::default();
            for k in 0..100 {
                let arm_angle = speed * f64::from(k);
                watch.update(&p, 0.08, &Sample { arm_angle, ..REST });
            }
            assert_eq!(watch.drive_fault(&p, ratio), Some(fault), "{speed} {ratio}");
        }
    }
}
