//! Reference with limited acceleration: position and velocity never jump by themselves.
//!
//! The velocity is a ramp, v' = v + clamp(v_target - v, -a T_s, a T_s); the position is its exact integral,
//! x' = x + (v + v') T_s / 2.

use serde::{Deserialize, Serialize};

use super::ramp::ramp;

/// Position (m or rad) of a reference with its derivatives to the time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Trajectory {
    /// Position, m or rad.
    pub position: f64,
    /// Velocity, m/s or rad/s.
    pub velocity: f64,
    /// Acceleration, m/s2 or rad/s2; after a step that of the last sample.
    pub acceleration: f64,
}

impl Trajectory {
    /// At rest at `position`, m or rad.
    pub fn resting(position: f64) -> Self {
        Self { position, ..Self::default() }
    }

    /// Moves for `dt` s towards the velocity `target` (m/s or rad/s) with at most `acceleration_max` (m/s2 or rad/s2).
    pub fn step(&mut self, target: f64, acceleration_max: f64, dt: f64) {
        let velocity = ramp(self.velocity, target, acceleration_max * dt);
        self.acceleration = (velocity - self.velocity) / dt;
        self.position += 0.5 * (self.velocity + velocity) * dt;
        self.velocity = velocity;
    }
}

/// Distance (m) to stop from `velocity` (m/s) with `deceleration` (m/s2), v^2 / (2 a).
pub fn stopping_distance(velocity: f64, deceleration: f64) -> f64 {
    velocity * velocity / (2.0 * deceleration)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keeps_its_limits_and_its_continuity() {
        let (dt, limit) = (1e-4, 0.05);
        let mut reference = Trajectory::resting(0.7);
        for k in 0..600 {
            let before = reference;
            let target = if k < 300 { 1e-4 } else { -1e-3 };
            reference.step(target, limit, dt);
            assert!(reference.acceleration.abs() <= limit * (1.0 + 1e-9));
            let travel = reference.position - before.position;
            let mean = 0.5 * (before.velocity + reference.velocity);
            assert!((travel - mean * dt).abs() < 1e-15);
        }
        assert_eq!(reference.velocity, -1e-3);
        assert_eq!(reference.acceleration, 0.0);
    }

    #[test]
    fn stops_in_its_stopping_distance() {
        let mut reference = Trajectory { velocity: 1e-3, ..Trajectory::default() };
        while reference.velocity > 0.0 {
            reference.step(0.0, 2.0, 1e-4);
        }
        assert!((reference.position - stopping_distance(1e-3, 2.0)).abs() < 1e-12);
    }
}
