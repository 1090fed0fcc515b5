//! Every fault is found here, the gravest first; how it ends; and in `message` the numbers that are told with it.

pub mod message;

use control_blocks::{SafeEnd, ticks};

use crate::interface::{Fault, Parameters, ThresholdOutput};
use crate::reading::{Loss, Reading};

/// Share of the commanded force below which the drive pushes the wrong way.
const WRONG_WAY: f64 = -0.2;
/// Samples in a row that make a disturbance or a following error.
const ROW: u32 = 3;
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
            Self::ContactRejected | Self::LateContact | Self::CommissionRejected | Self::TeachingRejected => {
                SafeEnd::Stop
            }
            Self::LostReading
            | Self::FrozenReading
            | Self::ReadingJump
            | Self::LateReading
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
    /// The reading lives wherever the stage stands, and now does not.
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
    /// While the velocity is unknown: the last readings bend more than any force of this machine bends its path.
    pub bent: bool,
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
    /// What the teaching has learned cannot be used.
    pub mistaught: bool,
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
        (Fault::LateReading, lost(Loss::Jumps) && s.reading.late.is_some()),
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
        (Fault::TeachingRejected, s.mistaught),
        (Fault::NoProgress, s.late),
    ];
    let found = faults.into_iter().find_map(|(fault, found)| found.then_some(fault));
    found.map(|fault| match fault {
        Fault::Overload | Fault::FollowingError if s.bent => Fault::ReadingJump,
        _ => cause(p, fault, s.share),
    })
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

#[cfg(test)]
mod tests;
