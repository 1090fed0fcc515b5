//! Whether the error grows from turn to turn: a cancellation or a cut that is not stable.
//!
//! The residual error of a stable loop decays with its time constants, and noise is the same in every revolution. A
//! tool that enters the part, or a step of another kind, is over within two revolutions. An error that rises in four to
//! ten consecutive revolutions, to twice its value, by 1.05 to 4 in each, is unstable: each revolution cuts the error
//! of the one before, and the harmonics learn it with the wrong phase. Another speed means another path, and the count
//! restarts. Below `expert.limits.tracking_error` there is no fault.

use serde::{Deserialize, Serialize};

use crate::interface::Parameters;

/// Smallest and largest number of consecutive revolutions: an error that doubles over more of them follows the path.
const REVOLUTIONS: [u32; 2] = [4, 10];
/// Growth over them.
const GROWTH: f64 = 2.0;
/// Smallest and largest growth in one revolution: noise rises by less, a step of the path by more.
const EACH: [f64; 2] = [1.05, 4.0];
/// Largest change of the speed of the spindle over them.
const STEADY: f64 = 0.01;

/// The turns in which the error has risen; by default none.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub struct GrowthWatch {
    /// error of the last revolution, and the error where it started to rise, root mean square, m
    last: f64,
    begin: f64,
    /// speed of the spindle there, rad/s
    speed: f64,
    revolutions: u32,
}

impl GrowthWatch {
    /// Takes the error over the last full turn (m, root mean square, 0 before the first) and the speed of the spindle
    /// (rad/s).
    pub fn update(&mut self, rms: f64, speed: f64) {
        // the value is constant until the next revolution is complete
        if rms == self.last {
            return;
        }
        let steady = (speed - self.speed).abs() <= STEADY * self.speed.abs();
        let grown = rms > EACH[0] * self.last && rms < EACH[1] * self.last;
        if grown && steady && self.revolutions < REVOLUTIONS[1] {
            self.revolutions += 1;
        } else {
            (self.begin, self.speed, self.revolutions) = (rms, speed, 0);
        }
        self.last = rms;
    }

    /// Consecutive revolutions with a rise, and the error at their start (m, root mean square).
    pub fn rise(&self) -> (u32, f64) {
        (self.revolutions, self.begin)
    }

    /// Whether it grows.
    pub fn grows(&self, p: &Parameters) -> bool {
        self.revolutions >= REVOLUTIONS[0] && self.last >= GROWTH * self.begin && self.last > p.limits.tracking_error
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The first revolution of 30, each of 100 samples, after which the error (um) is growing.
    fn grows(error: impl Fn(i32) -> f64, speed: impl Fn(i32) -> f64) -> Option<i32> {
        let (p, mut watch) = (Parameters::START, GrowthWatch::default());
        (0..30).find(|revolution| {
            (0..100).for_each(|_| watch.update(1e-6 * error(*revolution), speed(*revolution)));
            watch.grows(&p)
        })
    }

    #[test]
    fn an_error_that_doubles_over_four_turns_or_more_grows() {
        assert_eq!(grows(|revolution| 20.0 * 1.19_f64.powi(revolution), |_| 62.8), Some(4));
        assert_eq!(grows(|revolution| 20.0 * 1.10_f64.powi(revolution), |_| -62.8), Some(8));
        // after it fell
        assert_eq!(grows(|revolution| 20.0 * 1.3_f64.powi((revolution - 9).abs()), |_| 62.8), Some(13));
    }

    #[test]
    fn small_errors_and_short_rises_raise_no_fault() {
        assert_eq!(grows(|revolution| (0.05 * 1.19_f64.powi(revolution)).min(19.9), |_| 62.8), None);
        assert_eq!(grows(|revolution| 20.1 * 1.19_f64.powi(revolution.min(3)), |_| 62.8), None);
        assert_eq!(grows(|revolution| 2.0 * 3.0_f64.powi(revolution % 4), |_| 62.8), None);
        // from nothing, and to less than twice
        assert_eq!(
            grows(|revolution| if revolution == 0 { 0.0 } else { 30.0 + 0.9 * f64::from(revolution) }, |_| 62.8),
            None
        );
    }

    #[test]
    fn a_step_among_rising_revolutions_restarts_the_count() {
        assert_eq!(
            grows(|revolution| 20.0 * 1.3_f64.powi(revolution) * if revolution < 3 { 1.0 } else { 3.2 }, |_| 62.8),
            Some(7)
        );
        // less than four times is part of the growth
        assert_eq!(
            grows(|revolution| 20.0 * 1.3_f64.powi(revolution) * if revolution < 3 { 1.0 } else { 3.0 }, |_| 62.8),
            Some(4)
        );
        // and it is detected beyond the largest error alone
        assert_eq!(grows(|revolution| 20.0 / 16.0 * 2.0_f64.powi(revolution), |_| 62.8), Some(5));
    }

    #[test]
    fn a_step_after_noise_that_rose_by_chance_does_not_grow() {
        let error = |revolution: i32| match revolution {
            0..5 => 0.40 + 0.01 * f64::from(revolution),
            5 => 20.0,
            _ => 49.0 + 0.1 * f64::from(revolution),
        };
        assert_eq!(grows(error, |_| 62.8), None);
    }

    #[test]
    fn an_error_that_follows_the_radius_does_not_grow() {
        let (p, mut watch) = (Parameters::START, GrowthWatch::default());
        for revolution in 0..300 {
            watch.update(1e-4 * (1.0 + 0.01 * f64::from(revolution)).powi(2), 62.8);
            assert!(!watch.grows(&p), "turn {revolution}");
        }
    }

    #[test]
    fn at_another_speed_the_count_restarts() {
        assert_eq!(
            grows(|revolution| 20.0 * 1.19_f64.powi(revolution), |revolution| 62.8 * 1.02_f64.powi(revolution)),
            None
        );
        assert_eq!(
            grows(|revolution| 20.0 * 1.19_f64.powi(revolution), |revolution| 62.8 * 1.002_f64.powi(revolution)),
            Some(4)
        );
        assert_eq!(
            grows(
                |revolution| 20.0 * 1.19_f64.powi(revolution),
                |revolution| if revolution < 5 { 62.8 - f64::from(revolution) } else { 60.0 }
            ),
            Some(9)
        );
    }
}
