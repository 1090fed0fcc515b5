//! Motion to `hold_angle`: a quintic whenever the requested angle changes, continuous from any motion.

use control_blocks::{Quintic, Trajectory, quintic_duration};
use serde::{Deserialize, Serialize};

use crate::interface::Parameters;

/// Smallest time in which a moving arm is stopped, s.
const STOP_TIME: f64 = 0.02;

/// The motion in progress.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct HoldMotion {
    quintic: Quintic,
    ticks: u32,
    /// It stops an arm that was found moving: no other goal before it is at rest.
    stops: bool,
}

impl HoldMotion {
    /// At rest at an angle (rad).
    pub fn at(angle: f64) -> Self {
        Self { quintic: Quintic::resting(angle), ticks: 0, stops: false }
    }

    /// Stops an arm that moves: half way of its speed, with a fifth of the torque.
    pub fn stopping(p: &Parameters, motion: Trajectory) -> Self {
        let speed = motion.velocity.abs();
        let duration = f64::max(STOP_TIME, 10.0 * speed * p.servo.inertia / p.servo.torque_max);
        let goal = motion.position + 0.5 * motion.velocity * duration;
        Self { quintic: Quintic::new(motion, goal, duration), ticks: 0, stops: speed > 0.0 }
    }

    /// Stops the motion in progress.
    pub fn stop(&mut self, p: &Parameters) {
        *self = Self::stopping(p, self.now(p));
    }

    /// Whether the arm was found moving and does not stand yet.
    pub fn stops(&self, p: &Parameters) -> bool {
        self.stops && !self.arrived(p)
    }

    /// Starts from `motion` to rest at `goal` (rad).
    pub fn go(&mut self, p: &Parameters, motion: Trajectory, goal: f64) {
        let duration = duration(p, motion.position, goal);
        *self = Self { quintic: Quintic::new(motion, goal, duration), ticks: 0, stops: false };
    }

    /// From the present motion to rest at `goal` (rad).
    pub fn redirect(&mut self, p: &Parameters, goal: f64) {
        let motion = self.now(p);
        self.go(p, motion, goal);
    }

    /// Reference (rad) of this sample; `goal` is the requested angle.
    pub fn step(&mut self, p: &Parameters, goal: f64) -> Trajectory {
        if goal != self.quintic.goal() && !self.stops(p) {
            self.redirect(p, goal);
        }
        self.coast(p)
    }

    /// Continues to the last requested angle.
    pub fn coast(&mut self, p: &Parameters) -> Trajectory {
        self.ticks = self.ticks.saturating_add(1);
        self.now(p)
    }

    /// Whether the motion has come to its end.
    pub fn arrived(&self, p: &Parameters) -> bool {
        self.quintic.over(f64::from(self.ticks) * p.sample_period)
    }

    fn now(&self, p: &Parameters) -> Trajectory {
        self.quintic.at(f64::from(self.ticks) * p.sample_period)
    }
}

/// Time (s) of the motion from one angle to another (rad).
pub fn duration(p: &Parameters, from: f64, to: f64) -> f64 {
    f64::max(p.approach_time, quintic_duration((to - from).abs(), p.hold_speed))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_time_is_that_of_the_way_and_never_less_than_that_of_the_approach() {
        let p = Parameters::START;
        // the largest speed of a quintic is 15/8 of the mean
        assert!((duration(&p, 0.5, 2.5) - 15.0 / 8.0).abs() < 1e-12, "{}", duration(&p, 0.5, 2.5));
        assert_eq!(duration(&p, 2.5, 0.5), duration(&p, 0.5, 2.5));
        assert_eq!(duration(&p, 0.5, 0.6), p.approach_time);
        for (velocity, stops) in [(0.0, false), (0.1, true), (-0.1, true)] {
            assert_eq!(HoldMotion::stopping(&p, Trajectory { velocity, ..Trajectory::resting(0.2) }).stops(&p), stops);
        }
    }

    #[test]
    fn keeps_the_speed_and_arrives() {
        let p = Parameters::START;
        let mut hold = HoldMotion::at(0.0);
        let mut fastest: f64 = 0.0;
        for _ in 0..20_000 {
            assert!(!hold.arrived(&p) || fastest > 0.0);
            fastest = fastest.max(hold.step(&p, 1.0).velocity.abs());
        }
        assert!((fastest - p.hold_speed).abs() < 1e-6, "{fastest}");
        assert!(hold.arrived(&p));
        assert_eq!(hold.step(&p, 1.0), Trajectory::resting(1.0));
    }

    #[test]
    fn an_arm_that_is_found_moving_stops_before_it_goes_anywhere() {
        let p = Parameters::START;
        for velocity in [-34.0, -1.0, 2.7, 10.0] {
            let mut hold = HoldMotion::stopping(&p, Trajectory { position: 0.1, velocity, acceleration: 0.0 });
            let (mut before, mut maximum) = (velocity, 0.0f64);
            while hold.stops(&p) {
                let now = hold.step(&p, -0.5);
                assert!((now.velocity - before).abs() < 0.3 * p.servo.torque_max / p.servo.inertia * p.sample_period);
                assert!(now.velocity * velocity >= -1e-9);
                (before, maximum) = (now.velocity, maximum.max((now.position - 0.1).abs()));
            }
            assert!(
                maximum < 0.51 * velocity.abs() * (0.012 * velocity.abs() / 10.0).max(0.02),
                "{velocity}: {maximum}"
            );
            let last = (0..20_000).map(|_| hold.step(&p, -0.5)).last();
            assert_eq!(last, Some(Trajectory::resting(-0.5)));
        }
    }

    #[test]
    fn a_new_goal_during_a_motion_is_reached_without_a_jump() {
        let p = Parameters::START;
        let mut hold = HoldMotion::at(0.0);
        let mut before = Trajectory::default();
        for k in 0..20_000 {
            let now = hold.step(&p, if k < 700 { 0.2 } else { -0.3 });
            let predicted = before.position + 0.5 * (before.velocity + now.velocity) * p.sample_period;
            assert!((now.position - predicted).abs() < 1e-8, "sample {k}");
            assert!((now.velocity - before.velocity).abs() < 0.02, "sample {k}");
            before = now;
        }
        assert_eq!(before.position, -0.3);
    }
}
