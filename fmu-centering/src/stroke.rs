//! Motion of the slide in a push: fast to a standoff, at contact velocity to the ring, braked to rest at the end.
//!
//! Every part has a constant acceleration, so position and velocity are exact at any time.

use serde::{Deserialize, Serialize};

use crate::contact::Finish;

/// Where and how fast the slide is before the stroke, m and m/s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Begin {
    /// Position, m.
    pub position: f64,
    /// Velocity, m/s.
    pub velocity: f64,
}

/// Limits of the slide.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Velocity, m/s.
    pub velocity: f64,
    /// Acceleration, m/s2.
    pub acceleration: f64,
}

/// Part of a stroke with constant acceleration.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
struct Part {
    duration: f64,
    velocity: f64,
    acceleration: f64,
}

impl Part {
    fn travel(&self, time: f64) -> f64 {
        (self.velocity + 0.5 * self.acceleration * time) * time
    }
}

/// A stroke that ends at rest.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Stroke {
    start: f64,
    parts: [Part; 5],
}

impl Stroke {
    /// From `begin` to rest at `end` (m), the last `slow` m before it no faster than `finish` says.
    pub fn plan(begin: Begin, end: f64, slow: f64, finish: Finish, limits: Limits) -> Self {
        let Limits { velocity: v_max, acceleration: a } = limits;
        let (v0, v1) = (begin.velocity, finish.velocity.min(v_max));
        let braking = 0.5 * v1 * v1 / finish.deceleration;
        let slow = slow.max(braking);
        let fast = end - slow - begin.position;
        // peak of the trapezoid: fast = (vp^2 - v0^2) / 2a + (vp^2 - v1^2) / 2a
        let peak = (a * fast + 0.5 * (v0 * v0 + v1 * v1)).max(0.0).sqrt().clamp(v1, v_max);
        let up = Part { duration: (peak - v0).abs() / a, velocity: v0, acceleration: a.copysign(peak - v0) };
        let down = Part { duration: (peak - v1) / a, velocity: peak, acceleration: -a };
        let left = fast - up.travel(up.duration) - down.travel(down.duration);
        let cruise = Part { duration: (left / peak).max(0.0), velocity: peak, acceleration: 0.0 };
        // too near for the trapezoid: only the slow part is shorter
        let slow = slow + left.min(0.0);
        let creep = Part { duration: ((slow - braking) / v1).max(0.0), velocity: v1, acceleration: 0.0 };
        let brake = Part { duration: v1 / finish.deceleration, velocity: v1, acceleration: -finish.deceleration };
        let parts = [up, cruise, down, creep, brake];
        let travel: f64 = parts.iter().map(|part| part.travel(part.duration)).sum();
        Self { start: end - travel, parts }
    }

    /// Duration, s.
    pub fn duration(&self) -> f64 {
        self.parts.iter().map(|part| part.duration).sum()
    }

    /// Position (m) and velocity (m/s) at `time` s after the begin; at rest at the end from then on.
    pub fn at(&self, time: f64) -> (f64, f64) {
        let (mut position, mut left) = (self.start, time.max(0.0));
        for part in &self.parts {
            if left < part.duration {
                return (position + part.travel(left), part.velocity + part.acceleration * left);
            }
            position += part.travel(part.duration);
            left -= part.duration;
        }
        (position, 0.0)
    }
}
