//! Motion of the reference in each state: approach, brake, retract, hold.

use control_blocks::{Trajectory, stopping_distance};
use serde::{Deserialize, Serialize};

use crate::interface::{Approach, Parameters, State};
use crate::motion::travel::{cycle_limit, retract_distance};

/// Reference of the servo in the frame where the workpiece is in the positive direction.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Motion {
    /// The reference itself.
    pub reference: Trajectory,
    /// The tunable parameters of this approach.
    pub approach: Approach,
    /// Maximum time of a cycle with it, s.
    pub cycle_limit: f64,
    /// Motion of the reference in the last sample, m.
    pub requested: f64,
    started_at: f64,
    retreat_from: f64,
    retreat_to: f64,
}

impl Motion {
    /// Reference at rest at 0.
    pub fn new(p: &Parameters) -> Self {
        Self {
            reference: Trajectory::default(),
            approach: p.approach,
            cycle_limit: cycle_limit(p, &p.approach),
            requested: 0.0,
            started_at: 0.0,
            retreat_from: 0.0,
            retreat_to: 0.0,
        }
    }

    /// Begins an approach at the measured position (m), with the tunable parameters of this moment.
    pub fn start(&mut self, p: &Parameters, position: f64, approach: &Approach) {
        (self.approach, self.cycle_limit) = (*approach, cycle_limit(p, approach));
        self.reference = Trajectory { position, ..Trajectory::default() };
        (self.started_at, self.retreat_from, self.retreat_to) = (position, position, position);
    }

    /// Marks where the retreat begins.
    pub fn depart(&mut self, p: &Parameters) {
        self.retract_by(retract_distance(p, &self.approach));
    }

    /// Has `distance` m to go back from here.
    pub fn retract_by(&mut self, distance: f64) {
        self.retreat_from = self.reference.position;
        self.retreat_to = self.retreat_from - distance;
    }

    /// Has at least `distance` m to go back from where the retreat began.
    pub fn retract_farther(&mut self, distance: f64) {
        self.retreat_to = self.retreat_to.min(self.retreat_from - distance);
    }

    /// Continues from another position (m) and velocity (m/s), with the same distance still to retract.
    pub fn reseat(&mut self, position: f64, velocity: f64) {
        let moved = position - self.reference.position;
        (self.retreat_from, self.retreat_to) = (self.retreat_from + moved, self.retreat_to + moved);
        self.reference = Trajectory { position, velocity, acceleration: 0.0 };
    }

    /// Lies at a position (m), with nowhere to go: nothing moves the stage by command.
    pub fn rest_at(&mut self, position: f64) {
        self.reference = Trajectory::resting(position);
        (self.requested, self.retreat_from, self.retreat_to) = (0.0, position, position);
    }

    /// Has no way left to retreat once it has stopped.
    pub fn hold(&mut self) {
        (self.retreat_from, self.retreat_to) = (f64::INFINITY, f64::INFINITY);
    }

    /// Moves the reference for one sample; without a valid position it only stops, and a waiting approach stays at
    /// rest.
    pub fn step(&mut self, p: &Parameters, state: State, valid: bool, wait: bool) {
        let (velocity, acceleration) = match state {
            State::Approach if wait => (0.0, self.approach.acceleration),
            State::Approach | State::Learn | State::Detect => (self.approach.velocity, self.approach.acceleration),
            State::Confirm if self.distance_left(p) => (-self.approach.velocity, p.retract.deceleration),
            State::Confirm => (self.approach.velocity, self.approach.acceleration),
            State::Contact => (-p.retract.velocity, p.retract.deceleration),
            State::Retract | State::Calibrate | State::Fault if valid && self.distance_left(p) => {
                (-p.retract.velocity, p.retract.deceleration)
            }
            _ => (0.0, p.retract.deceleration),
        };
        if state == State::Confirm && velocity > 0.0 {
            // forth from here on
            self.hold();
        }
        let before = self.reference.position;
        self.reference.step(velocity, acceleration, p.sample_period);
        self.requested = self.reference.position - before;
    }

    /// Takes the reference of this sample from elsewhere.
    pub fn follow(&mut self, reference: Trajectory) {
        self.requested = reference.position - self.reference.position;
        self.reference = reference;
    }

    /// Lag (m) of the stage, because the current acts late: v (1 + io_delay) T_s.
    pub fn late(&self, p: &Parameters) -> f64 {
        self.reference.velocity.abs() * (1.0 + f64::from(p.io_delay)) * p.sample_period
    }

    /// Whether the reference moves at the approach speed.
    pub fn cruising(&self) -> bool {
        self.reference.velocity == self.approach.velocity
    }

    /// Whether the reference is at rest.
    pub fn at_rest(&self) -> bool {
        self.reference.velocity == 0.0
    }

    /// Whether the reference is at rest after its retract.
    pub fn retreated(&self, p: &Parameters) -> bool {
        self.at_rest() && !self.distance_left(p)
    }

    /// Whether the reference, stopped now, would end beyond the longest travel.
    pub fn beyond_travel(&self, p: &Parameters) -> bool {
        let braking = stopping_distance(self.reference.velocity, p.retract.deceleration);
        self.reference.position + braking - self.started_at >= self.approach.travel_max
    }

    /// Whether the reference must still move back before it brakes; one sample early is better than late.
    fn distance_left(&self, p: &Parameters) -> bool {
        let Trajectory { position, velocity, .. } = self.reference;
        let braking = stopping_distance(velocity, p.retract.deceleration);
        let margin = velocity.abs() * p.sample_period + 0.5 * p.retract.deceleration * p.sample_period.powi(2);
        position - self.retreat_to > braking + margin
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn approaching(p: &Parameters, ticks: u32) -> Motion {
        let mut motion = Motion::new(p);
        motion.start(p, 0.3, &p.approach);
        for _ in 0..ticks {
            motion.step(p, State::Approach, true, false);
        }
        motion
    }

    #[test]
    fn approaches_from_where_it_is() {
        let p = Parameters::START;
        let motion = approaching(&p, 1020);
        assert!(motion.cruising());
        // 20 ticks of acceleration, 1000 ticks of 10 nm
        assert!((motion.reference.position - 0.3 - 1e-7 - 1e-5).abs() < 1e-12);
    }

    #[test]
    fn retreats_by_its_distance_and_rests() {
        let p = Parameters::START;
        let mut motion = approaching(&p, 1000);
        let from = motion.reference.position;
        motion.depart(&p);
        let ticks = (0..10_000).find(|_| {
            motion.step(&p, State::Retract, true, false);
            motion.retreated(&p)
        });
        assert!(ticks.is_some());
        let distance = from - motion.reference.position;
        assert!((distance - retract_distance(&p, &p.approach)).abs() < 0.2e-6, "{distance} m");
    }

    #[test]
    fn a_stage_is_late_by_the_delay_and_a_sample() {
        let p = Parameters { io_delay: 3, ..Parameters::START };
        let late = approaching(&p, 100).late(&p);
        assert!((late - 4e-8).abs() < 1e-15, "{late} m");
    }

    #[test]
    fn without_a_position_it_only_stops() {
        let p = Parameters::START;
        let mut motion = approaching(&p, 1000);
        motion.depart(&p);
        let from = motion.reference.position;
        for _ in 0..1000 {
            motion.step(&p, State::Fault, false, false);
        }
        assert!(motion.at_rest() && !motion.retreated(&p));
        assert!((motion.reference.position - from).abs() < 1e-8);
    }

    #[test]
    fn stops_inside_the_longest_travel() {
        let mut p = Parameters::START;
        p.approach.travel_max = 1e-4;
        let mut motion = approaching(&p, 100);
        while !motion.beyond_travel(&p) {
            motion.step(&p, State::Detect, true, false);
        }
        while !motion.at_rest() {
            motion.step(&p, State::Fault, false, false);
        }
        let travel = motion.reference.position - 0.3;
        assert!(travel > 0.99e-4 && travel < 1e-4 + 11e-9, "{travel} m");
    }

    #[test]
    fn reseat_keeps_the_distance_to_retract() {
        let p = Parameters::START;
        let mut motion = approaching(&p, 1000);
        motion.depart(&p);
        motion.reseat(0.5, 0.0);
        let left = motion.reference.position - motion.retreat_to;
        assert!((left - retract_distance(&p, &p.approach)).abs() < 1e-15);
    }

    #[test]
    fn a_longer_retract_counts_from_where_the_retreat_began() {
        let p = Parameters::START;
        // in the retract, after it, and after the stage was found elsewhere
        for (samples, moved) in [(100, 0.0), (3000, 0.0), (3000, 0.2)] {
            for (farther, expected) in [(3e-5, 5e-5), (8e-5, 8e-5)] {
                let mut motion = approaching(&p, 1000);
                let from = motion.reference.position;
                motion.retract_by(5e-5);
                let retract = |motion: &mut Motion, samples: u32| {
                    (0..samples).for_each(|_| motion.step(&p, State::Retract, true, false));
                };
                retract(&mut motion, samples);
                motion.reseat(motion.reference.position + moved, motion.reference.velocity);
                motion.retract_farther(farther);
                retract(&mut motion, 3000);
                let distance = from + moved - motion.reference.position;
                assert!(motion.retreated(&p) && (distance - expected).abs() < 0.2e-6, "{distance} m");
            }
        }
        // one that is held has not retreated from anywhere
        let mut motion = approaching(&p, 0);
        motion.hold();
        motion.retract_farther(8e-5);
        assert!(motion.retreated(&p));
    }

    #[test]
    fn an_approach_that_waits_is_at_rest() {
        let p = Parameters::START;
        let mut motion = approaching(&p, 0);
        (0..100).for_each(|_| motion.step(&p, State::Approach, true, true));
        assert_eq!((motion.reference.position, motion.requested, motion.at_rest()), (0.3, 0.0, true));
    }

    #[test]
    fn a_stage_that_is_held_has_no_distance_to_go() {
        let p = Parameters::START;
        let mut motion = approaching(&p, 1000);
        motion.depart(&p);
        motion.reseat(0.5, 1e-3);
        motion.hold();
        (0..100).for_each(|_| motion.step(&p, State::Fault, true, false));
        assert!(motion.retreated(&p));
        // 1 mm/s is braked within 0.25 um
        let distance = motion.reference.position - 0.5;
        assert!((0.0..0.4e-6).contains(&distance), "{distance} m");
    }

    #[test]
    fn a_second_touch_retracts_once_and_then_forth_at_the_approach_speed() {
        let p = Parameters::START;
        let mut motion = approaching(&p, 1000);
        let from = motion.reference.position;
        motion.retract_by(5e-6);
        let positions: Vec<f64> = (0..2000)
            .map(|_| {
                motion.step(&p, State::Confirm, true, false);
                motion.reference.position - from
            })
            .collect();
        let back = positions.iter().copied().fold(0.0, f64::min);
        assert!((back + 5e-6).abs() < 0.1e-6, "{back}");
        let reversal = positions.iter().position(|z| *z == back).unwrap();
        assert!(positions[reversal..].is_sorted() && motion.cruising());
        // 50 ms there at 100 um/s, a reversal of 2 ms
        assert!((490..540).contains(&reversal), "{reversal}");
    }

    #[test]
    fn a_retract_ends_within_a_sample_of_its_distance() {
        for deceleration in [0.01, 2.0, 10.0] {
            for k in 0..20 {
                let mut p = Parameters::START;
                (p.retract.deceleration, p.retract.distance) = (deceleration, 1e-4 * (1.0 + 0.0137 * f64::from(k)));
                let mut motion = approaching(&p, 0);
                motion.depart(&p);
                while !motion.retreated(&p) {
                    motion.step(&p, State::Retract, true, false);
                }
                let left = motion.reference.position - (0.3 - p.retract.distance);
                let sample = p.retract.velocity * p.sample_period + deceleration * p.sample_period.powi(2);
                assert!(left.abs() <= sample, "{deceleration} m/s2: {left} m of {sample} m");
            }
        }
    }
}
