//! One axis against the model of its loop.
//!
//! The loop makes of reference and compensation the position T (r + c), with T of the nominal drive. What the encoder says
//! beyond that is what nothing explains: at rest nothing, in motion the error of the drive's gain times the lag V/Kp of
//! the bare servo. So the limit is `error_max` + 0.5 V/Kp for drives of 0.7 to 2 times their gain, whether the patterns are
//! learned, foreign or none. A pattern that grows is explained by the model, and found by its error: `error_max` + V/Kp; the
//! error of a bare servo of half its gain is twice V/Kp.
//!
//! A drive has an offset: at rest it stands where the command cancels that, so what is commanded there is not unanswered. What was
//! commanded when the reading last moved while the model stood tells the offset, within what the band of the reading hides. A reading
//! that drifts looks the same; the rest after a run tells either where it is large.
//!
//! A limit that is passed asks for the cause: a reading that stands, a command that swings, the sign and the strength of
//! the answer.

use control_blocks::{Consecutive, Frozen, Response, Reversals};
use serde::{Deserialize, Serialize};

use crate::interface::{Fault, Parameters};
use crate::learning::nominal::{LoopState, Nominal};
use crate::monitoring::finding::{Finding, Numbers};

/// Difference from the model in lags of the bare servo.
const MISMATCH: f64 = 0.5;
/// Error in lags of the bare servo.
const BARE: f64 = 2.0;
/// Error in lags of the bare servo from which a pattern that is learned does harm.
const GROWN: f64 = 1.0;
/// The lag is held at its peak and fades with so many times Kp, in motion and in the rest after it.
///
/// A drive of gain g leaves (1/g - 1)/((1 + s/(g Kp)) (1 + s/Kp)) of the lag, later by both time constants. Where the lag is at
/// most that peak, e^(f Kp t) times what is held, it is at most (1/g - 1)/((1 - f/g)(1 - f)): with f = 0.06 `MISMATCH` at g = 0.7.
const FADING: [f64; 2] = [0.06, 0.5];
/// Samples over which the answer of an axis is compared with its command.
const MEMORY: f64 = 4.0;
/// Counts of motion in a sample from which there is an answer to compare.
const EXCITED: f64 = 20.0;
/// Counts within which a reading stands.
const BAND: f64 = 1.5;
/// Counts in a sample below which the model stands, and for how many times 1/Kp until the axis does, too.
const STANDS: (f64, f64) = (0.1, 4.0);
/// Counts from its place that a reading may be held to have come to rest: the band, half of it in its last step, and rounding.
const HIDDEN: f64 = 3.0;
/// Share of the commanded motion below which a drive is weak.
const WEAK: f64 = 0.7;
/// Share below which it goes the other way.
const OPPOSITE: f64 = -0.2;
/// Share of the command for `error_max` from which a command swings.
const SWING: f64 = 0.1;
/// Reversals of a loop that is not stable, and the longest time between two, samples.
const SWINGS: (u32, u32) = (3, 20);

/// What one axis is watched with.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct AxisMonitor {
    nominal: Nominal,
    model: LoopState,
    /// lag of the bare servo, held at its peak, rad or m
    lag: f64,
    /// the same that fades faster, in the rest after a run
    tail: f64,
    reference: f64,
    before: f64,
    frozen: Frozen,
    /// motion in a sample that the command makes up for at rest, rad or m
    offset: f64,
    /// time for which the model has stood, s
    rest: f64,
    response: Response,
    swing: Reversals,
    swings: u32,
    unexplained: Consecutive,
    far: Consecutive,
    off: Consecutive,
}

/// What one axis does, rad or m.
#[derive(Clone, Copy, Debug)]
pub struct Motion {
    /// Encoder reading.
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

/// What is wrong with an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Verdict {
    /// Nothing.
    Good,
    /// A pattern that is being learned grows.
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
            lag: 0.0,
            tail: 0.0,
            reference: 0.0,
            before: 0.0,
            frozen: Frozen::default(),
            offset: 0.0,
            rest: f64::INFINITY,
            response: Response::default(),
            swing: Reversals::default(),
            swings: 0,
            unexplained: Consecutive::NONE,
            far: Consecutive::NONE,
            off: Consecutive::NONE,
        }
    }

    /// The loop closes at rest at a position (rad or m); `pulse` is that of the encoder.
    pub fn restart(&mut self, position: f64, pulse: f64) {
        let place = position / pulse;
        self.model = LoopState::resting(place.round());
        (self.lag, self.tail, self.offset, self.rest) = (0.0, 0.0, 0.0, f64::INFINITY);
        (self.reference, self.before) = (place.round() * pulse, position);
        (self.frozen, self.response, self.swing, self.swings) =
            (Frozen::default(), Response::default(), Reversals::default(), 0);
        (self.unexplained, self.far, self.off) = (Consecutive::NONE, Consecutive::NONE, Consecutive::NONE);
    }

    /// Position beyond that of the model, rad or m.
    pub fn residual(&self, position: f64, pulse: f64) -> f64 {
        position - self.model.position() * pulse
    }

    /// How far the position may be from the model in the rest after a run, because the drive is slow, rad or m.
    pub fn allowance(&self) -> f64 {
        MISMATCH * self.tail
    }

    /// Takes what was sent: reference and compensation in counts, and the velocity command (rad/s or m/s).
    pub fn command(&mut self, p: &Parameters, axis: usize, reference: f64, compensation: f64, velocity: f64) {
        let (kp, pulse) = (p.servo_gain[axis], p.axis[axis].pulse);
        let stood = self.nominal.step(&mut self.model, reference + compensation);
        let stands = (self.model.position() - stood).abs() < STANDS.0;
        self.rest = if stands { self.rest + p.sample_period } else { 0.0 };
        let moved = (reference * pulse - self.reference).abs();
        self.reference = reference * pulse;
        // turns of the loop in a sample
        let turns = kp * p.model.axis[axis].gain * p.sample_period;
        let lag = moved / turns;
        let [slow, fast] = FADING.map(|fading| (-fading * turns).exp());
        (self.lag, self.tail) = ((self.lag * slow).max(lag), (self.tail * fast).max(lag));
        let limit = SWING * kp * p.limits.axis[axis].error_max;
        self.swings = self.swing.update(velocity, limit, SWINGS.1);
    }

    /// Looks at the axis `axis` (from 0) in a sample in which its loop is closed.
    pub fn look(&mut self, p: &Parameters, axis: usize, motion: &Motion, expected: Expectation) -> Verdict {
        let Motion { position, commanded, error } = *motion;
        let (pulse, limits) = (p.axis[axis].pulse, &p.limits.axis[axis]);
        self.expect(p, axis, position, commanded);
        self.response.update(commanded, position - self.before, MEMORY);
        self.before = position;
        let bridged = p.limits.lost_samples.unsigned_abs();
        let stands = self.frozen.still() > bridged;
        let unanswered = self.frozen.unanswered();
        if stands && unanswered > limits.error_max {
            return self.wrong(axis, Fault::FrozenReading, unanswered, limits.error_max, p);
        }
        let residual = self.residual(position, pulse).abs();
        let most = limits.error_max + MISMATCH * self.lag;
        if self.unexplained.update(residual > most) > bridged {
            return self.wrong(axis, Fault::FollowingError, residual, most, p);
        }
        let lags = if expected == Expectation::Learned { GROWN } else { BARE };
        let most = limits.error_max + lags * self.lag;
        if self.far.update(error.abs() > most) > bridged {
            return match expected {
                Expectation::Learned => Verdict::Grown,
                _ => self.wrong(axis, Fault::FollowingError, error.abs(), most, p),
            };
        }
        let most = limits.pattern_error;
        if self.off.update(expected == Expectation::Compensated && error.abs() > most) > bridged {
            // no drive of another gain is off like this: it is not the pattern
            let explained = residual <= most + MISMATCH * self.lag;
            let consequence = if explained { Fault::PatternMismatch } else { Fault::FollowingError };
            return self.wrong(axis, consequence, error.abs(), most, p);
        }
        Verdict::Good
    }

    /// Takes a reading and the motion that was commanded, less the offset of the drive.
    fn expect(&mut self, p: &Parameters, axis: usize, position: f64, commanded: f64) {
        let (kp, pulse) = (p.servo_gain[axis], p.axis[axis].pulse);
        let hidden = HIDDEN * pulse * kp * p.sample_period;
        let beyond = commanded - self.offset;
        self.frozen.update(position, beyond - beyond.clamp(-hidden, hidden), BAND * pulse);
        if self.frozen.still() == 0 && kp * self.rest > STANDS.1 {
            self.offset = commanded;
        }
    }

    fn wrong(&self, axis: usize, consequence: Fault, value: f64, limit: f64, p: &Parameters) -> Verdict {
        let pulse = p.axis[axis].pulse;
        let share = self.response.share((EXCITED * pulse).powi(2));
        let stands = self.frozen.still() > p.limits.lost_samples.unsigned_abs();
        let fault = if stands && self.frozen.unanswered() > EXCITED * pulse {
            Fault::FrozenReading
        } else if self.swings >= SWINGS.0 {
            Fault::Oscillation
        } else {
            match share {
                Some(share) if share < OPPOSITE => Fault::DriveSign,
                Some(share) if share < WEAK => Fault::WeakDrive,
                _ => consequence,
            }
        };
        Verdict::Wrong(Finding { fault, numbers: Numbers { axis: axis as i32 + 1, value, limit, share } })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Axis 3 on a path of constant speed (m/s): what the monitor says, and after how many samples of it.
    struct Bench {
        p: Parameters,
        monitor: AxisMonitor,
        drive: LoopState,
        nominal: Nominal,
        sent: control_blocks::SentCommands,
        reference: f64,
        position: f64,
    }

    impl Bench {
        fn new() -> Self {
            let p = Parameters::START;
            let (mut monitor, nominal) = (AxisMonitor::new(&p, 2), Nominal::new(&p, 2));
            monitor.restart(0.0, p.axis[2].pulse);
            let sent = control_blocks::SentCommands::default();
            Self { p, monitor, drive: LoopState::default(), nominal, sent, reference: 0.0, position: 0.0 }
        }

        /// One sample; `bends` makes of commanded motion and position (counts) what the machine does and what is read.
        fn step(&mut self, speed: f64, expected: Expectation, bends: impl Fn(f64, f64) -> (f64, f64)) -> Verdict {
            let pulse = self.p.axis[2].pulse;
            let commanded = self.sent.before(1) * self.p.sample_period;
            let (moved, seen) = bends(commanded / pulse, self.position);
            // the drive follows its command at once
            self.position += moved;
            let read = seen + moved;
            let error = self.reference - read;
            let motion = Motion { position: read.floor() * pulse, commanded, error: error * pulse };
            let verdict = self.monitor.look(&self.p, 2, &motion, expected);
            self.reference += speed * self.p.sample_period / pulse;
            let velocity = 13.0 * pulse * (self.reference - read);
            self.sent.send(velocity);
            self.nominal.step(&mut self.drive, self.reference);
            self.monitor.command(&self.p, 2, self.reference.round(), 0.0, velocity);
            verdict
        }

        fn faulted(&mut self, bends: impl Fn(f64, f64) -> (f64, f64)) -> Option<(usize, Finding)> {
            for _ in 0..150 {
                assert_eq!(self.step(0.1, Expectation::Bare, |moved, at| (moved, at)), Verdict::Good);
            }
            (0..300).find_map(|k| match self.step(0.1, Expectation::Bare, &bends) {
                Verdict::Wrong(finding) => Some((k, finding)),
                _ => None,
            })
        }
    }

    #[test]
    fn a_good_axis_is_good_at_any_speed_and_when_it_stops() {
        let mut bench = Bench::new();
        for speed in [0.0, 0.02, 0.5, -0.5, 0.1, 0.0] {
            for _ in 0..100 {
                assert_eq!(bench.step(speed, Expectation::Bare, |moved, at| (moved, at)), Verdict::Good);
            }
        }
    }

    #[test]
    fn drives_within_a_fifth_of_their_gain_are_good() {
        for gain in [0.8, 1.2] {
            assert_eq!(Bench::new().faulted(|moved, at| (gain * moved, at)), None);
        }
    }

    #[test]
    fn a_drive_of_seven_tenths_of_its_gain_is_good_in_a_quick_motion_and_after_it() {
        for gain in [0.7, 2.0] {
            let mut bench = Bench::new();
            for k in 0..300 {
                // 0.22 m in 1.5 s, as to the start of the path, and rest
                let share = (f64::from(k) / 150.0).min(1.0);
                let speed = 0.22 / 1.5 * 30.0 * (share * (1.0 - share)).powi(2);
                let verdict = bench.step(speed, Expectation::Bare, |moved, at| (gain * moved, at));
                assert_eq!(verdict, Verdict::Good, "{gain}, sample {k}");
            }
        }
    }

    #[test]
    fn the_cause_is_named_before_the_consequence() {
        let (k, finding) = Bench::new().faulted(|moved, at| (-moved, at)).unwrap();
        assert_eq!((finding.fault, finding.numbers.axis), (Fault::DriveSign, 3));
        assert!(k < 20, "{k}: {finding:?}");
        let (_, finding) = Bench::new().faulted(|moved, at| (0.3 * moved, at)).unwrap();
        assert_eq!(finding.fault, Fault::WeakDrive);
        assert!((finding.numbers.share.unwrap() - 0.3).abs() < 0.05, "{finding:?}");
        let (k, finding) = Bench::new().faulted(|_, at| (0.0, at)).unwrap();
        assert_eq!(finding.fault, Fault::FrozenReading);
        assert!(k < 8, "{k}: {finding:?}");
    }

    #[test]
    fn what_the_commands_do_not_explain_is_a_following_error() {
        // something pushes with 60 mm/s against the motion
        let (_, finding) = Bench::new().faulted(|moved, at| (moved - 240.0, at)).unwrap();
        assert!(finding.numbers.value > finding.numbers.limit, "{finding:?}");
        assert!(matches!(finding.fault, Fault::FollowingError | Fault::WeakDrive), "{finding:?}");
    }

    #[test]
    fn a_drive_with_an_offset_stands_where_its_command_cancels_it() {
        // 1 and 2 mm/s of 1 m/s, for a minute after a motion
        for offset in [2.0, -2.0, 4.0] {
            let mut bench = Bench::new();
            for k in 0..6000 {
                let speed = if (200..400).contains(&k) { 0.02 } else { 0.0 };
                let verdict = bench.step(speed, Expectation::Bare, |moved, at| (moved + offset, at));
                assert_eq!(verdict, Verdict::Good, "{offset}, sample {k}");
            }
            // and its encoder freezes still
            let said = (0..100).map(|_| bench.step(0.02, Expectation::Bare, |_, at| (0.0, at)));
            let Some(Verdict::Wrong(finding)) = said.into_iter().find(|said| *said != Verdict::Good) else { panic!() };
            assert_eq!(finding.fault, Fault::FrozenReading);
        }
    }

    #[test]
    fn a_reading_that_freezes_just_before_the_rest_is_told_before_the_axis_has_crept_a_millimetre() {
        // 0.5 to 0.05 mm are left
        for left in [100.0, 50.0, 10.0] {
            let mut bench = Bench::new();
            for _ in 0..50 {
                bench.step(0.0, Expectation::Bare, |moved, at| (moved, at));
            }
            bench.reference += left;
            let mut crept = 0.0;
            let said = (0..4000).map(|_| {
                crept += bench.sent.before(1) * bench.p.sample_period;
                bench.step(0.0, Expectation::Bare, |_, at| (0.0, at))
            });
            let Some(Verdict::Wrong(finding)) = said.into_iter().find(|said| *said != Verdict::Good) else {
                panic!("{left}")
            };
            assert_eq!(finding.fault, Fault::FrozenReading);
            assert!(crept < 1.6e-3, "{left}: {crept}");
        }
    }

    #[test]
    fn what_no_gain_explains_is_not_the_pattern() {
        let mut bench = Bench::new();
        for _ in 0..50 {
            assert_eq!(bench.step(0.0, Expectation::Compensated, |moved, at| (moved, at)), Verdict::Good);
        }
        // pushed by 10 mm/s at rest: 0.77 mm, more than a pattern leaves and less than `error_max`
        let said = (0..200).map(|_| bench.step(0.0, Expectation::Compensated, |moved, at| (moved + 20.0, at)));
        let Some(Verdict::Wrong(finding)) = said.into_iter().find(|said| *said != Verdict::Good) else { panic!() };
        // retracting would move an axis that is not under control
        assert_eq!(finding.fault.safe_end(), control_blocks::SafeEnd::DriveOff, "{finding:?}");
    }

    #[test]
    fn only_what_should_be_compensated_has_the_narrow_limit() {
        let run = |expected| {
            let mut bench = Bench::new();
            (0..100).map(|_| bench.step(0.05, expected, |moved, at| (moved, at))).find(|said| *said != Verdict::Good)
        };
        assert_eq!(run(Expectation::Bare), None);
        let Some(Verdict::Wrong(finding)) = run(Expectation::Compensated) else { panic!("nothing was found") };
        assert_eq!((finding.fault, finding.numbers.limit), (Fault::PatternMismatch, 5e-4));
    }

    /// Samples in a row with a motion until something is said, and what; counted from 1.
    fn said(expected: Expectation, motion: Motion) -> Option<(usize, Verdict)> {
        let p = Parameters::START;
        let mut monitor = AxisMonitor::new(&p, 2);
        monitor.restart(0.0, p.axis[2].pulse);
        (1..20).map(|k| (k, monitor.look(&p, 2, &motion, expected))).find(|(_, verdict)| *verdict != Verdict::Good)
    }

    #[test]
    fn what_is_wrong_for_the_samples_that_are_bridged_and_one_more_is_told() {
        let [bare, learned, compensated] = [Expectation::Bare, Expectation::Learned, Expectation::Compensated];
        let motion = |position: f64, error: f64| Motion { position, commanded: 0.0, error };
        for (expected, motion) in [
            (bare, motion(1.1e-3, 0.0)),
            (bare, motion(-1.1e-3, 0.0)),
            (bare, motion(0.0, 1.1e-3)),
            (learned, motion(0.0, -1.1e-3)),
            (compensated, motion(0.0, 5.1e-4)),
            (compensated, motion(0.0, -5.1e-4)),
        ] {
            assert_eq!(said(expected, motion).map(|said| said.0), Some(4), "{expected:?} {motion:?}");
        }
        for (expected, motion) in [
            (bare, motion(9.9e-4, 9.9e-4)),
            (learned, motion(-9.9e-4, -9.9e-4)),
            (compensated, motion(9.9e-4, 4.9e-4)),
            // the limit itself is good
            (compensated, motion(0.0, 5e-4)),
            (bare, motion(0.0, 1e-3)),
        ] {
            assert_eq!(said(expected, motion), None, "{expected:?} {motion:?}");
        }
    }

    #[test]
    fn the_consequence_says_what_the_error_is_of() {
        let fault =
            |expected, position: f64, error: f64| match said(expected, Motion { position, commanded: 0.0, error })
                .unwrap()
                .1
            {
                Verdict::Wrong(finding) => (finding.fault, finding.numbers.value, finding.numbers.limit),
                verdict => panic!("{verdict:?}"),
            };
        assert_eq!(fault(Expectation::Bare, 1.5e-3, 0.0), (Fault::FollowingError, 1.5e-3, 1e-3));
        assert_eq!(fault(Expectation::Bare, 0.0, -1.5e-3), (Fault::FollowingError, 1.5e-3, 1e-3));
        assert_eq!(fault(Expectation::Compensated, 4e-4, 6e-4), (Fault::PatternMismatch, 6e-4, 5e-4));
        assert_eq!(fault(Expectation::Compensated, -6e-4, 6e-4), (Fault::FollowingError, 6e-4, 5e-4));
        let grown = said(Expectation::Learned, Motion { position: 0.0, commanded: 0.0, error: 1.1e-3 });
        assert_eq!(grown.unwrap().1, Verdict::Grown);
    }

    #[test]
    fn the_lag_of_the_bare_servo_widens_the_limits_and_fades() {
        let p = Parameters::START;
        let (kp, pulse) = (p.servo_gain[2], p.axis[2].pulse);
        let mut monitor = AxisMonitor::new(&p, 2);
        monitor.restart(0.0, pulse);
        // 0.1 m/s for a sample, back at once, and then rest: a lag of V/Kp
        monitor.command(&p, 2, 200.0, 0.0, 0.0);
        let lag = 0.1 / kp;
        assert!((monitor.lag - lag).abs() < 1e-12 && (monitor.allowance() - 0.5 * lag).abs() < 1e-12);
        monitor.command(&p, 2, 200.0, 0.0, 0.0);
        let faded = |share: f64| lag * (-share * kp * p.sample_period).exp();
        assert!((monitor.lag - faded(0.06)).abs() < 1e-12);
        assert!((monitor.allowance() - 0.5 * faded(0.5)).abs() < 1e-12);
        assert_eq!(monitor.residual(0.3, pulse), 0.3 - monitor.model.position() * pulse);
    }

    #[test]
    fn a_compensation_moves_the_model_as_the_reference_does() {
        let p = Parameters::START;
        let mut monitor = AxisMonitor::new(&p, 2);
        monitor.restart(0.0, p.axis[2].pulse);
        (0..300).for_each(|_| monitor.command(&p, 2, 100.0, 40.0, 0.0));
        assert!((monitor.model.position() - 140.0).abs() < 1e-6);
    }
}
