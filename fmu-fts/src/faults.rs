//! Every fault is named here, how it ends, and the numbers that are told with it.

use control_blocks::SafeEnd;

use crate::calibration::form::READINGS_MIN;
use crate::commission::plan::FLEXURE_MAX;
use crate::commission::values::longest_delay;
use crate::interface::Fault::{FrozenReading, FrozenSlide, FrozenSpindle, LostReading, LostSlide, LostSpindle};
use crate::interface::Fault::{ReadingJump, SlideJump, SpindleJump};
use crate::interface::{Fault, Measured, Parameters, Status, Vars};
use crate::monitoring::numbers::Numbers;
use crate::monitoring::watch::{REVERSALS, SETTLED};
use crate::path::feasibility::{available_torque, infeasible};
use crate::path::path_table::PathTable;
use crate::reading::{Loss, Missing};

/// A table that leaves out more is told to the user, m.
const TRUNCATION_MAX: f64 = 1e-7;

/// What the faults of one sample are found from.
pub struct Situation<'a> {
    /// What of the readings is missing.
    pub missing: &'a Missing,
    /// What the monitors of the closed loop have found.
    pub found: Option<Fault>,
    /// The slide does not go on with its feed.
    pub feed_lost: bool,
    /// The samples of this communication step have the same inputs.
    pub long_step: bool,
    /// The job has taken longer than it may.
    pub overdue: bool,
    /// The commission has a result that cannot be used.
    pub rejected: bool,
    /// The path that is asked for, if one is.
    pub path: Option<&'a PathTable>,
    /// The slide is where the path has no table, and it is not the end of the cut.
    pub outside: bool,
    /// Spindle speed, rad/s; 0 while it is not sure.
    pub spindle_speed: f64,
}

impl Fault {
    /// What a torque does to the arm, as far as is known: 1 if what it should, -1 if the opposite, 0 if that is not sure; `seen`
    /// is what it was seen to do.
    pub fn answer(self, seen: f64) -> f64 {
        match self {
            // of a long step the last command alone is seen
            Self::WeakDrive | Self::Oscillation | Self::LongStep => 0.0,
            // which a drive that does not obey may cause
            Self::FollowingError | Self::Saturation => seen.max(0.0),
            Self::DriveSign => seen.min(0.0),
            _ => 1.0,
        }
    }

    /// How the job ends. The arm obeys wherever its encoder, its drive and its loop do, and leaves the part then; without
    /// one of them, or with no torque to spare, none is known to help.
    pub fn safe_end(self) -> SafeEnd {
        match self {
            Self::None
            | Self::Infeasible
            | Self::OutsideTable
            | Self::InvalidInput
            | Self::LostSpindle
            | Self::SpindleJump
            | Self::FrozenSpindle
            | Self::LostSlide
            | Self::SlideJump
            | Self::FrozenSlide
            | Self::NoProgress
            | Self::Divergence
            | Self::CommissionRejected => SafeEnd::Retract,
            Self::FollowingError
            | Self::LostReading
            | Self::FrozenReading
            | Self::ReadingJump
            | Self::DriveSign
            | Self::WeakDrive
            | Self::Oscillation
            | Self::Saturation
            | Self::LongStep => SafeEnd::DriveOff,
        }
    }
}

/// The gravest fault of this sample, its cause before its consequences.
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
        .or(of(missing.arm, [LostReading, FrozenReading, ReadingJump]))
        .or(now.found)
        .or(missing.hold.then_some(Fault::InvalidInput))
        .or(now.path.and_then(|path| {
            let infeasible = infeasible(p, path, spindle_speed);
            of(missing.spindle, [LostSpindle, FrozenSpindle, SpindleJump])
                .or(of(missing.slide, [LostSlide, FrozenSlide, SlideJump]))
                .or(now.feed_lost.then_some(FrozenSlide))
                .or(now.outside.then_some(Fault::OutsideTable))
                .or(infeasible.then_some(Fault::Infeasible))
        }))
        .or(now.overdue.then_some(Fault::NoProgress))
        .or(now.rejected.then_some(Fault::CommissionRejected))
}

/// The numbers behind a fault.
pub fn numbers(vars: &Vars) -> String {
    let Vars { input, output, in_force: p, .. } = vars;
    let Numbers { saturated, turns, begin, share, late, fed, table: [first, last] } = output.numbers;
    let share = format!(
        "`{share:.2}` of what the torque should do, at least `limits.drive_share` = `{}`",
        p.limits.drive_share
    );
    let lost = format!("more than `limits.lost_samples` = `{}` readings", p.limits.lost_samples);
    let error = format!(
        "error over a turn `{:.1} um`, `limits.tracking_error` = `{:.1} um`",
        1e6 * output.error.rms,
        1e6 * p.limits.tracking_error
    );
    match output.fault {
        Fault::None => String::new(),
        Fault::FollowingError => format!(
            ": `{:.3} mm`, limit `{} mm`; the arm does {share}",
            1e3 * output.error.tracking,
            1e3 * p.limits.following_error
        ),
        Fault::DriveSign | Fault::WeakDrive => format!(": the arm does {share}"),
        Fault::Saturation => format!(
            ": `{saturated:.2}` of the samples at `servo.torque_max` = `{} N.m`, at most `limits.saturated_share` = `{}`",
            p.servo.torque_max, p.limits.saturated_share
        ),
        Fault::Oscillation => {
            format!(": `{REVERSALS}` times from limit to limit of `servo.torque_max` = `{} N.m`", p.servo.torque_max)
        }
        Fault::NoProgress => match late {
            Some([time, limit]) => format!(": `{time:.1} s`, limit `{limit:.1} s`"),
            None => format!(": {error}, for `{} s` of learning", SETTLED * p.afc.tau),
        },
        Fault::Divergence => format!(": from `{:.1} um` in `{turns}` turns; {error}", 1e6 * begin),
        Fault::Infeasible => format!(
            ": needed `{:.3} N.m` at `{:.2} rad/s`, available `{:.3} N.m`",
            output.path_torque,
            output.spindle_speed,
            available_torque(p)
        ),
        Fault::LongStep => format!(": limit `{} s`", p.sample_period),
        Fault::OutsideTable => {
            format!(": `slide_position` = `{} m`, the table is from `{first} m` to `{last} m`", input.slide_position)
        }
        LostReading | FrozenReading | ReadingJump => {
            format!(": `arm_angle` = `{} rad`, wanted `{} rad`, {lost}", input.arm_angle, output.reference.angle)
        }
        LostSpindle | FrozenSpindle | SpindleJump => {
            format!(": `spindle_angle` = `{} rad`, {lost}", input.spindle_angle)
        }
        LostSlide | FrozenSlide | SlideJump => match fed.filter(|_| output.fault == FrozenSlide) {
            Some(way) => format!(
                ": `slide_position` went `{way:.2e} m` in a turn, `limits.feed` = `{} m` within half of it",
                p.limits.feed
            ),
            None => format!(": `slide_position` = `{} m`, {lost}", input.slide_position),
        },
        Fault::CommissionRejected => rejected(p, &output.measured),
        Fault::InvalidInput => format!(": `hold_angle` = `{} rad`, {lost}", input.hold_angle),
    }
}

/// The numbers of a commission that was rejected, after which what was told is in force.
fn rejected(p: &Parameters, m: &Measured) -> String {
    format!(
        ": inertia `{} kg.m2`, deviation `{} kg.m2`, limits half and twice `servo.inertia` = `{} kg.m2` as told and \
         `commission.deviation_max` = `{}` of it; flexure `{} rad/s`, deviation `{} rad/s`, limits `tip.frequency` = `{} rad/s` as told \
         within a factor of `{FLEXURE_MAX}` and the same part; delay `{}` samples, deviation `{}`, limits `0` to `{}` for `io_delay` = `{}` \
         as told and `commission.delay_deviation_max` = `{}`; or no loop of 0.3 `servo.bandwidth` with a sensitivity of \
         `commission.sensitivity_max` = `{}`",
        m.inertia,
        m.inertia_deviation,
        p.servo.inertia,
        p.commission.deviation_max,
        m.tip_frequency,
        m.tip_frequency_deviation,
        p.tip.frequency,
        m.io_delay,
        m.io_delay_deviation,
        longest_delay(&p.into()),
        p.io_delay,
        p.commission.delay_deviation_max,
        p.commission.sensitivity_max,
    )
}

/// A warning of a table with too few harmonics.
pub fn truncation(vars: &Vars) -> Option<String> {
    let (left_out, harmonics) = (vars.output.path_truncation, vars.in_force.path.harmonics);
    (left_out > TRUNCATION_MAX).then(|| {
        format!(
            "`path.harmonics` = `{harmonics}` leave out up to `{left_out:.1e} m` of the depth\nhint: take more harmonics, \
             or end the cut at a smaller `surface.outer_radius`"
        )
    })
}

/// A warning of a fitted lens that gives no correction; `corrects`: the next path has one of a lens before.
pub fn form(vars: &Vars, corrects: bool) -> Option<String> {
    let (form, limits, found) = (&vars.output.form, &vars.in_force.form, &vars.output.calibration);
    let (what, hint) = match found.status {
        Status::Solved => return None,
        Status::NotForm => (
            format!(
                "the lens asks for a correction of `{:.1e} m`, limit `form.depth_max` = `{:.1e} m`",
                form.largest, limits.depth_max
            ),
            "calibrate `tool.*` by a toroid and flats, and check that this part was cut on this path",
        ),
        Status::Unsure => (
            format!(
                "the correction has a deviation of `{:.1e} m`, limit `form.deviation_max` = `{:.1e} m`, residuals `{:.1e} m`",
                form.deviation, limits.deviation_max, found.residual
            ),
            "read more places at more angles, all that were cut, on both sides of the axis",
        ),
        status => (
            format!(
                "the readings of the lens tell no correction, `{status:?}`: `{}` are stored, at least `{READINGS_MIN}` are needed",
                found.samples
            ),
            "read at least nine angles on each side of the axis, and all places at each",
        ),
    };
    let then = if corrects { "the correction before stays" } else { "it corrects nothing" };
    Some(format!("{what}: {then}\nhint: {hint}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_arm_moves_on_only_where_encoder_drive_and_loop_obey() {
        for fault in Fault::ALL {
            let end = match fault {
                Fault::None | Fault::Infeasible | Fault::OutsideTable | Fault::InvalidInput => SafeEnd::Retract,
                Fault::LostSpindle | Fault::SpindleJump | Fault::FrozenSpindle => SafeEnd::Retract,
                Fault::LostSlide | Fault::SlideJump | Fault::FrozenSlide => SafeEnd::Retract,
                Fault::NoProgress | Fault::Divergence | Fault::CommissionRejected => SafeEnd::Retract,
                Fault::LostReading | Fault::FrozenReading | Fault::ReadingJump => SafeEnd::DriveOff,
                Fault::DriveSign | Fault::WeakDrive | Fault::Oscillation => SafeEnd::DriveOff,
                Fault::FollowingError | Fault::Saturation | Fault::LongStep => SafeEnd::DriveOff,
            };
            assert_eq!(fault.safe_end(), end, "{fault:?}");
        }
    }

    #[test]
    fn a_fault_tells_what_was_judged_and_its_limit() {
        let mut vars = <Vars as fmi2_export::Interface>::START;
        vars.input.spindle_angle = 7.0;
        vars.output.error.rms = 50e-6;
        vars.output.numbers =
            Numbers { saturated: 0.31, turns: 5, begin: 24e-6, share: -0.9, fed: Some(1e-6), ..Numbers::START };
        vars.output.numbers.table = [0.04, 0.09];
        let tracking = "error over a turn `50.0 um`, `limits.tracking_error` = `20.0 um`";
        let mut told = |fault, expected: &str| {
            vars.output.fault = fault;
            assert_eq!(numbers(&vars), expected, "{fault:?}");
        };
        told(
            Fault::Saturation,
            ": `0.31` of the samples at `servo.torque_max` = `7 N.m`, at most `limits.saturated_share` = `0.18`",
        );
        told(
            Fault::DriveSign,
            ": the arm does `-0.90` of what the torque should do, at least `limits.drive_share` = `0.4`",
        );
        told(Fault::Divergence, &format!(": from `24.0 um` in `5` turns; {tracking}"));
        told(Fault::NoProgress, &format!(": {tracking}, for `2.4 s` of learning"));
        told(SpindleJump, ": `spindle_angle` = `7 rad`, more than `limits.lost_samples` = `3` readings");
        told(FrozenSlide, ": `slide_position` went `1.00e-6 m` in a turn, `limits.feed` = `0 m` within half of it");
        told(Fault::OutsideTable, ": `slide_position` = `0 m`, the table is from `0.04 m` to `0.09 m`");
        vars.output.numbers.late = Some([61.0, 60.0]);
        vars.output.fault = Fault::NoProgress;
        assert_eq!(numbers(&vars), ": `61.0 s`, limit `60.0 s`");
    }

    #[test]
    fn too_few_harmonics_are_told_beyond_their_limit() {
        let mut vars = <Vars as fmi2_export::Interface>::START;
        vars.output.path_truncation = TRUNCATION_MAX;
        assert_eq!(truncation(&vars), None);
        vars.output.path_truncation = 1.001 * TRUNCATION_MAX;
        vars.in_force.path.harmonics = 12;
        let told = truncation(&vars).unwrap();
        assert!(told.starts_with("`path.harmonics` = `12` leave out up to `"), "{told}");
    }

    #[test]
    fn a_lens_that_corrects_nothing_is_told_with_value_and_limit() {
        let mut vars = <Vars as fmi2_export::Interface>::START;
        (vars.output.form.largest, vars.output.form.deviation, vars.output.calibration.residual) = (3e-4, 5e-7, 1e-6);
        vars.output.calibration.samples = 30;
        let few = "`30` are stored, at least `38` are needed";
        for (status, parts) in [
            (Status::NotForm, ["`3.0e-4 m`", "`form.depth_max` = `1.0e-4 m`"]),
            (Status::Unsure, ["`5.0e-7 m`", "`form.deviation_max` = `2.0e-7 m`, residuals `1.0e-6 m`"]),
            (Status::TooFewSamples, ["`TooFewSamples`", few]),
            (Status::NotObservable, ["`NotObservable`", few]),
            (Status::NotConverged, ["`NotConverged`", few]),
        ] {
            vars.output.calibration.status = status;
            for (corrects, then) in [(false, ": it corrects nothing\n"), (true, ": the correction before stays\n")] {
                let told = form(&vars, corrects).unwrap();
                assert!(parts.iter().chain(&[then, "hint: "]).all(|part| told.contains(part)), "{told}");
            }
        }
        vars.output.calibration.status = Status::Solved;
        assert_eq!(form(&vars, true), None);
    }

    #[test]
    fn every_fault_is_told_with_numbers() {
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
