//! Following error of the slide, and its cause.

use control_blocks::{Consecutive, Following, Frozen, Response, Trajectory};
use serde::{Deserialize, Serialize};

use crate::interface::{Fault, Parameters};
use crate::sensing::RESOLUTION;

/// Time over which the gain ratio of the motion is computed, s (default: longer than the lag of a servo, and shorter
/// than the time in which a slide without drive reaches the limit).
const MEMORY: f64 = 0.02;
/// Minimum motion in that time for a meaningful ratio, m.
const EXCITED: f64 = 1e-6;
/// Fraction of the following error without a response of a frozen encoder.
const UNANSWERED: f64 = 0.5;
/// A slide with a smaller gain ratio moves backwards; one below the second value is weak.
const BACKWARDS: f64 = -0.2;
const WEAK: f64 = 0.5;
/// Fraction of `limits.following_error` allowed at a constant setpoint (default: 50 um; 0.7 N of the probe are
/// 12 um on the slowest servo).
const AT_REST: f64 = 0.05;
/// Time for which it may be larger, s (default: 20 times 1 / w of the slowest servo).
const REST_TIME: f64 = 0.25;

/// Comparison of setpoint and slide; by default before the first sample.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct DriveMonitor {
    following: Following,
    before: Option<Place>,
    frozen: Frozen,
    response: Response,
    /// samples with a constant setpoint, and the slide off it
    away: Consecutive,
    error: f64,
    allowed: f64,
}

/// One sample of both, m.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
struct Place {
    setpoint: f64,
    slide: f64,
}

impl DriveMonitor {
    /// Adds the last setpoint and the slide position (m) that responds to it; `ahead` (m) is the intended distance of
    /// the setpoint beyond the ring.
    pub fn update(&mut self, p: &Parameters, setpoint: &Trajectory, ahead: f64, slide: f64) {
        if self.before.is_none() {
            self.following = Following::resting(setpoint.position);
        }
        self.error = self.following.update(setpoint.position, slide, p.io_delay.unsigned_abs() as usize);
        let now = Place { setpoint: self.error + slide, slide };
        let before = self.before.replace(now).unwrap_or(now);
        let (commanded, done) = (now.setpoint - before.setpoint, now.slide - before.slide);
        self.frozen.update(slide, commanded, RESOLUTION);
        let samples = MEMORY / p.sample_period;
        self.response.update(commanded, done, samples);
        let moving = setpoint.velocity.abs() * p.sample_period;
        self.allowed = p.limits.following_error + moving + ahead.abs();
        let limit_at_rest = AT_REST * p.limits.following_error + ahead.abs();
        let constant = setpoint.velocity == 0.0 && commanded.abs() < RESOLUTION;
        if self.away.update(constant && self.error.abs() > limit_at_rest) > p.ticks(REST_TIME) {
            self.allowed = limit_at_rest;
        }
    }

    /// Setpoint minus position, m.
    pub fn error(&self) -> f64 {
        self.error
    }

    /// Limit of the following error, m.
    pub fn allowed(&self) -> f64 {
        self.allowed
    }

    /// Ratio of recent slide travel to commanded travel; 1 if the motion was too small.
    pub fn ratio(&self, p: &Parameters) -> f64 {
        // the smallest sum of squares for this way: evenly in all samples
        let samples = MEMORY / p.sample_period;
        self.response.ratio(EXCITED.powi(2) / samples).unwrap_or(1.0)
    }

    /// Number of samples for which the slide has been at rest within the resolution.
    pub fn still(&self) -> u32 {
        self.frozen.still()
    }

    /// The cause of an error above the limit.
    pub fn fault(&self, p: &Parameters) -> Option<Fault> {
        if self.error.abs() <= self.allowed {
            return None;
        }
        let ratio = self.ratio(p);
        Some(if self.frozen.unanswered() > UNANSWERED * self.error.abs() {
            Fault::PositionFrozen
        } else if ratio < BACKWARDS {
            Fault::DriveSign
        } else if ratio < WEAK {
            Fault::WeakDrive
        } else {
            Fault::FollowingError
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const P: Parameters = Parameters::START;

    /// The first fault, and the error (m) at that time, of a slide commanded to move at 0.1 m/s for 0.3 s.
    fn found(slide: impl Fn(f64) -> f64) -> Option<(Fault, f64)> {
        let mut drive = DriveMonitor::default();
        (0..300u32).find_map(|k| {
            let commanded = |k: u32| 1e-4 * f64::from(k);
            // what is read answers the setpoint of `io_delay` samples before the last
            let setpoint = Trajectory { position: commanded(k), velocity: 0.1, acceleration: 0.0 };
            drive.update(&P, &setpoint, 0.0, slide(commanded(k.saturating_sub(P.io_delay as u32))));
            drive.fault(&P).map(|fault| (fault, drive.error()))
        })
    }

    #[test]
    fn a_slide_that_follows_has_no_fault() {
        assert_eq!(found(|commanded| commanded), None);
        assert_eq!(found(|commanded| commanded - 9e-4), None);
    }

    #[test]
    fn every_cause_has_its_name_at_the_same_limit() {
        type Cause = (Fault, fn(f64) -> f64);
        let causes: [Cause; 4] = [
            (Fault::DriveSign, |commanded| -commanded),
            (Fault::WeakDrive, |commanded| 0.3 * commanded),
            (Fault::FollowingError, |commanded| 0.9 * commanded),
            (Fault::PositionFrozen, |commanded| 1e-5 * (1e4 * commanded).sin()),
        ];
        for (fault, slide) in causes {
            let (name, error) = found(slide).unwrap();
            assert_eq!(name, fault);
            assert!((1e-3..1.5e-3).contains(&error), "{fault:?}: {error} m");
        }
    }

    #[test]
    fn a_setpoint_that_is_ahead_on_purpose_is_no_error() {
        let mut drive = DriveMonitor::default();
        let setpoint = Trajectory { position: 2e-3, ..Trajectory::default() };
        drive.update(&P, &setpoint, 1.5e-3, 0.0);
        assert_eq!(drive.fault(&P), None);
        drive.update(&P, &setpoint, 0.0, 0.0);
        assert_eq!(drive.fault(&P), Some(Fault::FollowingError));
    }

    /// Monitor of a slide with the gain ratio `ratio` at 0.1 mm a sample, and then the ratio `then`.
    fn moved(ratio: f64, samples: u32, then: f64, later: u32) -> DriveMonitor {
        let mut drive = DriveMonitor::default();
        let (mut commanded, mut slide) = (0.0, 0.0);
        for k in 0..samples + later {
            let before = commanded;
            commanded += 1e-4;
            drive.update(&P, &Trajectory { position: commanded, ..Trajectory::default() }, 0.0, slide);
            // the slide answers the setpoint of the last sample
            slide += (commanded - before) * if k < samples { ratio } else { then };
        }
        drive
    }

    #[test]
    fn the_ratio_is_that_of_the_last_hundredths_of_a_second() {
        assert!((moved(0.4, 300, 0.4, 0).ratio(&P) - 0.4).abs() < 1e-9);
        // 20 samples at 1 kHz: (1 - 1/20)^20 of what was before
        let kept = 0.95_f64.powi(20);
        assert!((moved(1.0, 300, 0.0, 21).ratio(&P) - kept).abs() < 0.02, "{}", moved(1.0, 300, 0.0, 21).ratio(&P));
        assert_eq!(DriveMonitor::default().ratio(&P), 1.0);
        // less than a micrometer in that time gives no ratio, a little more does
        let slow = |distance: f64| {
            let mut drive = DriveMonitor::default();
            for k in 0..100 {
                drive.update(&P, &Trajectory { position: distance * f64::from(k), ..Trajectory::default() }, 0.0, 0.0);
            }
            drive
        };
        assert_eq!([4e-8, 6e-8].map(|distance| slow(distance).ratio(&P)), [1.0, 0.0]);
        let mut drive = slow(4e-8);
        let setpoint = Trajectory { position: 1e-5, ..Trajectory::default() };
        (0..3).for_each(|_| drive.update(&P, &setpoint, 0.0, 0.0));
        assert_eq!(drive.ratio(&P), 0.0);
    }

    #[test]
    fn a_slide_is_at_rest_as_long_as_it_is_within_the_resolution() {
        let mut drive = DriveMonitor::default();
        let samples_at_rest = |drive: &mut DriveMonitor, slide: f64| {
            drive.update(&P, &Trajectory::default(), 0.0, slide);
            drive.still()
        };
        let first = samples_at_rest(&mut drive, 0.0);
        assert_eq!(
            [1.9e-5, 0.0, 1e-5].map(|slide| samples_at_rest(&mut drive, slide)),
            [first + 1, first + 2, first + 3]
        );
        assert_eq!(samples_at_rest(&mut drive, 1e-3), 0);
        assert_eq!(samples_at_rest(&mut drive, 1e-3), 1);
    }

    #[test]
    fn a_moving_setpoint_may_be_a_sample_ahead() {
        let fault = |velocity: f64, error: f64| {
            let mut drive = DriveMonitor::default();
            let setpoint = |position: f64| Trajectory { position, velocity, acceleration: 0.0 };
            drive.update(&P, &setpoint(0.0), 0.0, 0.0);
            (0..3).for_each(|_| drive.update(&P, &setpoint(error), 0.0, 0.0));
            drive.fault(&P).is_some()
        };
        // 1 mm and 0.5 m/s for 1 ms
        for side in [1.0, -1.0] {
            assert_eq!([1.49e-3, 1.51e-3].map(|error| fault(0.5 * side, error * side)), [false, true]);
            assert_eq!([0.99e-3, 1.01e-3].map(|error| fault(0.0, error * side)), [false, true]);
        }
    }

    #[test]
    fn a_slide_away_from_a_constant_setpoint_does_not_follow() {
        let (rest, limit) = (P.ticks(REST_TIME), AT_REST * P.limits.following_error);
        // the limit that is logged with the fault, and after how many samples
        let away = |error: f64, ahead: f64| {
            let mut drive = DriveMonitor::default();
            (0..4 * rest).find_map(|k| {
                drive.update(&P, &Trajectory::default(), ahead, error);
                drive.fault(&P).map(|fault| (fault, drive.allowed(), k.abs_diff(rest) < 3))
            })
        };
        for side in [1.0, -1.0] {
            assert_eq!(away(1.01 * side * limit, 0.0), Some((Fault::FollowingError, limit, true)));
            assert_eq!(away(0.99 * side * limit, 0.0), None);
            // ahead on purpose
            assert_eq!(away(2.0 * side * limit, 1.1 * limit), None);
        }
    }

    #[test]
    fn a_slide_in_motion_or_a_bad_sample_is_not_away_from_a_constant_setpoint() {
        let error = 10.0 * AT_REST * P.limits.following_error;
        let found = |setpoint: fn(u32) -> Trajectory, slide: &dyn Fn(u32) -> f64| {
            let mut drive = DriveMonitor::default();
            (0..2000).find_map(|k| {
                drive.update(&P, &setpoint(k), 0.0, slide(k));
                drive.fault(&P)
            })
        };
        let moving = |k: u32| Trajectory { position: 1e-5 * f64::from(k), velocity: 0.01, acceleration: 0.0 };
        assert_eq!(found(moving, &|k| moving(k).position - 1e-5 - error), None);
        let limit_at_rest = |_: u32| Trajectory::default();
        assert_eq!(found(limit_at_rest, &|k| if k % 100 == 0 { 0.0 } else { error }), None);
        assert_eq!(found(limit_at_rest, &|_| error), Some(Fault::FollowingError));
    }

    #[test]
    fn half_of_the_way_is_not_weak_and_a_fifth_backwards_is_not_the_sign() {
        let fault = |ratio: f64| moved(ratio, 300, ratio, 0).fault(&P);
        assert_eq!([0.51, 0.49].map(fault), [Some(Fault::FollowingError), Some(Fault::WeakDrive)]);
        assert_eq!([-0.19, -0.21].map(fault), [Some(Fault::WeakDrive), Some(Fault::DriveSign)]);
    }
}
