//! A position that is frozen at rest: its noise was there and is gone.
//!
//! The reference does not move at rest, so only the last bits show that the encoder works. Their change alone proves
//! little: at the edge of a step the stage itself toggles them, and half a step farther they stay constant. An encoder
//! that is known to show noise wherever the stage is ([`super::life`]) must show it from the first sample at rest:
//! [`ROW`] equal samples are then significant, and so is `expert.limits.rest_time` where that is longer.

use control_blocks::{Frozen, ticks};
use serde::{Deserialize, Serialize};

use crate::interface::Parameters;

/// The transient of a motion has decayed after this many times 1 / `servo.bandwidth`.
pub const SETTLING: f64 = 20.0;
/// Number of equal samples that noise of three tenths of a step produces with a probability of 1e-13.
pub const ROW: u32 = 300;
/// Minimum change, as a fraction of a step.
const CHANGE: f64 = 0.5;

/// The reading since the stage rests.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Rest {
    samples: u32,
    still: Frozen,
}

impl Rest {
    /// Begins again, after a motion for instance.
    pub fn clear(&mut self) {
        *self = Self::default();
    }

    /// Whether the transient of the previous motion has decayed.
    pub fn settled(&self, p: &Parameters) -> bool {
        self.lasts(ticks(SETTLING / p.servo.bandwidth, p.sample_period))
    }

    /// Whether the stage has been at rest for more than `samples` samples.
    pub fn lasts(&self, samples: u32) -> bool {
        self.samples > samples
    }

    /// Takes one position at rest (m); `lives`: the encoder shows noise wherever the stage is. Returns whether it
    /// should and is frozen.
    pub fn update(&mut self, p: &Parameters, position: f64, lives: bool) -> bool {
        self.samples = self.samples.saturating_add(1);
        self.still.update(position, 0.0, CHANGE * p.stage.encoder_resolution);
        let window = ticks(p.limits.rest_time, p.sample_period).max(ROW);
        p.limits.rest_time > 0.0 && lives && self.still.still() >= window
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Samples until the position is detected as frozen; it changes by a step every `every` samples.
    fn detected(p: &Parameters, lives: bool, every: u32) -> Option<u32> {
        let mut rest = Rest::default();
        (0..5000).find(|k| rest.update(p, 1e-9 * f64::from(k / every), lives))
    }

    #[test]
    fn one_with_noise_anywhere_and_is_frozen_is_detected_after_the_rest_time() {
        let mut p = Parameters::START;
        assert_eq!(detected(&p, true, 10_000), Some(300));
        assert_eq!(detected(&p, true, 300), None);
        // after a motion, again
        let mut rest = Rest::default();
        assert!((0..300).all(|_| !rest.update(&p, 0.0, true)) && rest.update(&p, 0.0, true));
        rest.clear();
        assert!((0..300).all(|_| !rest.update(&p, 0.0, true)) && rest.update(&p, 0.0, true));
        p.limits.rest_time = 0.1;
        assert_eq!(detected(&p, true, 10_000), Some(1000));
        p.limits.rest_time = 0.0;
        assert_eq!(detected(&p, true, 10_000), None);
    }

    #[test]
    fn one_that_may_have_no_noise_may_be_at_rest() {
        assert_eq!(detected(&Parameters::START, false, 10_000), None);
    }

    #[test]
    fn fewer_equal_samples_than_noise_makes_by_chance_show_nothing() {
        let mut p = Parameters::START;
        for (rest_time, sample_period) in [(0.03, 1e-3), (1e-3, 1e-4), (1e-6, 1e-4)] {
            (p.limits.rest_time, p.sample_period) = (rest_time, sample_period);
            assert_eq!([299, 300, 301].map(|every| detected(&p, true, every)), [None, None, Some(300)]);
        }
    }

    #[test]
    fn what_is_left_of_a_motion_has_died_out_after_a_tenth_of_a_second() {
        let (p, mut rest) = (Parameters::START, Rest::default());
        // 20 / (188 rad/s)
        let settled = (1..2000).find(|_| {
            rest.update(&p, 0.0, false);
            rest.settled(&p)
        });
        assert_eq!(settled, Some(1065));
    }
}
