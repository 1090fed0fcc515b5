//! Motion that was commanded and that the reading of an axis does not answer.
//!
//! A drive has an offset: at rest it stands where the command cancels that, so what is commanded there is not unanswered. What was
//! commanded when the reading last moved while the model stood tells the offset, within what the band of the reading hides. A reading
//! that drifts looks the same; the rest after a run tells either where it is large.

use control_blocks::Frozen;
use serde::{Deserialize, Serialize};

use crate::interface::Parameters;

/// Counts within which a reading stands.
const BAND: f64 = 1.5;
/// Counts in a sample below which the model stands, and for how many times 1/Kp until the axis does, too.
const STANDS: (f64, f64) = (0.1, 4.0);
/// Counts from its place that a reading may be held to have come to rest: the band, half of it in its last step, and rounding.
const HIDDEN: f64 = 3.0;

/// A reading against what was commanded.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Unanswered {
    frozen: Frozen,
    /// motion in a sample that the command makes up for at rest, rad or m
    offset: f64,
    /// time for which the model has stood, s
    rest: f64,
}

impl Default for Unanswered {
    /// At rest.
    fn default() -> Self {
        Self { frozen: Frozen::default(), offset: 0.0, rest: f64::INFINITY }
    }
}

impl Unanswered {
    /// The model of the loop has moved by so many counts in a sample.
    pub fn expect(&mut self, p: &Parameters, counts: f64) {
        self.rest = if counts.abs() < STANDS.0 { self.rest + p.sample_period } else { 0.0 };
    }

    /// Takes a reading of the axis `axis` (from 0) and the motion that was commanded for the sample that it ends, rad or m.
    pub fn update(&mut self, p: &Parameters, axis: usize, position: f64, commanded: f64) {
        let (kp, pulse) = (p.servo_gain[axis], p.axis[axis].pulse);
        let hidden = HIDDEN * pulse * kp * p.sample_period;
        let beyond = commanded - self.offset;
        self.frozen.update(position, beyond - beyond.clamp(-hidden, hidden), BAND * pulse);
        if self.frozen.still() == 0 && kp * self.rest > STANDS.1 {
            self.offset = commanded;
        }
    }

    /// Whether the reading has stood for longer than is bridged.
    pub fn stands(&self, p: &Parameters) -> bool {
        self.frozen.still() > p.limits.lost_samples.unsigned_abs()
    }

    /// The motion, rad or m, not negative.
    pub fn motion(&self) -> f64 {
        self.frozen.unanswered()
    }
}
