//! A signal that moves faster than the machine can.
//!
//! With the maximum speed v, the sample period T and the spread w of the noise a value is accepted while
//! |y - y_b| <= n v T + w, where y_b is the last accepted one, n samples ago. A single wrong sample is replaced by the one
//! before it. A signal that stays away is within reach again after |jump| / (v T) samples, or is reported as lost before.
//! If a model predicts the motion of the sample, y_b moves with it ([`JumpGuard::shift`]), and v T is only the
//! error of the model.

use serde::{Deserialize, Serialize};

/// The last accepted value and the samples since.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct JumpGuard {
    accepted: Option<f64>,
    doubted: u32,
}

/// Allowed motion of a signal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reach {
    /// Maximum motion in one sample, in the unit of the signal.
    pub motion: f64,
    /// Maximum difference of two values at rest.
    pub spread: f64,
}

impl JumpGuard {
    /// Accepts the next value, whatever it is.
    pub fn clear(&mut self) {
        *self = Self::default();
    }

    /// Moves the last accepted value by the known motion of the machine since, in the unit of the signal.
    pub fn shift(&mut self, motion: f64) {
        self.accepted = self.accepted.map(|accepted| accepted + motion);
    }

    /// Whether the machine can be at `reading`; always true before the first accepted value.
    pub fn reaches(&self, reading: f64, reach: Reach) -> bool {
        let samples = f64::from(self.doubted.saturating_add(1));
        let allowed = samples * reach.motion + reach.spread;
        reading.is_finite() && self.accepted.is_none_or(|accepted| (reading - accepted).abs() <= allowed)
    }

    /// The value to use: `reading` if the machine can be there, otherwise the last accepted one.
    ///
    /// A value that is not finite is rejected; without any accepted one the result is 0.
    pub fn update(&mut self, reading: f64, reach: Reach) -> f64 {
        if self.reaches(reading, reach) {
            *self = Self { accepted: Some(reading), doubted: 0 };
        } else {
            self.doubted = self.doubted.saturating_add(1);
        }
        self.accepted.unwrap_or_default()
    }

    /// Assumed position of the machine; none before the first accepted value.
    pub fn accepted(&self) -> Option<f64> {
        self.accepted
    }

    /// Consecutive values that were rejected.
    pub fn doubted(&self) -> u32 {
        self.doubted
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const REACH: Reach = Reach { motion: 0.1, spread: 0.025 };

    #[test]
    fn the_fastest_motion_is_accepted_and_a_faster_one_is_not() {
        let mut guard = JumpGuard::default();
        for k in 0..100 {
            let reading = 0.1 * f64::from(k) + if k % 2 == 0 { 0.01 } else { -0.01 };
            assert_eq!(guard.update(reading, REACH), reading);
        }
        assert_eq!(guard.doubted(), 0);
        let before = guard.update(9.9, REACH);
        assert_eq!((guard.update(10.026, REACH), guard.doubted()), (before, 1));
    }

    #[test]
    fn one_bad_sample_moves_nothing() {
        for bad in [1e9, -50.0, f64::NAN, f64::INFINITY] {
            let mut guard = JumpGuard::default();
            guard.update(1.0, REACH);
            assert_eq!((guard.update(bad, REACH), guard.doubted()), (1.0, 1));
            assert_eq!((guard.update(1.05, REACH), guard.doubted()), (1.05, 0));
        }
    }

    #[test]
    fn what_stays_away_is_doubted_until_the_machine_could_be_there() {
        let mut guard = JumpGuard::default();
        guard.update(0.0, REACH);
        // 1.0 is within n 0.1 + 0.025 from n = 10 on
        let doubted = (0..12).map(|_| (guard.update(1.0, REACH), guard.doubted())).collect::<Vec<_>>();
        assert_eq!(doubted[8], (0.0, 9));
        assert_eq!(doubted[9], (1.0, 0));
    }

    #[test]
    fn a_foreseen_motion_needs_no_reach() {
        let mut guard = JumpGuard::default();
        let near = Reach { motion: 0.0, spread: 0.5 };
        guard.update(0.0, near);
        for k in 1..10 {
            guard.shift(3.0);
            let reading = 3.0 * f64::from(k);
            // one sample in the middle is bad: the model bridges it
            let expected = (reading, u32::from(k == 5));
            let given = if k == 5 { reading + 0.6 } else { reading };
            assert_eq!((guard.update(given, near), guard.doubted()), expected);
        }
    }

    #[test]
    fn nothing_is_accepted_before_the_first_good_reading() {
        let mut guard = JumpGuard::default();
        assert_eq!((guard.update(f64::NAN, REACH), guard.doubted()), (0.0, 1));
        assert_eq!(guard.update(7.0, REACH), 7.0);
    }
}
