//! What the answer of an axis says of its drive: the sign and the strength of it, and a command that swings.

use control_blocks::{Response, Reversals};
use serde::{Deserialize, Serialize};

use crate::interface::{Fault, Parameters};

/// Samples over which the answer of an axis is compared with its command.
const MEMORY: f64 = 4.0;
/// Counts of motion in a sample from which there is an answer to compare.
pub const EXCITED: f64 = 20.0;
/// Share of the commanded motion below which a drive is weak.
const WEAK: f64 = 0.7;
/// Share below which it goes the other way.
const OPPOSITE: f64 = -0.2;
/// Share of the command for `error_max` from which a command swings.
const SWING: f64 = 0.1;
/// Reversals of a loop that is not stable, and the longest time between two, samples.
const SWINGS: (u32, u32) = (3, 20);

/// The answer of an axis to its commands.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Answer {
    before: f64,
    response: Response,
    swing: Reversals,
    swings: u32,
}

impl Answer {
    /// At rest at a position (rad or m).
    pub fn resting(position: f64) -> Self {
        Self { before: position, ..Self::default() }
    }

    /// Takes the velocity command (rad/s or m/s) that was sent to the axis `axis` (from 0).
    pub fn command(&mut self, p: &Parameters, axis: usize, velocity: f64) {
        let limit = SWING * p.servo_gain[axis] * p.limits.axis[axis].error_max;
        self.swings = self.swing.update(velocity, limit, SWINGS.1);
    }

    /// Takes a reading and the motion that was commanded for the sample that it ends, rad or m.
    pub fn update(&mut self, position: f64, commanded: f64) {
        self.response.update(commanded, position - self.before, MEMORY);
        self.before = position;
    }

    /// Share of the commanded motion that was done; none where too little was commanded.
    pub fn share(&self, pulse: f64) -> Option<f64> {
        self.response.share((EXCITED * pulse).powi(2))
    }

    /// What a drive of this answer is a fault by, if anything.
    pub fn cause(&self, pulse: f64) -> Option<Fault> {
        if self.swings >= SWINGS.0 {
            return Some(Fault::Oscillation);
        }
        match self.share(pulse) {
            Some(share) if share < OPPOSITE => Some(Fault::DriveSign),
            Some(share) if share < WEAK => Some(Fault::WeakDrive),
            _ => None,
        }
    }
}
