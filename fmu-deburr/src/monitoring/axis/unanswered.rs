//! Commanded motion without a response of the position.
//!
//! A drive has an offset. At rest the axis is where the command cancels it, and what is commanded there is not without
//! response. The command at the last change of the position while the model was at rest is the offset, within the band
//! of the position. An offset that comes in motion, or immediately with an axis at rest, comes to rest before the
//! model. It is then the difference between commanded and measured motion, in the last travel of one band. The rest
//! without response is a fault, but not one of the position, which would have moved as commanded before it froze. A
//! position that drifts looks like an offset; the rest after a run detects both if they are large.

use control_blocks::Frozen;
use serde::{Deserialize, Serialize};

use crate::interface::Parameters;

/// Counts within which a position is frozen.
const BAND: f64 = 1.5;
/// Counts in a sample below which the model is at rest, and the time in 1/Kp until the axis is at rest, too.
const STOPPED: (f64, f64) = (0.1, 4.0);
/// Counts from its position that a measurement may be held to have come to rest: the band, half of it in its last step,
/// and rounding.
const HIDDEN: f64 = 3.0;

/// Ratio of what is commanded that an offset must leave, at most, to explain it.
const EXPLAINED: f64 = 0.5;

/// Counts by which rounding changes a measured travel, at its start and at its end.
const ROUNDED: f64 = 2.0;
/// Velocity command from which no offset explains it, in Kp `error_max`: an offset of half of it displaces the axis at
/// rest by `error_max`.
const LARGEST: f64 = 2.0;

/// A measurement against what was commanded.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Unanswered {
    frozen: Frozen,
    /// motion in a sample that the command makes up for at rest, rad or m
    offset: f64,
    /// what of the commanded motion was missing in the last way of the measurement, in a sample, how unsure that is,
    /// and whether it explains what is commanded now
    missing: f64,
    uncertain: f64,
    explained: bool,
    /// where the measurement last moved to, what was commanded since, rad or m, and in how many samples
    origin: f64,
    commanded: f64,
    samples: u32,
    /// time for which the model has been at rest, s; none before the first command
    rest: Option<f64>,
}

impl Unanswered {
    /// From a position (rad or m) on; the first command shows whether the axis is at rest there.
    pub fn resting(position: f64) -> Self {
        Self {
            frozen: Frozen::default(),
            offset: 0.0,
            missing: 0.0,
            uncertain: 0.0,
            explained: false,
            origin: position,
            commanded: 0.0,
            samples: 0,
            rest: None,
        }
    }

    /// Motion of the loop model in a sample, counts, past or future.
    pub fn expect(&mut self, p: &Parameters, counts: f64) {
        let stopped = counts.abs() < STOPPED.0;
        self.rest = Some(if stopped { self.rest.map_or(f64::INFINITY, |rest| rest + p.sample_period) } else { 0.0 });
    }

    /// Takes a measurement of the axis `axis` (from 0) and the motion that was commanded for the sample that it ends,
    /// rad or m.
    pub fn update(&mut self, p: &Parameters, axis: usize, position: f64, commanded: f64) {
        let (kp, pulse) = (p.servo_gain[axis], p.axis[axis].pulse);
        let decay = kp * p.sample_period;
        let hidden = HIDDEN * pulse * decay;
        let beyond = commanded - self.offset;
        self.frozen.update(position, beyond - beyond.clamp(-hidden, hidden), BAND * pulse);
        (self.commanded, self.samples) = (self.commanded + commanded, self.samples.saturating_add(1));
        if self.frozen.still() == 0 {
            self.missing = (self.commanded - (position - self.origin)) / f64::from(self.samples);
            self.uncertain = ROUNDED * pulse / f64::from(self.samples);
            if self.rests(kp) {
                self.offset = commanded;
            }
            (self.origin, self.commanded, self.samples) = (position, 0.0, 0);
        }
        let large = LARGEST * decay * p.limits.axis[axis].error_max;
        let certain = self.uncertain.max((commanded - self.missing).abs()) < EXPLAINED * commanded.abs();
        self.explained = certain && commanded.abs() < large;
    }

    /// Whether the model has been at rest until the axis is, too; `kp` in 1/s.
    fn rests(&self, kp: f64) -> bool {
        self.rest.is_some_and(|rest| kp * rest > STOPPED.1)
    }

    /// Whether the position has been constant for longer than is bridged.
    pub fn stopped(&self, p: &Parameters) -> bool {
        self.frozen.still() > p.limits.lost_samples.unsigned_abs()
    }

    /// Whether an offset of the drive explains it, and no measurement that has frozen.
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
        // twice Kp T of a millimeter
        for (commanded, explained) in [(2.5e-4, true), (2.7e-4, false), (-2.5e-4, true), (-2.7e-4, false)] {
            let mut axis = Unanswered::resting(0.0);
            // a tenth of it is answered, then nothing
            axis.update(&p, 2, 0.1 * commanded, commanded);
            axis.update(&p, 2, 0.1 * commanded, commanded);
            assert_eq!(axis.explained(), explained, "{commanded} m");
        }
    }
    #[test]
    fn a_measurement_is_constant_for_more_samples_than_are_bridged() {
        let mut p = Parameters::START;
        for bridged in [0, 3, 10] {
            p.limits.lost_samples = bridged;
            let mut axis = Unanswered::resting(0.0);
            // far from where it was, then there
            let stopped: Vec<_> = (0..20)
                .map(|_| {
                    axis.update(&p, 2, 0.5, 1e-3);
                    axis.stopped(&p)
                })
                .collect();
            assert_eq!(stopped.iter().position(|stopped| *stopped), Some(bridged as usize + 1));
        }
    }
}
