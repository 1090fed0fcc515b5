//! Response of an axis to its command: sign, strength, and a command that oscillates.
//!
//! An offset of the drive moves the axis against the command that compensates it, as a drive of the wrong sign does. If
//! the response is the command plus a constant, sign and strength are not evaluated. This is the case if that model
//! leaves less than a quarter of the residual of a drive of any strength, both by least squares.

use control_blocks::{Response, Reversals};
use serde::{Deserialize, Serialize};

use crate::interface::{Fault, Parameters};

/// Samples over which the answer of an axis is compared with its command.
const MEMORY: f64 = 4.0;
/// Counts of motion in a sample from which there is an answer to compare.
pub const EXCITED: f64 = 20.0;
/// Ratio of the commanded motion below which a drive is weak.
const WEAK: f64 = 0.7;
/// Ratio below which it goes the other way.
const OPPOSITE: f64 = -0.2;
/// Ratio of the command for `error_max` from which a command oscillates.
const SPEED_MIN: f64 = 0.1;
/// Reversals of a loop that is not stable, and the longest time between two, samples.
const OSCILLATIONS: (u32, u32) = (3, 20);

/// Ratio of what a drive of another strength leaves, below which an answer is that of a drive with an offset.
const SHIFTED: f64 = 0.25;

/// Sums of an answer m to commands c with the memory of the response.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
struct AnswerSums {
    weight: f64,
    answer: f64,
    command: f64,
    product: f64,
    shift: f64,
    shifts: f64,
}

impl AnswerSums {
    fn update(&mut self, commanded: f64, moved: f64) {
        let keep = 1.0 - MEMORY.recip();
        let shift = moved - commanded;
        for (sum, term) in [
            (&mut self.weight, 1.0),
            (&mut self.answer, moved * moved),
            (&mut self.command, commanded * commanded),
            (&mut self.product, commanded * moved),
            (&mut self.shift, shift),
            (&mut self.shifts, shift * shift),
        ] {
            *sum = keep * *sum + term;
        }
    }

    /// Whether an offset explains the answer and no strength does.
    fn shifted(&self) -> bool {
        let scaled = self.answer - self.product * self.product / self.command.max(f64::MIN_POSITIVE);
        let shifted = self.shifts - self.shift * self.shift / self.weight.max(1.0);
        shifted < SHIFTED * scaled
    }
}

/// The answer of an axis to its commands.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Answer {
    before: f64,
    response: Response,
    sums: AnswerSums,
    reversals: Reversals,
    oscillations: u32,
}

impl Answer {
    /// At rest at a position (rad or m).
    pub fn resting(position: f64) -> Self {
        Self { before: position, ..Self::default() }
    }

    /// Takes the velocity command (rad/s or m/s) that was sent to the axis `axis` (from 0).
    pub fn command(&mut self, p: &Parameters, axis: usize, velocity: f64) {
        let limit = SPEED_MIN * p.servo_gain[axis] * p.limits.axis[axis].error_max;
        self.oscillations = self.reversals.update(velocity, limit, OSCILLATIONS.1);
    }

    /// Takes a measurement and the motion that was commanded for the sample that it ends, rad or m.
    pub fn update(&mut self, position: f64, commanded: f64) {
        let moved = position - self.before;
        self.response.update(commanded, moved, MEMORY);
        self.sums.update(commanded, moved);
        self.before = position;
    }

    /// Ratio of the commanded motion that was done; none where too little was commanded.
    pub fn ratio(&self, pulse: f64) -> Option<f64> {
        self.response.ratio((EXCITED * pulse).powi(2))
    }

    /// `Oscillation`, `DriveSign` or `WeakDrive` if the response shows it; `pulse` is that of the encoder (rad or m).
    /// None for a good response, one that an offset explains, or a motion too small to evaluate.
    pub fn cause(&self, pulse: f64) -> Option<Fault> {
        if self.oscillations >= OSCILLATIONS.0 {
            return Some(Fault::Oscillation);
        }
        match self.ratio(pulse) {
            _ if self.sums.shifted() => None,
            Some(ratio) if ratio < OPPOSITE => Some(Fault::DriveSign),
            Some(ratio) if ratio < WEAK => Some(Fault::WeakDrive),
            _ => None,
        }
    }
}
