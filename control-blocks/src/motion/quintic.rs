//! Quintic motions: the polynomials of lowest order with six end conditions (position, velocity, acceleration).
//!
//! Between two rests the fraction of the distance at s = t / T is 10 s^3 - 15 s^4 + 6 s^5, the motion of minimum jerk
//! (Flash and Hogan, 1985). Its velocity 30 s^2 (1 - s)^2 / T peaks at s = 1/2 with 15/8 of the mean. From any motion
//! p, v, a to rest at 0 the distance to the target is sum c_i s^i with c_0 = p, c_1 = v T, c_2 = a T^2 / 2, and the
//! conditions at s = 1 give
//!
//! ```text
//! c_3 = -10 c_0 - 6 c_1 - 3 c_2,   c_4 = 15 c_0 + 8 c_1 + 3 c_2,   c_5 = -6 c_0 - 3 c_1 - c_2.
//! ```

use serde::{Deserialize, Serialize};

use super::trajectory::Trajectory;

/// Peak speed of a quintic between two rests, over its mean speed.
const PEAK_OVER_MEAN: f64 = 1.875;
/// Peak acceleration of a quintic between two rests, over distance / duration^2: 10 / 3^(1/2).
pub const QUINTIC_ACCELERATION: f64 = 5.7735;

/// Duration (s) of a quintic between two rests over `distance` (m or rad) with the peak speed `speed` (m/s or rad/s).
pub fn quintic_duration(distance: f64, speed: f64) -> f64 {
    PEAK_OVER_MEAN * distance / speed
}

/// Fraction of the distance between two rests at the fraction `s` (0 to 1) of the duration.
pub fn minimum_jerk(s: f64) -> f64 {
    s * s * s * (10.0 + s * (6.0 * s - 15.0))
}

/// First (1/s) and second (1/s2) derivative to the time of [`minimum_jerk`] at `s`; `rate` is 1 / duration, 1/s.
pub fn minimum_jerk_rates(s: f64, rate: f64) -> [f64; 2] {
    let rest = 1.0 - s;
    [30.0 * rate * s * s * rest * rest, 60.0 * rate * rate * s * rest * (rest - s)]
}

/// A motion of fixed duration that ends at rest.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Quintic {
    goal: f64,
    duration: f64,
    /// coefficients of the distance to the target over the fraction of the duration
    coefficients: [f64; 6],
}

impl Quintic {
    /// From `start` to rest at `goal` (m or rad) in `duration` (s, positive).
    pub fn new(start: Trajectory, goal: f64, duration: f64) -> Self {
        let (p, v) = (start.position - goal, start.velocity * duration);
        let a = 0.5 * start.acceleration * duration * duration;
        let coefficients =
            [p, v, a, -10.0 * p - 6.0 * v - 3.0 * a, 15.0 * p + 8.0 * v + 3.0 * a, -6.0 * p - 3.0 * v - a];
        Self { goal, duration, coefficients }
    }

    /// At rest at `goal` (m or rad).
    pub fn resting(goal: f64) -> Self {
        Self::new(Trajectory::resting(goal), goal, 1.0)
    }

    /// End of the motion, m or rad.
    pub fn goal(&self) -> f64 {
        self.goal
    }

    /// Whether the motion is over at the time `t` (s) after its start.
    pub fn over(&self, t: f64) -> bool {
        t >= self.duration
    }

    /// The motion at the time `t` (s) after its start.
    pub fn at(&self, t: f64) -> Trajectory {
        let (s, per_second) = (t / self.duration, 1.0 / self.duration);
        if s >= 1.0 {
            return Trajectory::resting(self.goal);
        }
        let [c0, c1, c2, c3, c4, c5] = self.coefficients;
        Trajectory {
            position: self.goal + c0 + s * (c1 + s * (c2 + s * (c3 + s * (c4 + s * c5)))),
            velocity: per_second * (c1 + s * (2.0 * c2 + s * (3.0 * c3 + s * (4.0 * c4 + s * 5.0 * c5)))),
            acceleration: per_second * per_second * (2.0 * c2 + s * (6.0 * c3 + s * (12.0 * c4 + s * 20.0 * c5))),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const START: Trajectory = Trajectory { position: 0.4, velocity: -3.0, acceleration: 20.0 };

    #[test]
    fn starts_and_ends_as_configured() {
        let quintic = Quintic::new(START, -0.1, 0.3);
        let first = quintic.at(0.0);
        assert!((first.position - 0.4).abs() < 1e-15 && (first.velocity + 3.0).abs() < 1e-12);
        assert!((first.acceleration - 20.0).abs() < 1e-9);
        let last = quintic.at(0.3 - 1e-9);
        assert!((last.position + 0.1).abs() < 1e-12 && last.velocity.abs() < 1e-9 && last.acceleration.abs() < 1e-3);
        assert_eq!(quintic.at(0.3), Trajectory::resting(-0.1));
        assert_eq!(quintic.at(1e9), quintic.at(0.3));
        assert!(quintic.over(0.3) && !quintic.over(0.299));
    }

    #[test]
    fn velocity_and_acceleration_are_the_derivatives() {
        let quintic = Quintic::new(START, -0.1, 0.3);
        for k in 1..29 {
            let (t, h) = (0.01 * f64::from(k), 1e-6);
            let (before, here, after) = (quintic.at(t - h), quintic.at(t), quintic.at(t + h));
            assert!(((after.position - before.position) / (2.0 * h) - here.velocity).abs() < 1e-7);
            assert!(((after.velocity - before.velocity) / (2.0 * h) - here.acceleration).abs() < 1e-5);
        }
    }

    #[test]
    fn between_two_rests_it_is_the_motion_of_least_jerk() {
        let (distance, duration) = (0.8, 0.25);
        let quintic = Quintic::new(Trajectory::resting(0.0), distance, duration);
        for k in 0..=100 {
            let s = 0.01 * f64::from(k);
            let [first, second] = minimum_jerk_rates(s, 1.0 / duration);
            let motion = quintic.at(s * duration);
            assert!((motion.position - distance * minimum_jerk(s)).abs() < 1e-14, "{s}");
            assert!((motion.velocity - distance * first).abs() < 1e-12, "{s}");
            assert!((motion.acceleration - distance * second).abs() < 1e-10, "{s}");
        }
        assert_eq!((minimum_jerk(0.0), minimum_jerk(0.5), minimum_jerk(1.0)), (0.0, 0.5, 1.0));
    }

    #[test]
    fn the_peak_is_in_the_middle_at_the_speed_that_was_requested() {
        let duration = quintic_duration(0.6, 1.5);
        assert_eq!(duration, 0.75);
        let quintic = Quintic::new(Trajectory::resting(0.0), 0.6, duration);
        let hardest = (0..=7500).map(|k| quintic.at(1e-4 * f64::from(k)).acceleration).fold(0.0, f64::max);
        assert!((hardest * duration * duration / 0.6 / QUINTIC_ACCELERATION - 1.0).abs() < 1e-4, "{hardest}");
        let fastest = (0..=1000).map(|k| quintic.at(duration * f64::from(k) / 1000.0).velocity).fold(0.0, f64::max);
        assert!((fastest - 1.5).abs() < 1e-12, "{fastest}");
        assert!((quintic.at(0.5 * duration).velocity - fastest).abs() < 1e-12);
        assert!(quintic.at(0.5 * duration).acceleration.abs() < 1e-12);
    }
}
