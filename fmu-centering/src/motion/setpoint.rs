//! Setpoint of the slide: follows a velocity, or moves to a position.

use control_blocks::{Trajectory, stopping_distance};
use serde::{Deserialize, Serialize};

use crate::interface::Parameters;
use crate::motion::profile::Trapezoid;

/// The setpoint and its target; by default without a target.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Motion {
    /// The setpoint itself.
    pub setpoint: Trajectory,
    placed: bool,
    home: f64,
    course: Option<Course>,
}

/// The active move.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Course {
    profile: Trapezoid,
    ticks: u32,
}

impl Motion {
    /// Sets a setpoint at rest to the slide position (m); the first time in any case.
    pub fn reseat(&mut self, position: f64, jumped: bool) {
        if !self.placed || (jumped && self.at_rest()) {
            self.setpoint = Trajectory { position, ..Trajectory::default() };
            (self.placed, self.home, self.course) = (true, position, None);
        }
    }

    /// Starts an approach at the measured position (m); an active retract reverses and keeps its start position.
    pub fn start(&mut self, position: f64) {
        self.reseat(position, true);
        self.course = None;
    }

    /// Starts a move to rest at `end` m with at most `velocity` m/s.
    pub fn go(&mut self, p: &Parameters, end: f64, velocity: f64) {
        self.go_gently(end, velocity, p.slide.acceleration_max);
    }

    /// The same with an acceleration of its own, m/s2.
    pub fn go_gently(&mut self, end: f64, velocity: f64, acceleration: f64) {
        let profile = Trapezoid::new(self.setpoint, end, velocity, acceleration);
        self.course = Some(Course { profile, ticks: 0 });
    }

    /// Starts the return to the start of the approach.
    pub fn retreat(&mut self, p: &Parameters) {
        self.go(p, self.home, p.approach.velocity);
    }

    /// Follows the position (m) of a slide without drive; the slide is not returned from there.
    pub fn yield_to(&mut self, position: f64) {
        self.setpoint = Trajectory { position, ..Trajectory::default() };
        (self.home, self.course) = (position, None);
    }

    /// Ends a move: the setpoint follows the commanded velocity.
    pub fn release(&mut self) {
        self.course = None;
    }

    /// Moves the setpoint for one sample, with the velocity `target` (m/s) if no move is active.
    pub fn step(&mut self, p: &Parameters, target: f64) {
        let dt = p.sample_period;
        match &mut self.course {
            Some(course) => {
                course.ticks = course.ticks.saturating_add(1);
                self.setpoint = course.profile.at(f64::from(course.ticks) * dt);
            }
            None => self.setpoint.step(target, p.slide.acceleration_max, dt),
        }
    }

    /// Whether a move has been over for `dwell` s; false without a move.
    pub fn arrived(&self, p: &Parameters, dwell: f64) -> bool {
        self.course
            .as_ref()
            .is_some_and(|course| f64::from(course.ticks) * p.sample_period >= course.profile.duration() + dwell)
    }

    /// Whether a move is active or has just ended.
    pub fn moving(&self) -> bool {
        self.course.is_some()
    }

    /// Whether the setpoint, stopped now, would end further from the start than `travel`, m.
    pub fn beyond(&self, p: &Parameters, travel: f64) -> bool {
        let velocity = self.setpoint.velocity.max(0.0);
        // one sample early is better than late
        let distance = velocity * p.sample_period + stopping_distance(velocity, p.slide.acceleration_max);
        self.setpoint.position + distance - self.home >= travel
    }

    /// Whether the setpoint is at rest, and no move will change that.
    pub fn resting(&self, p: &Parameters) -> bool {
        self.at_rest() && (!self.moving() || self.arrived(p, 0.0))
    }

    fn at_rest(&self) -> bool {
        self.setpoint.velocity == 0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const P: Parameters = Parameters::PAPER;

    /// A setpoint at its approach velocity after `ticks`, started at 0.3 m.
    fn approaching(ticks: u32) -> Motion {
        let mut motion = Motion::default();
        motion.start(0.3);
        (0..ticks).for_each(|_| motion.step(&P, P.approach.velocity));
        motion
    }

    #[test]
    fn approaches_from_where_it_is() {
        let motion = approaching(200);
        assert_eq!(motion.setpoint.velocity, 0.12);
        // v t - v^2 / 2a
        assert!((motion.setpoint.position - 0.3 - 0.024 + 0.0144 / 5.12).abs() < 1e-5);
    }

    #[test]
    fn retreats_to_where_it_began_and_rests() {
        let mut motion = approaching(200);
        motion.retreat(&P);
        assert!(!motion.resting(&P));
        let mut ticks = 0;
        while !motion.arrived(&P, 0.0) {
            let before = motion.setpoint;
            motion.step(&P, 0.0);
            assert!((motion.setpoint.velocity - before.velocity).abs() <= 2.56e-3 * 1.000_001);
            ticks += 1;
            assert!(ticks < 1000);
        }
        assert_eq!((motion.setpoint.position, motion.setpoint.velocity), (0.3, 0.0));
        assert!(motion.resting(&P));
        // at rest, but about to move
        motion.go(&P, 0.4, 0.1);
        assert!(!motion.resting(&P));
    }

    #[test]
    fn a_start_in_the_middle_of_a_retreat_keeps_its_home() {
        let mut motion = approaching(200);
        motion.retreat(&P);
        (0..100).for_each(|_| motion.step(&P, 0.0));
        motion.start(0.31);
        (0..100).for_each(|_| motion.step(&P, P.approach.velocity));
        motion.retreat(&P);
        (0..1000).for_each(|_| motion.step(&P, 0.0));
        assert_eq!(motion.setpoint.position, 0.3);
    }

    #[test]
    fn stops_inside_its_travel() {
        let mut motion = approaching(100);
        while !motion.beyond(&P, P.approach.travel_max) {
            motion.step(&P, P.approach.velocity);
        }
        motion.retreat(&P);
        let mut furthest: f64 = 0.0;
        for _ in 0..3000 {
            motion.step(&P, 0.0);
            furthest = furthest.max(motion.setpoint.position - 0.3);
        }
        assert!(furthest > 0.1497 && furthest < 0.15, "{furthest}");
    }

    #[test]
    fn only_a_setpoint_at_rest_is_put_elsewhere() {
        let mut motion = approaching(100);
        let before = motion.setpoint;
        motion.reseat(0.7, true);
        assert_eq!(motion.setpoint, before);
        let mut motion = Motion::default();
        motion.reseat(0.2, false);
        motion.reseat(0.7, false);
        assert_eq!(motion.setpoint.position, 0.2);
        motion.reseat(0.7, true);
        assert_eq!(motion.setpoint.position, 0.7);
    }

    #[test]
    fn the_end_of_the_travel_is_seen_a_sample_and_the_braking_before_it() {
        let motion = approaching(200);
        let distance = motion.setpoint.position - 0.3 + 0.12 * 1e-3 + 0.12 * 0.12 / 5.12;
        assert!(motion.beyond(&P, distance - 1e-9) && !motion.beyond(&P, distance + 1e-9));
        // during the return only the position matters
        let mut back = approaching(200);
        back.setpoint.velocity = -0.12;
        let distance = back.setpoint.position - 0.3;
        assert!(back.beyond(&P, distance - 1e-9) && !back.beyond(&P, distance + 1e-9));
    }

    #[test]
    fn a_move_has_arrived_at_its_end_and_dwells_from_then_on() {
        let mut motion = Motion::default();
        motion.reseat(0.1, false);
        assert!(!motion.arrived(&P, 0.0) && !motion.moving() && motion.resting(&P));
        motion.go(&P, 0.101, 0.05);
        let ticks = (0.001 / 0.05 + 0.05 / 2.56) * 1e3;
        let (mut arrived, mut dwelt) = (0, 0);
        for k in 1..200 {
            motion.step(&P, 0.0);
            arrived += u32::from(!motion.arrived(&P, 0.0));
            dwelt += u32::from(!motion.arrived(&P, 0.03));
            assert_eq!(motion.resting(&P), f64::from(k) >= ticks, "{k}");
        }
        assert_eq!((arrived, dwelt), (ticks as u32, ticks as u32 + 30));
        motion.release();
        assert!(!motion.moving());
        motion.yield_to(0.2);
        motion.retreat(&P);
        motion.step(&P, 0.0);
        assert_eq!(motion.setpoint.position, 0.2);
    }
}
