//! The numbers that are told with a fault.

use control_blocks::{SIGNIFICANT, bearable_delays};

use crate::check::check_derived;
use crate::commission::response::loop_spread;
use crate::commission::values::{self, Values, acceptable};
use crate::faults::REVERSALS;
use crate::interface::{Fault, Output, Parameters, Vars};
use crate::limits::{bend_limit, disturbance_limit};
use crate::monitoring::numbers::{LateContact, Unseen};
use crate::monitoring::rest::ROW;
use crate::motion::stability::longest_delay;
use crate::motion::travel::{learn_limit, teaching_travel};
use crate::teaching::lesson::RATIO;

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
            ": `{} m`, more than `limits.frozen` = `{} m` unanswered {row}, or equal for `limits.rest_time` = `{} s` and `{ROW}` samples",
            vars.input.position, p.limits.frozen, p.limits.rest_time
        ),
        Fault::LateReading => {
            format!(": `{} m` was read `{}` samples before, {row}", vars.input.position, output.numbers.late_by)
        }
        Fault::ReadingJump if output.numbers.bend > 0.0 => format!(
            ": second differences of `{:.3e} m`, limit `{:.3e} m`, what `{} N` and the drive make of a sample; {error}",
            output.numbers.bend,
            bend_limit(p),
            disturbance_limit(p)
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
            format!(": `{:.4} s`, limit `{:.4} s`", output.numbers.lasted, output.numbers.time_limit)
        }
        Fault::CommissionRejected => rejected(p, output),
        Fault::TeachingRejected => mistaught(p, output),
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

/// What cannot be used of a teaching.
fn mistaught(p: &Parameters, output: &Output) -> String {
    let (taught, [least, most], travel) = (&output.taught, output.numbers.biases, teaching_travel(p));
    if p.approach.travel_max < travel {
        return format!(
            ": `approach.travel_max` = `{} m`, less than the `{travel:.3e} m` from behind a touch to the next at \
             `teach.velocity_max` = `{} m/s`",
            p.approach.travel_max, p.teach.velocity_max
        );
    }
    if let Some(fastest) = output.numbers.bearable {
        return format!(
            ": `teach.force_max` = `{} N` bears no more than `{fastest:.3e} m/s` by the touches so far, limit three times \
             `teach.velocity_min`, `{:.3e} m/s`",
            p.teach.force_max,
            RATIO * p.teach.velocity_min
        );
    }
    format!(
        ": scatter of the touches `{:.2e} m`, limit `limits.touch_scatter` = `{} m`; bias from `{least:.2e} m`, limit `{:.2e} m`, \
         three deviations, to `{most:.2e} m`, limit `limits.bias` = `{} m`, behind `teach.place` = `{} m`; its deviation `{:.2e} m`, limit \
         `teach.deviation_max` = `{} m`",
        taught.scatter,
        p.limits.touch_scatter,
        -SIGNIFICANT * taught.deviation,
        p.limits.bias,
        p.teach.place,
        taught.deviation,
        p.teach.deviation_max
    )
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
    fn readings_that_jump_tell_how_late_they_are_or_how_far_they_bend() {
        let mut vars = <Vars as fmi2_export::Interface>::START;
        (vars.output.fault, vars.output.numbers.late_by) = (Fault::LateReading, 10);
        assert!(numbers(&vars).contains("was read `10` samples before"), "{}", numbers(&vars));
        vars.output.fault = Fault::ReadingJump;
        assert!(numbers(&vars).contains("`limits.jump`"), "{}", numbers(&vars));
        vars.output.numbers.bend = 2e-6;
        assert!(
            numbers(&vars).starts_with(": second differences of `2.000e-6 m`, limit `1.900e-7 m`"),
            "{}",
            numbers(&vars)
        );
    }

    #[test]
    fn a_job_that_is_late_tells_its_time_and_the_limit_that_was_judged() {
        let mut vars = <Vars as fmi2_export::Interface>::START;
        vars.output.fault = Fault::NoProgress;
        (vars.output.numbers.lasted, vars.output.numbers.time_limit) = (634.5674, 634.5673);
        assert_eq!(numbers(&vars), ": `634.5674 s`, limit `634.5673 s`");
    }

    #[test]
    fn a_rejected_teaching_tells_the_limits_that_were_judged() {
        let mut vars = <Vars as fmi2_export::Interface>::START;
        vars.output.fault = Fault::TeachingRejected;
        (vars.output.taught.deviation, vars.output.numbers.biases) = (2e-8, [-6.1e-8, 3e-7]);
        let told = numbers(&vars);
        assert!(
            told.contains("bias from `-6.10e-8 m`, limit `-6.00e-8 m`, three deviations, to `3.00e-7 m`"),
            "{told}"
        );
        assert!(!told.contains("travel"), "{told}");
        vars.in_force.approach.travel_max = 2.7e-4;
        let told = numbers(&vars);
        assert!(told.starts_with(": `approach.travel_max` = `0.00027 m`, less than the `2.721e-4 m`"), "{told}");
        assert!(told.contains("`teach.velocity_max` = `0.0003 m/s`"), "{told}");
        vars.in_force.approach.travel_max = 5e-3;
        (vars.in_force.teach.force_max, vars.output.numbers.bearable) = (0.1, Some(2.5e-5));
        let told = numbers(&vars);
        assert!(told.starts_with(": `teach.force_max` = `0.1 N` bears no more than `2.500e-5 m/s`"), "{told}");
        assert!(told.ends_with("`teach.velocity_min`, `3.000e-5 m/s`"), "{told}");
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
}
