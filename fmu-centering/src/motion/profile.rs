//! Moves with a given length: the trapezoidal velocity profile of eq. 35.

use control_blocks::Trajectory;
use serde::{Deserialize, Serialize};

/// Duration t3 (s) of a move over `distance` (m) from rest to rest, 0 if there is nothing to move.
pub fn duration(distance: f64, velocity: f64, acceleration: f64) -> f64 {
    if distance <= 0.0 {
        0.0
    } else if distance >= velocity * velocity / acceleration {
        // eq. 35
        distance / velocity + velocity / acceleration
    } else {
        // too short for its velocity: a triangle
        2.0 * (distance / acceleration).sqrt()
    }
}

/// A trapezoidal move, in time from its start; it may start with a velocity.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Trapezoid {
    start: Trajectory,
    end: f64,
    /// +1 or -1
    direction: f64,
    acceleration: f64,
    peak: f64,
    /// ends of acceleration, cruise and deceleration, s
    times: [f64; 3],
}

impl Trapezoid {
    /// A move from `start` to rest at the position `end` m, with at most `velocity` m/s and `acceleration` m/s2.
    pub fn new(start: Trajectory, end: f64, velocity: f64, acceleration: f64) -> Self {
        // a move that cannot stop before the end stops after it and returns
        let stop = start.position + start.velocity * start.velocity.abs() / (2.0 * acceleration);
        let direction = if end >= stop { 1.0 } else { -1.0 };
        let (distance, initial) = (direction * (end - start.position), direction * start.velocity);
        // without a cruise the peak is where acceleration meets deceleration
        let peak = (acceleration * distance + 0.5 * initial * initial).max(0.0).sqrt().min(velocity.max(initial));
        let speed_up = (peak - initial) / acceleration;
        let ramps = (2.0 * peak * peak - initial * initial) / (2.0 * acceleration);
        let cruise = if peak > 0.0 { ((distance - ramps) / peak).max(0.0) } else { 0.0 };
        let times = [speed_up, speed_up + cruise, speed_up + cruise + peak / acceleration];
        Self { start, end, direction, acceleration, peak, times }
    }

    /// Time until rest, s.
    pub fn duration(&self) -> f64 {
        self.times[2]
    }

    /// Setpoint at the time `t` s; at rest at the end afterwards.
    pub fn at(&self, t: f64) -> Trajectory {
        let [t1, t2, t3] = self.times;
        // everything below is along the direction of the move
        let (position, velocity, acceleration) = if t < t1 {
            let initial = self.direction * self.start.velocity;
            let velocity = initial + self.acceleration * t;
            (self.start.position + self.direction * 0.5 * (initial + velocity) * t, velocity, self.acceleration)
        } else if t < t2 {
            let left = self.peak * (t2 - t) + 0.5 * self.peak * (t3 - t2);
            (self.end - self.direction * left, self.peak, 0.0)
        } else if t < t3 {
            let velocity = self.acceleration * (t3 - t);
            (self.end - self.direction * 0.5 * velocity * (t3 - t), velocity, -self.acceleration)
        } else {
            (self.end, 0.0, 0.0)
        };
        Trajectory { position, velocity: self.direction * velocity, acceleration: self.direction * acceleration }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const REST: Trajectory = Trajectory { position: 0.1, velocity: 0.0, acceleration: 0.0 };

    /// Checks continuity, limits, and that the velocity integrates to the position.
    fn examine(start: Trajectory, end: f64, velocity: f64, acceleration: f64) -> Trapezoid {
        let profile = Trapezoid::new(start, end, velocity, acceleration);
        let steps = 20_000;
        let dt = profile.duration() / f64::from(steps);
        let mut position = start.position;
        let mut before = profile.at(0.0);
        assert!((before.position - start.position).abs() < 1e-12, "{before:?}");
        for k in 1..=steps {
            let now = profile.at(f64::from(k) * dt);
            position += 0.5 * (before.velocity + now.velocity) * dt;
            assert!((now.velocity - before.velocity).abs() <= acceleration * dt * (1.0 + 1e-6) + 1e-12);
            assert!(now.velocity.abs() <= velocity.max(start.velocity.abs()) + 1e-12);
            let change = (now.velocity - before.velocity) / dt;
            // except at the transition between two parts
            if now.acceleration == before.acceleration {
                assert!((change - now.acceleration).abs() < 1e-6 * acceleration, "{k}: {now:?}, {change} m/s2");
            }
            assert!((now.position - position).abs() < acceleration * dt * dt, "{k}: {now:?} against {position}");
            before = now;
        }
        assert_eq!(profile.at(1e9), Trajectory { position: end, velocity: 0.0, acceleration: 0.0 });
        profile
    }

    #[test]
    fn moves_from_rest_last_as_eq_35_says() {
        // long ones, and below v^2/a = 4.8 um triangles
        for distance in [2e-7, 2e-6, 4.785e-6, 1e-5, 5e-4, 0.02] {
            let profile = examine(REST, 0.1 + distance, 3.5e-3, 2.56);
            let expected = duration(distance, 3.5e-3, 2.56);
            assert!((profile.duration() - expected).abs() < 1e-9 * expected, "{distance} m");
        }
        assert!((duration(5e-4, 4e-4, 2.56) - 1.25015625).abs() < 1e-9);
        assert_eq!(duration(-1e-3, 3.5e-3, 2.56), 0.0);
    }

    #[test]
    fn moves_go_both_ways() {
        let forth = examine(REST, 0.101, 0.12, 2.56);
        let back = examine(REST, 0.099, 0.12, 2.56);
        assert!((forth.duration() - back.duration()).abs() < 1e-12);
    }

    #[test]
    fn a_move_takes_over_any_velocity() {
        for velocity in [-0.1, -1e-3, 1e-3, 0.1] {
            for end in [0.05, 0.0999, 0.1, 0.1001, 0.15] {
                examine(Trajectory { position: 0.1, velocity, acceleration: 0.0 }, end, 0.05, 2.56);
            }
        }
    }

    #[test]
    fn no_move_takes_no_time() {
        let profile = Trapezoid::new(REST, 0.1, 0.05, 2.56);
        assert_eq!((profile.duration(), profile.at(0.0)), (0.0, REST));
    }
}
