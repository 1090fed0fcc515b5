//! Details of a fault for the log.

use control_blocks::{SIGNIFICANT, tolerated_delays};

use crate::calibration::series::RATIO;
use crate::check::check_derived;
use crate::commission::response::loop_spread;
use crate::commission::values::{self, Values, acceptable};
use crate::faults::REVERSALS;
use crate::interface::{Fault, Output, Parameters, Vars};
use crate::limits::{bend_limit, disturbance_limit};
use crate::monitoring::numbers::{LateContact, Unseen};
use crate::monitoring::rest::ROW;
use crate::motion::stability::longest_delay;
use crate::motion::travel::{calibration_travel, learn_limit};

/// Details of the fault for the log.
pub fn numbers(vars: &Vars) -> String {
    let (p, output) = (&vars.in_force, &vars.output);
    let row = format!("for more than `limits.lost_samples` = `{}`", p.limits.lost_samples);
    let error = format!(
        "tracking error `{} m`, disturbance `{} N`, drive gain ratio `{}`",
        output.tracking_error, output.force.disturbance, output.drive_gain_ratio
    );
    match output.fault {
        Fault::None => String::new(),
        Fault::TravelLimit => format!(": `{} m`", p.approach.travel_max),
        Fault::PositionLost => format!(": `{} m` {row}", vars.input.position),
        Fault::PositionFrozen => format!(
            ": `{} m` did not change over more than `limits.frozen` = `{} m` of motion {row}, or for `expert.limits.rest_time` = `{} s` and \
             `{ROW}` samples at rest",
            vars.input.position, p.limits.frozen, p.limits.rest_time
        ),
        Fault::PositionDelayed => {
            format!(
                ": `{} m` repeats the value of `{}` samples before, {row}",
                vars.input.position, output.numbers.late_by
            )
        }
        Fault::PositionJump if output.numbers.bend > 0.0 => format!(
            ": second differences of `{:.3e} m`, limit `{:.3e} m`, the motion by `{} N` and the drive in a sample; {error}",
            output.numbers.bend,
            bend_limit(p),
            disturbance_limit(p)
        ),
        Fault::PositionJump => {
            format!(": `{} m` is beyond `limits.jump` = `{} m` {row}", vars.input.position, p.limits.jump)
        }
        Fault::SpindleJump => format!(
            ": `{} rad/s`, faster than `expert.limits.spindle_acceleration` = `{} rad/s2` {row}",
            vars.input.spindle_speed, p.limits.spindle_acceleration
        ),
        Fault::FollowingError => format!(": {error}, limit of the distance `{} m`", output.numbers.following_limit),
        Fault::Saturation => {
            format!(": longer than `expert.limits.saturated_time` = `{} s`; {error}", p.limits.saturated_time)
        }
        Fault::Overload => format!(": {error}, limit of the disturbance `{} N`", disturbance_limit(p)),
        Fault::DriveSign => format!(": {error}"),
        Fault::WeakDrive => format!(": {error}, minimum `limits.drive_gain_ratio` = `{}`", p.limits.drive_gain_ratio),
        Fault::Oscillation if output.numbers.oscillations >= REVERSALS => format!(
            ": `{REVERSALS}` reversals beyond `guard.force` = `{} N` while the reference does not accelerate; {error}",
            p.guard_force
        ),
        Fault::Oscillation => {
            format!(
                ": `{REVERSALS}` reversals from limit to limit of `stage.current_max` = `{} A`",
                p.stage.current_max
            )
        }
        Fault::LearnRejected => format!(
            ": mean `{} N/s`, sigma `{} N/s`, limit `limits.slope_sigma_max` = `{} N/s`",
            output.threshold.mean, output.threshold.sigma, p.limits.slope_sigma_max
        ),
        Fault::LearnTimeout => format!(": `{} s`", learn_limit(p)),
        Fault::ContactRejected => {
            format!(
                ": `{} N` remain, limit `limits.residual_force` = `{} N`",
                output.numbers.residual_force, p.limits.residual_force
            )
        }
        Fault::LateContact => late_contact(p, output.numbers.late),
        Fault::NoProgress => {
            format!(": `{:.4} s`, limit `{:.4} s`", output.numbers.lasted, output.numbers.time_limit)
        }
        Fault::CommissionRejected => rejected(p, output),
        Fault::CalibrationRejected => calibration_rejected(p, output),
        Fault::LongStep => format!(": limit `{} s`", p.sample_period),
        Fault::SpindleLost => format!(": `{} rad/s` {row}", vars.input.spindle_speed),
    }
}

fn late_contact(p: &Parameters, contact: Option<LateContact>) -> String {
    let Some(LateContact { position, force, unseen }) = contact else { return String::new() };
    let (limit, detector) = (p.guard_force, p.detector);
    let why = match unseen {
        Unseen::Unarmed => format!("before the detector `{detector:?}` was armed"),
        Unseen::Doubted => format!("after jumps of `position` that the detector `{detector:?}` ignored"),
        Unseen::Missed => format!("missed by the armed detector `{detector:?}`"),
    };
    format!(": at `{position:.7} m`, `{force:.3} N` of `guard.force` = `{limit} N`, {why}")
}

/// Why a calibration cycle is rejected.
fn calibration_rejected(p: &Parameters, output: &Output) -> String {
    let (calibrated, [minimum, maximum], travel) = (&output.calibrated, output.numbers.biases, calibration_travel(p));
    if p.approach.travel_max < travel {
        return format!(
            ": `approach.travel_max` = `{} m`, less than the `{travel:.3e} m` from one touch to the next at \
             `calibration.velocity_max` = `{} m/s`",
            p.approach.travel_max, p.calibration.velocity_max
        );
    }
    if let Some(fastest) = output.numbers.tolerated {
        return format!(
            ": `calibration.force_max` = `{} N` allows at most `{fastest:.3e} m/s` by the touches so far, minimum three times \
             `calibration.velocity_min`, `{:.3e} m/s`",
            p.calibration.force_max,
            RATIO * p.calibration.velocity_min
        );
    }
    format!(
        ": scatter of the touches `{:.2e} m`, limit `expert.limits.touch_scatter` = `{} m`; bias from `{minimum:.2e} m`, limit `{:.2e} m`, \
         three standard deviations, to `{maximum:.2e} m`, limit `expert.limits.bias` = `{} m`, from `calibration.position` = `{} m`; standard \
         deviation `{:.2e} m`, limit `expert.calibration.std_max` = `{} m`",
        calibrated.scatter,
        p.limits.touch_scatter,
        -SIGNIFICANT * calibrated.std,
        p.limits.bias,
        p.calibration.position,
        calibrated.std,
        p.calibration.std_max
    )
}

/// Why a commissioning run is rejected; the configured values are active after it.
fn rejected(p: &Parameters, output: &Output) -> String {
    let (configured, m) = (Values::of(p), &output.measured);
    let longest = longest_delay(p, *tolerated_delays(p.io_delay).end() as usize);
    let constants = [output.numbers.force_constant, p.stage.force_constant];
    let noise = m.slope_sigma > 0.0;
    let good = if noise {
        configured.quiet(p, m)
    } else {
        constants.into_iter().all(|constant| acceptable(p, constant, longest, m))
    };
    if good {
        let mut found = p.clone();
        let derived = if noise { configured.derived(p, m) } else { configured.with_response(m) };
        derived.put(&mut found);
        if let Err(error) = check_derived(&found) {
            return format!(": {}", error.of_derived());
        }
    }
    if noise {
        return format!(
            ": noise of the slope `{} N/s`, limit the configured `limits.slope_sigma_max` = `{} N/s`; force of the guard for this noise and \
             cogging `{} N`, limit three times the configured `guard.force` = `{} N`",
            m.slope_sigma,
            p.limits.slope_sigma_max,
            values::guard(p, m),
            p.guard_force
        );
    }
    format!(
        ": thrust constant `{} N/A`, standard deviation `{} N/A`, limits half and twice `stage.force_constant`, `{} N/A` configured and \
         `{} N/A` active, and `expert.commission.std_max` = `{}` of it; delay `{}` samples, standard deviation `{}`, limits `0` to \
         `{longest}`, with which the loop is stable, and `expert.commission.delay_std_max` = `{}` in addition to `{}` of the current loop",
        m.force_constant,
        m.force_constant_std,
        p.stage.force_constant,
        output.numbers.force_constant,
        p.commission.std_max,
        m.io_delay,
        m.io_delay_std,
        p.commission.delay_std_max,
        loop_spread(p)
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_fault_has_details() {
        for &fault in Fault::ALL {
            let mut vars = <Vars as fmi2_export::Interface>::START;
            vars.output.fault = fault;
            vars.output.numbers.late = Some(LateContact { position: 0.0, force: 0.0, unseen: Unseen::Missed });
            assert_eq!(numbers(&vars).is_empty(), fault == Fault::None, "{fault:?}");
        }
    }

    #[test]
    fn a_late_contact_has_position_force_and_why_the_detector_missed_it() {
        let mut vars = <Vars as fmi2_export::Interface>::START;
        vars.output.fault = Fault::LateContact;
        for (unseen, why) in [
            (Unseen::Unarmed, "before the detector `SlopePaper` was armed"),
            (Unseen::Doubted, "after jumps of `position` that the detector `SlopePaper` ignored"),
            (Unseen::Missed, "missed by the armed detector `SlopePaper`"),
        ] {
            vars.output.numbers.late = Some(LateContact { position: 5.12e-5, force: 0.4321, unseen });
            let expected = format!(": at `0.0000512 m`, `0.432 N` of `guard.force` = `0.4 N`, {why}");
            let detector = format!("{:?}", vars.in_force.detector);
            assert_eq!(numbers(&vars), expected.replace("SlopePaper", &detector));
        }
        (vars.output.fault, vars.output.numbers.residual_force) = (Fault::ContactRejected, 0.31);
        assert!(numbers(&vars).starts_with(": `0.31 N` remain"), "{}", numbers(&vars));
    }

    #[test]
    fn jumps_have_their_delay_or_second_difference() {
        let mut vars = <Vars as fmi2_export::Interface>::START;
        (vars.output.fault, vars.output.numbers.late_by) = (Fault::PositionDelayed, 10);
        assert!(numbers(&vars).contains("repeats the value of `10` samples before"), "{}", numbers(&vars));
        vars.output.fault = Fault::PositionJump;
        assert!(numbers(&vars).contains("`limits.jump`"), "{}", numbers(&vars));
        vars.output.numbers.bend = 2e-6;
        assert!(
            numbers(&vars).starts_with(": second differences of `2.000e-6 m`, limit `1.900e-7 m`"),
            "{}",
            numbers(&vars)
        );
    }

    #[test]
    fn a_late_cycle_has_its_time_and_its_limit() {
        let mut vars = <Vars as fmi2_export::Interface>::START;
        vars.output.fault = Fault::NoProgress;
        (vars.output.numbers.lasted, vars.output.numbers.time_limit) = (634.5674, 634.5673);
        assert_eq!(numbers(&vars), ": `634.5674 s`, limit `634.5673 s`");
    }

    #[test]
    fn a_rejected_calibration_has_its_limits() {
        let mut vars = <Vars as fmi2_export::Interface>::START;
        vars.output.fault = Fault::CalibrationRejected;
        (vars.output.calibrated.std, vars.output.numbers.biases) = (2e-8, [-6.1e-8, 3e-7]);
        let text = numbers(&vars);
        assert!(
            text.contains("bias from `-6.10e-8 m`, limit `-6.00e-8 m`, three standard deviations, to `3.00e-7 m`"),
            "{text}"
        );
        assert!(!text.contains("travel"), "{text}");
        vars.in_force.approach.travel_max = 2.7e-4;
        let text = numbers(&vars);
        assert!(text.starts_with(": `approach.travel_max` = `0.00027 m`, less than the `2.721e-4 m`"), "{text}");
        assert!(text.contains("`calibration.velocity_max` = `0.0003 m/s`"), "{text}");
        vars.in_force.approach.travel_max = 5e-3;
        (vars.in_force.calibration.force_max, vars.output.numbers.tolerated) = (0.1, Some(2.5e-5));
        let text = numbers(&vars);
        assert!(text.starts_with(": `calibration.force_max` = `0.1 N` allows at most `2.500e-5 m/s`"), "{text}");
        assert!(text.ends_with("`calibration.velocity_min`, `3.000e-5 m/s`"), "{text}");
    }

    #[test]
    fn a_rejected_run_has_the_noise_once_it_was_measured_and_the_response_before() {
        let mut vars = <Vars as fmi2_export::Interface>::START;
        vars.output.fault = Fault::CommissionRejected;
        assert!(numbers(&vars).starts_with(": thrust constant `0 N/A`"), "{}", numbers(&vars));
        vars.output.measured.slope_sigma = 7.5;
        assert!(numbers(&vars).starts_with(": noise of the slope `7.5 N/s`"), "{}", numbers(&vars));
    }

    #[test]
    fn a_rejected_run_has_the_configured_values_and_the_parameters_that_do_not_fit() {
        let mut vars = <Vars as fmi2_export::Interface>::START;
        vars.output.fault = Fault::CommissionRejected;
        vars.output.numbers.force_constant = 25.0;
        let text = numbers(&vars);
        assert!(
            text.contains("`20 N/A` configured and `25 N/A` active") && text.contains("limits `0` to `3`"),
            "{text}"
        );
        let m = &mut vars.output.measured;
        (m.force_constant, m.io_delay) = (16.0, 1.0);
        vars.in_force.commission.force = 0.9 * 20.0 * vars.in_force.stage.current_max;
        let text = numbers(&vars);
        assert!(text.contains("do not fit: parameter `commission.force` would be"), "{text}");
        vars.output.measured.slope_sigma = 9.0;
        assert!(numbers(&vars).contains("configured `limits.slope_sigma_max` = `5 N/s`"), "{}", numbers(&vars));
    }
}
