//! Every fault is found here, the highest severity first; `message` makes the details for the log.

pub mod message;

use control_blocks::ticks;

use crate::interface::{Fault, Parameters, ThresholdOutput};
use crate::reading::{Loss, Reading};

/// Ratio of measured to commanded acceleration below which the drive pushes the wrong way.
const WRONG_DIRECTION: f64 = -0.2;
/// Consecutive samples that make a disturbance or a following error.
const ROW: u32 = 3;
/// Consecutive reversals that make an oscillation.
const REVERSALS: u32 = 6;

/// Symptoms of one sample from which faults are found.
#[derive(Clone, Copy)]
pub struct Symptoms<'a> {
    /// The inputs of this sample.
    pub reading: &'a Reading,
    /// The communication step is longer than a sample.
    pub long_step: bool,
    /// The position has shown noise at rest before, and now does not change.
    pub frozen_at_rest: bool,
    /// The spindle must be steady.
    pub steady_spindle: bool,
    /// Consecutive samples with the current at its limit.
    pub limited: u32,
    /// Consecutive reversals of the current from limit to limit.
    pub reversals: u32,
    /// Consecutive reversals of the inertial force while the reference does not accelerate.
    pub oscillations: u32,
    /// Consecutive samples with a following error beyond its limit.
    pub diverged: u32,
    /// Consecutive samples with a disturbance beyond its limit.
    pub overloaded: u32,
    /// While the velocity is unknown: the second difference of the position is larger than any force of this machine
    /// explains.
    pub bent: bool,
    /// Ratio of measured to commanded acceleration of the stage, where it is known.
    pub gain_ratio: Option<f64>,
    /// The drive is to be evaluated by that ratio now.
    pub evaluated: bool,
    /// The approach, stopped now, would end beyond its longest travel.
    pub travelled: bool,
    /// Statistics that have just been learned.
    pub learned: Option<ThresholdOutput>,
    /// Learning takes too long.
    pub learning: bool,
    /// Change of the force from before the contact to after the retract, N.
    pub residual_force: Option<f64>,
    /// The force guard has found the contact, not the detector.
    pub guarded: bool,
    /// The result of the commissioning run is rejected.
    pub rejected: bool,
    /// The result of the calibration cycle is rejected.
    pub calibration_rejected: bool,
    /// The cycle or the commissioning run takes too long.
    pub late: bool,
}

/// The fault of highest severity in this sample.
pub fn find(p: &Parameters, symptoms: &Symptoms) -> Option<Fault> {
    let s = symptoms;
    let beyond = |samples: u32| samples > p.limits.lost_samples.unsigned_abs();
    let lost = |loss| beyond(s.reading.lost) && s.reading.loss == loss;
    let weak = s.evaluated && s.gain_ratio.is_some_and(|ratio| ratio < p.limits.drive_gain_ratio);
    let learned = |learned: ThresholdOutput| !learned.plausible(p.limits.slope_sigma_max);
    let faults = [
        (Fault::LongStep, s.long_step),
        (Fault::PositionFrozen, s.frozen_at_rest || lost(Loss::Frozen)),
        (Fault::PositionDelayed, lost(Loss::Jumps) && s.reading.late.is_some()),
        (Fault::PositionJump, lost(Loss::Jumps)),
        (Fault::PositionLost, lost(Loss::Invalid)),
        (Fault::Oscillation, s.reversals.max(s.oscillations) >= REVERSALS),
        (Fault::Saturation, s.limited > ticks(p.limits.saturated_time, p.sample_period)),
        (Fault::FollowingError, s.diverged >= ROW),
        (Fault::Overload, s.overloaded >= ROW),
        (Fault::WeakDrive, weak),
        (Fault::SpindleLost, beyond(s.reading.invalid)),
        (Fault::SpindleJump, s.steady_spindle && beyond(s.reading.spindle_lost)),
        (Fault::TravelLimit, s.travelled),
        (Fault::LearnRejected, s.learned.is_some_and(learned)),
        (Fault::LearnTimeout, s.learning),
        (Fault::ContactRejected, s.residual_force.is_some_and(|force| force.abs() > p.limits.residual_force)),
        (Fault::LateContact, s.guarded),
        (Fault::CommissionRejected, s.rejected),
        (Fault::CalibrationRejected, s.calibration_rejected),
        (Fault::NoProgress, s.late),
    ];
    let found = faults.into_iter().find_map(|(fault, found)| found.then_some(fault));
    found.map(|fault| match fault {
        Fault::Overload | Fault::FollowingError if s.bent => Fault::PositionJump,
        _ => cause(p, fault, s.gain_ratio),
    })
}

/// The cause of a fault: a stage that does not follow, or is where it cannot be, may have a drive that pushes the wrong
/// way; one that only does not follow may have a weak drive.
fn cause(p: &Parameters, fault: Fault, gain_ratio: Option<f64>) -> Fault {
    use Fault::{FollowingError, Oscillation, Overload, PositionJump, Saturation, WeakDrive};
    let Some(ratio) = gain_ratio else { return fault };
    match fault {
        Oscillation | Saturation | FollowingError | Overload | WeakDrive | PositionJump if ratio < WRONG_DIRECTION => {
            Fault::DriveSign
        }
        Saturation | FollowingError | Overload if ratio < p.limits.drive_gain_ratio => WeakDrive,
        _ => fault,
    }
}

#[cfg(test)]
mod tests;
