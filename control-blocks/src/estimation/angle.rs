//! Angles that may be wrapped: their shortest difference, and their sum without jumps.
//!
//! An angle and the same with k revolutions, a - 2 pi k, are one direction. With k = round(a / 2 pi) the remainder is
//! the shortest difference, within pi. Steps below pi per sample add up to the angle without wraps.

use std::f64::consts::{PI, TAU};

use serde::{Deserialize, Serialize};

/// The same direction within -pi to pi (rad); an angle that is already there is left as it is, to the last bit.
pub fn wrap(angle: f64) -> f64 {
    if angle.abs() <= PI { angle } else { angle - TAU * (angle / TAU).round() }
}

/// The same direction from -pi up to, without, pi (rad): pi has one sign only, but the result is rounded.
pub fn wrap_half_open(angle: f64) -> f64 {
    (angle + PI).rem_euclid(TAU) - PI
}

/// Converts samples of an angle, wrapped or not, into steps; before the first there is none.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Unwrapper {
    before: Option<f64>,
}

impl Unwrapper {
    /// Adds the next sample (rad); the shortest difference (rad) from the last one, none for the first.
    pub fn step(&mut self, reading: f64) -> Option<f64> {
        self.before.replace(reading).map(|before| wrap(reading - before))
    }

    /// The last sample, rad.
    pub fn reading(&self) -> Option<f64> {
        self.before
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Angles over many revolutions in both directions, none at pi.
    fn angles() -> impl Iterator<Item = f64> {
        (-20_000..=20_000).map(|k| 0.0037 * f64::from(k))
    }

    #[test]
    fn the_direction_stays_and_the_range_holds() {
        for angle in angles() {
            for wrapped in [wrap(angle), wrap_half_open(angle)] {
                assert!(wrapped.abs() <= PI, "{angle}: {wrapped}");
                assert!((wrapped.sin() - angle.sin()).abs() < 1e-13 && (wrapped.cos() - angle.cos()).abs() < 1e-13);
            }
        }
    }

    #[test]
    fn what_is_in_range_keeps_its_bits() {
        for angle in angles().map(|angle| angle / 74.0 * PI).filter(|angle| angle.abs() < PI) {
            assert_eq!(wrap(angle).to_bits(), angle.to_bits());
            // the same without the condition, except for -0 and pi
            assert_eq!(angle - TAU * (angle / TAU).round(), angle);
        }
        assert_eq!((wrap(PI), wrap(-PI)), (PI, -PI));
    }

    #[test]
    fn half_a_revolution_has_one_sign() {
        assert_eq!((wrap_half_open(PI), wrap_half_open(-PI), wrap_half_open(3.0 * PI)), (-PI, -PI, -PI));
    }

    #[test]
    fn steps_add_up_to_the_angle_without_wraps() {
        for read in [|angle| angle, |angle: f64| angle.rem_euclid(TAU), wrap] {
            let mut unwrapper = Unwrapper::default();
            assert_eq!((unwrapper.reading(), unwrapper.step(read(1.0))), (None, None));
            let mut sum = 1.0;
            // 2.9 rad per sample forward, then back
            for k in 1..=2000 {
                let angle = 1.0 + 2.9 * f64::from(if k <= 1000 { k } else { 2000 - k });
                sum += unwrapper.step(read(angle)).unwrap();
                assert!((sum - angle).abs() < 1e-9, "sample {k}");
                assert_eq!(unwrapper.reading(), Some(read(angle)));
            }
        }
    }
}
