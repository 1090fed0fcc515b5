//! Motion of the slide in a push: fast to a standoff, with the contact velocity to the ring, braked to rest at the end.
//!
//! Every part has a constant acceleration, so position and velocity are exact at any time.

use control_blocks::{Trajectory, stopping_distance};
use serde::{Deserialize, Serialize};

/// Velocity at which the servo settles after the fast part, if the contact is slower, m/s.
const SETTLING_VELOCITY: f64 = 1e-3;
/// Time in which it settles, s; the travel in it exceeds the overshoot of a slide whose servo is configured 30 % too
/// fast, 0.04 mm.
const SETTLING_TIME: f64 = 0.05;
/// Deceleration from there to the contact velocity, m/s2.
const EASE: f64 = 0.1;

/// End of a stroke: constant velocity, then a constant deceleration to rest.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Finish {
    /// Velocity at contact, m/s.
    pub velocity: f64,
    /// Deceleration, m/s2.
    pub deceleration: f64,
}

impl Finish {
    /// A finish that takes `duration` s for the last `distance` m, braking all the way if `velocity_max` (m/s) permits.
    pub fn braked(distance: f64, duration: f64, velocity_max: f64) -> Self {
        let deceleration = 2.0 * distance / duration.powi(2);
        Self { velocity: (deceleration * duration).min(velocity_max), deceleration }
    }

    /// The same, but with at least `velocity` m/s where `distance` m remain.
    pub fn at_least(self, velocity: f64, distance: f64) -> Self {
        if self.velocity >= velocity {
            self
        } else {
            Self { velocity, deceleration: velocity.powi(2) / (2.0 * distance) }
        }
    }

    /// Distance to rest, m.
    pub fn braking(&self) -> f64 {
        stopping_distance(self.velocity, self.deceleration)
    }

    /// Distance from the end (m) and velocity (m/s) at `time` s before the end.
    pub fn before(&self, time: f64) -> (f64, f64) {
        let braking = self.velocity / self.deceleration;
        if time <= braking {
            return (0.5 * self.deceleration * time * time, self.deceleration * time);
        }
        (self.velocity * (time - 0.5 * braking), self.velocity)
    }

    /// Time before the end (s) at which `distance` m remain.
    pub fn time(&self, distance: f64) -> f64 {
        if distance <= self.braking() {
            return (2.0 * distance / self.deceleration).sqrt();
        }
        distance / self.velocity + 0.5 * self.velocity / self.deceleration
    }
}

/// Limits of the slide.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SlideLimits {
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
    fn whole(&self) -> f64 {
        self.travel(self.duration)
    }

    fn travel(&self, time: f64) -> f64 {
        (self.velocity + 0.5 * self.acceleration * time) * time
    }
}

/// A stroke; by default none.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Stroke {
    start: f64,
    end: f64,
    parts: [Part; 7],
}

impl Stroke {
    /// From `begin` to rest at `end` (m), the last `slow` m before it with the velocity of `finish` or slower.
    pub fn plan(begin: &Trajectory, end: f64, slow: f64, finish: &Finish, limits: &SlideLimits) -> Self {
        let a = limits.acceleration;
        let (v0, v2) = (begin.velocity, finish.velocity);
        let v1 = v2.max(SETTLING_VELOCITY);
        let braking = finish.braking();
        let ease = Part { duration: (v1 - v2) / EASE, velocity: v1, acceleration: -EASE };
        let settle = Part { duration: SETTLING_TIME, velocity: v1, acceleration: 0.0 };
        let slow = slow.max(braking);
        let fast = end - slow - ease.whole() - settle.whole() - begin.position;
        // peak of the trapezoid: fast = (vp^2 - v0^2) / 2a + (vp^2 - v1^2) / 2a
        let peak = (a * fast + 0.5 * (v0 * v0 + v1 * v1)).max(0.0).sqrt().clamp(v1, limits.velocity.max(v1));
        let up = Part { duration: (peak - v0).abs() / a, velocity: v0, acceleration: a.copysign(peak - v0) };
        let down = Part { duration: (peak - v1) / a, velocity: peak, acceleration: -a };
        let left = fast - up.whole() - down.whole();
        let cruise = Part { duration: left.max(0.0) / peak, velocity: peak, acceleration: 0.0 };
        let creep = Part { duration: (slow - braking) / v2, velocity: v2, acceleration: 0.0 };
        let brake = Part { duration: v2 / finish.deceleration, velocity: v2, acceleration: -finish.deceleration };
        let parts = [up, cruise, down, settle, ease, creep, brake];
        let travel: f64 = parts.iter().map(Part::whole).sum();
        Self { start: end - travel, end, parts }
    }

    /// Duration, s.
    pub fn duration(&self) -> f64 {
        self.parts.iter().map(|part| part.duration).sum()
    }

    /// Position of the end, m.
    pub fn end(&self) -> f64 {
        self.end
    }

    /// The reference `time` s after the start: before it at constant velocity, after the end at rest.
    pub fn at(&self, time: f64) -> Trajectory {
        let velocity = self.parts[0].velocity;
        if time < 0.0 {
            return Trajectory { position: self.start + velocity * time, velocity, acceleration: 0.0 };
        }
        let (mut position, mut left) = (self.start, time);
        for part in &self.parts {
            if left < part.duration {
                return Trajectory {
                    position: position + part.travel(left),
                    velocity: part.velocity + part.acceleration * left,
                    acceleration: part.acceleration,
                };
            }
            position += part.whole();
            left -= part.duration;
        }
        Trajectory { position: self.end, ..Trajectory::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LIMITS: SlideLimits = SlideLimits { velocity: 0.12, acceleration: 2.56 };

    fn rest(position: f64) -> Trajectory {
        Trajectory { position, ..Trajectory::default() }
    }

    #[test]
    fn a_braked_finish_covers_its_distance_in_its_time() {
        let finish = Finish::braked(5e-4, 0.08, 1.0);
        assert!((finish.braking() - 5e-4).abs() < 1e-18);
        assert!((finish.time(5e-4) - 0.08).abs() < 1e-15);
        let (distance, velocity) = finish.before(0.08);
        assert!((distance - 5e-4).abs() < 1e-15 && (velocity - finish.velocity).abs() < 1e-15);
    }

    #[test]
    fn time_and_distance_before_the_end_are_inverse() {
        let finish = Finish { velocity: 0.02, deceleration: 0.4 };
        for k in 0..100 {
            let distance = 1e-5 * f64::from(k);
            assert!((finish.before(finish.time(distance)).0 - distance).abs() < 1e-12);
        }
    }

    #[test]
    fn a_stroke_starts_and_ends_where_it_should_and_keeps_its_limits() {
        let finish = Finish::braked(5e-4, 0.08, 0.04);
        for velocity in [0.0, 0.04, -0.04] {
            let begin = Trajectory { position: 0.1, velocity, acceleration: 0.0 };
            let stroke = Stroke::plan(&begin, 0.116, 1e-3, &finish, &LIMITS);
            assert!((stroke.at(0.0).position - 0.1).abs() < 1e-12, "{velocity}");
            assert_eq!(stroke.at(stroke.duration() + 1.0), rest(0.116));
            let dt = 1e-4;
            for k in 0..(stroke.duration() / dt) as i32 {
                let (now, next) = (stroke.at(f64::from(k) * dt), stroke.at(f64::from(k + 1) * dt));
                assert!(next.velocity <= 0.12 + 1e-12);
                assert!((next.velocity - now.velocity).abs() <= 2.56 * dt * 1.000_001);
                let travel = 0.5 * (now.velocity + next.velocity) * dt;
                assert!((next.position - now.position - travel).abs() < 2.56 * dt * dt);
            }
        }
    }

    #[test]
    fn the_last_part_is_slow() {
        let finish = Finish::braked(5e-4, 0.08, 0.04);
        let stroke = Stroke::plan(&rest(0.0), 0.016, 1e-3, &finish, &LIMITS);
        let contact = stroke.duration() - finish.time(5e-4);
        let slow = stroke.at(contact - 0.02);
        assert!((slow.velocity - finish.velocity).abs() < 1e-12);
        assert!((0.016 - stroke.at(contact).position - 5e-4).abs() < 1e-12);
    }

    #[test]
    fn a_contact_slower_than_the_servo_settles_is_eased_into() {
        let finish = Finish { velocity: 4e-4, deceleration: 0.01 };
        let stroke = Stroke::plan(&rest(0.1), 0.116, 1e-3, &finish, &LIMITS);
        assert!((stroke.at(0.0).position - 0.1).abs() < 1e-12);
        assert_eq!((stroke.end(), stroke.at(-1.0).position), (0.116, stroke.at(0.0).position));
        // the last millimeter: 8 um of braking, and before it 50 ms at 1 mm/s and 6 ms of easing
        let slow = stroke.duration() - finish.time(1e-3);
        let velocities = [1e-4, -1e-4, -0.0059, -0.0061, -0.0559, -0.0565].map(|late| stroke.at(slow + late).velocity);
        let eased = 4e-4 + 0.1 * 1e-4;
        let expected = [4e-4, eased, 4e-4 + 0.1 * 0.0059, 1e-3, 1e-3];
        assert!(velocities.iter().zip(expected).all(|(v, expected)| (v - expected).abs() < 1e-9), "{velocities:?}");
        assert!(velocities[5] > 1.5e-3);
        assert!((0.116 - stroke.at(slow).position - 1e-3).abs() < 1e-12);
    }

    #[test]
    fn a_long_stroke_cruises_and_a_short_one_has_the_peak_of_its_distance() {
        let finish = Finish { velocity: 0.02, deceleration: 0.4 };
        let fastest = |end: f64| {
            let stroke = Stroke::plan(&rest(0.0), end, 0.0, &finish, &LIMITS);
            (0..20_000).map(|k| stroke.at(stroke.duration() * f64::from(k) / 2e4).velocity).fold(0.0, f64::max)
        };
        assert!((fastest(0.1) - 0.12).abs() < 1e-12);
        // without braking (0.5 mm) and settling (1 mm): vp^2 = a d + v^2 / 2, d the distance
        let peak = (2.56 * (4e-3 - 1.5e-3) + 0.5 * 0.02_f64.powi(2)).sqrt();
        assert!((fastest(4e-3) - peak).abs() < 1e-3 * peak, "{} {peak}", fastest(4e-3));
    }

    #[test]
    fn a_finish_has_at_least_the_velocity_that_it_must() {
        let finish = Finish { velocity: 0.02, deceleration: 0.4 };
        assert_eq!(finish.at_least(0.02, 1e-3), finish);
        assert_eq!(finish.at_least(0.04, 1e-3), Finish { velocity: 0.04, deceleration: 0.8 });
        let braked = Finish::braked(1e-3, 0.1, 1.0);
        assert!((braked.velocity - 0.02).abs() < 1e-15 && (braked.deceleration - 0.2).abs() < 1e-15);
        assert_eq!(Finish::braked(1e-3, 0.1, 0.01).velocity, 0.01);
    }

    #[test]
    fn a_short_stroke_takes_over_the_velocity_of_the_slide() {
        let finish = Finish { velocity: 0.02, deceleration: 0.4 };
        for velocity in [0.05, 0.01, -0.05] {
            let begin = Trajectory { position: 0.1, velocity, acceleration: 0.0 };
            let stroke = Stroke::plan(&begin, 0.1045, 0.0, &finish, &LIMITS);
            assert!((stroke.at(0.0).position - 0.1).abs() < 1e-12 && stroke.at(0.0).velocity == velocity);
            let fastest =
                (0..20_000).map(|k| stroke.at(stroke.duration() * f64::from(k) / 2e4).velocity).fold(0.0, f64::max);
            // braking takes 0.5 mm, settling 1 mm
            let peak = (2.56 * 3e-3 + 0.5 * (velocity * velocity + 0.02_f64.powi(2))).sqrt();
            assert!((fastest - peak).abs() < 1e-3 * peak, "{velocity}: {fastest} {peak}");
            // before its begin at constant velocity
            assert!((stroke.at(-0.1).position - 0.1 + 0.1 * velocity).abs() < 1e-12);
        }
    }
}
