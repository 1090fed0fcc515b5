//! Push plan: launch, distance and velocity.

use std::f64::consts::TAU;

use serde::{Deserialize, Serialize};

use crate::center::Estimate;
use crate::interface::Parameters;
use crate::motion::duration;
use crate::paper::crossing::Crossing;
use crate::paper::push::{distance, lead_angle, velocity};
use crate::sensing::Sample;

/// Inputs of the planner in one step.
#[derive(Clone, Copy, Debug)]
pub struct Situation<'a> {
    /// The ring.
    pub estimate: &'a Estimate,
    /// Smoothed spindle angle, rad.
    pub angle: f64,
    /// Spindle speed, rad/s.
    pub speed: f64,
    /// The encoders.
    pub sample: Sample,
    /// Learned offset P, m.
    pub offset: f64,
}

/// A push at its launch.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct PlannedPush {
    /// Travel d of the slide from its measured position, m.
    pub distance: f64,
    /// Slide position at the end, m.
    pub end: f64,
    /// Velocity v, m/s.
    pub velocity: f64,
    /// Lead angle L, rad.
    pub lead: f64,
}

/// The published plan: computed again in each control period from the present gap.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct LeadPlanner {
    crossing: Crossing,
}

impl LeadPlanner {
    /// The push, in the control period of its launch.
    pub fn update(&mut self, p: &Parameters, now: &Situation) -> Option<PlannedPush> {
        let (b, r) = (now.estimate.center.eccentricity(), p.ring.radius);
        // eq. 29 with its sign put right: positive while following
        let gap = p.probe.at_pusher - now.sample.probe;
        let travel = |lead: f64| distance(r, b, lead, gap, now.offset);
        let velocity = velocity(&p.push, b);
        let delay = start_delay(p);
        let time = |lead: f64| (duration(travel(lead), velocity, p.slide.acceleration_max) + delay).max(0.0);
        let lead = lead_angle(now.speed, time);
        let left = now.speed.signum() * (now.estimate.center.nearest() - now.angle);
        // the beat after a crossing is half a beat late on average
        let early = 0.5 * now.speed.abs() / p.rates.control;
        if !self.crossing.update(left - lead - early) {
            return None;
        }
        let distance = travel(left);
        Some(PlannedPush { distance, end: now.sample.slide + distance, velocity, lead: left.rem_euclid(TAU) })
    }
}

/// Time (s) from the sample of the launch to the start of the stroke.
fn start_delay(p: &Parameters) -> f64 {
    // the first setpoint belongs to the end of its sample
    (f64::from(p.io_delay) - 1.0) * p.sample_period
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::center::Center;
    use control_blocks::wrap;

    const P: Parameters = Parameters::PAPER;
    /// 20 rpm, rad/s.
    const SPEED: f64 = TAU / 3.0;

    /// Angle of the spindle at the launch and the push, for a ring 0.3 mm off, nearest at 1 rad.
    fn launched(speed: f64, phase: f64) -> (f64, PlannedPush) {
        launched_with(&P, speed, phase)
    }

    fn launched_with(p: &Parameters, speed: f64, phase: f64) -> (f64, PlannedPush) {
        let (x, y) = (3e-4 * 1f64.cos(), -3e-4 * 1f64.sin());
        let estimate = Estimate { center: Center { x, y }, mean: 0.08, sigma: 0.0 };
        let mut planner = LeadPlanner::default();
        for k in 0..400 {
            let angle = phase + speed * f64::from(k) / p.rates.control;
            let sample = Sample { angle, slide: 0.1, probe: p.null() };
            let now = Situation { estimate: &estimate, angle, speed, sample, offset: 0.0 };
            if let Some(push) = planner.update(p, &now) {
                return (angle, push);
            }
        }
        panic!("no launch within a revolution");
    }

    #[test]
    fn the_ring_is_nearest_when_the_slide_comes_to_rest() {
        for speed in [SPEED, -SPEED, 4.712, -4.712] {
            for k in 0..50 {
                let (angle, push) = launched(speed, 0.13 * f64::from(k));
                let end = angle + speed * duration(push.distance, push.velocity, P.slide.acceleration_max);
                // half a control beat, and what the ring turns in the longer way of a late launch
                let limit = speed.abs() * 0.0051 * (1.0 + speed.abs() * 3e-4 / push.velocity);
                assert!(wrap(end - 1.0).abs() < limit, "{speed} rad/s: {} rad late", wrap(end - 1.0));
            }
        }
    }

    #[test]
    fn a_known_delay_is_launched_ahead_of() {
        for io_delay in [0, 1, 8] {
            let mut p = P;
            p.io_delay = io_delay;
            let delay = (f64::from(io_delay) - 1.0) * p.sample_period;
            let late = |k: i32| {
                let (angle, push) = launched_with(&p, SPEED, 0.0317 * f64::from(k));
                let t3 = duration(push.distance, push.velocity, p.slide.acceleration_max);
                wrap(angle - 1.0 + SPEED * (delay + t3)) / SPEED
            };
            let mean = (0..200).map(late).sum::<f64>() / 200.0;
            assert!(mean.abs() < 5e-4, "io_delay {io_delay}: {mean} s late on average");
        }
    }

    #[test]
    fn reverse_rotation_is_the_mirror() {
        let (forth, back) = (launched(2.0, 1.0 - 2.5), launched(-2.0, 1.0 + 2.5));
        assert!((forth.0 - 1.0 + (back.0 - 1.0)).abs() < 1e-9);
        assert!((forth.1.distance - back.1.distance).abs() < 1e-12);
        assert!((forth.1.lead - back.1.lead).abs() < 1e-9);
    }

    #[test]
    fn a_spindle_at_rest_launches_nothing_and_stays_finite() {
        let estimate = Estimate { center: Center { x: 3e-4, y: 0.0 }, mean: 0.08, sigma: 0.0 };
        let mut planner = LeadPlanner::default();
        for angle in [0.0, 0.0, -0.0, 1e-3, 0.0] {
            let sample = Sample { angle, slide: 0.1, probe: P.null() };
            let now = Situation { estimate: &estimate, angle, speed: 0.0, sample, offset: 0.0 };
            assert_eq!(planner.update(&P, &now), None);
        }
    }
}
