//! A reading that stands at rest: noise that was there and is gone.
//!
//! Nothing is asked of a stage at rest, so only the last bits tell that its encoder lives. Once they have been seen to
//! change, at rest and after every motion has died out, `limits.rest_time` without any change is no chance: a rounded
//! normal noise of half a step stays at one number with at most 0.68 a sample. A stage at rest has one place, so that every
//! change is a sign of life; a motion forgets it, for at the edge of a step less noise is seen than elsewhere. One that is known to live
//! wherever the stage stands ([`super::life`]) is asked for it from the first sample of a rest on.

use control_blocks::{Frozen, ticks};
use serde::{Deserialize, Serialize};

use crate::interface::Parameters;

/// What is left of a motion has died out after this many times 1 / `servo.bandwidth`.
pub const SETTLING: f64 = 20.0;
/// Share of samples that change by which a reading lives.
const LIVES: f64 = 0.1;
/// A change is more than this share of a step.
const CHANGE: f64 = 0.5;

/// The reading since the stage rests.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Rest {
    samples: u32,
    still: Frozen,
    changing: f64,
    lived: bool,
}

impl Rest {
    /// Begins again, after a motion for instance.
    pub fn clear(&mut self) {
        *self = Self::default();
    }

    /// What is left of the motion before has died out.
    pub fn settled(&self, p: &Parameters) -> bool {
        self.samples > ticks(SETTLING / p.servo.bandwidth, p.sample_period)
    }

    /// Takes one position at rest (m) of a reading that `lives` anywhere, or may not; whether it has lived and now stands.
    pub fn update(&mut self, p: &Parameters, position: f64, lives: bool) -> bool {
        let window = ticks(p.limits.rest_time, p.sample_period);
        self.samples = self.samples.saturating_add(1);
        self.still.update(position, 0.0, CHANGE * p.stage.encoder_resolution);
        if window == 0 {
            return false;
        }
        if self.settled(p) {
            let changed = f64::from(u8::from(self.still.still() == 0));
            self.changing += (changed - self.changing) / f64::from(window);
            self.lived |= self.changing > LIVES;
        }
        (self.lived || lives) && self.still.still() >= window
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Samples of noise until the reading stands, and then until that is told.
    fn told(p: &Parameters, noise: usize, freeze: impl Fn(usize) -> f64) -> Option<usize> {
        let mut rest = Rest::default();
        // steps of 0 and 1 nm in an irregular row
        for k in 0..noise {
            assert!(!rest.update(p, if k * k % 7 < 3 { 1e-9 } else { 0.0 }, false), "{k}");
        }
        (0..5000).find(|k| rest.update(p, freeze(*k), false))
    }

    #[test]
    fn noise_that_is_gone_is_told_after_the_rest_time() {
        let p = Parameters::START;
        assert!(told(&p, 3000, |_| 0.0).is_some_and(|k| (298..=302).contains(&k)));
        assert_eq!(told(&p, 3000, |k| 1e-9 * (k % 300 / 299) as f64), None);
    }

    #[test]
    fn what_never_lived_is_not_told() {
        let p = Parameters::START;
        // only while the motion before dies out
        assert_eq!(told(&p, 1000, |_| 0.0), None);
        let mut unwatched = p.clone();
        unwatched.limits.rest_time = 0.0;
        assert_eq!(told(&unwatched, 3000, |_| 0.0), None);
    }

    #[test]
    fn what_hardly_ever_changed_may_stand() {
        let p = Parameters::START;
        let mut rest = Rest::default();
        // a step of 1 nm every 5 ms: 2 % of the samples
        assert!((0..3000u32).all(|k| !rest.update(&p, 1e-9 * f64::from(k / 50), false)));
        assert!((0..5000).all(|_| !rest.update(&p, 1e-9, false)));
    }

    #[test]
    fn a_motion_forgets_the_life_before() {
        let p = Parameters::START;
        let mut rest = Rest::default();
        assert!((0..3000).all(|k| !rest.update(&p, if k * k % 7 < 3 { 1e-9 } else { 0.0 }, false)));
        rest.clear();
        assert!((0..5000).all(|_| !rest.update(&p, 0.0, false)));
    }

    #[test]
    fn one_that_lives_anywhere_is_asked_from_the_first_sample_of_a_rest_on() {
        let p = Parameters::START;
        for lives in [true, false] {
            let mut rest = Rest::default();
            assert_eq!((0..1000).find(|_| rest.update(&p, 7e-9, lives)), lives.then_some(300));
            rest.clear();
            assert_eq!((0..1000).find(|k| rest.update(&p, 1e-9 * f64::from(k / 250), lives)), None);
        }
    }
}
