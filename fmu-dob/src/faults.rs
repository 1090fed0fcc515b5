//! Every fault is found here, the gravest first; how it ends; and the numbers that are told with it.

use control_blocks::{SafeEnd, bearable_delays, ticks};

use crate::check::check_derived;
use crate::commission::plan;
use crate::commission::response::loop_spread;
use crate::commission::values::{self, Values, acceptable};
use crate::interface::{Fault, Output, Parameters, ThresholdOutput, Vars};
use crate::monitoring::numbers::{LateContact, Unseen};
use crate::motion::stability::longest_delay;
use crate::motion::travel::{job_limit, learn_limit};
use crate::reading::{Loss, Reading};

/// Share of the commanded force below which the drive pushes the wrong way.
const WRONG_WAY: f64 = -0.2;
/// Samples in a row that make a disturbance or a following error.
const ROW: u32 = 3;
/// Least limit of the following error (m), and how many times the error of the hardest acceleration it is.
const FOLLOWING: (f64, f64) = (20e-6, 3.0);
/// Changes in a row from one side to the other that make an oscillation.
const REVERSALS: u32 = 6;

impl Fault {
    /// How a job ends that this fault has stopped.
    ///
    /// With a position that cannot be believed, or a stage that does not do what the current says, no controlled end is
    /// known to be safe.
    pub fn safe_end(self) -> SafeEnd {
        match self {
            Self::None
            | Self::TravelLimit
            | Self::LostSpindle
            | Self::SpindleJump
            | Self::LearnRejected
            | Self::LearnTimeout
            | Self::NoProgress => SafeEnd::Retract,
            // it has retracted already, or never came near
            Self::ContactRejected | Self::LateContact | Self::CommissionRejected => SafeEnd::Stop,
            Self::LostReading
            | Self::FrozenReading
            | Self::ReadingJump
            | Self::FollowingError
            | Self::Saturation
            | Self::Overload
            | Self::DriveSign
            | Self::WeakDrive
            | Self::Oscillation
            | Self::LongStep => SafeEnd::DriveOff,
        }
    }
}

/// What faults are found in.
#[derive(Clone, Copy)]
pub struct Symptoms<'a> {
    /// The inputs of this sample.
    pub reading: &'a Reading,
    /// The communication step is longer than a sample.
    pub long_step: bool,
    /// The reading has lived at rest and now stands.
    pub standing: bool,
    /// The spindle must be steady.
    pub steady_spindle: bool,
    /// Samples in a row with the current at its limit.
    pub limited: u32,
    /// Changes in a row from one limit of the current to the other.
    pub reversals: u32,
    /// Changes in a row of the inertial force from one side to the other while the reference does not accelerate.
    pub swings: u32,
    /// Samples in a row with a following error beyond its limit.
    pub astray: u32,
    /// Samples in a row with a disturbance beyond its limit.
    pub overloaded: u32,
    /// Share of the commanded force that accelerates the stage, where it is known.
    pub share: Option<f64>,
    /// The drive is to be judged by that share now.
    pub judged: bool,
    /// The approach, stopped now, would end beyond its longest travel.
    pub travelled: bool,
    /// What has just been learned.
    pub learned: Option<ThresholdOutput>,
    /// Learning takes too long.
    pub learning: bool,
    /// Change of the force from before the contact to behind the retract, N.
    pub force_left: Option<f64>,
    /// Not the detector but the force guard has found the contact.
    pub guarded: bool,
    /// What the commission has measured cannot be used.
    pub rejected: bool,
    /// The job or the commission takes too long.
    pub late: bool,
}

/// The gravest fault of this sample.
pub fn find(p: &Parameters, symptoms: &Symptoms) -> Option<Fault> {
    let s = symptoms;
    let beyond = |samples: u32| samples > p.limits.lost_samples.unsigned_abs();
    let lost = |loss| beyond(s.reading.lost) && s.reading.loss == loss;
    let weak = s.judged && s.share.is_some_and(|share| share < p.limits.drive_share);
    let learned = |learned: ThresholdOutput| !learned.plausible(p.limits.slope_sigma_max);
    let faults = [
        (Fault::LongStep, s.long_step),
        (Fault::FrozenReading, s.standing || lost(Loss::Stands)),
        (Fault::ReadingJump, lost(Loss::Jumps)),
        (Fault::LostReading, lost(Loss::Told)),
        (Fault::Oscillation, s.reversals.max(s.swings) >= REVERSALS),
        (Fault::Saturation, s.limited > ticks(p.limits.saturated_time, p.sample_period)),
        (Fault::FollowingError, s.astray >= ROW),
        (Fault::Overload, s.overloaded >= ROW),
        (Fault::WeakDrive, weak),
        (Fault::LostSpindle, beyond(s.reading.invalid)),
        (Fault::SpindleJump, s.steady_spindle && beyond(s.reading.spindle_lost)),
        (Fault::TravelLimit, s.travelled),
        (Fault::LearnRejected, s.learned.is_some_and(learned)),
        (Fault::LearnTimeout, s.learning),
        (Fault::ContactRejected, s.force_left.is_some_and(|force| force.abs() > p.limits.force_left)),
        (Fault::LateContact, s.guarded),
        (Fault::CommissionRejected, s.rejected),
        (Fault::NoProgress, s.late),
    ];
    let found = faults.into_iter().find_map(|(fault, found)| found.then_some(fault));
    found.map(|fault| cause(p, fault, s.share))
}

/// The cause of a fault: a stage that does not follow, or goes where it cannot be, may have a drive that pushes the wrong
/// way; one that only does not follow may have a drive that hardly pushes.
fn cause(p: &Parameters, fault: Fault, share: Option<f64>) -> Fault {
    use Fault::{FollowingError, Oscillation, Overload, ReadingJump, Saturation, WeakDrive};
    let Some(share) = share else { return fault };
    match fault {
        Oscillation | Saturation | FollowingError | Overload | WeakDrive | ReadingJump if share < WRONG_WAY => {
            Fault::DriveSign
        }
        Saturation | FollowingError | Overload if share < p.limits.drive_share => WeakDrive,
        _ => fault,
    }
}

/// The numbers behind the fault, for the log.
pub fn numbers(vars: &Vars) -> String {
    let (p, output) = (&vars.in_force, &vars.output);
    let row = format!("for more than `limits.lost_samples` = `{}`", p.limits.lost_samples);
    let error = format!(
        "tracking error `{} m`, disturbance `{} N`, share of the commanded force `{}`",
        output.tracking_error, output.force.disturbance, output.drive_share
    );
    match output.fault {
        Fault::None => String::new(),
        Fault::TravelLimit => format!(": `{} m`", p.approach.travel_max),
        Fault::LostReading => format!(": `{} m` {row}", vars.input.position),
        Fault::FrozenReading => format!(
            ": `{} m`, more than `limits.frozen` = `{} m` unanswered {row}, or equal for `limits.rest_time` = `{} s`",
            vars.input.position, p.limits.frozen, p.limits.rest_time
        ),
        Fault::ReadingJump => {
            format!(": `{} m` is beyond `limits.jump` = `{} m` {row}", vars.input.position, p.limits.jump)
        }
        Fault::SpindleJump => format!(
            ": `{} rad/s`, faster than `limits.spindle_acceleration` = `{} rad/s2` {row}",
            vars.input.spindle_speed, p.limits.spindle_acceleration
        ),
        Fault::FollowingError => format!(": {error}, limit of the distance `{} m`", output.numbers.following_limit),
        Fault::Saturation => {
            format!(": longer than `limits.saturated_time` = `{} s`; {error}", p.limits.saturated_time)
        }
        Fault::Overload => format!(": {error}, limit of the disturbance `{} N`", disturbance_limit(p)),
        Fault::DriveSign => format!(": {error}"),
        Fault::WeakDrive => format!(": {error}, least `limits.drive_share` = `{}`", p.limits.drive_share),
        Fault::Oscillation if output.numbers.swings >= REVERSALS => format!(
            ": `{REVERSALS}` swings beyond `guard.force` = `{} N` while the reference does not accelerate; {error}",
            p.guard_force
        ),
        Fault::Oscillation => {
            format!(": `{REVERSALS}` changes from limit to limit of `stage.current_max` = `{} A`", p.stage.current_max)
        }
        Fault::LearnRejected => format!(
            ": mean `{} N/s`, sigma `{} N/s`, limit `limits.slope_sigma_max` = `{} N/s`",
            output.threshold.mean, output.threshold.sigma, p.limits.slope_sigma_max
        ),
        Fault::LearnTimeout => format!(": `{} s`", learn_limit(p)),
        Fault::ContactRejected => {
            format!(
                ": `{} N` are left, limit `limits.force_left` = `{} N`",
                output.numbers.force_left, p.limits.force_left
            )
        }
        Fault::LateContact => late_contact(p, output.numbers.late),
        Fault::NoProgress => {
            format!(": limit of the job `{} s`, of the commission `{} s`", job_limit(p, &p.approach), plan::time(p))
        }
        Fault::CommissionRejected => rejected(p, output),
        Fault::LongStep => format!(": limit `{} s`", p.sample_period),
        Fault::LostSpindle => format!(": `{} rad/s` {row}", vars.input.spindle_speed),
    }
}

fn late_contact(p: &Parameters, contact: Option<LateContact>) -> String {
    let Some(LateContact { position, force, unseen }) = contact else { return String::new() };
    let (limit, detector) = (p.guard_force, p.detector);
    let why = match unseen {
        Unseen::Unarmed => format!("before the detector `{detector:?}` was armed"),
        Unseen::Doubted => format!("after readings that the detector `{detector:?}` could not count in full"),
        Unseen::Missed => format!("which the armed detector `{detector:?}` had missed"),
    };
    format!(": at `{position:.7} m`, `{force:.3} N` of `guard.force` = `{limit} N`, {why}")
}

/// Largest distance (m) from the reference, besides what the stage is late: `limits.following_error`, or three times what the
/// late velocity makes of the hardest acceleration.
pub fn following_limit(p: &Parameters) -> f64 {
    if p.limits.following_error > 0.0 {
        return p.limits.following_error;
    }
    let braking = 2.0 * p.servo.damping * hardest(p) / (p.servo.bandwidth * p.observer.velocity_bandwidth);
    f64::max(FOLLOWING.0, FOLLOWING.1 * braking)
}

/// Hardest acceleration of a job, m/s2.
fn hardest(p: &Parameters) -> f64 {
    p.retract.deceleration.max(p.approach.acceleration)
}

/// Largest disturbance (N): `limits.disturbance`, or the larger of half the force of the drive and of `guard.force` with
/// the force of the hardest acceleration.
pub fn disturbance_limit(p: &Parameters) -> f64 {
    if p.limits.disturbance > 0.0 {
        return p.limits.disturbance;
    }
    f64::max(0.5 * p.stage.force_constant * p.stage.current_max, p.guard_force + p.stage.mass * hardest(p))
}

/// What cannot be used of a commission, after which what was told is in force.
fn rejected(p: &Parameters, output: &Output) -> String {
    let (told, m) = (Values::of(p), &output.measured);
    let longest = longest_delay(p, *bearable_delays(p.io_delay).end() as usize);
    let constants = [output.numbers.force_constant, p.stage.force_constant];
    let noise = m.slope_sigma > 0.0;
    let good = if noise {
        told.quiet(p, m)
    } else {
        constants.into_iter().all(|constant| acceptable(p, constant, longest, m))
    };
    if good {
        let mut found = p.clone();
        let derived = if noise { told.derived(p, m) } else { told.with_response(m) };
        derived.put(&mut found);
        if let Err(error) = check_derived(&found) {
            return format!(": {}", error.of_derived());
        }
    }
    if noise {
        return format!(
            ": noise of the slope `{} N/s`, limit `limits.slope_sigma_max` = `{} N/s` as told; force that noise and cogging ask of \
             the guard `{} N`, limit three times `guard.force` = `{} N` as told",
            m.slope_sigma,
            p.limits.slope_sigma_max,
            values::guard(p, m),
            p.guard_force
        );
    }
    format!(
        ": thrust constant `{} N/A`, deviation `{} N/A`, limits half and twice `stage.force_constant`, `{} N/A` as told and `{} N/A` in \
         force, and `commission.deviation_max` = `{}` of it; delay `{}` samples, deviation `{}`, limits `0` to `{longest}`, with which \
         the loop is stable, and `commission.delay_deviation_max` = `{}` beside `{}` of the current loop",
        m.force_constant,
        m.force_constant_deviation,
        p.stage.force_constant,
        output.numbers.force_constant,
        p.commission.deviation_max,
        m.io_delay,
        m.io_delay_deviation,
        p.commission.delay_deviation_max,
        loop_spread(p)
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOOD: Reading = Reading {
        position: Some(0.0),
        spindle_speed: 0.0,
        enabled: true,
        begin: false,
        commission: false,
        begin_commission: false,
        reset: false,
        found: false,
        invalid: 0,
        lost: 0,
        loss: Loss::Told,
        alive: true,
        whole: 0,
        spindle_lost: 0,
    };
    const LOST: Reading = Reading { position: None, lost: 100, ..GOOD };
    const NOISE: ThresholdOutput = ThresholdOutput { sigma: 1.0, ..ThresholdOutput::START };

    fn symptoms(reading: &Reading) -> Symptoms<'_> {
        Symptoms {
            reading,
            long_step: false,
            standing: false,
            steady_spindle: true,
            limited: 0,
            reversals: 0,
            swings: 0,
            astray: 0,
            overloaded: 0,
            share: Some(1.0),
            judged: true,
            travelled: false,
            learned: Some(NOISE),
            learning: false,
            force_left: Some(0.0),
            guarded: false,
            rejected: false,
            late: false,
        }
    }

    #[test]
    fn each_limit_is_the_last_value_without_a_fault() {
        let mut p = Parameters::START;
        (p.limits.lost_samples, p.limits.saturated_time, p.limits.slope_sigma_max) = (7, 9e-4, 1.0);
        (p.limits.drive_share, p.limits.force_left) = (0.4, 0.3);
        type Set = fn(&mut Reading, &mut Symptoms, f64);
        let found = |set: Set, value: f64| {
            let (mut reading, mut all) = (GOOD, symptoms(&GOOD));
            set(&mut reading, &mut all, value);
            find(&p, &Symptoms { reading: &reading, ..all })
        };
        let limits: [(Set, f64, f64, Fault); 16] = [
            (|r, _, x| r.lost = x as u32, 7.0, 8.0, Fault::LostReading),
            (|r, _, x| (r.lost, r.loss) = (x as u32, Loss::Jumps), 7.0, 8.0, Fault::ReadingJump),
            (|r, _, x| (r.lost, r.loss) = (x as u32, Loss::Stands), 7.0, 8.0, Fault::FrozenReading),
            (|r, _, x| r.spindle_lost = x as u32, 7.0, 8.0, Fault::SpindleJump),
            (|r, _, x| r.invalid = x as u32, 7.0, 8.0, Fault::LostSpindle),
            (|_, s, x| s.limited = x as u32, 9.0, 10.0, Fault::Saturation),
            (|_, s, x| s.reversals = x as u32, 5.0, 6.0, Fault::Oscillation),
            (|_, s, x| s.swings = x as u32, 5.0, 6.0, Fault::Oscillation),
            (|_, s, x| s.astray = x as u32, 2.0, 3.0, Fault::FollowingError),
            (|_, s, x| s.overloaded = x as u32, 2.0, 3.0, Fault::Overload),
            (|_, s, x| s.share = Some(x), 0.4, 0.39, Fault::WeakDrive),
            (|_, s, x| s.share = Some(x), 0.4, -0.21, Fault::DriveSign),
            (|_, s, x| s.force_left = Some(x), -0.3, -0.31, Fault::ContactRejected),
            (|_, s, x| s.guarded = x > 0.5, 0.0, 1.0, Fault::LateContact),
            (|_, s, x| s.rejected = x > 0.5, 0.0, 1.0, Fault::CommissionRejected),
            (|_, s, x| s.learned = Some(ThresholdOutput { sigma: x, ..NOISE }), 1.0, 1.1, Fault::LearnRejected),
        ];
        for (set, last, first, fault) in limits {
            assert_eq!((found(set, last), found(set, first)), (None, Some(fault)));
        }
    }

    #[test]
    fn the_share_of_the_commanded_force_names_the_cause() {
        let p = Parameters::START;
        let named = |share, judged| {
            let all = Symptoms { share, judged, astray: 3, ..symptoms(&GOOD) };
            find(&p, &all)
        };
        assert_eq!(named(Some(1.0), false), Some(Fault::FollowingError));
        assert_eq!(named(None, false), Some(Fault::FollowingError));
        assert_eq!(named(Some(0.5), false), Some(Fault::FollowingError));
        assert_eq!(named(Some(0.3), false), Some(Fault::WeakDrive));
        assert_eq!(named(Some(-0.2), false), Some(Fault::WeakDrive));
        assert_eq!(named(Some(-0.9), false), Some(Fault::DriveSign));
        // a share alone is no fault until it is to be judged
        let share = |judged| find(&p, &Symptoms { share: Some(0.1), judged, ..symptoms(&GOOD) });
        assert_eq!((share(false), share(true)), (None, Some(Fault::WeakDrive)));
        // where the drive takes it the wrong way, the position cannot be believed either
        let jumps = Reading { position: None, lost: 9, loss: Loss::Jumps, ..GOOD };
        let jump = |share| find(&p, &Symptoms { share: Some(share), judged: false, ..symptoms(&jumps) });
        assert_eq!((jump(0.1), jump(-0.3)), (Some(Fault::ReadingJump), Some(Fault::DriveSign)));
        // a loop that swings has a drive that answers
        let swings = |share| find(&p, &Symptoms { share: Some(share), judged: false, reversals: 9, ..symptoms(&GOOD) });
        assert_eq!((swings(0.3), swings(-0.3)), (Some(Fault::Oscillation), Some(Fault::DriveSign)));
    }

    #[test]
    fn the_gravest_fault_is_named() {
        let p = Parameters::START;
        let reading = Reading { loss: Loss::Stands, spindle_lost: 100, ..LOST };
        let all = Symptoms {
            standing: false,
            limited: 100,
            reversals: 9,
            astray: 9,
            overloaded: 9,
            travelled: true,
            learned: Some(ThresholdOutput::START),
            learning: true,
            force_left: Some(9.0),
            guarded: true,
            late: true,
            ..symptoms(&reading)
        };
        assert_eq!(find(&p, &Symptoms { long_step: true, ..all }), Some(Fault::LongStep));
        assert_eq!(find(&p, &all), Some(Fault::FrozenReading));
        assert_eq!(find(&p, &Symptoms { reading: &GOOD, ..all }), Some(Fault::Oscillation));
        let nonsense = Reading { invalid: 4, spindle_lost: 4, ..GOOD };
        assert_eq!(find(&p, &symptoms(&nonsense)), Some(Fault::LostSpindle));
        assert_eq!(find(&p, &symptoms(&Reading { invalid: 4, ..LOST })), Some(Fault::LostReading));
        assert_eq!(
            find(&p, &Symptoms { reading: &GOOD, late: true, travelled: true, ..symptoms(&GOOD) }),
            Some(Fault::TravelLimit)
        );
    }

    #[test]
    fn the_drive_goes_off_where_the_position_or_the_drive_cannot_be_trusted() {
        let ends = |end: SafeEnd| Fault::ALL.iter().filter(move |fault| fault.safe_end() == end).count();
        assert_eq!([SafeEnd::Retract, SafeEnd::Stop, SafeEnd::DriveOff].map(ends), [7, 3, 10]);
        assert_eq!(Fault::FrozenReading.safe_end(), SafeEnd::DriveOff);
        assert_eq!(Fault::TravelLimit.safe_end(), SafeEnd::Retract);
    }

    #[test]
    fn every_fault_tells_its_numbers() {
        for &fault in Fault::ALL {
            let mut vars = <Vars as fmi2_export::Interface>::START;
            vars.output.fault = fault;
            vars.output.numbers.late = Some(LateContact { position: 0.0, force: 0.0, unseen: Unseen::Missed });
            assert_eq!(numbers(&vars).is_empty(), fault == Fault::None, "{fault:?}");
        }
    }

    #[test]
    fn a_late_contact_tells_place_force_and_why_the_detector_was_silent() {
        let mut vars = <Vars as fmi2_export::Interface>::START;
        vars.output.fault = Fault::LateContact;
        for (unseen, why) in [
            (Unseen::Unarmed, "before the detector `SlopePaper` was armed"),
            (Unseen::Doubted, "after readings that the detector `SlopePaper` could not count in full"),
            (Unseen::Missed, "which the armed detector `SlopePaper` had missed"),
        ] {
            vars.output.numbers.late = Some(LateContact { position: 5.12e-5, force: 0.4321, unseen });
            let expected = format!(": at `0.0000512 m`, `0.432 N` of `guard.force` = `0.4 N`, {why}");
            let detector = format!("{:?}", vars.in_force.detector);
            assert_eq!(numbers(&vars), expected.replace("SlopePaper", &detector));
        }
        (vars.output.fault, vars.output.numbers.force_left) = (Fault::ContactRejected, 0.31);
        assert!(numbers(&vars).starts_with(": `0.31 N` are left"), "{}", numbers(&vars));
    }

    #[test]
    fn a_rejected_commission_tells_the_noise_once_that_was_measured_and_the_response_before() {
        let mut vars = <Vars as fmi2_export::Interface>::START;
        vars.output.fault = Fault::CommissionRejected;
        assert!(numbers(&vars).starts_with(": thrust constant `0 N/A`"), "{}", numbers(&vars));
        vars.output.measured.slope_sigma = 7.5;
        assert!(numbers(&vars).starts_with(": noise of the slope `7.5 N/s`"), "{}", numbers(&vars));
    }

    #[test]
    fn a_rejected_commission_tells_what_was_told_and_what_the_parameters_do_not_bear() {
        let mut vars = <Vars as fmi2_export::Interface>::START;
        vars.output.fault = Fault::CommissionRejected;
        vars.output.numbers.force_constant = 25.0;
        let told = numbers(&vars);
        assert!(
            told.contains("`20 N/A` as told and `25 N/A` in force") && told.contains("limits `0` to `3`"),
            "{told}"
        );
        let m = &mut vars.output.measured;
        (m.force_constant, m.io_delay) = (16.0, 1.0);
        vars.in_force.commission.force = 0.9 * 20.0 * vars.in_force.stage.current_max;
        let told = numbers(&vars);
        assert!(told.contains("do not fit: parameter `commission.force` would be"), "{told}");
        vars.output.measured.slope_sigma = 9.0;
        assert!(numbers(&vars).contains("`limits.slope_sigma_max` = `5 N/s` as told"), "{}", numbers(&vars));
    }

    #[test]
    fn a_slow_servo_and_a_hard_braking_may_be_farther_from_the_reference() {
        let near = |p: &Parameters, expected: f64| assert!((following_limit(p) / expected - 1.0).abs() < 1e-9);
        let mut p = Parameters::START;
        near(&p, 3.0 * 2.0 * 2.0 / (188.0 * 3142.0));
        p.servo.bandwidth = 50.0;
        near(&p, 3.0 * 2.0 * 2.0 / (50.0 * 3142.0));
        p.retract.deceleration = 0.2;
        near(&p, 20e-6);
        p.limits.following_error = 7e-6;
        near(&p, 7e-6);
    }

    #[test]
    fn the_disturbance_of_a_machine_is_half_its_drive_or_what_its_motion_needs() {
        let mut p = Parameters::START;
        assert_eq!(disturbance_limit(&p), 50.0);
        p.retract.deceleration = 20.0;
        assert_eq!(disturbance_limit(&p), 200.4);
        p.limits.disturbance = 7.0;
        assert_eq!(disturbance_limit(&p), 7.0);
    }
}
