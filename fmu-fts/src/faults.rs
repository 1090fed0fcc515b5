//! Selection of the fault of a control step, and the values in its message.

use crate::calibration::form::READINGS_MIN;
use crate::commission::plan::FLEXURE_MAX;
use crate::commission::values::longest_delay;
use crate::interface::Fault::{PositionFrozen, PositionJump, PositionLost};
use crate::interface::Fault::{SlideFrozen, SlideJump, SlideLost, SpindleFrozen, SpindleJump, SpindleLost};
use crate::interface::{Fault, Measured, Parameters, Status, Vars};
use crate::monitoring::numbers::Numbers;
use crate::monitoring::watch::{REVERSALS, SETTLED};
use crate::path::feasibility::{available_torque, infeasible};
use crate::path::path_table::PathTable;
use crate::reading::{Loss, Missing};

/// Omitted depth of a table above which the user gets a warning, m.
const TRUNCATION_MAX: f64 = 1e-7;

/// Findings of one sample, from which its fault is selected.
pub struct Situation<'a> {
    /// Missing measurements.
    pub missing: &'a Missing,
    /// Fault found by the monitors of the closed loop.
    pub found: Option<Fault>,
    /// The slide does not keep its feed.
    pub feed_lost: bool,
    /// The samples of this communication step have the same inputs.
    pub long_step: bool,
    /// The task has exceeded its time limit.
    pub overdue: bool,
    /// The commissioning run has a result that cannot be used.
    pub rejected: bool,
    /// The requested path, if any.
    pub path: Option<&'a PathTable>,
    /// The slide is outside the table, and this is not the end of the cut.
    pub outside: bool,
    /// Spindle speed, rad/s; 0 while it is unconfirmed.
    pub spindle_speed: f64,
}

impl Fault {
    /// Response of the arm to a torque, as far as it is known with this fault: 1 nominal, -1 reversed, 0 unknown;
    /// `seen` is the observed response.
    pub fn answer(self, seen: f64) -> f64 {
        match self {
            // in a long step only the last command takes effect
            Self::WeakDrive | Self::Oscillation | Self::LongStep => 0.0,
            // a drive that does not respond may be the cause
            Self::FollowingError | Self::Saturation => seen.max(0.0),
            Self::DriveSign => seen.min(0.0),
            _ => 1.0,
        }
    }
}

/// The fault of this sample: causes before their consequences.
pub fn find(p: &Parameters, now: &Situation) -> Option<Fault> {
    let Situation { missing, spindle_speed, .. } = *now;
    let of = |loss: Option<Loss>, [invalid, frozen, jump]: [Fault; 3]| {
        loss.map(|loss| match loss {
            Loss::Invalid => invalid,
            Loss::Frozen => frozen,
            Loss::Jump => jump,
        })
    };
    now.long_step
        .then_some(Fault::LongStep)
        .or(of(missing.arm, [PositionLost, PositionFrozen, PositionJump]))
        .or(now.found)
        .or(missing.hold.then_some(Fault::InvalidInput))
        .or(now.path.and_then(|path| {
            let infeasible = infeasible(p, path, spindle_speed);
            of(missing.spindle, [SpindleLost, SpindleFrozen, SpindleJump])
                .or(of(missing.slide, [SlideLost, SlideFrozen, SlideJump]))
                .or(now.feed_lost.then_some(SlideFrozen))
                .or(now.outside.then_some(Fault::OutsideTable))
                .or(infeasible.then_some(Fault::Infeasible))
        }))
        .or(now.overdue.then_some(Fault::NoProgress))
        .or(now.rejected.then_some(Fault::CommissionRejected))
}

/// Values and limits of the present fault, for its message.
pub fn numbers(vars: &Vars) -> String {
    let Vars { input, output, in_force: p, .. } = vars;
    let Numbers { saturated, revolutions, begin, drive_ratio, late, fed, table: [first, last] } = output.numbers;
    let drive_ratio = format!(
        "`{drive_ratio:.2}` of the expected acceleration, minimum `expert.limits.drive_gain_ratio` = `{}`",
        p.limits.drive_gain_ratio
    );
    let lost = format!("more than `limits.lost_samples` = `{}` samples", p.limits.lost_samples);
    let error = format!(
        "error of a revolution `{:.1} um`, `expert.limits.tracking_error` = `{:.1} um`",
        1e6 * output.error.rms,
        1e6 * p.limits.tracking_error
    );
    match output.fault {
        Fault::None => String::new(),
        Fault::FollowingError => format!(
            ": `{:.3} mm`, limit `{} mm`; the arm has {drive_ratio}",
            1e3 * output.error.tracking,
            1e3 * p.limits.following_error
        ),
        Fault::DriveSign | Fault::WeakDrive => format!(": the arm has {drive_ratio}"),
        Fault::Saturation => format!(
            ": `{saturated:.2}` of the samples at `servo.torque_max` = `{} N.m`, maximum `expert.limits.saturated_ratio` = `{}`",
            p.servo.torque_max, p.limits.saturated_ratio
        ),
        Fault::Oscillation => {
            format!(": `{REVERSALS}` changes between the limits of `servo.torque_max` = `{} N.m`", p.servo.torque_max)
        }
        Fault::NoProgress => match late {
            Some([time, limit]) => format!(": `{time:.1} s`, limit `{limit:.1} s`"),
            None => format!(": {error}, after `{} s` of learning", SETTLED * p.afc.tau),
        },
        Fault::Divergence => format!(": from `{:.1} um` in `{revolutions}` revolutions; {error}", 1e6 * begin),
        Fault::Infeasible => format!(
            ": required `{:.3} N.m` at `{:.2} rad/s`, available `{:.3} N.m`",
            output.path_torque,
            output.spindle_speed,
            available_torque(p)
        ),
        Fault::LongStep => format!(": limit `{} s`", p.sample_period),
        Fault::OutsideTable => {
            format!(
                ": `slide_position` = `{} m`, the table extends from `{first} m` to `{last} m`",
                input.slide_position
            )
        }
        PositionLost | PositionFrozen | PositionJump => {
            format!(": `arm_angle` = `{} rad`, reference `{} rad`, {lost}", input.arm_angle, output.reference.angle)
        }
        SpindleLost | SpindleFrozen | SpindleJump => {
            format!(": `spindle_angle` = `{} rad`, {lost}", input.spindle_angle)
        }
        SlideLost | SlideFrozen | SlideJump => match fed.filter(|_| output.fault == SlideFrozen) {
            Some(travel) => format!(
                ": `slide_position` moved `{travel:.2e} m` in a revolution, `limits.feed` = `{} m`, tolerance 50 %",
                p.limits.feed
            ),
            None => format!(": `slide_position` = `{} m`, {lost}", input.slide_position),
        },
        Fault::CommissionRejected => rejected(p, &output.measured),
        Fault::InvalidInput => format!(": `hold_angle` = `{} rad`, {lost}", input.hold_angle),
    }
}

/// Values of a rejected commissioning run, after which the configured parameters are active.
fn rejected(p: &Parameters, m: &Measured) -> String {
    format!(
        ": inertia `{} kg.m2`, standard deviation `{} kg.m2`, limits half and twice `servo.inertia` = `{} kg.m2` and relative \
         `expert.commission.std_max` = `{}`; flexure `{} rad/s`, standard deviation `{} rad/s`, limits `tip.frequency` = `{} rad/s` \
         within a factor of `{FLEXURE_MAX}` and the same relative one; delay `{}` samples, standard deviation `{}`, limits `0` to \
         `{}` for `io_delay` = `{}` and `expert.commission.delay_std_max` = `{}`; or no loop of 0.3 `servo.bandwidth` with a \
         sensitivity of `expert.commission.sensitivity_max` = `{}`",
        m.inertia,
        m.inertia_std,
        p.servo.inertia,
        p.commission.std_max,
        m.tip_frequency,
        m.tip_frequency_std,
        p.tip.frequency,
        m.io_delay,
        m.io_delay_std,
        longest_delay(&p.into()),
        p.io_delay,
        p.commission.delay_std_max,
        p.commission.sensitivity_max,
    )
}

/// Warning about a table with too few harmonics.
pub fn truncation(vars: &Vars) -> Option<String> {
    let (left_out, harmonics) = (vars.output.path_truncation, vars.in_force.path.harmonics);
    (left_out > TRUNCATION_MAX).then(|| {
        format!(
            "`path.harmonics` = `{harmonics}` omits up to `{left_out:.1e} m` of the depth\nhint: increase `path.harmonics`, \
             or reduce `surface.outer_radius`"
        )
    })
}

/// Warning about a fitted lens without a correction; `corrects`: the next path has the correction of an earlier lens.
pub fn form(vars: &Vars, corrects: bool) -> Option<String> {
    let (form, limits, found) = (&vars.output.form, &vars.in_force.form, &vars.output.calibration);
    let (what, hint) = match found.status {
        Status::Solved => return None,
        Status::TooLarge => (
            format!(
                "the lens needs a correction of `{:.1e} m`, limit `expert.form.depth_max` = `{:.1e} m`",
                form.largest, limits.depth_max
            ),
            "Calibrate `tool.*` with a toroid and flats. Check that this part was cut on this path.",
        ),
        Status::Uncertain => (
            format!(
                "the correction has a standard deviation of `{:.1e} m`, limit `expert.form.std_max` = `{:.1e} m`, residuals `{:.1e} m`",
                form.std, limits.std_max, found.residual
            ),
            "Probe more positions and angles, over the whole cut and on both sides of the axis.",
        ),
        status => (
            format!(
                "the samples of the lens give no correction, `{status:?}`: `{}` stored, minimum `{READINGS_MIN}`",
                found.samples
            ),
            "Probe at least nine angles on each side of the axis, and all positions at each.",
        ),
    };
    let then = if corrects { "the previous correction stays" } else { "no correction" };
    Some(format!("{what}: {then}\nhint: {hint}"))
}

#[cfg(test)]
mod tests {
    use control_blocks::Reaction;

    use super::*;

    #[test]
    fn the_arm_retracts_only_where_encoder_drive_and_loop_respond() {
        for fault in Fault::ALL {
            let end = match fault {
                Fault::None | Fault::Infeasible | Fault::OutsideTable | Fault::InvalidInput => Reaction::Retract,
                Fault::SpindleLost | Fault::SpindleJump | Fault::SpindleFrozen => Reaction::Retract,
                Fault::SlideLost | Fault::SlideJump | Fault::SlideFrozen => Reaction::Retract,
                Fault::NoProgress | Fault::Divergence | Fault::CommissionRejected => Reaction::Retract,
                Fault::PositionLost | Fault::PositionFrozen | Fault::PositionJump => Reaction::DriveOff,
                Fault::DriveSign | Fault::WeakDrive | Fault::Oscillation => Reaction::DriveOff,
                Fault::FollowingError | Fault::Saturation | Fault::LongStep => Reaction::DriveOff,
            };
            assert_eq!(fault.reaction(), end, "{fault:?}");
        }
    }

    #[test]
    fn a_fault_message_has_value_and_limit() {
        let mut vars = <Vars as fmi2_export::Interface>::START;
        vars.input.spindle_angle = 7.0;
        vars.output.error.rms = 50e-6;
        vars.output.numbers = Numbers {
            saturated: 0.31,
            revolutions: 5,
            begin: 24e-6,
            drive_ratio: -0.9,
            fed: Some(1e-6),
            ..Numbers::START
        };
        vars.output.numbers.table = [0.04, 0.09];
        let tracking = "error of a revolution `50.0 um`, `expert.limits.tracking_error` = `20.0 um`";
        let mut check = |fault, expected: &str| {
            vars.output.fault = fault;
            assert_eq!(numbers(&vars), expected, "{fault:?}");
        };
        check(
            Fault::Saturation,
            ": `0.31` of the samples at `servo.torque_max` = `7 N.m`, maximum `expert.limits.saturated_ratio` = `0.18`",
        );
        check(
            Fault::DriveSign,
            ": the arm has `-0.90` of the expected acceleration, minimum `expert.limits.drive_gain_ratio` = `0.4`",
        );
        check(Fault::Divergence, &format!(": from `24.0 um` in `5` revolutions; {tracking}"));
        check(Fault::NoProgress, &format!(": {tracking}, after `2.4 s` of learning"));
        check(SpindleJump, ": `spindle_angle` = `7 rad`, more than `limits.lost_samples` = `3` samples");
        check(
            SlideFrozen,
            ": `slide_position` moved `1.00e-6 m` in a revolution, `limits.feed` = `0 m`, tolerance 50 %",
        );
        check(Fault::OutsideTable, ": `slide_position` = `0 m`, the table extends from `0.04 m` to `0.09 m`");
        vars.output.numbers.late = Some([61.0, 60.0]);
        vars.output.fault = Fault::NoProgress;
        assert_eq!(numbers(&vars), ": `61.0 s`, limit `60.0 s`");
    }

    #[test]
    fn too_few_harmonics_give_a_warning_beyond_their_limit() {
        let mut vars = <Vars as fmi2_export::Interface>::START;
        vars.output.path_truncation = TRUNCATION_MAX;
        assert_eq!(truncation(&vars), None);
        vars.output.path_truncation = 1.001 * TRUNCATION_MAX;
        vars.in_force.path.harmonics = 12;
        let message = truncation(&vars).unwrap();
        assert!(message.starts_with("`path.harmonics` = `12` omits up to `"), "{message}");
    }

    #[test]
    fn a_lens_without_a_correction_gives_a_warning_with_value_and_limit() {
        let mut vars = <Vars as fmi2_export::Interface>::START;
        (vars.output.form.largest, vars.output.form.std, vars.output.calibration.residual) = (3e-4, 5e-7, 1e-6);
        vars.output.calibration.samples = 30;
        let few = "`30` stored, minimum `38`";
        for (status, parts) in [
            (Status::TooLarge, ["`3.0e-4 m`", "`expert.form.depth_max` = `1.0e-4 m`"]),
            (Status::Uncertain, ["`5.0e-7 m`", "`expert.form.std_max` = `2.0e-7 m`, residuals `1.0e-6 m`"]),
            (Status::TooFewSamples, ["`TooFewSamples`", few]),
            (Status::NotObservable, ["`NotObservable`", few]),
            (Status::NotConverged, ["`NotConverged`", few]),
        ] {
            vars.output.calibration.status = status;
            for (corrects, then) in [(false, ": no correction\n"), (true, ": the previous correction stays\n")] {
                let message = form(&vars, corrects).unwrap();
                assert!(parts.iter().chain(&[then, "hint: "]).all(|part| message.contains(part)), "{message}");
            }
        }
        vars.output.calibration.status = Status::Solved;
        assert_eq!(form(&vars, true), None);
    }

    #[test]
    fn every_fault_message_has_values() {
        for fault in Fault::ALL {
            let mut vars = <Vars as fmi2_export::Interface>::START;
            vars.output.fault = *fault;
            assert_eq!(
                numbers(&vars).matches('`').count() >= 2,
                *fault != Fault::None,
                "{fault:?}: {}",
                numbers(&vars)
            );
        }
    }
}
