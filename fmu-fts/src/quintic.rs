//! Quintic motion from any angle, velocity and acceleration to rest.

use serde::{Deserialize, Serialize};

/// Angle (rad), angular velocity (rad/s) and angular acceleration (rad/s2).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Motion {
    /// Angle, rad.
    pub angle: f64,
    /// Angular velocity, rad/s.
    pub velocity: f64,
    /// Angular acceleration, rad/s2.
    pub acceleration: f64,
}

/// A motion of fixed duration that ends at rest.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Quintic {
    goal: f64,
    duration: f64,
    /// coefficients of the distance to the goal over the share of the duration
    coefficients: [f64; 6],
}

impl Quintic {
    /// From `start` to rest at `goal` (rad) in `duration` (s, positive).
    pub fn new(start: Motion, goal: f64, duration: f64) -> Self {
        let (p, v, a) = (start.angle - goal, start.velocity * duration, 0.5 * start.acceleration * duration * duration);
        let coefficients =
            [p, v, a, -10.0 * p - 6.0 * v - 3.0 * a, 15.0 * p + 8.0 * v + 3.0 * a, -6.0 * p - 3.0 * v - a];
        Self { goal, duration, coefficients }
    }

    /// At rest at `goal` (rad).
    pub fn resting(goal: f64) -> Self {
        Self::new(Motion { angle: goal, ..Motion::default() }, goal, 1.0)
    }

    /// Where the motion ends, rad.
    pub fn goal(&self) -> f64 {
        self.goal
    }

    /// Whether the motion is over at the time `t` (s) after its start.
    pub fn over(&self, t: f64) -> bool {
        t >= self.duration
    }

    /// The motion at the time `t` (s) after its start.
    pub fn at(&self, t: f64) -> Motion {
        let (s, per_second) = (t / self.duration, 1.0 / self.duration);
        if s >= 1.0 {
            return Motion { angle: self.goal, ..Motion::default() };
        }
        let [c0, c1, c2, c3, c4, c5] = self.coefficients;
        Motion {
            angle: self.goal + c0 + s * (c1 + s * (c2 + s * (c3 + s * (c4 + s * c5)))),
            velocity: per_second * (c1 + s * (2.0 * c2 + s * (3.0 * c3 + s * (4.0 * c4 + s * 5.0 * c5)))),
            acceleration: per_second * per_second * (2.0 * c2 + s * (6.0 * c3 + s * (12.0 * c4 + s * 20.0 * c5))),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn begins_and_ends_as_told() {
        let start = Motion { angle: 0.4, velocity: -3.0, acceleration: 20.0 };
        let quintic = Quintic::new(start, -0.1, 0.3);
        let first = quintic.at(0.0);
        assert!((first.angle - 0.4).abs() < 1e-15 && (first.velocity + 3.0).abs() < 1e-12);
        assert!((first.acceleration - 20.0).abs() < 1e-9);
        let last = quintic.at(0.3 - 1e-9);
        assert!((last.angle + 0.1).abs() < 1e-12 && last.velocity.abs() < 1e-9 && last.acceleration.abs() < 1e-3);
        assert_eq!(quintic.at(0.3), Motion { angle: -0.1, ..Motion::default() });
        assert_eq!(quintic.at(1e9), quintic.at(0.3));
    }

    #[test]
    fn velocity_and_acceleration_are_the_derivatives() {
        let start = Motion { angle: 0.4, velocity: -3.0, acceleration: 20.0 };
        let quintic = Quintic::new(start, -0.1, 0.3);
        for k in 1..29 {
            let (t, h) = (0.01 * f64::from(k), 1e-6);
            let (before, here, after) = (quintic.at(t - h), quintic.at(t), quintic.at(t + h));
            assert!(((after.angle - before.angle) / (2.0 * h) - here.velocity).abs() < 1e-7);
            assert!(((after.velocity - before.velocity) / (2.0 * h) - here.acceleration).abs() < 1e-5);
        }
    }
}
