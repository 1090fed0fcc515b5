//! Motion that was commanded and that the reading of an axis does not answer.
//!
//! A drive has an offset: at rest it stands where the command cancels that, so what is commanded there is not unanswered. What was
//! commanded when the reading last moved while the model stood tells the offset, within what the band of the reading hides. One that
//! comes in motion, or at once where the axis stands, has come to rest before the model has: what the reading moved less than was
//! commanded, in its last way of a band, tells it then. What it leaves unanswered is a fault, but not one of the reading, which had moved
//! as commanded if it froze. A reading that drifts looks as an offset does; the rest after a run tells either where it is large.

use control_blocks::Frozen;
use serde::{Deserialize, Serialize};

use crate::interface::Parameters;

/// Counts within which a reading stands.
const BAND: f64 = 1.5;
/// Counts in a sample below which the model stands, and for how many times 1/Kp until the axis does, too.
const STANDS: (f64, f64) = (0.1, 4.0);
/// Counts from its place that a reading may be held to have come to rest: the band, half of it in its last step, and rounding.
const HIDDEN: f64 = 3.0;

/// Share of what is commanded that an offset must leave, at most, to explain it.
const EXPLAINED: f64 = 0.5;

/// Counts by which a way of the reading is rounded, at its begin and at its end.
const ROUNDED: f64 = 2.0;
/// What is commanded that no offset explains, in Kp `error_max`: half of it leaves the axis where no axis may be.
const LARGEST: f64 = 2.0;

/// A reading against what was commanded.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Unanswered {
    frozen: Frozen,
    /// motion in a sample that the command makes up for at rest, rad or m
    offset: f64,
    /// what of the commanded motion was missing in the last way of the reading, in a sample, how unsure that is, and whether it
    /// explains what is commanded now
    missing: f64,
    unsure: f64,
    explained: bool,
    /// where the reading last moved to, what was commanded since, rad or m, and in how many samples
    place: f64,
    commanded: f64,
    samples: u32,
    /// time for which the model has stood, s; none before the first command
    rest: Option<f64>,
}

impl Unanswered {
    /// From a position (rad or m) on; the first command tells whether the axis rests there.
    pub fn resting(position: f64) -> Self {
        Self {
            frozen: Frozen::default(),
            offset: 0.0,
            missing: 0.0,
            unsure: 0.0,
            explained: false,
            place: position,
            commanded: 0.0,
            samples: 0,
            rest: None,
        }
    }

    /// The model of the loop has moved by so many counts in a sample, or will.
    pub fn expect(&mut self, p: &Parameters, counts: f64) {
        let stands = counts.abs() < STANDS.0;
        self.rest = Some(if stands { self.rest.map_or(f64::INFINITY, |rest| rest + p.sample_period) } else { 0.0 });
    }

    /// Takes a reading of the axis `axis` (from 0) and the motion that was commanded for the sample that it ends, rad or m.
    pub fn update(&mut self, p: &Parameters, axis: usize, position: f64, commanded: f64) {
        let (kp, pulse) = (p.servo_gain[axis], p.axis[axis].pulse);
        let turns = kp * p.sample_period;
        let hidden = HIDDEN * pulse * turns;
        let beyond = commanded - self.offset;
        self.frozen.update(position, beyond - beyond.clamp(-hidden, hidden), BAND * pulse);
        (self.commanded, self.samples) = (self.commanded + commanded, self.samples.saturating_add(1));
        if self.frozen.still() == 0 {
            self.missing = (self.commanded - (position - self.place)) / f64::from(self.samples);
            self.unsure = ROUNDED * pulse / f64::from(self.samples);
            if self.rests(kp) {
                self.offset = commanded;
            }
            (self.place, self.commanded, self.samples) = (position, 0.0, 0);
        }
        let large = LARGEST * turns * p.limits.axis[axis].error_max;
        let told = self.unsure.max((commanded - self.missing).abs()) < EXPLAINED * commanded.abs();
        self.explained = told && commanded.abs() < large;
    }

    /// Whether the model has stood until the axis does, too; `kp` in 1/s.
    fn rests(&self, kp: f64) -> bool {
        self.rest.is_some_and(|rest| kp * rest > STANDS.1)
    }

    /// Whether the reading has stood for longer than is bridged.
    pub fn stands(&self, p: &Parameters) -> bool {
        self.frozen.still() > p.limits.lost_samples.unsigned_abs()
    }

    /// Whether an offset of the drive explains it, and no reading that has frozen.
    pub fn explained(&self) -> bool {
        self.explained
    }

    /// The motion, rad or m, not negative.
    pub fn motion(&self) -> f64 {
        self.frozen.unanswered()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_offset_explains_a_command_of_which_half_would_leave_the_axis_where_none_may_be() {
        let p = Parameters::START;
        // twice Kp T of a millimetre
        for (commanded, explained) in [(2.5e-4, true), (2.7e-4, false), (-2.5e-4, true), (-2.7e-4, false)] {
            let mut axis = Unanswered::resting(0.0);
            // a tenth of it is answered, then nothing
            axis.update(&p, 2, 0.1 * commanded, commanded);
            axis.update(&p, 2, 0.1 * commanded, commanded);
            assert_eq!(axis.explained(), explained, "{commanded} m");
        }
    }
    #[test]
    fn a_reading_stands_for_more_samples_than_are_bridged() {
        let mut p = Parameters::START;
        for bridged in [0, 3, 10] {
            p.limits.lost_samples = bridged;
            let mut axis = Unanswered::resting(0.0);
            // far from where it was, then there
            let stands: Vec<_> = (0..20)
                .map(|_| {
                    axis.update(&p, 2, 0.5, 1e-3);
                    axis.stands(&p)
                })
                .collect();
            assert_eq!(stands.iter().position(|stands| *stands), Some(bridged as usize + 1));
        }
    }
}
