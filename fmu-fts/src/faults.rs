//! Every fault is named here, how it ends, and the numbers that are told with it.

use control_blocks::SafeEnd;

use crate::interface::{Fault, Parameters, Vars};
use crate::path::feasibility::{available_torque, needed_torque};
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
    /// The path that is asked for, if one is.
    pub path: Option<&'a PathTable>,
    /// The slide is where the path has no table, and it is not the end of the cut.
    pub outside: bool,
    /// Spindle speed, rad/s.
    pub spindle_speed: f64,
}

impl Fault {
    /// Whether a torque does to the arm what it should, as far as is known.
    pub fn drive_obeys(self) -> bool {
        !matches!(
            self,
            Self::DriveSign
                | Self::WeakDrive
                | Self::Oscillation
                // which a drive that does not obey may cause
                | Self::FollowingError
                | Self::Saturation
                // of whose commands the last alone is seen
                | Self::LongStep
        )
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
            | Self::LostSlide
            | Self::NoProgress
            | Self::Divergence => SafeEnd::Retract,
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
    let arm = missing.arm.map(|loss| match loss {
        Loss::Invalid => Fault::LostReading,
        Loss::Frozen => Fault::FrozenReading,
        Loss::Jump => Fault::ReadingJump,
    });
    now.long_step
        .then_some(Fault::LongStep)
        .or(arm)
        .or(now.found)
        .or(missing.hold.then_some(Fault::InvalidInput))
        .or(now.path.and_then(|path| {
            let axis = |loss: Option<Loss>, own| {
                loss.map(|loss| if loss == Loss::Invalid { Fault::InvalidInput } else { own })
            };
            let infeasible = needed_torque(p, path, spindle_speed) > available_torque(p);
            axis(missing.spindle, Fault::LostSpindle)
                .or(axis(missing.slide, Fault::LostSlide))
                .or(now.feed_lost.then_some(Fault::LostSlide))
                .or(now.outside.then_some(Fault::OutsideTable))
                .or(infeasible.then_some(Fault::Infeasible))
        }))
        .or(now.overdue.then_some(Fault::NoProgress))
}

/// The numbers behind a fault.
pub fn numbers(vars: &Vars) -> String {
    let Vars { input, output, in_force: p, .. } = vars;
    let share =
        format!("`{:.2}` of what the torque should do, at least `{}`", output.drive_share, p.limits.drive_share);
    match output.fault {
        Fault::None => String::new(),
        Fault::FollowingError => format!(
            ": `{:.3} mm`, limit `{} mm`; the arm does {share}",
            1e3 * output.error.tracking,
            1e3 * p.limits.following_error
        ),
        Fault::DriveSign | Fault::WeakDrive | Fault::Saturation | Fault::Oscillation => {
            format!(": the arm does {share}; torque limit `{} N.m`", p.servo.torque_max)
        }
        Fault::NoProgress => format!(
            ": error over a turn `{:.1} um`, limit `{:.1} um`; `limits.job_time` = `{} s`",
            1e6 * output.error.rms,
            1e6 * p.limits.tracking_error,
            p.limits.job_time
        ),
        Fault::Divergence => format!(
            ": doubled from turn to turn, to `{:.1} um`, beyond `limits.tracking_error` = `{:.1} um`",
            1e6 * output.error.rms,
            1e6 * p.limits.tracking_error
        ),
        Fault::Infeasible => format!(
            ": needed `{:.3} N.m` at `{:.2} rad/s`, available `{:.3} N.m`",
            output.path_torque,
            output.spindle_speed,
            available_torque(p)
        ),
        Fault::LongStep => format!(": limit `{} s`", p.sample_period),
        Fault::OutsideTable => format!(": `slide_position` = `{} m`", input.slide_position),
        Fault::LostReading | Fault::FrozenReading | Fault::ReadingJump => format!(
            ": `arm_angle` = `{} rad`, wanted `{} rad`, more than `{}` readings",
            input.arm_angle, output.reference.angle, p.limits.lost_samples
        ),
        Fault::InvalidInput | Fault::LostSpindle | Fault::LostSlide => format!(
            ": `spindle_angle` = `{} rad`, `slide_position` = `{} m`, `hold_angle` = `{} rad`",
            input.spindle_angle, input.slide_position, input.hold_angle
        ),
    }
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_arm_moves_on_only_where_encoder_drive_and_loop_obey() {
        for fault in Fault::ALL {
            let end = match fault {
                Fault::None | Fault::Infeasible | Fault::OutsideTable | Fault::InvalidInput => SafeEnd::Retract,
                Fault::LostSpindle | Fault::LostSlide | Fault::NoProgress | Fault::Divergence => SafeEnd::Retract,
                Fault::LostReading | Fault::FrozenReading | Fault::ReadingJump => SafeEnd::DriveOff,
                Fault::DriveSign | Fault::WeakDrive | Fault::Oscillation => SafeEnd::DriveOff,
                Fault::FollowingError | Fault::Saturation | Fault::LongStep => SafeEnd::DriveOff,
            };
            assert_eq!(fault.safe_end(), end, "{fault:?}");
        }
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
